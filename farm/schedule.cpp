#include "farm/schedule.h"

#include <cmath>

namespace sf::farm {

std::uint64_t readings_begun(std::int64_t now, double rate, double phase) {
  // Whole seconds and the rest apart: a year in nanoseconds does not fit a double's significand times a rate.
  const auto start = static_cast<std::int64_t>(std::llround(phase * 1e9));
  const std::int64_t since = now - start;
  if (since < 0) return 0;
  const std::int64_t seconds = since / 1'000'000'000;
  const std::int64_t rest = since % 1'000'000'000;
  const double whole = static_cast<double>(seconds) * rate;
  const double part = static_cast<double>(rest) * 1e-9 * rate;
  constexpr double kNanosecond = 1e-9;
  const double base = std::floor(whole);
  return static_cast<std::uint64_t>(base) +
         static_cast<std::uint64_t>(std::floor((whole - base) + part + kNanosecond * rate)) + 1;
}

}  // namespace sf::farm
