#include "gpu/self_check_arithmetic.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace sf::gpu {

namespace {

using Form = Operation::Form;

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }
std::uint64_t bits32(float x) { return std::bit_cast<std::uint32_t>(x); }
float root32(Operands o) { return std::sqrt(static_cast<float>(1.0 + o.a * o.a)); }

std::uint64_t sum_of_eight(Operands o) {
  double total = 0.0;
  double x = o.a;
  for (int turn = 0; turn < 8; ++turn) {
    total += x * o.b;
    x *= 0.9;
  }
  return bits(total);
}

std::uint64_t compared(Operands o) {
  return (o.a < o.b ? 1u : 0u) | (o.a <= o.b ? 2u : 0u) | (o.a == o.b ? 4u : 0u) | (o.a > o.b ? 8u : 0u) |
         (o.a >= o.b ? 16u : 0u) | (o.a != o.b ? 32u : 0u);
}

std::uint64_t turned32(Operands o) {
  const auto x = static_cast<float>(o.a);
  const auto y = static_cast<float>(o.b);
  return bits32(x * y - y * (0.9f * x));
}

std::uint64_t quotient32(Operands o) {
  const auto divisor = static_cast<float>(o.b);
  return bits32(divisor != 0.0f ? static_cast<float>(o.a) / divisor : 0.0f);
}

std::uint64_t inverse_root(Operands o) {
  const double square = 1.0 + o.a * o.a;
  const auto rough = static_cast<double>(1.0f / root32(o));
  return bits(rough * (1.5 - 0.5 * (square * rough * rough)));
}

std::uint64_t refined_root(Operands o) {
  const double square = 1.0 + o.a * o.a;
  const auto s = static_cast<double>(root32(o));
  return bits(s + (square - s * s) * static_cast<double>(0.5f / root32(o)));
}

/// Vulkan allows errors of a few ulps in 32-bit roots and quotients. One step of Newton's method reduces them below
/// 1e-12.
constexpr double kNewton = 1e-12;

constexpr Operation kOperations[] = {
    {"a + b", 0, Form::f64, [](Operands o) { return bits(o.a + o.b); }},
    {"a - b", 0, Form::f64, [](Operands o) { return bits(o.a - o.b); }},
    {"a * b", 0, Form::f64, [](Operands o) { return bits(o.a * o.b); }},
    {"a / b, 0 where b is 0", 0, Form::f64, [](Operands o) { return bits(o.b != 0.0 ? o.a / o.b : 0.0); }},
    {"a * b - b * (0.9 * a), unfused", 0, Form::f64, [](Operands o) { return bits(o.a * o.b - o.b * (0.9 * o.a)); }},
    {"a + b * (0.9 * a), unfused", 0, Form::f64, [](Operands o) { return bits(o.a + o.b * (0.9 * o.a)); }},
    {"a * a + b * b, unfused", 0, Form::f64, [](Operands o) { return bits(o.a * o.a + o.b * o.b); }},
    {"sqrt(a * a + b * b)", 0, Form::f64, [](Operands o) { return bits(std::sqrt(o.a * o.a + o.b * o.b)); }},
    {"the sum of eight products of b", 0, Form::f64, sum_of_eight},
    {"min(max(a, b), 3)", 0, Form::f64, [](Operands o) { return bits(std::min(std::max(o.a, o.b), 3.0)); }},
    {"comparisons of a with b", 0, Form::word, compared},
    {"a where a > b, else NaN", 0, Form::f64,
     [](Operands o) { return bits(o.a > o.b ? o.a : std::numeric_limits<double>::quiet_NaN()); }},
    {"double(float of the high word of a)", 0, Form::f64,
     [](Operands o) { return bits(std::bit_cast<float>(static_cast<std::uint32_t>(bits(o.a) >> 32))); }},
    {"double(int of the low word of a)", 0, Form::f64,
     [](Operands o) { return bits(static_cast<std::int32_t>(static_cast<std::uint32_t>(bits(o.a)))); }},
    {"float(a)", 0, Form::f32, [](Operands o) { return bits32(static_cast<float>(o.a)); }},
    {"float(a) * float(b) - float(b) * (0.9 * float(a)), unfused", 0, Form::f32, turned32},
    {"1 / sqrt(1 + a * a) to 1e-12, by Newton's method", kNewton, Form::f64, inverse_root},
    {"sqrt(1 + a * a) to 1e-12, by Newton's method", kNewton, Form::f64, refined_root},
    {"sqrt(1 + a * a) in 32 bits", 0, Form::f32, [](Operands o) { return bits32(root32(o)); }, false},
    {"a / b in 32 bits, 0 where b is 0", 0, Form::f32, quotient32, false},
};

double value(std::uint64_t result, Form form) {
  return form == Form::f64 ? std::bit_cast<double>(result) : std::bit_cast<float>(static_cast<std::uint32_t>(result));
}

bool agree(const Operation& operation, std::uint64_t expected, std::uint64_t found) {
  if (operation.form == Form::word || expected == found) return expected == found;
  const double e = value(expected, operation.form);
  const double f = value(found, operation.form);
  return (std::isnan(e) && std::isnan(f)) || std::abs(f - e) <= operation.tolerance * std::abs(e);
}

std::string result_text(std::uint64_t result, Form form) {
  if (form == Form::word) return fmt::format("{:#x}", result);
  return fmt::format("{:.{}g}", value(result, form), form == Form::f64 ? 17 : 9);
}

}  // namespace

std::span<const Operation> operations() { return kOperations; }

std::vector<Operands> operands() {
  std::vector<Operands> rows{{0.0, -0.0}, {-0.0, 2.5}, {M_PI, M_PI}, {-1e-9, 0.0}};
  double a = M_PI;
  double b = M_E;
  while (rows.size() < 64) {
    rows.push_back({a, b});
    a = std::fmod(a * 1.9999371 + b * 0.37, 1e5) + 1e-3;
    b = -b * 1.0437 + 1e-7 * a;
  }
  return rows;
}

std::vector<std::uint64_t> expected_results() {
  std::vector<std::uint64_t> results;
  for (const Operands& row : operands())
    for (const Operation& operation : kOperations) results.push_back(operation.evaluate(row));
  return results;
}

std::string first_difference(std::span<const std::uint64_t> found) {
  const std::vector<Operands> rows = operands();
  const std::vector<std::uint64_t> expected = expected_results();
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Operation& operation = kOperations[i % std::size(kOperations)];
    if (!operation.required || agree(operation, expected[i], found[i])) continue;
    const Operands& o = rows[i / std::size(kOperations)];
    return fmt::format("differs from IEEE 754 in {}: a = {:.17g} and b = {:.17g} give {}, not {}", operation.name, o.a,
                       o.b, result_text(found[i], operation.form), result_text(expected[i], operation.form));
  }
  return "";
}

bool rounds32(std::span<const std::uint64_t> found) {
  const std::vector<std::uint64_t> expected = expected_results();
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Operation& operation = kOperations[i % std::size(kOperations)];
    if (!operation.required && !agree(operation, expected[i], found[i])) return false;
  }
  return true;
}

}  // namespace sf::gpu
