#pragma once
// Arithmetic expressions in world files (muParser): `0.5 * (thermometer.temperature_C + thermometer1.temperature_C)`.

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sf::sensors {

/// One expression of named numbers: + - * / ^, comparisons, && ||, `a ? b : c`, and the functions of muParser, such as
/// min, max, avg, sum, abs, sqrt, exp, ln, sin, atan2. Numbers that an expression does not use may be anything.
class Expression {
 public:
  /// @param names of letters, digits, '_', '.', '[' and ']'
  /// @throws base::InputError for an expression that is not valid, or uses other names, without file and line
  Expression(const std::string& text, std::vector<std::string> names);
  ~Expression();
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;

  /// Rows in `names` of the numbers that it uses, ascending; at least one.
  std::span<const std::size_t> used() const { return used_; }
  /// Returns the value, which is not finite for a division by zero and the like. @param numbers one per name
  double evaluate(std::span<const double> numbers);

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
  std::vector<std::size_t> used_;
};

/// Returns `text` with '_' for each character that names of numbers cannot have.
std::string expression_name(std::string text);

}  // namespace sf::sensors
