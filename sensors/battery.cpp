#include "sensors/battery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <unordered_map>

#include "base/box_tree.h"
#include "base/displacement.h"
#include "robots/footprint.h"
#include "sensors/host_backend.h"
#include "sensors/odometer.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"
#include "world/wall_tree.h"

namespace sf::sensors {

namespace {

constexpr double kHour = 3600.0;           // [s]
constexpr double kLongestDockReach = 1e3;  // [m]
constexpr double kFaces = 0.6;             // [rad] largest heading error towards the dock for a contact with its face

constexpr double kTouches = 0.01;  // [m] contacts of a robot and a dock reach across this gap

/// A dock of the world, with its body.
struct Dock {
  Pose X_WD;
  std::vector<world::Segment> walls;
};

/// A battery at one time.
struct Charge {
  Pose X_WM;
  std::int64_t since = 0;  ///< [ns] time of the pose
  double charge = 0.0;     ///< [A h]
  double current = 0.0;    ///< [A] mean since the time before; negative: discharging
  bool docked = false;
  bool known = false;  ///< false: the robot has no pose yet, or is absent
};

class Batteries : public HostBackend {
 public:
  Batteries(const SensorContext& context, const ParsedSensors& sensors);

  void accumulate(std::int64_t now, bool between) override;
  void write_state(std::uint32_t row, base::ByteWriter& out) const override {
    out.put_bytes(&charges_[row], sizeof charges_[row]);
  }
  void read_state(std::uint32_t row, base::ByteReader& in) override {
    in.get_into(&charges_[row], sizeof charges_[row]);
  }
  void restart(std::uint32_t row, std::int64_t now) override {
    charges_[row] = {.charge = settings_[row].charge * settings_[row].capacity};
    advance(row, now, charges_[row]);
  }

 private:
  void measure(std::span<const HostSample> samples) const override;
  bool in_dock(std::size_t row, const Pose& X_WM) const;
  void advance(std::size_t row, std::int64_t now, Charge& charge) const;

  const std::vector<Battery>& settings_;  ///< per row
  std::vector<double> radii_;             ///< [m] per row, of the robot's footprint
  std::vector<Dock> docks_;
  base::BoxTree dock_places_;
  std::vector<Charge> charges_;  ///< per row, at the last tick
  std::vector<Charge> ahead_;    ///< per row, in a sample between two ticks
  bool between_ = false;         ///< `ahead_` is current
};

static_assert(std::is_trivially_copyable_v<Charge>);

Batteries::Batteries(const SensorContext& context, const ParsedSensors& sensors)
    : HostBackend(context, battery_type, sensors), settings_(sensors.settings_as<Battery>()) {
  std::vector<base::Box> places;
  std::unordered_map<std::uint32_t, std::size_t> dock_of_model;
  for (const world::Emitter& emitter : context.world.emitters) {
    if (emitter.kind != world::Emitter::Kind::dock) continue;
    dock_of_model.emplace(emitter.model, docks_.size());
    docks_.push_back({emitter.X_WE, {}});
    places.push_back(base::box_around({emitter.X_WE.x, emitter.X_WE.y}, 0.0));
  }
  dock_places_ = base::BoxTree(places);
  for (const world::Segment& wall : context.world.walls)
    if (const auto dock = dock_of_model.find(wall.model); wall.stops_robots && dock != dock_of_model.end())
      docks_[dock->second].walls.push_back(wall);
  for (const Battery& battery : settings_) charges_.push_back({.charge = battery.charge * battery.capacity});
  for (const SensorSpec& row : rows()) radii_.push_back(robots::footprint_of(world().movers[row.mover]).radius);
}

/// Decides contact by the pose alone, since recordings have no contacts.
bool Batteries::in_dock(std::size_t row, const Pose& X_WM) const {
  const double reach = settings_[row].dock_reach;
  const glm::dvec2 p{X_WM.x, X_WM.y};
  return dock_places_.any(base::box_around(p, 2.5 * reach), [&](std::uint32_t i) {
    const bool touches = std::any_of(docks_[i].walls.begin(), docks_[i].walls.end(), [&](const world::Segment& wall) {
      return world::distance(p, wall.a, wall.b) <= radii_[row] + kTouches;
    });
    return is_docked(docks_[i].X_WD, X_WM, reach, touches);
  });
}

/// Continues a battery up to `now`. A robot that was relocated has not driven. A dock charges while the robot is in it
/// at both ends of the time.
void Batteries::advance(std::size_t row, std::int64_t now, Charge& charge) const {
  const Battery& battery = settings_[row];
  const base::Report& state = states()[rows()[row].mover];
  const world::Mover& mover = world().movers[rows()[row].mover];
  if (base::is_absent(state.X_WM)) {
    charge.known = false;
    return;
  }
  const Charge before = charge;
  charge.X_WM = state.X_WM;
  charge.docked = in_dock(row, state.X_WM);
  charge.since = now;
  charge.known = true;
  const double seconds = 1e-9 * static_cast<double>(now - before.since);
  if (!before.known || !(seconds > 0.0)) return;
  const bool drove = base::is_drivable(before.X_WM, state.X_WM, mover.max_forward, seconds);
  const Rolled rolled = drove ? roll(before.X_WM, state.X_WM, mover.track) : Rolled{};
  const double way = 0.5 * (std::abs(rolled.left) + std::abs(rolled.right));
  const double gained = before.docked && charge.docked ? battery.charging * seconds : 0.0;
  const double net = gained - battery.idle * seconds - battery.driving * way;  // [A s]
  charge.charge = std::clamp(before.charge + net / kHour, 0.0, battery.capacity);
  charge.current = (charge.charge - before.charge) * kHour / seconds;
}

void Batteries::accumulate(std::int64_t now, bool between) {
  between_ = between;
  if (between) ahead_ = charges_;
  for (std::size_t i = 0; i < charges_.size(); ++i) advance(i, now, (between ? ahead_ : charges_)[i]);
}

void Batteries::measure(std::span<const HostSample> samples) const {
  for (const HostSample& sample : samples) {
    const Battery& battery = settings_[sample.row];
    const Charge& now = (between_ ? ahead_ : charges_)[sample.row];
    const double level = now.charge / battery.capacity;
    const double voltage = battery.empty + level * (battery.full - battery.empty) + battery.resistance * now.current;
    const double row[] = {std::max(0.0, voltage), now.current, now.charge, now.docked ? 1.0 : 0.0};
    std::copy(std::begin(row), std::end(row), sample.values.begin());
  }
}

ParsedSensors parse_batteries(const world::World& world) {
  return parse_each(world, battery_type, [&](const world::Sensor& sensor, SensorSpec& row) {
    row.reach = 0.0;
    return read_battery(sensor, world.movers[row.mover]);
  });
}

constexpr std::string_view kKeys[] = {"capacity", "charge",  "idle",       "driving",
                                      "charging", "voltage", "resistance", "dock_reach"};
constexpr Column kColumns[] = {{"voltage_V"}, {"current_A"}, {"charge_Ah"}, {"docked", 1, true}};
constexpr PlainNumber kNumbers[] = {{1e-3, 0.0}, {1e-3}, {1e-6, 0.0}, {1.0, 0.0, 1.0}};
constexpr PlainForm kForm{kBattery, "battery", kNumbers};

}  // namespace

bool is_docked(const Pose& X_WD, const Pose& X_WM, double reach, bool contact) {
  const glm::dvec2 p = base::rotate(-X_WD.yaw, {X_WM.x - X_WD.x, X_WM.y - X_WD.y});
  if (glm::length(p) <= reach) return true;
  const double off = base::wrap_angle(X_WD.yaw + M_PI - X_WM.yaw);
  return contact && p.x > 0.0 && p.x < 2.0 * reach && std::abs(p.y) < 0.4 * reach && std::abs(off) < kFaces;
}

double dock_reach_of(const world::Mover& mover) { return robots::footprint_of(mover).radius + 0.03; }

Battery read_battery(const world::Sensor& sensor, const world::Mover& mover) {
  Battery b;
  b.capacity = number(sensor, "capacity", b.capacity, 1e-6, 1e3);
  b.charge = number(sensor, "charge", b.charge, 0.0, 1.0);
  b.idle = number(sensor, "idle", b.idle, 0.0, 1e3);
  b.driving = number(sensor, "driving", b.driving, 0.0, 1e6);
  b.charging = number(sensor, "charging", b.charging, 0.0, 1e3);
  b.resistance = number(sensor, "resistance", b.resistance, 0.0, 1e3);
  b.dock_reach =
      length(sensor, "dock_reach", std::min(dock_reach_of(mover), kLongestDockReach), 0.0, kLongestDockReach);
  if (const auto v = tuple(sensor, "voltage", 2, "[empty full] in volts")) {
    b.empty = (*v)[0];
    b.full = (*v)[1];
    if (!(b.empty >= 0.0 && b.empty <= b.full && b.full <= 1e6))
      refuse(sensor, "voltage",
             fmt::format("'voltage' is [{:g} {:g}]; expected [empty full] in volts, from 0 to 1e6 and not falling",
                         b.empty, b.full));
  }
  return b;
}

constinit const SensorType battery_type = plain<kForm>({
    .word = {"battery", kKeys},
    .base_port = 56000,
    .list = "",
    .columns = kColumns,
    .parse = parse_batteries,
    .make = make_backend<Batteries>,
});

}  // namespace sf::sensors
