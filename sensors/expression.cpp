#include "sensors/expression.h"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <limits>

#include "base/error.h"
#include "base/suggest.h"

namespace sf::sensors {

namespace {

constexpr const char* kNameCharacters = "0123456789_abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.[]";
constexpr std::size_t kMostCharacters = 4096;

[[noreturn]] void refuse_name(const std::string& name, std::span<const std::string> names) {
  const std::vector<std::string_view> known(names.begin(), names.end());
  throw base::InputError(fmt::format("'{}' is unknown{}", name, base::expected_one_of(name, known)));
}

/// Returns whether a `=` is not part of a comparison.
bool assigns(std::string_view text) {
  const auto is_any = [&](std::size_t at, std::string_view of) {
    return at < text.size() && of.find(text[at]) != std::string_view::npos;
  };
  for (std::size_t at = text.find('='); at != std::string_view::npos; at = text.find('=', at + 1)) {
    if (is_any(at + 1, "="))
      ++at;
    else if (at == 0 || !is_any(at - 1, "<>!"))
      return true;
  }
  return false;
}

}  // namespace

struct Expression::Parser {
  mu::Parser parser;
  std::vector<std::string> names;
  std::vector<double> numbers;
};

Expression::Expression(const std::string& text, std::vector<std::string> names) : parser_(std::make_unique<Parser>()) {
  if (text.size() > kMostCharacters)
    throw base::InputError(fmt::format("is longer than {} characters", kMostCharacters));
  if (assigns(text)) throw base::InputError("assigns with '='; expected '==' to compare");
  parser_->names = std::move(names);
  parser_->numbers.resize(parser_->names.size());
  mu::Parser& parser = parser_->parser;
  try {
    parser.DefineNameChars(kNameCharacters);
    for (std::size_t i = 0; i < parser_->names.size(); ++i) parser.DefineVar(parser_->names[i], &parser_->numbers[i]);
    parser.SetExpr(text);
    int results = 0;
    parser.Eval(results);
    if (results != 1) throw base::InputError("has several values, separated by commas; expected one");
    for (const auto& [name, at] : parser.GetUsedVar()) {
      if (at == nullptr) refuse_name(name, parser_->names);
      if (std::ranges::count(parser_->names, name) > 1)
        throw base::InputError(fmt::format("'{}' is the name of several inputs; rename a robot", name));
      used_.push_back(static_cast<std::size_t>(at - parser_->numbers.data()));
    }
  } catch (const mu::Parser::exception_type& error) {
    if (error.GetCode() == mu::ecUNASSIGNABLE_TOKEN) refuse_name(error.GetToken(), parser_->names);
    throw base::InputError(error.GetMsg());
  }
  if (used_.empty()) {
    const std::vector<std::string_view> known(parser_->names.begin(), parser_->names.end());
    throw base::InputError("uses no input" + base::expected_one_of("", known));
  }
  std::ranges::sort(used_);
}

Expression::~Expression() = default;
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;

double Expression::evaluate(std::span<const double> numbers) {
  std::ranges::copy(numbers, parser_->numbers.begin());
  try {
    return parser_->parser.Eval();
  } catch (const mu::Parser::exception_type&) {
    return std::numeric_limits<double>::quiet_NaN();
  }
}

std::string expression_name(std::string text) {
  for (char& c : text)
    if (std::string_view(kNameCharacters).find(c) == std::string_view::npos) c = '_';
  if (!text.empty() && std::isdigit(static_cast<unsigned char>(text[0])) != 0) text.insert(text.begin(), '_');
  return text;
}

}  // namespace sf::sensors
