#include "tests/sensors/compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <iostream>
#include <sstream>

#include "raycast/casters.h"
#include "raycast/range_bounds.h"
#include "sensors/laser_settings.h"
#include "tests/device.h"
#include "tests/sensors/brute_force.h"

namespace sf::trial {

using base::Pose;

Tally& Tally::operator+=(const Tally& other) {
  beams += other.beams;
  met += other.met;
  ambiguous += other.ambiguous;
  silhouettes += other.silhouettes;
  wrong += other.wrong;
  beyond_bound += other.beyond_bound;
  worst = std::max(worst, other.worst);
  worst_grazing = std::max(worst_grazing, other.worst_grazing);
  if (example.empty()) example = other.example;
  return *this;
}

std::string text(const Tally& t) {
  std::ostringstream out;
  out << t.beams << " beams, " << t.met << " met something, worst " << t.worst << " m (" << t.worst_grazing
      << " m below 1 mrad), " << t.ambiguous << " at a silhouette, " << t.silhouettes << " decided otherwise, "
      << t.wrong << " wrong";
  return out.str();
}

namespace {

/// Bearings by definition: both ends are exactly at the ends of the field of view.
long double bearing(const sensors::LaserSettings& laser, std::size_t i) {
  if (laser.samples < 2) return 0.0L;
  return static_cast<long double>(laser.fov) *
         (static_cast<long double>(i) / static_cast<long double>(laser.samples - 1) - 0.5L);
}

/// A beam of a reading, and its flags and bound.
struct Answer {
  const base::ReadingBlock& reading;
  std::size_t beam;
  double range;
  std::uint32_t model;
};

std::string describe(const oracle::Truth& truth, const Answer& answer) {
  std::ostringstream out;
  out.precision(17);
  out << "mover " << answer.reading.mover << " at (" << answer.reading.X_WS.x << ", " << answer.reading.X_WS.y << "; "
      << answer.reading.X_WS.yaw << "), beam " << answer.beam << " of " << answer.reading.values.size() << ": "
      << answer.range << " m of model " << static_cast<std::int32_t>(answer.model) << ", expected " << truth.first.range
      << " m of model " << static_cast<std::int32_t>(truth.first.model) << " (sine " << truth.first.sine << ", "
      << truth.right.size() << " right answers)";
  return out.str();
}

/// @param slack [m] error of the movers' outlines in the truth, which are computed in `double`
void compare_beam(const oracle::Truth& truth, const Answer& answer, double slack, Tally& tally) {
  const double range = answer.range;
  const std::uint32_t model = answer.model;
  ++tally.beams;
  tally.met += model != base::kNoHit;
  tally.ambiguous += truth.ambiguous;
  const double error = std::fabs(static_cast<double>(range - truth.first.range));
  const bool known = std::any_of(truth.right.begin(), truth.right.end(), [&](const oracle::Meeting& m) {
    return m.model == model &&
           std::fabs(static_cast<double>(range - m.range)) <= oracle::rounding(m) + slack / std::max(m.sine, 1e-16);
  });
  if (known && error <= 1e-5) {
    const bool grazes = truth.first.sine < raycast::kMinSine;
    double& worst = grazes ? tally.worst_grazing : tally.worst;
    worst = std::max(worst, error);
    tally.beyond_bound += !grazes && !truth.ambiguous && error > answer.reading.bound + slack / truth.first.sine;
    return;
  }
  if (known) {
    ++tally.silhouettes;
    return;
  }
  if (++tally.wrong == 1) tally.example = describe(truth, answer);
}

/// Readings of one caster, and the results of their comparison.
struct Compared {
  std::string_view caster;
  std::span<const base::ReadingBlock> readings;
  double slack_per_metre = 0.0;  ///< [-] `slack` of compare_beam, per metre of the largest coordinate
  Tally tally = {};
};

/// Compares readings of several casters with the same truth.
void compare_each(const world::World& world, std::span<const Pose> poses, std::span<Compared> all) {
  for (std::size_t k = 0; k < all[0].readings.size(); ++k) {
    const base::ReadingBlock& r = all[0].readings[k];
    const sensors::LaserSettings laser = sensors::lasers_of(world.movers[r.mover])[r.sensor];
    const glm::dvec2 origin{r.X_WS.x, r.X_WS.y};
    const double farthest = std::max(std::abs(origin.x), std::abs(origin.y)) + laser.range_max;
    const auto visible = oracle::surfaces(world, poses, r.mover, r.X_WS.z);
    const auto near = oracle::within(visible, origin, laser.range_max);
    // The reference is slow: it checks only some thousand beams of a scan with very many.
    const std::size_t stride = r.values.size() / 5000 + 1;
    for (std::size_t i = 0; i < r.values.size(); i += stride) {
      const auto truth = oracle::judge(near, origin, r.X_WS.yaw + bearing(laser, i), laser.range_max);
      for (Compared& each : all) {
        const base::ReadingBlock& own = each.readings[k];
        compare_beam(truth, {own, i, own.values[i], own.hits[i]}, each.slack_per_metre * farthest, each.tally);
      }
    }
  }
}

/// [pairs of a beam and a surface] largest size of a small scene: the reference casts it in some tenths of a second.
constexpr std::size_t kSmall = 20'000'000;

bool is_small(const world::World& world) {
  std::size_t surfaces = world.walls.size(), beams = 0;
  for (const world::Mover& mover : world.movers) {
    surfaces += mover.body.size();
    for (const sensors::LaserSettings& laser : sensors::lasers_of(mover)) beams += laser.samples;
  }
  return beams == 0 || surfaces <= kSmall / beams;
}

}  // namespace

std::vector<Pose> loaded_poses(const world::World& world) {
  std::vector<Pose> poses;
  for (const world::Mover& mover : world.movers) poses.push_back(mover.X_WM);
  return poses;
}

Tally compare(const world::World& world, std::span<const Pose> poses, std::span<const base::ReadingBlock> readings) {
  Compared one[] = {{{}, readings}};
  compare_each(world, poses, one);
  return one[0].tally;
}

Glance::Glance(const world::World& world, const farm::FarmOptions& options) : farm(world, device(), options) {
  farm.subscribe_all();
  readings = farm.tick(0, {});
}

void expect_same_bits(std::span<const base::ReadingBlock> p, std::span<const base::ReadingBlock> q) {
  ASSERT_EQ(p.size(), q.size());
  std::size_t differ = 0;
  std::ostringstream example;
  example.precision(17);
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_EQ(p[i].bound, q[i].bound) << i;
    EXPECT_TRUE(std::ranges::equal(p[i].quality, q[i].quality)) << "flags of reading " << i;
    ASSERT_EQ(p[i].hits.size(), q[i].hits.size());
    const auto hit_of = [&](const base::ReadingBlock& r,
                            std::size_t k) {  // of its beam, which may have several numbers
      return r.hits.empty() ? 0 : r.hits[k * r.hits.size() / r.values.size()];
    };
    for (std::size_t k = 0; k < p[i].values.size(); ++k) {
      const bool same =
          std::memcmp(&p[i].values[k], &q[i].values[k], sizeof(double)) == 0 && hit_of(p[i], k) == hit_of(q[i], k);
      if (same || ++differ > 1) continue;
      example << "reading " << i << " at (" << p[i].X_WS.x << ", " << p[i].X_WS.y << "; " << p[i].X_WS.yaw
              << "), number " << k << ": " << p[i].values[k] << " of " << hit_of(p[i], k) << ", " << q[i].values[k]
              << " of " << hit_of(q[i], k);
    }
  }
  EXPECT_EQ(differ, 0u) << example.str();
}

Tally sweep(const world::World& world, const farm::FarmOptions& options) {
  std::vector<Pose> poses;
  for (const world::Mover& mover : world.movers) poses.push_back(mover.X_WM);
  std::deque<Glance> runs;
  std::vector<Compared> compared;
  farm::FarmOptions by = options;
  by.scene.caster = &raycast::host_caster;
  compared.push_back({raycast::host_caster.name, runs.emplace_back(world, by).readings});
  EXPECT_GE(runs[0].readings.size(), 1u);
  for (const raycast::CasterType* type : raycast::casters()) {
    by.scene.caster = type;
    if (type->same_bytes && type != &raycast::host_caster)
      expect_same_bits(runs[0].readings, Glance(world, by).readings);
    if (!type->same_bytes && is_small(world))
      compared.push_back({type->name, runs.emplace_back(world, by).readings, 8.0 * 0x1p-53});
  }
  compare_each(world, poses, compared);
  for (const Compared& each : compared) {
    EXPECT_EQ(each.tally.beyond_bound, 0u) << each.caster << ": " << text(each.tally);
    if (&each == compared.data()) continue;  // checked by the caller
    EXPECT_EQ(each.tally.wrong, 0u) << each.caster << ": " << each.tally.example;
    std::cout << "[ measured ] " << each.caster << ": " << text(each.tally) << "\n";
  }
  return compared[0].tally;
}

void expect_exact(const std::string& name, const Tally& tally, double most) {
  std::cout << "[ measured ] " << name << ": " << text(tally) << "\n";
  EXPECT_GT(tally.beams, 0u) << name;
  EXPECT_EQ(tally.wrong, 0u) << name << ": " << tally.example;
  EXPECT_LE(tally.worst, most) << name;
}

sensors::LaserSettings eye(std::uint32_t samples, double fov, double range_max) {
  sensors::LaserSettings laser;
  laser.name = "eye";
  laser.X_MS = {0.0, 0.0, 0.1, 0.0};
  laser.samples = samples;
  laser.fov = fov;
  laser.range_max = range_max;
  return laser;
}

std::uint32_t add_eye(world::World& world, const Pose& pose, const sensors::LaserSettings& laser) {
  world::Mover mover;
  const auto number = static_cast<std::uint32_t>(world.movers.size());
  mover.name = "eye" + std::to_string(number);
  mover.id = number + 1;
  mover.model = static_cast<std::uint32_t>(world.models.size());
  mover.X_WM = pose;
  world.models.push_back({mover.name, "position"});
  world.models.back().mover = number;
  mover.sensors.push_back(sensors::laser_sensor(laser));
  world.movers.push_back(mover);
  return number;
}

std::uint32_t aim(world::World& world, glm::dvec2 from, glm::dvec2 target, const sensors::LaserSettings& laser) {
  const double yaw = std::atan2(target.y - from.y, target.x - from.x);
  return add_eye(world, {from.x, from.y, 0.0, yaw}, laser);
}

}  // namespace sf::trial
