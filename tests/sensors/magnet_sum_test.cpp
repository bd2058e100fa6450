// Sums over many magnets: compared with more than 64 bits, bit by bit, and by their properties.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iostream>

#include "sensors/magnetic_field/tables.h"
#include "tests/instrumented.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/field_on_both.h"
#include "tests/sensors/magnet_scenes.h"

namespace sf::trial {
namespace {

using scenes::magnet;
using scenes::magnitude;
using sensors::FieldPoint;
using sensors::FieldSum;

constexpr double kSumGauss = 1e-4;

/// The kernel for magnitudes sums vectors to the same bits.
TEST(MagnetSum, MagnitudesDoNotChangeVectors) {
  const world::World world = scenes::sheet(500, 3.0, 4, true);
  Chance chance(6);
  std::vector<FieldPoint> points;
  for (int i = 0; i < 203; ++i) points.push_back({chance.between(-2, 2), chance.between(-2, 2), 0.1});
  const auto plain = sample_on_both(world, points);
  const auto both = sample_on_both(world, points, {.magnitudes = true});
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(std::memcmp(&plain[i].x, &both[i].x, 3 * sizeof(double)), 0);
    EXPECT_EQ(plain[i].magnitudes, 0.0);
  }
}

struct SumErrors {
  double worst = 0.0;    ///< [T]
  double largest = 0.0;  ///< [T] |B| of the points
};

SumErrors errors(const world::World& world, std::span<const FieldPoint> points) {
  const auto sums = sample_on_both(world, points, {.magnitudes = true});
  SumErrors e;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const scenes::Exact truth = scenes::exact(world, points[i]);
    e.worst = std::max(e.worst, scenes::apart(truth, sums[i]));
    e.largest = std::max(e.largest, magnitude(truth));
    EXPECT_NEAR(sums[i].magnitudes, static_cast<double>(truth.magnitudes),
                1e-7 * static_cast<double>(truth.magnitudes));
  }
  return e;
}

/// Returns `count` points at `height` [m], some of them directly above a magnet, where the field is largest.
std::vector<FieldPoint> places_over(const world::World& world, std::uint32_t count, double half, double height) {
  Chance chance(11);
  std::vector<FieldPoint> points;
  const glm::dvec2 middle = world.magnets[0].p;
  for (std::uint32_t i = 0; i < count; ++i) {
    const world::Magnet& m = world.magnets[chance.below(static_cast<std::uint32_t>(world.magnets.size()))];
    const bool above = i % 4 == 0;
    points.push_back({above ? m.p.x + chance.between(-0.02, 0.02) : middle.x + chance.between(-half, half),
                      above ? m.p.y + chance.between(-0.02, 0.02) : middle.y + chance.between(-half, half), height});
  }
  return points;
}

const std::uint32_t kMany = instrumented() ? 20'000 : 200'000, kSumPlaces = instrumented() ? 50 : 500;

/// The thesis' components in plain doubles, on all cores.
std::vector<FieldSum> direct_sums(const world::World& world, std::span<const FieldPoint> points) {
  std::vector<FieldSum> sums(points.size());
  base::ThreadPool thread_pool;
  thread_pool.parallel_for(points.size(), 8, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i)
      for (const world::Magnet& m : world.magnets) {
        const double x = points[i].x - m.p.x, y = points[i].y - m.p.y, z = points[i].z - m.z;
        const double squared = x * x + y * y + z * z;
        const double k = 1e-7 * m.moment / (squared * squared * std::sqrt(squared));
        sums[i].x += k * 3 * x * z;
        sums[i].y += k * 3 * y * z;
        sums[i].z += k * (2 * z * z - x * x - y * y);
      }
  });
  return sums;
}

/// A sheet of magnets at the origin and 100 km away, near it and high above it: 2000 points in all.
TEST(MagnetSum, TwoHundredThousandMagnetsAreAccurateAnywhere) {
  for (const double offset : {0.0, 1e5})
    for (const double height : {0.1, 1.0}) {
      world::World world = scenes::sheet(kMany, 400.0, 7);
      for (world::Magnet& m : world.magnets) m.p = m.p + glm::dvec2{offset, -offset};
      const auto points = places_over(world, kSumPlaces, 100.0, height);
      const auto sums = sample_on_both(world, points);
      const auto truths = direct_sums(world, points);
      double worst = 0.0, largest = 0.0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const FieldSum &a = sums[i], &b = truths[i];
        worst = std::max(worst, std::hypot(a.x - b.x, a.y - b.y, a.z - b.z));
        largest = std::max(largest, magnitude(b));
      }
      std::cout << "[ measured ] " << kMany << " magnets, " << offset / 1e3 << " km off, " << height
                << " m up: worst error " << worst / largest << " of the largest field, " << largest / kSumGauss
                << " Gauss\n";
      EXPECT_LE(worst, 1e-9 * largest) << "1e-6 is asked for";
    }
}

/// All magnets are in one spot, so no grid reduces their number. Items stay below the loop limit of drivers, with and
/// without a cut-off.
TEST(MagnetSum, TwoHundredThousandMagnetsInOneSpot) {
  for (const double cutoff : {0.0, 0.5, 1e6}) {
    world::World world;
    for (std::uint32_t i = 0; i < 200'000; ++i) world.magnets.push_back(magnet({1.0, 2.0}, 0.0, 1e-6));
    world.magnet_cutoff = cutoff;
    const FieldSum b = field_at(world, {1.0, 2.0, 0.25});
    const double truth = 0.2 * 2e-7 / std::pow(0.25, 3);
    EXPECT_NEAR(b.z, truth, 1e-7 * truth) << cutoff;
    EXPECT_NEAR(b.magnitudes, truth, 1e-7 * truth) << cutoff;
  }
}

/// Numbers of magnets and points around the sizes of iterations, items and groups.
TEST(MagnetSum, EveryNumberOfMagnetsAndPlaces) {
  Chance chance(8);
  const auto most = sensors::kMostItemMagnets;
  for (const std::uint32_t magnets : {1u, 2u, 3u, 4u, 5u, most - 1, most, most + 1, 2 * most, 2 * most + 1}) {
    const world::World world = scenes::sheet(magnets, 3.0, magnets);
    for (const std::uint32_t count : {1u, 4u, 5u, 6u, 159u, 160u, 161u}) {
      if (magnets > 5 && count > 6) continue;
      const SumErrors e = errors(world, places_over(world, count, 1.0, 0.1));
      EXPECT_LE(e.worst, 1e-7 * e.largest) << magnets << " magnets, " << count << " points";
    }
  }
}

// --- To the bit.

/// The kernel in C++, operation by operation: one magnet at one point.
FieldSum mirrored(const sensors::DipoleRow& m, const FieldPoint& p) {
  const double dx = p.x - m.x, dy = p.y - m.y, dz = (p.z - m.z) + 1e-18;
  const double along = dx * dx + dy * dy;
  const double squared = along + dz * dz;
  const float root = std::sqrt(std::max(static_cast<float>(squared), 1e-37f));
  const double rough = static_cast<double>(1.0f / root);
  const double inverse = rough * (1.5 - 0.5 * (squared * rough * rough));
  const double bounded = std::min(inverse, static_cast<double>(m.inverse_radius));
  const double scale = static_cast<double>(m.moment) * bounded * (bounded * bounded);
  const double uz = dz * inverse;
  const double c = 3.0 * uz * scale * inverse;
  const double q = 1.0 + 3.0 * uz * uz;
  const float rough_q = std::sqrt(static_cast<float>(q));
  const double s = static_cast<double>(rough_q);
  const double shape = s + (q - s * s) * static_cast<double>(0.5f / rough_q);
  return {c * dx, c * dy, c * dz - scale, std::abs(scale) * shape};
}

TEST(MagnetSum, TheKernelIsBitIdenticalToItsMirror) {
  const world::World world = scenes::sheet(50, 1.0, 9, true);
  const auto points = places_over(world, 301, 0.6, 0.05);
  const auto sums = sample_on_both(world, points, {.magnitudes = true});
  for (std::size_t i = 0; i < points.size(); ++i) {
    FieldSum sum;
    for (const world::Magnet& m : world.magnets) {
      const FieldSum b = mirrored(sensors::dipole_row(m, m.p, m.z), points[i]);
      sum = {sum.x + b.x, sum.y + b.y, sum.z + b.z, sum.magnitudes + b.magnitudes};
    }
    sum = {1e-7 * sum.x, 1e-7 * sum.y, 1e-7 * sum.z, 1e-7 * sum.magnitudes};
    ASSERT_EQ(std::memcmp(&sum, &sums[i], sizeof sum), 0) << "point " << i;
  }
}

TEST(MagnetSum, DoesNotDependOnThreadsOrOtherPoints) {
  for (const double cutoff : {0.0, 1.0}) {
    world::World world = scenes::sheet(3000, 10.0, 10, true);
    world.magnet_cutoff = cutoff;
    const auto points = places_over(world, 400, 5.0, 0.1);
    const auto all = sample_on_both(world, points, {.threads = 1});
    const auto threaded = sample_on_both(world, points, {.threads = 3});
    EXPECT_EQ(std::memcmp(all.data(), threaded.data(), all.size() * sizeof all[0]), 0);
    for (std::size_t i = 0; i < points.size(); i += 40) {
      const auto group = std::span(points).subspan(i / 5 * 5, 5);
      const auto alone = sample_on_both(world, group);
      EXPECT_EQ(std::memcmp(&all[i / 5 * 5], alone.data(), 5 * sizeof alone[0]), 0) << cutoff << ", point " << i;
    }
  }
}

// --- Properties.

/// The field of two worlds together is the sum of both fields.
TEST(MagnetSum, IsLinear) {
  Chance chance(12);
  const world::World one_world = scenes::sheet(40, 2.0, 20, true), other = scenes::sheet(30, 2.0, 21, true);
  world::World both = one_world;
  both.magnets.insert(both.magnets.end(), other.magnets.begin(), other.magnets.end());
  for (int i = 0; i < 30; ++i) {
    const FieldPoint point{chance.between(-1, 1), chance.between(-1, 1), chance.between(0.05, 0.4)};
    const FieldSum a = field_at(one_world, point), b = field_at(other, point), c = field_at(both, point);
    EXPECT_NEAR(a.x + b.x, c.x, 1e-14 * (a.magnitudes + b.magnitudes));
    EXPECT_NEAR(a.z + b.z, c.z, 1e-14 * (a.magnitudes + b.magnitudes));
  }
}

/// A rotated and translated world has the rotated field. A world mirrored in the plane x = 0 has the mirrored field.
TEST(MagnetSum, RotatesAndMirrorsWithTheWorld) {
  Chance chance(13);
  const world::World world = scenes::sheet(60, 2.0, 22, true);
  for (int i = 0; i < 20; ++i) {
    const base::Pose X{chance.between(-50, 50), chance.between(-50, 50), 0.0, chance.between(-M_PI, M_PI)};
    const FieldPoint p{chance.between(-1, 1), chance.between(-1, 1), 0.1};
    world::World turned = world, mirrored_world = world;
    for (world::Magnet& m : turned.magnets) m.p = base::transform(X, m.p);
    for (world::Magnet& m : mirrored_world.magnets) m.p.x = -m.p.x;
    const glm::dvec2 q = base::transform(X, {p.x, p.y});
    const FieldSum b = field_at(world, p), t = field_at(turned, {q.x, q.y, p.z}),
                   s = field_at(mirrored_world, {-p.x, p.y, p.z});
    const glm::dvec2 expected = base::rotate(X.yaw, {b.x, b.y});
    const double some = 1e-10 * b.magnitudes;
    EXPECT_NEAR(t.x, expected.x, some);
    EXPECT_NEAR(t.y, expected.y, some);
    EXPECT_NEAR(t.z, b.z, some);
    EXPECT_EQ(s.x, -b.x);
    EXPECT_EQ(s.y, b.y);
    EXPECT_EQ(s.z, b.z);
  }
}

}  // namespace
}  // namespace sf::trial
