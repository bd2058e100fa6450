// Tests the comparison of the self-check with synthetic results, because no installed driver is faulty.

#include "gpu/self_check_arithmetic.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

namespace sf::gpu {
namespace {

using Form = Operation::Form;

/// First pair with an ordinary quotient; the four pairs before it are border cases.
constexpr std::size_t kOrdinary = 4;

std::size_t place(std::size_t row, std::string_view name) {
  for (std::size_t k = 0; k < operations().size(); ++k)
    if (operations()[k].name == name) return row * operations().size() + k;
  ADD_FAILURE() << "no operation " << name;
  return 0;
}

std::string difference_with(std::size_t at, std::uint64_t result) {
  std::vector<std::uint64_t> found = expected_results();
  found[at] = result;
  return first_difference(found);
}

TEST(Arithmetic, HostAgreesWithItself) {
  EXPECT_EQ(operands().size(), 64u) << "one group";
  EXPECT_EQ(expected_results().size(), 64 * operations().size());
  EXPECT_EQ(first_difference(expected_results()), "");
}

TEST(Arithmetic, FaultNamesOperationOperandsFoundAndExpected) {
  const std::size_t at = place(kOrdinary, "a + b");
  EXPECT_EQ(difference_with(at, std::bit_cast<std::uint64_t>(5.5)),
            "differs from IEEE 754 in a + b: a = 3.1415926535897931 and b = 2.7182818284590451 give 5.5, not "
            "5.8598744820488378");
  EXPECT_EQ(difference_with(place(kOrdinary, "float(a)"), std::bit_cast<std::uint32_t>(3.0f)),
            "differs from IEEE 754 in float(a): a = 3.1415926535897931 and b = 2.7182818284590451 give 3, not "
            "3.14159274");
  EXPECT_EQ(difference_with(place(kOrdinary, "comparisons of a with b"), 0x28),
            "differs from IEEE 754 in comparisons of a with b: a = 3.1415926535897931 and b = 2.7182818284590451 give "
            "0x28, not 0x38");
}

/// An error in the last place, in any row, is detected and named for all operations that must be bit-exact.
TEST(Arithmetic, DetectsALastBitErrorInEveryOperation) {
  const std::vector<std::uint64_t> right = expected_results();
  for (std::size_t at = 0; at < right.size(); ++at) {
    const Operation& operation = operations()[at % operations().size()];
    const bool is_zero = right[at] << 1 == 0;  // +-0 and the smallest denormal
    const bool is_nan = operation.form == Form::f64 && std::isnan(std::bit_cast<double>(right[at]));
    if (!operation.required || operation.tolerance > 0.0 || is_zero || is_nan) continue;
    const std::string text = difference_with(at, right[at] ^ 1u);
    EXPECT_EQ(text.find("differs from IEEE 754 in " + std::string(operation.name) + ": "), 0u) << at << " " << text;
  }
}

/// Vulkan leaves these open, and no reading depends on them.
TEST(Arithmetic, IgnoresSignsOfZeroAndBitsOfNaN) {
  const std::size_t zero = place(0, "a + b");
  EXPECT_EQ(expected_results()[zero], 0u);
  EXPECT_EQ(difference_with(zero, std::bit_cast<std::uint64_t>(-0.0)), "");
  EXPECT_NE(difference_with(zero, 1), "") << "the least number is not 0";
  const std::size_t nan = place(1, "a where a > b, else NaN");
  EXPECT_EQ(difference_with(nan, std::bit_cast<std::uint64_t>(-std::numeric_limits<double>::quiet_NaN())), "");
  EXPECT_NE(difference_with(nan, 0), "") << "a reading that is missing may not become 0";
  EXPECT_NE(difference_with(zero, std::bit_cast<std::uint64_t>(std::numeric_limits<double>::quiet_NaN())), "");
}

/// 32-bit roots may be wrong in the last places; a step of Newton's method squares the relative error.
TEST(Arithmetic, NewtonRootsHaveATolerance) {
  for (const char* name :
       {"1 / sqrt(1 + a * a) to 1e-12, by Newton's method", "sqrt(1 + a * a) to 1e-12, by Newton's method"}) {
    const std::size_t at = place(kOrdinary, name);
    const auto right = std::bit_cast<double>(expected_results()[at]);
    EXPECT_EQ(difference_with(at, std::bit_cast<std::uint64_t>(right * (1 + 0.9e-12))), "");
    EXPECT_EQ(difference_with(at, std::bit_cast<std::uint64_t>(right * (1 - 0.9e-12))), "");
    EXPECT_NE(difference_with(at, std::bit_cast<std::uint64_t>(right * (1 + 1.1e-12))), "");
    EXPECT_NE(difference_with(at, std::bit_cast<std::uint64_t>(right * (1 - 1.1e-12))), "");
  }
}

/// Kernels compute them in 64 bits on devices that round differently, so no device is rejected for them.
TEST(Arithmetic, ReportsButDoesNotRequire32BitRounding) {
  EXPECT_TRUE(rounds32(expected_results()));
  for (const char* name : {"sqrt(1 + a * a) in 32 bits", "a / b in 32 bits, 0 where b is 0"}) {
    std::vector<std::uint64_t> found = expected_results();
    found[place(63, name)] ^= 1u;
    EXPECT_FALSE(rounds32(found)) << name;
    EXPECT_EQ(first_difference(found), "") << name;
  }
  std::vector<std::uint64_t> found = expected_results();
  found[place(kOrdinary, "a + b")] ^= 1u;
  EXPECT_TRUE(rounds32(found)) << "of 64 bits";
}

/// Typical driver mistakes: fused products, a 32-bit quotient, a 32-bit root, a flushed or truncated conversion.
TEST(Arithmetic, DetectsTypicalDriverErrors) {
  const auto found_in = [](const char* name, auto wrong) {
    std::vector<std::uint64_t> found = expected_results();
    for (std::size_t row = 0; row < operands().size(); ++row) found[place(row, name)] = wrong(operands()[row]);
    return first_difference(found);
  };
  const auto f64 = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  EXPECT_NE(found_in("a * b - b * (0.9 * a), unfused",
                     [&](Operands o) { return f64(std::fma(o.a, o.b, -(o.b * (0.9 * o.a)))); }),
            "");
  EXPECT_NE(found_in("a + b * (0.9 * a), unfused", [&](Operands o) { return f64(std::fma(o.b, 0.9 * o.a, o.a)); }), "");
  EXPECT_NE(found_in("a * a + b * b, unfused", [&](Operands o) { return f64(std::fma(o.a, o.a, o.b * o.b)); }), "");
  EXPECT_NE(found_in("a / b, 0 where b is 0", [&](Operands o) { return f64(o.b != 0 ? o.a * (1.0 / o.b) : 0.0); }), "");
  EXPECT_NE(found_in("a / b, 0 where b is 0", [&](Operands o) { return f64(o.a / (o.b != 0 ? o.b : 1.0)); }), "");
  EXPECT_NE(found_in("sqrt(a * a + b * b)",
                     [&](Operands o) { return f64(std::sqrt(static_cast<float>(o.a * o.a + o.b * o.b))); }),
            "");
  EXPECT_NE(found_in("double(int of the low word of a)",
                     [&](Operands o) { return f64(static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(o.a))); }),
            "")
      << "unsigned";
  EXPECT_NE(found_in("float(a)",
                     [&](Operands o) {
                       const auto x = static_cast<float>(o.a);
                       return std::bit_cast<std::uint32_t>(std::abs(x) > std::abs(o.a) ? std::nextafter(x, 0.0f) : x);
                     }),
            "")
      << "truncated";
}

}  // namespace
}  // namespace sf::gpu
