// The filter on a robot's own sensors in SimVille: satellites in the streets, none under the bridge.

#include "robots/estimation/localization.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/time.h"
#include "scenarios/scenario.h"
#include "scenarios/simulation.h"
#include "sensors/encoder.h"
#include "sensors/gps.h"
#include "sensors/gyro.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::scenarios {
namespace {

/// Errors of all poses, beside those that the filter states.
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

/// One car's filters.
struct Car {
  estimation::Localization fused, reckoned;
  std::int64_t fixed = 0;  ///< [ns] of the last fix
};

// Receivers and gyros of worlds/robots.inc; ranges at the town's scale of 1/7.
constexpr double kRange = 1.5 / 7.0;
constexpr std::int64_t kEnd = 120 * base::kSecond;

std::string text(const Rms& e) { return fmt::format("{:.3f} m, {:.2f} degrees", e.position(), e.heading() / kDegree); }

world::World town(const Scenario& scenario) {
  world::World world = world_of(scenario);
  for (world::Mover& mover : world.movers) {
    if (mover.name.rfind("roomba", 0) != 0) continue;
    const auto add = [&](const char* type, std::vector<world::Setting> settings) {
      world::Sensor sensor;
      sensor.type = type;
      sensor.name = type;
      sensor.radians_per_unit = kDegree;
      sensor.settings = std::move(settings);
      std::erase_if(mover.sensors, [&](const world::Sensor& s) { return s.type == sensor.type; });
      mover.sensors.push_back(sensor);
    };
    add("encoder", {{"track", {0.258}, "", 0, ""}, {"slip", {0.005}, "", 0, ""}});
    add("gyro", {{"bias", {0.5}, "", 0, ""}, {"noise", {0.1}, "", 0, ""}, {"scale_error", {0.01}, "", 0, ""}});
    add("gps", {{"noise", {kRange}, "", 0, ""}, {"latency", {0.1}, "", 0, ""}});
  }
  world::update_extent_and_hash(world);
  return world;
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
  const Scenario scenario = parse_scenario(
      SF_SOURCE_DIR "/experiments/localization.toml",
      fmt::format("world = \"../worlds/simville/simville.world\"\nseed = {}\n[default]\ncontroller = \"route\"\n"
                  "settings = {{ tour = true, gap = 0.1 }}\n[[robot]]\nname = \"khepera6\"\ncontroller = \"none\"\n"
                  "[[robot]]\nname = \"khepera7\"\ncontroller = \"none\"\n",
                  seed));
  const world::World world = town(scenario);
  Simulation simulation(world, device, simulation_of(scenario, world));
  const estimation::LocalizationOptions options{.gyro = {0.1 * kDegree, 0.5 * kDegree}, .gps_noise = kRange};
  std::map<std::uint32_t, Car> cars;
  for (std::uint32_t row = 0; row < world.movers.size(); ++row)
    if (world.movers[row].name.rfind("roomba", 0) == 0) {
      const base::Pose& X_WM = world.movers[row].X_WM;
      cars.try_emplace(row, Car{{options, X_WM, 0}, {options, X_WM, 0}});
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

}  // namespace
}  // namespace sf::scenarios
