#include "raycast/host_cast.h"

#include <cmath>
#include <numeric>

namespace sf::raycast {

namespace {

using base::Vec2;

constexpr double kFullTurn = 4.0;
constexpr double kHalfTurn = 2.0;
/// Far above what rounding does to a turn, far below what is between two beams.
constexpr double kSlack = 1e-9;

/// Rises with the angle of `v` from 0 to 4, and opposite vectors are 2 apart: bearings in order, without trigonometry.
double turn_of(Vec2 v) {
  const double t = v.x / (std::abs(v.x) + std::abs(v.y));
  return v.y >= 0.0 ? 1.0 - t : 3.0 + t;
}

void lay_out_beams(const HostFan& fan, HostCast& cast) {
  const std::size_t beams = fan.bearings.size() / 2;
  cast.decisions.assign(beams, {fan.range_max});
  cast.directions.resize(beams);
  cast.turns.resize(beams);
  cast.order.resize(beams);
  for (std::size_t i = 0; i < beams; ++i) {
    const double c = fan.bearings[2 * i], s = fan.bearings[2 * i + 1];
    cast.directions[i] = {fan.heading.x * c - fan.heading.y * s, fan.heading.y * c + fan.heading.x * s};
    cast.turns[i] = turn_of(cast.directions[i]);
  }
  std::iota(cast.order.begin(), cast.order.end(), 0u);
  std::sort(cast.order.begin(), cast.order.end(),
            [&](std::uint32_t i, std::uint32_t k) { return cast.turns[i] < cast.turns[k]; });
  std::sort(cast.turns.begin(), cast.turns.end());
}

/// Decides `surface` for the beams that point between two turns.
void meet(const HostFan& fan, HostCast& cast, const Surface& surface, double low, double high) {
  const auto first = std::lower_bound(cast.turns.begin(), cast.turns.end(), low) - cast.turns.begin();
  for (auto i = static_cast<std::size_t>(first); i < cast.turns.size() && cast.turns[i] <= high; ++i) {
    const std::uint32_t beam = cast.order[i];
    decide(surface, fan.origin, cast.directions[beam], cast.decisions[beam]);
  }
}

}  // namespace

void cast_on_host(const HostFan& fan, HostCast& cast) {
  lay_out_beams(fan, cast);
  for (const Surface& surface : cast.surfaces) {
    const ExactSegment& s = surface.at;
    const double a = turn_of({s.ax - fan.origin.x, s.ay - fan.origin.y});
    const double b = turn_of({s.bx - fan.origin.x, s.by - fan.origin.y});
    const double low = std::min(a, b) - kSlack, high = std::max(a, b) + kSlack;
    const double apart = std::abs(a - b);
    // A surface through the origin, or with an end on it, has no side of its own.
    if (!(std::abs(apart - kHalfTurn) > 4.0 * kSlack)) {
      meet(fan, cast, surface, 0.0, kFullTurn);
    } else if (apart < kHalfTurn) {
      meet(fan, cast, surface, low, high);
      if (low < 0.0) meet(fan, cast, surface, low + kFullTurn, kFullTurn);
      if (high > kFullTurn) meet(fan, cast, surface, 0.0, high - kFullTurn);
    } else {
      meet(fan, cast, surface, high - 2.0 * kSlack, kFullTurn);
      meet(fan, cast, surface, 0.0, low + 2.0 * kSlack);
    }
  }
  for (Decision& decision : cast.decisions) decision.range = std::max(decision.range, fan.range_min);
}

}  // namespace sf::raycast
