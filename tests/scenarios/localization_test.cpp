// The filter on a robot's own sensors in SimVille: GPS in the streets, none under the bridge.

#include "robots/estimation/localization.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "base/time.h"
#include "control/lane_corridors.h"
#include "control/own_localization.h"
#include "scenarios/run_metrics.h"
#include "scenarios/scenario.h"
#include "scenarios/simulation.h"
#include "sensors/encoder.h"
#include "sensors/gps.h"
#include "sensors/gyro.h"
#include "tests/instrumented.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::scenarios {
namespace {

/// Errors of all poses, with the errors stated by the filter.
struct Rms {
  void add(const estimation::Prediction& prediction, const base::Pose& truth) {
    const base::Pose& X = prediction.estimate.X_WM;
    const estimation::Covariance& P = prediction.estimate.covariance;
    const double distance = std::hypot(X.x - truth.x, X.y - truth.y), turned = base::wrap_angle(X.yaw - truth.yaw);
    ++count;
    squares += distance * distance;
    yaw_squares += turned * turned;
    stated += P[0] + P[7];
    yaw_stated += P[14];
  }
  double position() const { return std::sqrt(squares / count); }     ///< [m]
  double heading() const { return std::sqrt(yaw_squares / count); }  ///< [rad]
  double count = 0.0, squares = 0.0, yaw_squares = 0.0, stated = 0.0, yaw_stated = 0.0;
};

struct Errors {
  Rms with_gps, dropout, reckoned, reckoned_end;
  double longest_dropout = 0.0;  ///< [s]
};

/// The filters of one car.
struct Car {
  estimation::Localization fused, reckoned;
  std::int64_t fixed = 0;  ///< [ns] of the last fix
};

// As in worlds/simville/simville.world.
constexpr double kRange = 0.214;
constexpr std::int64_t kEnd = 120 * base::kSecond;

std::string text(const Rms& e) { return fmt::format("{:.3f} m, {:.2f} degrees", e.position(), e.heading() / kDegree); }

Scenario town(std::uint64_t seed, const char* localize) {
  return parse_scenario(
      SF_SOURCE_DIR "/experiments/localization.toml",
      fmt::format("world = \"../worlds/simville/simville.world\"\nseed = {}\n[default]\ncontroller = \"route\"\n"
                  "settings = {{ tour = true, gap = 0.1, localize = {} }}\n[[robot]]\nname = \"khepera6\"\n"
                  "controller = \"none\"\n[[robot]]\nname = \"khepera7\"\ncontroller = \"none\"\n",
                  seed, localize));
}

void add(const base::ReadingBlock& reading, Car& car) {
  const auto& v = reading.values;
  for (estimation::Localization* each : {&car.fused, &car.reckoned}) {
    if (reading.type == sensors::kEncoder) each->add_encoder(reading.time, v[0], v[1]);
    if (reading.type == sensors::kGyro) each->add_gyro(reading.time, v[0]);
  }
  if (reading.type != sensors::kGps) return;
  car.fused.add_gps(reading.time, v[0], v[1], v[2]);
  if (std::isfinite(v[2])) car.fixed = reading.time;
}

void compare(const base::TickRecord& tick, const std::map<std::uint32_t, Car>& cars, Errors& errors) {
  for (const auto& [row, car] : cars) {
    const base::Pose& truth = tick.reports[row].X_WM;
    const estimation::Prediction fused = car.fused.predict(tick.time), reckoned = car.reckoned.predict(tick.time);
    const double since = 1e-9 * static_cast<double>(tick.time - car.fixed);
    (since > 1.5 ? errors.dropout : errors.with_gps).add(fused, truth);
    errors.longest_dropout = std::max(errors.longest_dropout, since);
    errors.reckoned.add(reckoned, truth);
    if (tick.time >= kEnd) errors.reckoned_end.add(reckoned, truth);
  }
}

void drive(std::uint64_t seed, gpu::Device& device, Errors& errors) {
  const Scenario scenario = town(seed, "false");
  const world::World world = world_of(scenario);
  Simulation simulation(world, device, simulation_of(scenario, world));
  const estimation::LocalizationOptions options{.encoder = estimation::LocalizationOptions::Encoder{},
                                                .gyro = {0.1 * kDegree, 0.5 * kDegree},
                                                .gps_noise = kRange};
  std::map<std::uint32_t, Car> cars;
  for (std::uint32_t row = 0; row < world.movers.size(); ++row)
    if (world.movers[row].name.rfind("roomba", 0) == 0) {
      const base::Pose& X_WM = world.movers[row].X_WM;
      estimation::Localization start(options);
      start.add_pose(0, X_WM, estimation::kKnownStart);
      cars.try_emplace(row, Car{start, start});
    }
  for (std::int64_t time = 0; time < kEnd;) {
    const base::TickRecord tick = simulation.step();
    time = tick.time;
    for (const base::ReadingBlock& reading : tick.readings)
      if (const auto car = cars.find(reading.mover); car != cars.end()) add(reading, car->second);
    compare(tick, cars, errors);
  }
}

// The figures of docs/estimation.md. Bounds: 1.3 times the worst of the seeds 1 to 8.
TEST(Localization, FusesSatellitesWheelsAndGyroInSimVille) {
  if (instrumented()) GTEST_SKIP() << "a statistic; DrivesRoutesByTheEstimate runs the same code";
  gpu::Device device;
  Errors errors;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) drive(seed, device, errors);
  SCOPED_TRACE(fmt::format("with GPS {}, in dropouts of up to {:.0f} s {}, without GPS {}, at the end {}",
                           text(errors.with_gps), errors.longest_dropout, text(errors.dropout), text(errors.reckoned),
                           text(errors.reckoned_end)));
  EXPECT_GT(errors.longest_dropout, 5.0) << "the bridge hides the sky";
  EXPECT_LT(errors.with_gps.position(), 0.1);
  EXPECT_LT(errors.with_gps.heading(), 4.1 * kDegree);
  EXPECT_LT(errors.dropout.position(), 0.19);
  EXPECT_LT(errors.dropout.heading(), 4.1 * kDegree);
  EXPECT_LT(2.0 * errors.with_gps.position(), errors.reckoned.position());
  // Stated covariances are not too small.
  for (const Rms& e : {errors.with_gps, errors.dropout}) {
    EXPECT_LT(e.squares, 1.3 * e.stated);
    EXPECT_LT(e.yaw_squares, 1.3 * e.yaw_stated);
  }
}

/// Six cars together.
struct Driving {
  double travelled = 0.0;  ///< [m]
  double squares = 0.0;    ///< [m^2] of true distances from the middle of the nearest lane
  double moving = 0.0;     ///< ticks in motion
  control::LocalizationError error;
  double lane_rms() const { return std::sqrt(squares / std::max(moving, 1.0)); }
};

Driving drive_by(const char* localize, std::uint64_t seed, gpu::Device& device) {
  Driving driving;
  const Scenario scenario = town(seed, localize);
  const world::World world = world_of(scenario);
  Simulation simulation(world, device, simulation_of(scenario, world));
  RunMetrics metrics(world, simulation);
  const control::LaneCorridors corridors(*simulation.roads(), world, control::footprint_of(world.movers[0]));
  for (std::int64_t time = 0; time < kEnd / 2;) {
    const base::TickRecord tick = simulation.step();
    time = tick.time;
    metrics.update(tick);
    for (const base::Report& report : tick.reports) {
      if (std::abs(report.velocity.forward) < kDriving) continue;
      const control::RoadPositions positions = corridors.positions(report.X_WM, 1.0);
      if (positions.count == 0) continue;
      const double offset = positions.begin()->offset;
      driving.squares += offset * offset;
      ++driving.moving;
    }
  }
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    driving.travelled += metrics.of(m).travelled;
    if (const control::Controller* controller = simulation.controller(m))
      if (const control::OwnLocalization* own = control::localization_of(*controller)) driving.error.add(own->error());
  }
  return driving;
}

// The two rows of docs/estimation.md, over one minute of one seed; the page uses two minutes of eight. Bounds are
// loose, because one car that waits for another changes everything that follows.
TEST(Localization, DrivesRoutesByTheEstimate) {
  gpu::Device device;
  const Driving truth = drive_by("false", 3, device), own = drive_by("true", 3, device);
  EXPECT_EQ(truth.error.steps, 0u);
  EXPECT_LT(truth.lane_rms(), 0.005);
  EXPECT_EQ(own.error.steps, 6 * 10 * 60u + 6) << "each step of each car";
  EXPECT_LT(own.error.rms(), 0.12);
  EXPECT_GT(own.error.rms(), 0.02) << "as good as the truth: it is the truth";
  EXPECT_LT(own.error.yaw_rms(), 5.0 * kDegree);
  EXPECT_LT(own.lane_rms(), 0.15) << "off the middle of its lane by its own error";
  EXPECT_GT(own.lane_rms(), 5.0 * truth.lane_rms());
  EXPECT_GT(own.travelled, 0.3 * truth.travelled);
}

}  // namespace
}  // namespace sf::scenarios
