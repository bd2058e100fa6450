#pragma once
// The operations of shaders/self_check.comp on the host. Vulkan promises little about 64-bit arithmetic, and the farm's
// last word on every range is 64-bit.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sf::gpu {

struct Operands {
  double a;
  double b;
};

/// The operations on each pair.
struct Operation {
  enum class Form { f64, f32, word };  ///< of a result: a double, a float in the low word, or a low word of bits
  const char* name;
  double tolerance;  ///< relative; 0 where readings are to be the same bits on every device
  Form form;
  std::uint64_t (*evaluate)(Operands);
};
std::span<const Operation> operations();

/// Sixty-four pairs: sixty whose sums, products and quotients need every bit, and four at the borders of comparisons.
std::vector<Operands> operands();

/// Row by row of `operands()`, all operations: the order in which the device answers.
std::vector<std::uint64_t> expected_results();

/// @param found as many results as `expected_results()` has
/// @return "" when they agree (the sign of a zero and the bits of a NaN are free), else one line with the first
/// difference: operation, operands, expected and found.
std::string first_difference(std::span<const std::uint64_t> found);

}  // namespace sf::gpu
