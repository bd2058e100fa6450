// Accuracy modes: errors stay within the stated bounds, and beams that are not cast are flagged.

#include <fmt/format.h>

#include "base/random.h"
#include "selftest/exact_ray_cast.h"
#include "selftest/suite.h"
#include "sensors/accuracy.h"

namespace sf::selftest {

namespace {

using base::QualityFlag;

double random(std::uint32_t index) {
  return base::random_uniform({17, base::RandomStream::placement, 0, 0, index}, 0)[0];
}

/// A room of a given width with blocks, and lasers inside it, `far` from the origin.
world::World room(double far, double width, std::uint32_t samples) {
  world::World world;
  add_room(world, {far - 0.5 * width, far - 0.5 * width}, width);
  for (std::uint32_t i = 0; i < 20; ++i) {
    const glm::dvec2 p{far + width * (0.9 * random(2 * i) - 0.5), far + width * (0.9 * random(2 * i + 1) - 0.5)};
    add_block(world, p, p + glm::dvec2{0.03 * width, 0.05 * width});
  }
  for (std::uint32_t i = 100; i < 130; ++i)
    add_laser_mover(world,
                    {far + 0.9 * width * (random(3 * i) - 0.5), far + 0.9 * width * (random(3 * i + 1) - 0.5), 0.0,
                     7.0 * random(3 * i + 2)},
                    laser(samples, 2.0 * M_PI, 0.4 * width));
  return world;
}

QualityFlag quality_of(const base::ReadingBlock& reading, std::size_t i) {
  return reading.quality.empty() ? QualityFlag::none : reading.quality[i];
}

void stated_bounds(Fixture& fixture, Checks& checks) {
  for (const char* mode : {"exact", "single"})
    for (const double far : {0.0, 1e5, 1e7})
      for (const double width : {1e-3, 1.0, 1e3, 1e6}) {
        world::World world = room(far, width, 361);
        sensors::set_accuracy(world, mode);
        const TestFarm test = fixture.measure(std::move(world));
        const auto what = fmt::format("{}, {:g} m wide, {:g} m away", mode, width, far);
        for (const base::ReadingBlock& r : test.readings) {
          const sensors::LaserSettings& laser = laser_of(test, r);
          for (std::uint32_t i = 0; i < r.values.size(); ++i) {
            if (quality_of(r, i) != QualityFlag::none) continue;
            const Hit met = nearest_hit(test.world->walls, beam_of(r.X_WS, laser, i), laser.range_max);
            if (!met.ambiguous) checks.near(r.values[i], met.range, r.bound, what, i);
          }
        }
      }
}

void skipped_beams(Fixture& fixture, Checks& checks) {
  for (const auto& [mode, skip] : {std::pair{"skip2", 2u}, std::pair{"skip4", 4u}, std::pair{"skip8", 8u}})
    for (const std::uint32_t samples : {1u, 2u, 3u, 9u, 360u, 3601u}) {
      world::World thin = room(0.0, 10.0, samples);
      sensors::set_accuracy(thin, mode);
      const TestFarm all = fixture.measure(room(0.0, 10.0, samples)), some = fixture.measure(std::move(thin));
      const std::uint32_t every = std::min(skip, std::max(1u, samples - 1));
      for (std::size_t k = 0; k < all.readings.size(); ++k)
        for (std::uint32_t i = 0; i < samples; ++i) {
          const bool cast = i % every == 0 || i + 1 == samples;
          const auto what = fmt::format("{} of {} samples", mode, samples);
          checks.holds((quality_of(some.readings[k], i) == QualityFlag::not_cast) == !cast, what + ": the flag", i);
          if (cast) checks.same(some.readings[k].values[i], all.readings[k].values[i], what, i);
        }
    }
}

void near_magnets(Fixture& fixture, Checks& checks) {
  world::World world;
  for (std::uint32_t i = 0; i < 300; ++i)
    world.magnets.push_back({{30.0 * random(4 * i) - 15.0, 30.0 * random(4 * i + 1) - 15.0},
                             -0.04,
                             (i % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, 6.0 * random(4 * i + 2) - 3.0),
                             0.01,
                             0});
  for (std::uint32_t i = 0; i < 60; ++i) {
    const std::uint32_t m = add_mover(world, {32.0 * random(2 * i) - 16.0, 32.0 * random(2 * i + 1) - 16.0, 0.0, 0.0});
    world.movers[m].sensors.push_back(sensor("magnetometer", {}, 0.05));
  }
  const TestFarm all = fixture.measure(world);
  for (const char* mode : {"near10", "near3", "near1"}) {
    sensors::set_accuracy(world, mode);
    const TestFarm near = fixture.measure(world);
    for (std::size_t k = 0; k < all.readings.size(); ++k)
      checks.near(near.readings[k].values[0], all.readings[k].values[0], near.readings[k].bound, mode, k);
  }
}

constexpr Case kAccuracyModeCases[] = {
    {"modes", "stated-bounds", "m", "scans in 64 and in 32 bits, 1 mm to 1 000 km wide: within the stated bounds",
     stated_bounds},
    {"modes", "skipped-beams", "", "cast beams are bitwise equal to those of exact scans, the others are flagged",
     skipped_beams},
    {"modes", "near-magnets", "T", "magnets of 1e-3 to 1e3 A m^2 left out: within the stated bounds", near_magnets},
};

}  // namespace

std::span<const Case> accuracy_mode_cases() { return kAccuracyModeCases; }

}  // namespace sf::selftest
