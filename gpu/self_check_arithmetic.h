#pragma once
// The operations of shaders/self_check.comp on the host. Vulkan guarantees little about 64-bit arithmetic, on which the
// final decision of every range depends.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sf::gpu {

struct Operands {
  double a;
  double b;
};

/// The operations on each pair of operands.
struct Operation {
  enum class Form { f64, f32, word };  ///< format of a result: a double, a float in the low word, or a low word of bits
  const char* name;
  double tolerance;  ///< relative; 0 where readings must be bit-identical on every device
  Form form;
  std::uint64_t (*evaluate)(Operands);
  bool required = true;  ///< false: a device may differ (`rounds32`)
};
std::span<const Operation> operations();

/// 64 pairs: 60 whose sums, products and quotients need every bit, and 4 at the borders of comparisons.
std::vector<Operands> operands();

/// Results of all operations, row by row of `operands()`, in the order of the device's results.
std::vector<std::uint64_t> expected_results();

/// @param found as many results as `expected_results()`
/// @return "" when they agree (the sign of a zero and the bits of a NaN are free), else one line with the first
/// difference of a required operation: its name, operands, expected and found
std::string first_difference(std::span<const std::uint64_t> found);

/// True when 32-bit roots and quotients are rounded as IEEE 754 states; Vulkan allows errors of a few last places.
bool rounds32(std::span<const std::uint64_t> found);

}  // namespace sf::gpu
