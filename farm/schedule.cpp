#include "farm/schedule.h"

#include <cmath>
#include <limits>

#include "base/time.h"

namespace sf::farm {

namespace {

// A year in nanoseconds times a rate exceeds a double's significand.
using Wide = long double;
static_assert(std::numeric_limits<Wide>::digits >= 64);

}  // namespace

std::uint64_t readings_started(std::int64_t now, double rate, double phase) {
  const std::int64_t since = now - base::nanoseconds(phase);
  if (since < 0) return 0;
  constexpr Wide kNanosecond = 1e-9L;
  return static_cast<std::uint64_t>(std::floor((static_cast<Wide>(since) + 1.0L) * kNanosecond * rate)) + 1;
}

std::int64_t due_time(std::uint64_t k, double rate, double phase) {
  const Wide due =
      std::round(1e9L * static_cast<Wide>(k) / static_cast<Wide>(rate)) + static_cast<Wide>(base::nanoseconds(phase));
  return due < static_cast<Wide>(kNever) ? static_cast<std::int64_t>(due) : kNever;
}

}  // namespace sf::farm
