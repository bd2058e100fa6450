#pragma once
// Host versions of the operations in shaders/self_check.comp. Vulkan guarantees little about 64-bit arithmetic, but the
// final decision of every range depends on it.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sf::gpu {

struct Operands {
  double a;
  double b;
};

/// One operation, applied to each pair of operands.
struct Operation {
  enum class Form { f64, f32, word };  ///< format of a result: a double, a float in the low word, or low-word bits
  const char* name;
  double tolerance;  ///< relative; 0 if readings must be bit-identical on every device
  Form form;
  std::uint64_t (*evaluate)(Operands);
  bool required = true;  ///< false: a device may differ (`rounds32`)
};
std::span<const Operation> operations();

/// Returns 64 pairs: 60 whose sums, products and quotients need every bit, and 4 at the boundaries of comparisons.
std::vector<Operands> operands();

/// Returns the results of all operations, row by row of `operands()`, in the order of the device's results.
std::vector<std::uint64_t> expected_results();

/// @param found as many results as `expected_results()`
/// @return "" if they agree (ignoring the sign of a zero and the bits of a NaN), else one line with the first
/// difference of a required operation: its name, operands, expected and found
std::string first_difference(std::span<const std::uint64_t> found);

/// Returns true when 32-bit roots and quotients are rounded as IEEE 754 requires; Vulkan allows errors of a few ulps.
bool rounds32(std::span<const std::uint64_t> found);

}  // namespace sf::gpu
