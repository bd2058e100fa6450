#include "base/random.h"

#include <Random123/philox.h>

#include <cmath>

#include "base/elementary.h"

namespace sf::base {

namespace {

double open_unit(std::uint32_t high, std::uint32_t low) {
  const std::uint64_t bits = (static_cast<std::uint64_t>(high) << 32 | low) >> 11;
  return (static_cast<double>(bits) + 0.5) * 0x1.0p-53;
}

std::uint32_t fold(std::uint64_t word) { return static_cast<std::uint32_t>(word ^ (word >> 32) * 0x9E3779B9u); }

}  // namespace

std::array<std::uint32_t, 4> random_words(const RandomKey& draw, std::uint32_t index) {
  // The key holds the seed and the counter holds the rest. The stream shares a word with `b` (sensor below 2^24, stream
  // below 2^8). The 64-bit `c` (tick) is folded to 32 bits.
  const philox4x32_key_t key = {{static_cast<std::uint32_t>(draw.seed), static_cast<std::uint32_t>(draw.seed >> 32)}};
  const philox4x32_ctr_t counter = {
      {index, draw.a, draw.b << 8 | static_cast<std::uint32_t>(draw.stream), fold(draw.c)}};
  const philox4x32_ctr_t words = philox4x32(counter, key);
  return {words.v[0], words.v[1], words.v[2], words.v[3]};
}

std::array<double, 2> random_uniform(const RandomKey& draw, std::uint32_t index) {
  const auto w = random_words(draw, index);
  return {open_unit(w[0], w[1]), open_unit(w[2], w[3])};
}

std::array<double, 2> random_normal(const RandomKey& draw, std::uint32_t index) {
  const auto u = random_uniform(draw, index);
  const double radius = draw.sigma * std::sqrt(-2.0 * log(u[0]));
  const SinCos angle = sin_cos(2.0 * M_PI * u[1]);
  return {radius * angle.cos, radius * angle.sin};
}

}  // namespace sf::base
