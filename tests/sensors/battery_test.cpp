// Batteries: consumption at rest and in motion, charging at docks, limits, and state between ticks and processes.

#include "sensors/battery.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sensors/host_trial.h"
#include "tests/units.h"

namespace sf::trial {
namespace {

using base::Pose;
using sensors::is_docked;

constexpr double kHour = 3600.0;

/// A battery of 1 A h with round numbers.
world::World powered_robot(std::vector<world::Setting> more = {}) {
  std::vector<world::Setting> settings{setting("capacity", {1}),     setting("idle", {0.36}),
                                       setting("driving", {3.6}),    setting("charging", {3.6}),
                                       setting("voltage", {10, 20}), setting("resistance", {0.5}),
                                       setting("dock_reach", {0.2})};
  for (world::Setting& s : more) {
    std::erase_if(settings, [&](const world::Setting& old) { return old.key == s.key; });
    settings.push_back(std::move(s));
  }
  world::World world = carriers(fitted("battery", std::move(settings)));
  world.movers[0].max_forward = 1.0;
  return world;
}

void add_dock(world::World& world, const Pose& X_WD) {
  world.emitters.push_back({world::Emitter::Kind::dock, world::kNone, X_WD, 2.0, 0.7, 0.5});
}

struct BatteryReading {
  double voltage, current, charge, docked;
};

/// Reads robot 0 at the ticks of `poses`, one every 100 ms.
class PoweredTrip {
 public:
  explicit PoweredTrip(world::World world)
      : world_(std::move(world)), farm_(world_, device()), states_(robots::states_at_load(world_)) {
    farm_.subscribe_all();
  }
  BatteryReading tick(const Pose& X_WM, std::int64_t ms, std::uint32_t contact = 0) {
    return read(farm_, X_WM, ms, contact, true);
  }
  /// The robot is absent at one tick.
  void leave(std::int64_t ms) {
    farm_.set_absent(0, true);
    farm_.tick(ms * 1'000'000, states_);
    farm_.set_absent(0, false);
    farm_.subscribe_all();
  }
  BatteryReading sample(const Pose& X_WM, std::int64_t ms) { return read(farm_, X_WM, ms, 0, false); }

 private:
  BatteryReading read(farm::Farm& farm, const Pose& X_WM, std::int64_t ms, std::uint32_t contact, bool ticks) {
    states_[0].X_WM = X_WM;
    states_[0].contact_mask = contact;
    const auto r = ticks ? farm.tick(ms * 1'000'000, states_) : farm.sample(ms * 1'000'000, states_);
    EXPECT_EQ(r.size(), 1u);
    return {r[0].values[0], r[0].values[1], r[0].values[2], r[0].values[3]};
  }

  world::World world_;
  farm::Farm farm_;
  std::vector<base::Report> states_;
};

// --- Docks.

TEST(Battery, IsDockedNearTheDockOrInContactWithItsFace) {
  const Pose dock{1, 2, 0, M_PI / 2};  // faces +y
  const auto at = [&](double ahead, double aside, double yaw, bool contact) {
    return is_docked(dock, base::compose(dock, {ahead, aside, 0, M_PI + yaw}), 0.2, contact);
  };
  EXPECT_TRUE(at(0.199, 0, 0, false));
  EXPECT_FALSE(at(0.201, 0, 0, false));
  EXPECT_TRUE(at(0.199, 0, 2, false)) << "in any heading";
  EXPECT_TRUE(at(0.399, 0, 0, true)) << "in contact, twice as far";
  EXPECT_FALSE(at(0.401, 0, 0, true));
  EXPECT_FALSE(at(0.3, 0.081, 0, true)) << "aside";
  EXPECT_FALSE(at(0.3, 0, 0.61, true)) << "askew";
  EXPECT_FALSE(at(-0.3, 0, 0, true)) << "behind it";
}

// --- Charge.

TEST(Battery, IdleRobotsDischarge) {
  PoweredTrip trip(powered_robot());
  const BatteryReading first = trip.tick({}, 0);
  EXPECT_EQ(first.charge, 1.0);
  EXPECT_EQ(first.current, 0.0) << "nothing was drawn yet";
  EXPECT_EQ(first.voltage, 20.0);
  BatteryReading last = first;
  for (int i = 1; i <= 100; ++i) last = trip.tick({}, 100 * i);
  EXPECT_NEAR(last.charge, 1.0 - 0.36 * 10 / kHour, 1e-12);
  EXPECT_NEAR(last.current, -0.36, 1e-9);
  EXPECT_NEAR(last.voltage, 10 + 10 * last.charge - 0.5 * 0.36, 1e-9);
  EXPECT_EQ(last.docked, 0.0);
}

/// A metre costs the same at any speed, in any direction; turning in place rolls both wheels.
TEST(Battery, DrivingCostsChargePerMetre) {
  for (const double step : {0.01, 0.05, -0.05}) {
    PoweredTrip trip(powered_robot());
    BatteryReading last{};
    const int ticks = static_cast<int>(std::round(1.0 / std::abs(step)));
    for (int i = 0; i <= ticks; ++i) last = trip.tick({step * i, 0, 0, 0}, 100 * i);
    EXPECT_NEAR(last.charge, 1.0 - (3.6 + 0.36 * 0.1 * ticks) / kHour, 1e-9) << step;
    EXPECT_NEAR(last.current, -0.36 - 3.6 * std::abs(step) / 0.1, 1e-9);
  }
  PoweredTrip trip(powered_robot());
  trip.tick({}, 0);
  EXPECT_NEAR(trip.tick({0, 0, 0, 0.5}, 100).current, -0.36 - 3.6 * 0.15 * 0.5 / 0.1, 1e-9) << "a track of 0.3 m";
}

TEST(Battery, RelocationsCostNothing) {
  PoweredTrip trip(powered_robot());
  trip.tick({}, 0);
  EXPECT_NEAR(trip.tick({50, 0, 0, 0}, 100).current, -0.36, 1e-9);
  trip.leave(200);
  const double before = trip.tick({50, 0, 0, 0}, 100'000).charge;
  EXPECT_NEAR(before, 1.0 - 0.036 / kHour, 1e-12) << "absent robots draw nothing";
}

/// It charges from the second reading in the dock on, up to its capacity.
TEST(Battery, DocksCharge) {
  world::World world = powered_robot({setting("charge", {0.999})});
  add_dock(world, {0, 0, 0, 0});
  PoweredTrip trip(world);
  EXPECT_EQ(trip.tick({0.5, 0, 0, M_PI}, 0).docked, 0.0);
  const BatteryReading entering = trip.tick({0.1, 0, 0, M_PI}, 1000);
  EXPECT_EQ(entering.docked, 1.0);
  EXPECT_LT(entering.current, 0.0);
  const BatteryReading charging = trip.tick({0.1, 0, 0, M_PI}, 1100);
  EXPECT_NEAR(charging.current, 3.6 - 0.36, 1e-9);
  EXPECT_GT(charging.charge, entering.charge);
  const BatteryReading full = trip.tick({0.1, 0, 0, M_PI}, 100'000);
  EXPECT_EQ(full.charge, 1.0);
  EXPECT_EQ(trip.tick({0.1, 0, 0, M_PI}, 100'100).current, 0.0) << "full";
  EXPECT_LT(trip.tick({0.5, 0, 0, M_PI}, 101'000).current, 0.0);
}

TEST(Battery, ContactWithTheDocksBodyCounts) {
  world::World world = powered_robot();
  world.emitters.push_back({world::Emitter::Kind::virtual_wall, world::kNone, {}, 2.0, 0.7, 0.5});
  add_dock(world, {10, 0, 0, 0});
  world.emitters.back().model = 5;
  world.walls = {{.a = {10.29, -0.1}, .b = {10.29, 0.1}, .z_max = 0.1, .model = 5},
                 {.a = {10.35, -0.1}, .b = {10.35, 0.1}, .z_max = 0.1, .model = 6}};
  PoweredTrip trip(world);
  EXPECT_EQ(trip.tick({}, 0).docked, 0.0);
  EXPECT_EQ(trip.tick({10.299, 0, 0, M_PI}, 100).docked, 1.0) << "9 mm from the dock's body";
  EXPECT_EQ(trip.tick({10.301, 0, 0, M_PI}, 200).docked, 0.0) << "11 mm";
  EXPECT_EQ(trip.tick({10.299, 0, 0, 0}, 300).docked, 0.0) << "facing away";
  EXPECT_EQ(trip.tick({10.345, 0, 0, M_PI}, 400, 1u).docked, 0.0) << "in contact with another body";
}

TEST(Battery, NeverFallsBelowZero) {
  PoweredTrip trip(powered_robot({setting("charge", {1e-5})}));
  trip.tick({}, 0);
  const BatteryReading empty = trip.tick({}, 10'000);
  EXPECT_EQ(empty.charge, 0.0);
  const BatteryReading later = trip.tick({}, 20'000);
  EXPECT_EQ(later.current, 0.0) << "nothing is left to draw";
  EXPECT_EQ(later.voltage, 10.0);
}

// --- State.

/// A reading between two ticks is current. The next tick continues from the last one, bit by bit.
TEST(Battery, ReadsBetweenTicksAndContinuesFromTheLastTick) {
  const world::World world = powered_robot({setting("rate", {50})});
  PoweredTrip often(world), seldom(world);
  double last = 2.0;
  for (std::int64_t tick = 0; tick < 50; ++tick) {
    const double x = 0.05 * static_cast<double>(tick);
    if (tick > 0) {
      const double between = often.sample({x - 0.025, 0, 0, 0}, 100 * tick - 40).charge;
      EXPECT_LT(between, last);
    }
    const BatteryReading p = often.tick({x, 0, 0, 0}, 100 * tick), q = seldom.tick({x, 0, 0, 0}, 100 * tick);
    EXPECT_EQ(p.charge, q.charge);
    EXPECT_EQ(p.current, q.current);
    last = p.charge;
  }
}

TEST(Battery, RejectsInvalidSettings) {
  expect_refused("battery", {setting("capacity", {0})}, 8, "'capacity' is 0");
  expect_refused("battery", {setting("charge", {1.1})}, 8, "'charge' is 1.1; expected 0 to 1");
  expect_refused("battery", {setting("idle", {-1})}, 8, "'idle' is -1");
  expect_refused("battery", {setting("voltage", {12})}, 8, "[empty full] in volts");
  expect_refused("battery", {setting("voltage", {12, 11})}, 8, "not falling");
  expect_refused("battery", {setting("dock_reach", {-0.1})}, 8, "'dock_reach' is -0.1");
}

}  // namespace
}  // namespace sf::trial
