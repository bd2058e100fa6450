// The experiment `sideslip`: what its source reports, confirmed or refuted, and its signals through `derive`.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/time.h"
#include "scenarios/derived_replay.h"
#include "scenarios/foreign_recording.h"
#include "scenarios/sideslip_runs.h"
#include "sensors/sideslip.h"
#include "tests/folder.h"
#include "tests/units.h"

namespace sf::scenarios {
namespace {

using estimation::SideslipObserver;
using Sensors = SideslipSensors;
constexpr SideslipObserver kNonlinear[] = {SideslipObserver::extended_luenberger, SideslipObserver::ekf,
                                           SideslipObserver::sliding_mode};

double rms_of(const SideslipRun& run, Sensors sensors, SideslipObserver observer, const robots::CarModel& car = {}) {
  return evaluate(run, car, sensors, observer, 3, 51).rms_deg;
}

TEST(SideslipRuns, ReachTheirLevels) {
  for (const Manoeuvre manoeuvre : {Manoeuvre::step_steer, Manoeuvre::slalom, Manoeuvre::lane_change})
    EXPECT_NEAR(drive_manoeuvre({}, manoeuvre, 0.6).reached, 0.6, 0.003);
  const SideslipRun beyond = drive_manoeuvre({}, Manoeuvre::step_steer, 1.5);
  EXPECT_LT(beyond.reached, 1.2) << "the tyres permit no more";
}

TEST(SideslipExperiment, AllObserversSufficeAtLowLateralAcceleration) {
  const SideslipRun run = drive_manoeuvre({}, Manoeuvre::slalom, 0.2);
  for (const Sensors sensors : {Sensors::yaw_rate, Sensors::speed, Sensors::both})
    for (std::size_t o = 0; o < estimation::kSideslipObservers.size(); ++o)
      EXPECT_TRUE(evaluate(run, {}, sensors, static_cast<SideslipObserver>(o), 3, 51).tracks()) << o;
}

TEST(SideslipExperiment, NonlinearObserversDoBestAndNeedNoSpeed) {
  const SideslipRun run = drive_manoeuvre({}, Manoeuvre::slalom, 0.8);
  const double linear = rms_of(run, Sensors::yaw_rate, SideslipObserver::luenberger);
  EXPECT_GT(linear, 1.0);
  for (const SideslipObserver observer : kNonlinear) {
    const double turn = rms_of(run, Sensors::yaw_rate, observer), both = rms_of(run, Sensors::both, observer);
    EXPECT_LT(turn, 0.4 * linear);
    EXPECT_NEAR(turn, both, 0.1) << "the speed adds nothing";
    EXPECT_LT(turn, 0.8 * rms_of(run, Sensors::none, observer)) << "the yaw rate does";
  }
}

/// Where a speed has no information on the sideways speed, observers say so: they are the model alone.
TEST(SideslipExperiment, SpeedAloneIsNoBetterThanTheModel) {
  const SideslipRun run = drive_manoeuvre({}, Manoeuvre::lane_change, 0.6);
  for (const SideslipObserver observer : kNonlinear)
    EXPECT_NEAR(rms_of(run, Sensors::speed, observer), rms_of(run, Sensors::none, observer), 0.02);
  EXPECT_EQ(observability_along(run, {}, Sensors::speed, true).most_rank, 0);
  robots::CarModel neutral;
  neutral.front_stiffness = neutral.rear_stiffness;
  EXPECT_EQ(observability_along(run, neutral, Sensors::yaw_rate, true).most_rank, 1);
  EXPECT_EQ(observability_along(run, {}, Sensors::yaw_rate, true).least_rank, 2);
}

class SideslipSignalsTest : public FolderTest {};

/// The derived sensor computes what the experiment does, from the table that it writes.
TEST_F(SideslipSignalsTest, DeriveGivesTheSameEstimates) {
  const SideslipRun run = drive_manoeuvre({}, Manoeuvre::lane_change, 0.5);
  const SideslipErrors errors{.mass_scale = 0.0, .friction_scale = 0.0};
  const auto signals = signals_of(run, errors, 7);
  const std::string table = write("signals.csv", signals_csv(run, signals));
  std::string text = "[[input]]\nrobot = \"car\"\nas = \"gyro\"\n";
  for (const auto& [sensor, column] :
       std::map<std::string, std::string>{{"speed", "speed_m_s"}, {"steering", "steer_rad"}, {"torque", "torque_n_m"}})
    text += "[[input]]\nrobot = \"car\"\nas = \"" + sensor + "\"\ncolumns = [\"" + column + "\"]\n";
  text +=
      "[[derived]]\nrobot = \"car\"\ntype = \"sideslip\"\nname = \"slip\"\ninputs = [\"gyro\", \"speed\", "
      "\"steering\", \"torque\"]\n"
      "rate = 100\n";
  const DeriveFile with = read_derive_file(write("with.toml", text));
  DerivedSource source = read_foreign(table, with);
  add_sensors(with.file, with.derived, source.world);
  struct Kept final : base::Sink {
    void write(const base::TickRecord& record) override {
      for (const base::ReadingBlock& r : record.readings)
        if (r.type == sensors::kSideslip) rows[r.time].assign(r.values.begin(), r.values.end());
    }
    std::map<std::int64_t, std::vector<double>> rows;
  } kept;
  replay_derived(source, kept, {});
  const auto expected = observe(observer_of({}, SideslipObserver::ekf, errors, 7), Sensors::both, signals);
  ASSERT_EQ(kept.rows.size(), expected.size());
  std::size_t k = 0;
  for (const auto& [time, values] : kept.rows) {
    EXPECT_NEAR(values[0], expected[k].sideslip, 1e-9) << time;
    EXPECT_NEAR(values[1], expected[k].force.front, 1e-4);
    EXPECT_NEAR(values[4], expected[k].covariance[0], 1e-9);
    ++k;
  }
}

}  // namespace
}  // namespace sf::scenarios
