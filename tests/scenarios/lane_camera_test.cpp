// The experiment `lane-camera`: a car in SimVille keeps its lane by its camera's images.

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "control/lane_view.h"
#include "farm/farm.h"
#include "scenarios/experiment.h"
#include "scenarios/lane_camera_runs.h"
#include "sensors/camera.h"
#include "tests/folder.h"
#include "tests/instrumented.h"
#include "vision/lane_tracker.h"

namespace sf::scenarios {
namespace {

Scenario lane_scenario(double duration) {
  Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/lane-camera.toml");
  scenario.duration = duration;
  return scenario;
}

constexpr LaneVariant kCoarse{.name = "160 x 120 pixels", .keys = "resolution [160 120]"};

/// One camera's lane at any pose.
struct Probe {
  world::World world = lane_world(lane_scenario(1.0), kCoarse);
  gpu::Device device;
  farm::Farm farm{world, device, {}};
  LaneCourse course = lane_course(world);
  std::uint32_t row = probe_of(world);
  control::LaneView view{{}, {}, farm.sensor_set().settings_of<sensors::CameraSettings>(sensors::kCamera, row)[0]};

  vision::LaneTracker look(const base::Pose& X_WM) {
    const auto points = view.look(farm.sense(row, sensors::kCamera, 0, X_WM).values);
    vision::LaneTracker tracker{vision::LaneLimits{}};
    for (int k = 0; k < 3; ++k) tracker.update(points);
    return tracker;
  }
};

/// Offset of the lane's middle where the controller steers by it.
double ahead_of(const vision::Lane& lane) {
  double y = 0.0;
  for (int k = 0; k < 30; ++k) y -= vision::left_of_middle(lane, {0.225, y});
  return y;
}

// From one image on the first straight, with other streets, shadows and buildings in view: the lane, or none where too
// little of an edge is in view. The bounds are twice the largest errors of 300 poses: the next bend is in the picture,
// so the arc fits neither piece exactly.
RC_GTEST_PROP(LaneCameraExperiment, OneImageShowsTheLane, ()) {
  static Probe probe;
  const auto number = [](int most) { return *rc::gen::inRange(-most, most + 1) * 1e-3; };
  const base::Pose X_WM =
      base::compose(pose_on(probe.course, 0.2), base::Pose{number(100), number(60), 0.0, number(100)});
  const vision::LaneTracker tracker = probe.look(X_WM);
  if (!tracker.has_lane()) return;
  RC_ASSERT(std::abs(ahead_of(tracker.lane()) - lane_error(probe.course, X_WM)) < 0.015);
  RC_ASSERT(std::abs(tracker.lane().width - 0.5) < 0.006);
}

// In the bend, where one edge may be out of view: then no lane is found rather than a wrong one.
RC_GTEST_PROP(LaneCameraExperiment, OneImageShowsTheBendOrNothing, ()) {
  static Probe probe;
  const auto number = [](int most) { return *rc::gen::inRange(-most, most + 1) * 1e-3; };
  const base::Pose X_WM =
      base::compose(pose_on(probe.course, 1.4 + number(100)), base::Pose{0.0, number(60), 0.0, number(100)});
  const vision::LaneTracker tracker = probe.look(X_WM);
  if (!tracker.has_lane()) return;
  RC_ASSERT(std::abs(ahead_of(tracker.lane()) - lane_error(probe.course, X_WM)) < 0.004);
  RC_ASSERT(std::abs(tracker.lane().width - 0.5) < 0.006);
}

LaneRun reduced(const LaneVariant& variant, double duration) {
  gpu::Device device;
  return run_lane(lane_scenario(duration), variant, device, 1, {});
}

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::isfinite(value) ? std::abs(value) : HUGE_VAL);
  return most;
}

TEST(LaneCameraExperiment, KeepsItsLaneThroughTheBend) {
  if (instrumented()) GTEST_SKIP() << "hundreds of images; tests/control/lane_camera_test.cpp takes these paths";
  const LaneRun run = reduced(kCoarse, 17.0);
  EXPECT_GT(run.s.back(), 3.3) << "the bend ends at 3.2 m";
  EXPECT_FALSE(run.left_lane);
  EXPECT_LT(largest(run.offsets), 0.06);
  EXPECT_LT(largest(run.errors), 0.03) << "a lane in every image";
}

TEST(LaneCameraExperiment, RepeatsItsBytes) {
  const LaneRun once = reduced(kCoarse, 2.0), again = reduced(kCoarse, 2.0);
  EXPECT_EQ(once.offsets, again.offsets);
  EXPECT_EQ(once.errors, again.errors);
  EXPECT_GT(once.offsets.size(), 15u);
}

// All variants for a moment, so that each works and the files are complete.
using LaneCameraFiles = FolderTest;
TEST_F(LaneCameraFiles, AreComplete) {
  if (instrumented()) GTEST_SKIP() << "millions of beams";
  gpu::Device device;
  const ExperimentOptions options{.trials = 1, .out = folder_.string(), .threads = 1};
  const ExperimentType& type = *find_experiment("lane-camera");
  const auto files = type.run({type, lane_scenario(0.2), options, device, {}});
  ASSERT_EQ(files.size(), 4u);
  for (const std::string& file : files) EXPECT_GT(std::filesystem::file_size(file), 500u) << file;
  std::ifstream csv(files[0]);
  std::string line;
  std::size_t lines = 0;
  while (std::getline(csv, line)) ++lines;
  EXPECT_EQ(lines, lane_variants().size() + 1);
}

}  // namespace
}  // namespace sf::scenarios
