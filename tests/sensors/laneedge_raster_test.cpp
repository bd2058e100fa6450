// The lane edge sensor on markings in pixels: the walk ray by ray, the stated bound, and the calibration of sigma.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "sensors/lane_markings/marking_raster.h"
#include "tests/instrumented.h"
#include "tests/refusal.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/laneedge_trial.h"
#include "tests/sensors/scenes.h"
#include "tests/units.h"

namespace sf::trial {
namespace {

using base::Pose;
using sensors::EdgeReading;
using sensors::MarkingRaster;

constexpr double kPixels[] = {0.002, 0.005, 0.01, 0.02};

// --- The walk -----------------------------------------------------------------------------------------------------

struct Entry {
  double range = 1e300;   ///< [m]
  bool doubtful = false;  ///< a painted cell's corner is very close to the ray
};

/// Returns the range at which origin + t d enters the box of one cell, corner by corner in long double.
void meet_cell(glm::dvec2 low, double cell, glm::dvec2 o, glm::dvec2 d, Entry& best) {
  const long double x0 = (static_cast<long double>(low.x) - o.x) / d.x;
  const long double x1 = (static_cast<long double>(low.x) + cell - o.x) / d.x;
  const long double y0 = (static_cast<long double>(low.y) - o.y) / d.y;
  const long double y1 = (static_cast<long double>(low.y) + cell - o.y) / d.y;
  const long double in = std::max(std::min(x0, x1), std::min(y0, y1));
  const long double out = std::min(std::max(x0, x1), std::max(y0, y1));
  if (std::fabs(in - out) < 1e-3L * cell && in > -cell) best.doubtful = true;
  if (in <= out && in >= 0.0L) best.range = std::min(best.range, static_cast<double>(in));
}

TEST(LaneEdgeRaster, EveryRayEntersTheFirstPaintedCell) {
  Chance chance(21);
  for (const double h : kPixels) {
    world::World world;
    world.road_resolution = h;
    for (int i = 0; i < 5; ++i)
      world.lane_markings.push_back(marking(chance.in_square(1.0), chance.in_square(1.0), chance.between(0.02, 0.1)));
    const MarkingRaster raster(world.lane_markings, h, 1.2, "");
    std::vector<glm::dvec2> cells;
    for (std::int64_t y = 0; y < 8 * raster.rows(); ++y)
      for (std::int64_t x = 0; x < 8 * raster.columns(); ++x)
        if (raster.painted(x, y))
          cells.push_back(
              {static_cast<double>(raster.first_column() + x) * h, static_cast<double>(raster.first_row() + y) * h});
    std::vector<Pose> poses;
    for (int i = 0; i < 400; ++i) {
      const glm::dvec2 p = chance.in_square(1.2);
      // Every eighth ray runs along an axis and thus along pixel borders.
      const double yaw = i % 8 == 0 ? 0.5 * M_PI * (i / 8 % 4) : chance.between(-M_PI, M_PI);
      add_edge_eye(world, {p.x, p.y, 0.0, yaw}, {{"samples", {1}}});
      poses.push_back({p.x, p.y, 0.0, yaw});
    }
    const auto readings = read_edges(world);
    std::size_t met = 0;
    std::size_t doubtful = 0;
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const Pose& X = poses[i];
      const auto x = static_cast<std::int64_t>(std::floor(X.x / h)) - raster.first_column();
      const auto y = static_cast<std::int64_t>(std::floor(X.y / h)) - raster.first_row();
      if (raster.painted(x, y)) continue;
      Entry truth;
      for (const glm::dvec2& low : cells)
        meet_cell(low, h, {X.x, X.y}, {std::cos(X.yaw) + 1e-300, std::sin(X.yaw) + 1e-300}, truth);
      const bool in_sight = truth.range < 0.99;
      if (truth.doubtful) {
        ++doubtful;
        continue;
      }
      EXPECT_EQ(std::isnan(readings[i].distance), !in_sight) << h << " " << i;
      if (!in_sight) continue;
      ++met;
      EXPECT_NEAR(readings[i].distance, truth.range, 1e-6) << h << " " << i;
    }
    EXPECT_GT(met, 100u);
    EXPECT_LT(doubtful, 60u);
  }
}

/// Inside paint, a ray reads the distance to the border of the paint.
TEST(LaneEdgeRaster, OnPaintARayReadsTheDistanceToTheBorder) {
  world::World world;
  world.road_resolution = 0.01;
  world.lane_markings.push_back(marking({-1.0, 0.0}, {1.0, 0.0}, 0.1));
  add_edge_eye(world, {0.003, 0.002, 0.0, 0.5 * M_PI}, {{"samples", {1}}});
  add_edge_eye(world, {0.003, 0.002, 0.0, 0.0}, {{"samples", {1}}});
  const auto readings = read_edges(world);
  EXPECT_NEAR(readings[0].distance, 0.048, 1e-6);
  EXPECT_TRUE(std::isnan(readings[1].distance)) << "0.997 m is near the maximum";
}

/// Far from all paint there is no edge, and the walk ends.
TEST(LaneEdgeRaster, FarFromAllPaint) {
  world::World world;
  world.road_resolution = 0.01;
  world.lane_markings.push_back(marking({-1.0, 0.0}, {1.0, 0.0}, 0.1));
  for (const double far : {3.0, 1e3, 1e7, -1e12}) add_edge_eye(world, {far, far, 0.0, -0.75 * M_PI});
  for (const EdgeReading& r : read_edges(world)) {
    EXPECT_TRUE(std::isnan(r.distance));
    EXPECT_EQ(r.points, 0);
  }
}

/// Outlines and movers count in addition to the pixels. The nearest surface wins.
TEST(LaneEdgeRaster, WallsAndMoversNextToPixels) {
  world::World world;
  world.road_resolution = 0.005;
  world.lane_markings.push_back(marking({-3.0, 0.55}, {3.0, 0.55}, 0.1));
  scenes::add_outline(world, {{1, 0.3}, {3, 0.3}, {3, 0.4}, {1, 0.4}}, "kerb");
  add_edge_eye(world, {0.0, 0.0, 0.0, 0.5 * M_PI});
  add_edge_eye(world, {2.0, 0.0, 0.0, 0.5 * M_PI});
  add_edge_eye(world, {-2.0, 0.0, 0.0, 0.5 * M_PI});
  scenes::add_robot(world, {-2.0, 0.25, 0.0, 0.0}, scenes::laser());
  const auto readings = read_edges(world);
  EXPECT_NEAR(readings[0].distance, 0.5, 0.005);
  EXPECT_NEAR(readings[1].distance, 0.3, 1e-12) << "an outline has no pixels";
  EXPECT_LT(readings[1].sigma, 1e-6);
  EXPECT_LT(readings[2].points, 5) << "a robot hides what is behind it";
}

TEST(LaneEdgeRaster, RejectsAResolutionTooFineForTheRange) {
  world::World world;
  world.file = "hand.world";
  world.road_resolution = 1e-4;
  world.lane_markings.push_back(marking({0.0, 0.0}, {0.5, 0.0}, 0.1));
  add_edge_eye(world, {});
  expect_in("road_resolution", refusal_of([&] { read_edges(world); }));
}

// --- The bound ----------------------------------------------------------------------------------------------------

/// One class of scenes, read once from every sensor.
struct Trial {
  world::World world;
  std::vector<double> truth;  ///< [m]
};

struct Outcome {
  std::size_t seen = 0, ten = 0, beyond = 0, surprised = 0;
  double worst = 0.0, worst_ratio = 0.0;
};

/// `beyond`: readings of ten points or more with an error above 0.75 h + 1 mm. `surprised`: errors above two sigmas.
Outcome judge(const char* name, const Trial& trial) {
  const double h = trial.world.road_resolution;
  const auto readings = read_edges(trial.world);
  Outcome o;
  double sum = 0.0;
  std::vector<double> ratios;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const EdgeReading& r = readings[i];
    if (std::isnan(r.distance)) continue;
    const double error = std::fabs(r.distance - trial.truth[i]);
    ++o.seen;
    o.surprised += error > 2.0 * r.sigma ? 1 : 0;
    ratios.push_back(error / r.sigma);
    if (r.points < 10) continue;
    ++o.ten;
    sum += r.distance - trial.truth[i];
    o.worst = std::max(o.worst, error);
    o.beyond += error > 0.75 * h + 1e-3 ? 1 : 0;
  }
  std::sort(ratios.begin(), ratios.end());
  o.worst_ratio = ratios.empty() ? 0.0 : ratios.back();
  const double at_95 = ratios.empty() ? 0.0 : ratios[ratios.size() * 95 / 100];
  std::printf(
      "%-22s h %5.3f: seen %5zu of %5zu, worst %8.5f m, mean %+8.5f m, %4zu beyond 0.75 h + 1 mm; |error|/sigma "
      "95 %% %.2f, most %.2f\n",
      name, h, o.seen, readings.size(), o.worst, o.ten > 0 ? sum / static_cast<double>(o.ten) : 0.0, o.beyond, at_95,
      o.worst_ratio);
  return o;
}

/// Sensors around straight markings at every angle to the pixels; `paint` and `gap` [m] of dashes, or solid.
Trial straight(double h, std::size_t count, double from_degrees, double to_degrees, double nearest, double farthest,
               double paint = 0.0, double gap = 0.0) {
  Trial trial;
  trial.world.road_resolution = h;
  Chance chance(31);
  constexpr double kRasterWidth = 0.05;
  constexpr std::size_t kStripes = 60;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = i % kStripes;
    const double a = 0.1 * static_cast<double>(k);
    const glm::dvec2 o{5.0 * static_cast<double>(k % 10), 5.0 * static_cast<double>(k / 10) + 0.0037 * a};
    const glm::dvec2 t{std::cos(a), std::sin(a)};
    const glm::dvec2 n{-t.y, t.x};
    if (i < kStripes && paint > 0.0) add_dashes(trial.world, o - 2.4 * t, o + 2.4 * t, kRasterWidth, paint, gap);
    if (i < kStripes && paint == 0.0)
      trial.world.lane_markings.push_back(marking(o - 2.4 * t, o + 2.4 * t, kRasterWidth));
    const double side = chance.below(2) == 0 ? 1.0 : -1.0;
    const double tilt = side * chance.between(from_degrees, to_degrees) * kDegree;
    const double d = chance.between(nearest, farthest);
    const glm::dvec2 p = o + chance.between(-1.0, 1.0) * t + (0.5 * kRasterWidth + d) * n;
    add_edge_eye(trial.world, {p.x, p.y, 0.0, std::atan2(-n.y, -n.x) + tilt}, {{"perpendicular", {0}}});
    trial.truth.push_back(d / std::cos(tilt));
  }
  return trial;
}

/// The documented bound: solid paint within 45 degrees, at least ten points.
TEST(LaneEdgeRaster, SolidPaintWithin45DegreesStaysWithinItsBound) {
  for (const double h : kPixels) {
    const Outcome o = judge("solid, to 45 degrees", straight(h, 6000, 0.0, 45.0, 0.04, 0.65));
    EXPECT_EQ(o.beyond, 0u) << h;
    EXPECT_GT(o.seen, 5980u);
    EXPECT_EQ(o.ten, o.seen);
    EXPECT_LT(o.surprised, o.seen / 20);
    EXPECT_LT(o.worst_ratio, 5.0);
  }
}

/// Elsewhere, sigma is documented: 95 % within two sigmas, no outlier far beyond.
TEST(LaneEdgeRaster, SigmaIsCalibratedElsewhere) {
  for (const double h : kPixels) {
    if (instrumented() && h < 0.02) continue;
    for (const Outcome& o : {judge("solid, 45 to 60", straight(h, 1000, 45.0, 60.0, 0.04, 0.4)),
                             judge("solid, 60 to 75", straight(h, 1000, 60.0, 75.0, 0.02, 0.2)),
                             judge("solid, 75 to 88", straight(h, 1000, 75.0, 88.0, 0.01, 0.1)),
                             judge("dashes 0.1 / 0.1", straight(h, 1000, 0.0, 45.0, 0.04, 0.65, 0.1, 0.1)),
                             judge("dashes 0.1 / 0.3", straight(h, 1000, 0.0, 45.0, 0.04, 0.65, 0.1, 0.3)),
                             judge("dashes 0.3 / 0.1", straight(h, 1000, 0.0, 45.0, 0.04, 0.65, 0.3, 0.1))}) {
      EXPECT_GT(o.seen, 300u);
      EXPECT_LT(o.surprised, o.seen / 20);
      EXPECT_LT(o.worst_ratio, 10.0);
    }
  }
}

/// The thesis' turn: the inner edge of a lane 0.5 m wide around a centre line of 0.93 m radius.
Trial turn(double h, bool inside, double look) {
  Trial trial;
  trial.world.road_resolution = h;
  Chance chance(41);
  constexpr double kRadius = 0.68;
  constexpr double kRasterWidth = 0.03;
  for (std::size_t i = 0; i < 800; ++i) {
    const std::size_t k = i % 16;
    const glm::dvec2 o{3.0 * static_cast<double>(k % 4) + 0.0037 * static_cast<double>(k),
                       3.0 * static_cast<double>(k / 4)};
    if (i < 16) trial.world.lane_markings.push_back(arc(o, kRadius, 0.0, 2.0 * M_PI - 0.01, kRasterWidth, 1e-5));
    const double d = chance.between(0.05, 0.4);
    const double at = chance.between(1.0, 5.0);
    const double face = inside ? kRadius - 0.5 * kRasterWidth : kRadius + 0.5 * kRasterWidth;
    const double from = inside ? face - d : face + d;
    const double yaw = (inside ? at : at + M_PI) + look * kDegree;
    add_edge_eye(trial.world, {o.x + from * std::cos(at), o.y + from * std::sin(at), 0.0, yaw},
                 {{"perpendicular", {-look}}});
    trial.truth.push_back(d);
  }
  return trial;
}

TEST(LaneEdgeRaster, SigmaCoversTheBendOfArcs) {
  for (const double h : {0.0, 0.005, 0.02})
    for (const double look : {0.0, 20.0})
      for (const bool inside : {true, false}) {
        const Outcome o = judge(inside ? (look > 0.0 ? "arc, inside, ahead" : "arc, inside")
                                       : (look > 0.0 ? "arc, outside, ahead" : "arc, outside"),
                                turn(h, inside, look));
        EXPECT_GT(o.seen, 790u);
        EXPECT_LT(o.worst, (look > 0.0 ? 0.025 : 0.004) + 1.2 * h);
        EXPECT_LT(o.surprised, o.seen / 20);
        EXPECT_LT(o.worst_ratio, 6.0);
      }
}

// --- A bitmap as a road -------------------------------------------------------------------------------------------

/// As in the thesis, a bitmap as a Stage model, with outlines as edges: equal pixels produce equal readings.
TEST(LaneEdgeRaster, StageBitmapMatchesTheRaster) {
  constexpr double kPixel = 1.0 / 128.0;
  Trial trial = straight(kPixel, 10, 0.0, 30.0, 0.05, 0.4);
  trial.world.lane_markings.resize(1);
  const glm::dvec2 o = 0.5 * (trial.world.lane_markings[0].line[0] + trial.world.lane_markings[0].line[1]);
  trial.world.movers.clear();
  Chance chance(3);
  std::vector<Pose> poses;
  for (int i = 0; i < 200; ++i)
    poses.push_back({o.x + chance.between(-1.0, 1.0), o.y + chance.between(0.06, 0.5), 0.0,
                     -0.5 * M_PI + chance.between(-0.7, 0.7)});
  for (const Pose& X : poses) add_edge_eye(trial.world, X, {{"perpendicular", {0}}});
  const auto from_raster = read_edges(trial.world);

  const MarkingRaster raster(trial.world.lane_markings, kPixel, 0.05, "");
  const int width = 8 * static_cast<int>(raster.columns());
  const int height = 8 * static_cast<int>(raster.rows());
  const std::filesystem::path folder = std::filesystem::path(SF_BINARY_DIR) / "laneedge_bitmap";
  std::filesystem::create_directories(folder);
  std::ofstream picture(folder / "road.pgm", std::ios::binary);
  picture << "P5 " << width << " " << height << " 255\n";
  for (int y = height; y-- > 0;)
    for (int x = 0; x < width; ++x) picture.put(raster.painted(x, y) ? '\0' : '\xFF');
  picture.close();
  std::ofstream file(folder / "road.world");
  file.precision(17);
  file << "old_shapes 1\n"  // the picture's margins count
       << "model( name \"road\" bitmap \"road.pgm\" size [" << width * kPixel << " " << height * kPixel
       << " 0.01] pose [" << (static_cast<double>(raster.first_column()) + 0.5 * width) * kPixel << " "
       << (static_cast<double>(raster.first_row()) + 0.5 * height) * kPixel << " 0 0] boundary 0 gui_nose 0 )\n";
  file.close();

  world::World staged = world::load_world((folder / "road.world").string());
  for (const Pose& X : poses) {
    add_edge_eye(staged, X, {{"perpendicular", {0}}});
    staged.movers.back().sensors[0].X_MS.z = 0.005;
  }
  const auto from_bitmap = read_edges(staged);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(std::isnan(from_raster[i].distance), std::isnan(from_bitmap[i].distance)) << i;
    if (std::isnan(from_raster[i].distance)) continue;
    ++seen;
    EXPECT_NEAR(from_raster[i].distance, from_bitmap[i].distance, 1e-6) << i;
    EXPECT_NEAR(from_raster[i].sigma, from_bitmap[i].sigma, 1e-6) << i;
  }
  EXPECT_GT(seen, 150u);
}

}  // namespace
}  // namespace sf::trial
