#include "selftest/exact_ray_cast.h"

#include <fmt/format.h>

#include <algorithm>

namespace sf::selftest {

namespace {

/// Returns whether another wall shares the end and lies on the other side of the beam.
bool is_closed(std::span<const world::Segment> surfaces, const Beam& beam, glm::dvec2 end, Real other_side) {
  return std::any_of(surfaces.begin(), surfaces.end(), [&](const world::Segment& s) {
    for (const auto& [near, far] : {std::pair{s.a, s.b}, std::pair{s.b, s.a}}) {
      if (near.x != end.x || near.y != end.y) continue;
      const Real side = beam.x * (Real{far.y} - beam.origin.y) - beam.y * (Real{far.x} - beam.origin.x);
      if (side * other_side < 0) return true;
    }
    return false;
  });
}

}  // namespace

Beam beam_of(const base::Pose& X_WS, const sensors::LaserSettings& laser, std::uint32_t sample) {
  const Real part = laser.samples < 2 ? 0.5L : static_cast<Real>(sample) / static_cast<Real>(laser.samples - 1);
  const Real bearing = static_cast<Real>(laser.fov) * (part - 0.5L);
  const Real yaw = X_WS.yaw, c = std::cos(yaw), s = std::sin(yaw), d = std::cos(bearing), e = std::sin(bearing);
  return {{X_WS.x, X_WS.y}, c * d - s * e, s * d + c * e};
}

Hit nearest_hit(std::span<const world::Segment> surfaces, const Beam& beam, double range_max) {
  Hit best{.range = range_max};
  const auto side_of = [&](glm::dvec2 p) {
    return beam.x * (Real{p.y} - beam.origin.y) - beam.y * (Real{p.x} - beam.origin.x);
  };
  std::vector<std::pair<Real, const world::Segment*>> doubtful;
  for (const world::Segment& s : surfaces) {
    const Real side_a = side_of(s.a), side_b = side_of(s.b);
    const Real ex = Real{s.b.x} - s.a.x, ey = Real{s.b.y} - s.a.y;
    const Real wx = Real{s.a.x} - beam.origin.x, wy = Real{s.a.y} - beam.origin.y;
    const Real below = ex * beam.y - ey * beam.x;
    if (below == 0) continue;
    const Real t = (ex * wy - ey * wx) / below;
    const Real slack = 4e-15L * (std::hypot(wx, wy) + std::hypot(ex, ey));
    if (t >= 0 && std::min(std::fabs(side_a), std::fabs(side_b)) <= slack) doubtful.push_back({t, &s});
    const bool crosses = (side_a >= 0 && side_b <= 0) || (side_a <= 0 && side_b >= 0);
    if (!crosses || t < 0 || t >= best.range) continue;
    best = {t, s.model, std::fabs(below) / std::hypot(ex, ey), std::hypot(wx, wy)};
  }
  for (const auto& [t, s] : doubtful) {
    if (t > best.range * (1 + 1e-12L)) continue;
    const Real side_a = side_of(s->a), side_b = side_of(s->b);
    const bool a_is_near = std::fabs(side_a) < std::fabs(side_b);
    if (!is_closed(surfaces, beam, a_is_near ? s->a : s->b, a_is_near ? side_b : side_a)) best.ambiguous = true;
  }
  return best;
}

double rounding(const Hit& m) { return static_cast<double>(2e-15L * (m.arm + m.range) / m.sine); }

void check_scan(const TestFarm& test, const base::ReadingBlock& reading, Checks& checks, std::string_view what,
                std::uint32_t stride) {
  const sensors::LaserSettings& laser = laser_of(test, reading);
  checks.equal(reading.values.size(), laser.samples, fmt::format("{}: samples", what));
  std::uint64_t hairs = 0;
  for (std::uint32_t i = 0; i < reading.values.size(); i += stride) {
    const Hit met = nearest_hit(test.world->walls, beam_of(reading.X_WS, laser, i), laser.range_max);
    if (met.ambiguous) {
      ++hairs;
    } else if (met.model == base::kNoHit) {
      checks.same(reading.values[i], laser.range_max, what, i);
    } else {
      checks.near(reading.values[i], met.range, rounding(met), what, i);
    }
  }
  if (hairs > 0) checks.note(fmt::format("{}: {} beams pass an end within rounding and were not judged", what, hairs));
}

}  // namespace sf::selftest
