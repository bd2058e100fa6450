#pragma once
// Hand-made sonar and infrared sensors, and the reference: the nearest of a cone's rays, each tested against every
// segment.

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "sensors/cones/cone_array.h"
#include "tests/sensors/brute_force.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/cone_scenes.h"
#include "tests/sensors/edit_laser.h"
#include "world/world.h"

namespace sf::trial {

/// Adds a robot that carries `sensor`. Its body is a 12-sided disc of `radius` [m], if given.
inline std::uint32_t add_ranger(world::World& world, const base::Pose& pose, const world::Sensor& sensor,
                                double radius = 0.0) {
  const std::uint32_t mover = add_eye(world, pose, {});
  scenes::remove_lasers(world.movers[mover]);
  world.movers[mover].sensors.push_back(sensor);
  for (int i = 0; radius > 0.0 && i < 12; ++i) {
    const auto at = [&](int k) { return base::rotate(k * M_PI / 6.0, {radius, 0.0}); };
    world::Segment side;
    side.a = at(i);
    side.b = at(i + 1);
    side.z_max = 0.3;
    side.model = world.movers[mover].model;
    world.movers[mover].body.push_back(side);
  }
  world.movers[mover].radius = radius;
  return mover;
}

/// Valid readings of one cone.
struct ConeTruth {
  double low = 0.0, high = 0.0;  ///< [m] equal except where a ray passes a silhouette
  bool met = false;
  bool delicate = false;  ///< the incidence of some ray is too close to the limit to decide
};

/// Computes the valid readings in `long double`, ray by ray. @param X_WC pose of the transducer in the world
inline ConeTruth cone_truth(std::span<const world::Segment> all, const base::Pose& X_WC,
                            const sensors::ConeArray& array) {
  using Wide = long double;
  const glm::dvec2 origin{X_WC.x, X_WC.y};
  const auto near = oracle::within(all, origin, array.range_max);
  ConeTruth truth{array.range_max, array.range_max};
  for (std::uint32_t i = 0; i < array.rays; ++i) {
    const Wide share = array.rays > 1 ? static_cast<Wide>(i) / (array.rays - 1) - 0.5L : 0.0L;
    const Wide direction = X_WC.yaw + array.fov * share;
    const oracle::Truth ray = oracle::judge(near, origin, direction, array.range_max);
    double low = array.range_max, high = 0.0;
    for (const oracle::Meeting& m : ray.right) {
      double range = static_cast<double>(m.range);
      if (array.min_cosine > 0.0 && m.model != base::kNoHit) {
        if (std::fabs(m.sine - array.min_cosine) < 1e-5) truth.delicate = true;
        if (m.sine < array.min_cosine) range = array.range_max;
      }
      low = std::min(low, range);
      high = std::max(high, range);
    }
    truth.low = std::min(truth.low, low);
    truth.high = std::min(truth.high, ray.right.empty() ? array.range_max : high);
  }
  truth.met = truth.low < array.range_max;
  truth.low = std::max(truth.low, array.range_min);
  truth.high = std::max(truth.high, array.range_min);
  return truth;
}

struct ConeTally {
  std::size_t cones = 0, met = 0, wide = 0, delicate = 0, wrong = 0;
  double worst = 0.0;  ///< [m] of cones with a single valid range
  std::string example;
};

/// Compares the first columns of `readings`, with `columns` numbers per transducer, with the reference at `poses`.
inline ConeTally compare_cones(const world::World& world, std::span<const base::Pose> poses,
                               std::span<const base::ReadingBlock> readings, std::span<const sensors::ConeArray> arrays,
                               std::size_t columns = 1) {
  ConeTally tally;
  for (std::size_t r = 0; r < readings.size(); ++r) {
    const base::ReadingBlock& reading = readings[r];
    const sensors::ConeArray& array = arrays[r];
    for (std::size_t i = 0; i < array.X_SC.size(); ++i) {
      const base::Pose X_WC = base::compose(poses[reading.mover], base::compose(array.row.X_MS, array.X_SC[i]));
      const auto all = oracle::surfaces(world, poses, reading.mover,
                                        world.movers[reading.mover].X_WM.z + array.row.X_MS.z + array.X_SC[i].z);
      const ConeTruth truth = cone_truth(all, X_WC, array);
      const double said = reading.values[columns * i];
      ++tally.cones;
      tally.met += truth.met;
      tally.wide += truth.high - truth.low > 1e-6;
      tally.delicate += truth.delicate;
      if (truth.delicate) continue;
      const double error = std::max({truth.low - said, said - truth.high, 0.0});
      tally.worst = std::max(tally.worst, error);
      if (error <= 1e-7) continue;
      if (++tally.wrong == 1)
        tally.example = "reading " + std::to_string(r) + ", transducer " + std::to_string(i) + ": " +
                        std::to_string(said) + " m, expected " + std::to_string(truth.low) + " to " +
                        std::to_string(truth.high);
    }
  }
  return tally;
}

}  // namespace sf::trial
