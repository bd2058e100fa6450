// This device compared with plain C++, and 32-bit arithmetic compared with the farm.

#include <fmt/format.h>

#include "base/random.h"
#include "base/time.h"
#include "selftest/exact_ray_cast.h"
#include "selftest/suite.h"
#include "sensors/laser_reference.h"

namespace sf::selftest {

namespace {

constexpr std::uint64_t kSeed = 11;

double random_place(std::uint32_t index) {
  return base::random_uniform({kSeed, base::RandomStream::placement, 0, 0, index}, 0)[0];
}

/// Blocks at any angle with robots between and on them, `far` from the origin.
world::World crowd(double far, const sensors::LaserSettings& laser) {
  world::World world;
  const glm::dvec2 away{far, -far};
  add_room(world, away - glm::dvec2{8.0, 8.0}, 16.0);
  std::uint32_t draw = 0;
  const auto next = [&] { return random_place(draw++); };
  for (int i = 0; i < 60; ++i) {
    const Pose X{15.0 * next() - 7.5, 15.0 * next() - 7.5, 0.0, 7.0 * next()};
    const double x = 0.1 + next(), y = 0.1 + 0.5 * next();
    std::vector<glm::dvec2> block;
    for (const glm::dvec2& p : {glm::dvec2{-x, -y}, glm::dvec2{x, -y}, glm::dvec2{x, y}, glm::dvec2{-x, y}})
      block.push_back(away + base::transform(X, p));
    add_outline(world, block);
  }
  for (int i = 0; i < 60; ++i) {
    const std::uint32_t m =
        add_laser_mover(world, {far + 15.0 * next() - 7.5, -far + 15.0 * next() - 7.5, 0.0, 9.0 * next()}, laser);
    add_body(world, m, 0.2);
  }
  return world;
}

struct Disagreements {
  std::uint64_t beams = 0, found = 0;
};

void beside(Fixture& fixture, Checks& checks, const world::World& world, const std::string& what, Disagreements& all) {
  TestFarm test = fixture.measure(world, {.seed = kSeed});
  sensors::LaserReference reference(*test.world, kSeed);
  std::vector<Pose> poses;
  for (const world::Mover& m : world.movers) poses.push_back(m.X_WM);
  for (int tick = 1; tick <= 2; ++tick) {
    std::vector<base::Report> reports;
    for (std::uint32_t m = 0; m < poses.size(); ++m) {
      poses[m].x += 0.05;
      poses[m].yaw += 0.7;
      reports.push_back({m, 0, poses[m], {}});
    }
    reference.set_poses(poses);
    for (const base::ReadingBlock& r : test.farm->tick(tick * 100'000'000ll, reports)) {
      const auto scan = reference.scan(r.mover, r.sensor, r.sequence);
      const double allowed = allowed_from_plain_cpp(fixture, test, r);
      for (std::size_t i = 0; i < r.values.size(); ++i, ++all.beams) {
        const bool same = std::abs(r.values[i] - scan.ranges[i]) <= allowed && r.hits[i] == scan.hits[i];
        all.found += !same;
        if (!same)
          checks.note(fmt::format("{}, robot {} beam {}: {:.17g} m, plain C++ {:.17g} m", what, r.mover, i, r.values[i],
                                  scan.ranges[i]));
        check_range(r.values[i], scan.ranges[i], allowed, checks, what, i);
        checks.equal(r.hits[i], scan.hits[i], what, i);
      }
    }
  }
}

void plain_cpp(Fixture& fixture, Checks& checks) {
  Disagreements all;
  sensors::LaserSettings noisy = laser(91, 4.0, 6.0);
  noisy.noise = {.range_sigma = 0.01, .range_proportional = 0.02, .angle_sigma = 0.005};
  sensors::LaserSettings sparse = laser(361, M_PI, 8.0);
  sparse.resolution = 7;
  sparse.range_min = 0.3;
  for (const double far : {0.0, 1e5, 1e7})
    beside(fixture, checks, crowd(far, laser(181, M_PI, 8.0)), fmt::format("{:g} m away", far), all);
  beside(fixture, checks, crowd(0.0, noisy), "with noise", all);
  beside(fixture, checks, crowd(0.0, sparse), "every 7th beam", all);
  beside(fixture, checks, crowd(0.0, laser(12, 2.0 * M_PI, 100.0)), "12 beams of 100 m", all);
  beside(fixture, checks, crowd(0.0, laser(181, 1e-3, 0.05)), "a range of 5 cm", all);
  checks.note(fmt::format("{} of {} beams are not bitwise equal", all.found, all.beams));
}

/// Readings after a year and at tick 1e9, with noise.
void tick_1e9(Fixture& fixture, Checks& checks) {
  constexpr std::int64_t kPeriod = base::kSecond / 10;
  world::World world;
  add_room(world, {-2.0, -2.0}, 4.0);
  sensors::LaserSettings eye = laser(61, 3.0, 8.0);
  eye.noise = {.range_sigma = 0.01, .angle_sigma = 0.001};
  add_laser_mover(world, {0.2, 0.1, 0.0, 0.0}, eye);
  TestFarm test = fixture.measure(std::move(world), {.seed = kSeed});
  const sensors::LaserReference reference(*test.world, kSeed);
  for (const std::int64_t tick : {315'569'520ll, 1'000'000'000ll, 1'000'000'001ll}) {
    const auto what = fmt::format("tick {}", tick);
    const auto readings = test.farm->tick(tick * kPeriod, {});
    checks.equal(readings.size(), 1u, what + ": readings");
    if (readings.empty()) return;
    checks.equal(readings[0].sequence, tick, what + ": number");
    checks.equal(readings[0].time, tick * kPeriod, what + ": time");
    const auto scan = reference.scan(0, 0, readings[0].sequence);
    const double allowed = allowed_from_plain_cpp(fixture, test, readings[0]);
    for (std::size_t i = 0; i < scan.ranges.size(); ++i)
      check_range(readings[0].values[i], scan.ranges[i], allowed, checks, what, i);
  }
}

/// Computes the same beam by the same formula in 32 bits, as a caster in world coordinates would.
double in_32_bits(glm::dvec2 eye, double yaw, const world::Segment& s) {
  const auto f = [](double x) { return static_cast<float>(x); };
  const float dx = std::cos(f(yaw)), dy = std::sin(f(yaw));
  const float wx = f(s.a.x) - f(eye.x), wy = f(s.a.y) - f(eye.y);
  const float ex = f(s.b.x) - f(s.a.x), ey = f(s.b.y) - f(s.a.y);
  return static_cast<double>((ex * wy - ey * wx) / (ex * dy - ey * dx));
}

/// Robots 2 m in front of a slanted wall: the farm is checked against 64-bit rounding; errors of 32 bits are noted.
void where_32_bits_break(Fixture& fixture, Checks& checks) {
  for (const double far : {0.0, 1e3, 1e5, 1e7}) {
    world::World world;
    add_wall(world, {far + 2.1, far - 5.3}, {far + 3.7, far + 5.9});
    for (std::uint32_t i = 0; i < 100; ++i)
      add_laser_mover(world, {far + random_place(2 * i), far + random_place(2 * i + 1), 0.0, 0.1 * random_place(i)},
                      laser(1, 0.0, 8.0));
    const TestFarm test = fixture.measure(world);
    Real ours = 0, theirs = 0;
    for (const base::ReadingBlock& r : test.readings) {
      const Hit met = nearest_hit(test.world->walls, beam_of(r.X_WS, laser(1, 0.0, 8.0), 0), 8.0);
      checks.near(r.values[0], met.range, rounding(met), fmt::format("{:g} m away", far), r.mover);
      const double single = in_32_bits({r.X_WS.x, r.X_WS.y}, r.X_WS.yaw, test.world->walls[0]);
      ours = std::max(ours, std::fabs(Real{r.values[0]} - met.range));
      if (std::isfinite(single)) theirs = std::max(theirs, std::fabs(Real{single} - met.range));
    }
    checks.note(fmt::format("{:g} m from the origin, 2 m ahead: 32 bits are wrong by {:.1e} m, the farm by {:.1e} m",
                            far, static_cast<double>(theirs), static_cast<double>(ours)));
    checks.holds(theirs > 1e5L * (ours + 1e-16L), "32 bits are worse by five orders");
  }
}

constexpr Case kDeviceCases[] = {
    {"devices", "plain-c++", "m",
     "scans of seven fleets compared with plain C++: bitwise in software, one count of the wire elsewhere", plain_cpp},
    {"devices", "where-32-bits-break", "m",
     "the same rays in 32-bit world coordinates: errors noted; the farm within rounding", where_32_bits_break},
    {"times", "tick-1e9", "m", "readings after a year and at tick 1e9, with noise: plain C++'s to the bit", tick_1e9},
};

}  // namespace

std::span<const Case> device_cases() { return kDeviceCases; }

}  // namespace sf::selftest
