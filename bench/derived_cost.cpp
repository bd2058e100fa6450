// Processor time of derived sensors: localizations of many robots by encoder and gyro, in whole ticks, against the same
// filter called in a plain loop without window, hypotheses and farm. Or monitors, by the same and a receiver.
//
//   build/release/derived_cost [ROBOTS [localization|monitor]]; default: 10000 localization

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/time.h"
#include "bench/cost.h"
#include "bench/usage.h"
#include "farm/farm.h"
#include "robots/estimation/wheeled_state.h"
#include "robots/fleet.h"
#include "sensors/encoder.h"
#include "sensors/gps.h"
#include "sensors/gyro.h"
#include "sensors/localization.h"
#include "world/stage/build_world.h"

namespace sf::bench {

namespace {

constexpr int kTicks = 40;
constexpr int kWarmUp = 40;  // windows of late readings are full
constexpr std::int64_t kTick = base::kSecond / 20;

world::World fleet(int robots, const std::string& type) {
  const std::string gps = type == "monitor" ? "gps( noise 1.5 rate 1 )" : "";
  std::string text;
  for (int i = 0; i < robots; ++i)
    text += fmt::format("bot( name \"r{}\" pose [{} {} 0 {}] )\n", i, i % 100, i / 100, i % 360);
  return world::build_world(
      "fleet.world",
      fmt::format(
          "define bot position( size [0.3 0.3 0.1] drive \"diff\" encoder( per_count 0.001 slip 0.01 rate 20 )\n"
          "gyro( noise 0.2 bias 0.5 rate 20 ) {}\nderived( type \"{}\" inputs [\"encoder\" \"gyro\"{}] rate 20 ) "
          ")\n{}",
          gps, type, gps.empty() ? "" : " \"gps\"", text),
      {.sensors = sensors::world_file_words()});
}

void drive(std::vector<base::Report>& reports) {
  for (base::Report& report : reports) {
    base::Pose& X = report.X_WM;
    X.x += 0.015 * std::cos(X.yaw), X.y += 0.015 * std::sin(X.yaw), X.yaw += 0.01;
    report.velocity = {0.3, 0.0, 0.2};
  }
}

/// Returns the processor time [s] of the measured ticks. @param hash out: of the readings
double ticks(const world::World& world, base::SensorTypes types, std::uint64_t& hash) {
  gpu::Device device{std::string(gpu::kHostDevice)};
  farm::Farm farm(world, device, {.seed = 1});
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) farm.subscribe(m, types);
  std::vector<base::Report> reports = robots::states_at_load(world);
  Cost started;
  for (int tick = 0; tick < kWarmUp + kTicks; ++tick) {
    if (tick == kWarmUp) started = now();
    farm.tick(tick * kTick, reports);
    drive(reports);
  }
  hash = farm.hash();
  return since(started).cpu_s;
}

/// Returns the processor time [s] of as many predictions and corrections.
double plain_loop(std::size_t robots) {
  using estimation::WheeledMeasurement;
  const estimation::WheeledModel model{.motion = estimation::differential_drive(4.0, 40.0), .track = 0.3};
  estimation::WheeledState first{.mean = {}};
  for (std::size_t k = 0; k < estimation::kWheeledComponents; ++k) estimation::set_variance(first, k, 1e-3);
  for (const int k : {estimation::kLeftScale, estimation::kRightScale, estimation::kTrackScale}) first.mean[k] = 1.0;
  std::vector<estimation::WheeledState> states(robots, first);
  const Cost started = now();
  for (int tick = 1; tick <= kTicks; ++tick)
    for (estimation::WheeledState& state : states) {
      const WheeledMeasurement gyro{tick * kTick, WheeledMeasurement::Kind::gyro, 0, {0.2}, {1e-5, 0, 0, 1, 0, 1}};
      const WheeledMeasurement encoder{
          tick * kTick, WheeledMeasurement::Kind::encoder, 0, {0.014 * tick, 0.016 * tick}, {1e-7, 0, 0, 1e-7, 0, 1}};
      state = estimation::correct(estimation::predict(model, state, gyro.time), gyro);
      state = estimation::correct(estimation::predict(model, state, encoder.time), encoder);
      if (!std::isfinite(estimation::estimate_of(estimation::predict(model, state, encoder.time)).X_WM.x)) std::abort();
    }
  return since(started).cpu_s;
}

}  // namespace

}  // namespace sf::bench

int main(int argc, char** argv) {
  return sf::bench::run_main(
      argc, argv, "derived_cost [ROBOTS [localization|monitor]]; default: 10000 localization", [&] {
        using namespace sf;
        const int robots = argc > 1 ? std::atoi(argv[1]) : 10'000;
        const std::string type = argc > 2 ? argv[2] : "localization";
        const world::World world = bench::fleet(robots, type);
        std::uint64_t hash = 0, again = 0, unused = 0;
        const double inputs = bench::ticks(
            world, base::only(sensors::kEncoder) | base::only(sensors::kGyro) | base::only(sensors::kGps), unused);
        const double all = bench::ticks(world, farm::kAllSensorTypes, hash);
        bench::ticks(world, farm::kAllSensorTypes, again);
        const double count = 2.0 * robots * bench::kTicks;  // measurements: encoder and gyro
        const double plain = bench::plain_loop(static_cast<std::size_t>(robots));
        fmt::print("{} of type {} at 20 Hz, encoder and gyro at 20 Hz, {} ticks, hash {:016x}, {} when repeated\n",
                   robots, type, bench::kTicks, hash, hash == again ? "the same" : "another");
        fmt::print("per measurement: {:.2f} us of processor time in ticks, {:.2f} us in a plain loop, ratio {:.2f}\n",
                   1e6 * (all - inputs) / count, 1e6 * plain / count, (all - inputs) / plain);
        return hash == again ? 0 : 1;
      });
}
