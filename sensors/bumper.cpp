#include "sensors/bumper.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "sensors/host_backend.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kTurn = 2.0 * M_PI;
constexpr double kSector = kTurn / base::kContactSectors;
constexpr double kRounding = 1e-9;  // [rad] rounding error of degrees converted to radians

/// Returns the sectors whose centres have bearings from `from` counter-clockwise to `from` + `sweep` [rad].
std::uint32_t sectors_of(double from, double sweep) {
  std::uint32_t sectors = 0;
  for (std::uint32_t k = 0; k < base::kContactSectors; ++k) {
    const double ahead = (k + 0.5) * kSector - from;
    const double turned = ahead - kTurn * std::floor((ahead + kRounding) / kTurn);
    if (turned < sweep - kRounding) sectors |= 1u << k;
  }
  return sectors;
}

std::uint32_t read_zone(const world::Sensor& sensor, const world::Setting& setting) {
  const auto degrees = *tuple(sensor, setting.key, 2, "[from to], bearings counter-clockwise");
  const double from = sensor.radians_per_unit * degrees[0];
  double sweep = sensor.radians_per_unit * degrees[1] - from;
  if (sweep < -kRounding) sweep += kTurn;
  if (!(std::abs(from) <= kTurn) || !(sweep > kRounding && sweep <= kTurn + kRounding))
    refuse(sensor, setting.key,
           fmt::format("'{}' is [{:g} {:g}]; expected [from to], an arc counter-clockwise of at most one turn that "
                       "begins within one turn of straight ahead",
                       setting.key, degrees[0], degrees[1]));
  const std::uint32_t sectors = sectors_of(from + sensor.X_MS.yaw, sweep);
  if (sectors != 0) return sectors;
  refuse(sensor, setting.key,
         fmt::format("'{}' is [{:g} {:g}], which contains the middle of none of the {} contact sectors; "
                     "widen it",
                     setting.key, degrees[0], degrees[1], base::kContactSectors));
}

/// Reads Stage's bars: [x y z angle] and `blength`, perpendicular to `angle`. A bar is the arc of bearings between its
/// ends.
std::vector<std::uint32_t> read_bars(const world::Sensor& sensor) {
  const std::uint32_t count = whole(sensor, "bcount", 1, 1, kMostBumperZones);
  std::vector<std::uint32_t> switches;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::string key = fmt::format("bpose[{}]", i);
    const auto bar = tuple(sensor, key, 4, "[x y z angle]");
    if (!bar) refuse(sensor, "bcount", fmt::format("'{}' is missing: 'bcount' is {}", key, count));
    const std::string own = fmt::format("blength[{}]", i);
    const double half = 0.5 * length(sensor, find(sensor, own) != nullptr ? own : "blength", 0.1, 0.0, 1e6);
    const double angle = sensor.radians_per_unit * (*bar)[3];
    const glm::dvec2 middle{sensor.metres_per_unit * (*bar)[0], sensor.metres_per_unit * (*bar)[1]};
    const glm::dvec2 along = base::rotate(angle, {0.0, half});
    const auto bearing = [&](glm::dvec2 p) {
      const glm::dvec2 p_M = base::transform(sensor.X_MS, p);
      return base::atan2(p_M.y, p_M.x);
    };
    double sweep = bearing(middle + along) - bearing(middle - along);
    if (sweep < 0.0) sweep += kTurn;
    switches.push_back(sectors_of(bearing(middle - along), std::max(sweep, kSector)));
  }
  return switches;
}

class Bumpers : public HostBackend {
 public:
  Bumpers(const SensorContext& context, const ParsedSensors& sensors)
      : HostBackend(context, bumper_type, sensors), switches_(sensors.settings_as<BumperSwitches>()) {}

 private:
  void measure(std::span<const HostSample> samples) const override;

  const std::vector<BumperSwitches>& switches_;  ///< per row
};

ParsedSensors parse_bumpers(const world::World& world) {
  return parse_each(world, bumper_type, [](const world::Sensor& sensor, SensorSpec& row) {
    BumperSwitches switches = read_bumper(sensor);
    row.elements = static_cast<std::uint32_t>(switches.size());
    row.limit = 1.0;
    row.reach = 0.0;
    return switches;
  });
}

void Bumpers::measure(std::span<const HostSample> samples) const {
  for (const HostSample& sample : samples) {
    const std::uint32_t contact_mask = states()[rows()[sample.row].mover].contact_mask;
    const auto& switches = switches_[sample.row];
    for (std::size_t i = 0; i < switches.size(); ++i) sample.values[i] = (contact_mask & switches[i]) != 0 ? 1.0 : 0.0;
  }
}

constexpr std::string_view kKeys[] = {"zones", "zone[]", "bcount", "bpose[]", "blength", "blength[]"};
constexpr Column kColumns[] = {{"pressed", 1, true}};
constexpr PlainNumber kNumbers[] = {{1.0, 0.0, 1.0}};
constexpr PlainForm kForm{kBumper, "bumper", kNumbers};

}  // namespace

BumperSwitches read_bumper(const world::Sensor& sensor) {
  if (find(sensor, "bcount") != nullptr) return read_bars(sensor);
  const std::uint32_t zones = whole(sensor, "zones", 1, 1, kMostBumperZones);
  refuse_beyond(sensor, "zone[", "zones", zones, kMostBumperZones);
  const bool all_round = find(sensor, "zones") == nullptr && find(sensor, "zone[0]") == nullptr;
  if (all_round) return {0xFFFFFFFFu};
  std::vector<std::uint32_t> switches;
  for (std::uint32_t i = 0; i < zones; ++i) {
    const world::Setting* zone = find(sensor, fmt::format("zone[{}]", i));
    if (zone == nullptr)
      refuse(sensor, "zones",
             fmt::format("'zone[{}]' is missing: 'zones {}' requires zone[0] to zone[{}], each once; number them, or "
                         "lower 'zones'",
                         i, zones, zones - 1));
    switches.push_back(read_zone(sensor, *zone));
  }
  return switches;
}

constinit const SensorType bumper_type = plain<kForm>({
    .word = {"bumper", kKeys},
    .base_port = 40000,
    .list = "switches",
    .columns = kColumns,
    .parse = parse_bumpers,
    .make = make_backend<Bumpers>,
});

}  // namespace sf::sensors
