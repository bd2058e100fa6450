#include "sensors/link_speed.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "base/displacement.h"
#include "base/elementary.h"
#include "robots/estimation/link_speed.h"
#include "sensors/derived/derived_type.h"
#include "sensors/host_backend.h"
#include "sensors/localization.h"
#include "sensors/plain_packets.h"
#include "sensors/pose_sensor.h"
#include "sensors/road_links.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

enum LinkPort : std::uint8_t { kLoops, kSatellites, kVehicles };

constexpr double kLongestGap = 30.0;  // [s] between two reports of one vehicle
constexpr double kStandsFrom = 0.95;  // occupancy of a loop on which a vehicle stands
constexpr double kLeastMove =
    0.05;  // [m] shortest move from which a vehicle's direction is derived, in addition to position noise
constexpr double kDetour = 1.5;      // of a way across the end of a link, over the straight distance
constexpr double kPoseError = 0.05;  // [m] of a pose that states no covariance
constexpr std::size_t kStatedPose = 8, kPoseValidAt = 3, kPoseXxAt = 4, kPoseYyAt = 7;

/// One vehicle, at its newest report.
struct Vehicle {
  double time = -HUGE_VAL;  ///< [s]
  glm::dvec2 p{};
  std::optional<double> yaw;  ///< [rad]
  glm::dvec2 turned{};        ///< where `yaw` was found from positions
  std::optional<LinkPlace> place;
  std::uint64_t interval = 0;  ///< of its travels
  struct OnLink {
    std::uint32_t link, travel;  ///< rows, in `Link::travels`
  };
  std::vector<OnLink> travels = {};  ///< one per link
};

/// One input.
struct Source {
  std::uint32_t port = 0;
  double max_speed = 0.0;     ///< [m/s] of the vehicle
  double sigma = kPoseError;  ///< [m] of positions with hdop 1, or that state no covariance
  bool stated = false;        ///< poses state `valid` and a covariance
  Vehicle vehicle;
  std::optional<std::uint32_t> link;  ///< of a loop
  double count = NAN;                 ///< newest, of a loop
  double covered = 0.0;               ///< [s] for which no vehicle has entered or left it
};

struct Link {
  estimation::LinkSpeed filter;
  std::vector<estimation::ProbeTravel> travels = {};  ///< of vehicles since the last update
  double newest = -HUGE_VAL;                          ///< [s] of the newest report
};

struct LinkSpeedSettings {
  estimation::LinkSpeedOptions filter;
  double hold = 60.0;  ///< [s] for which a link without reports is valid
};

LinkSpeedSettings read_link_settings(const world::Sensor& sensor) {
  LinkSpeedSettings s;
  s.filter.spread = length(sensor, "spread", s.filter.spread, 1e-4, 1e3);
  s.filter.drift = length(sensor, "drift", s.filter.drift, 0.0, 1e3);
  s.filter.spot = length(sensor, "spot", s.filter.spot, 0.0, 1e3);
  s.filter.correlation = number(sensor, "correlation", s.filter.correlation, 1e-3, 1e6);
  s.hold = number(sensor, "hold", s.hold, 0.0, 1e6);
  return s;
}

class LinkSpeedSensor final : public sensorfarm::DerivedSensor {
 public:
  explicit LinkSpeedSensor(const DerivedContext& context)
      : world_(context.world),
        links_(read_road_links(context.world, context.settings)),
        route_(read_link_route(context.settings, links_)),
        settings_(read_link_settings(context.settings)),
        spread_(settings_.filter.spread),
        states_(links_.links().size(), Link{estimation::LinkSpeed(settings_.filter)}) {
    for (const sensorfarm::DerivedInput& input : context.site.inputs) add_input(input);
    const auto is_loop = [](const Source& source) { return source.port == kLoops; };
    const auto is_off = [&](const Source& source) { return is_loop(source) && !source.link; };
    const auto loops = std::ranges::count_if(sources_, is_loop);
    if (loops > 0 && std::ranges::count_if(sources_, is_off) == loops)
      refuse(context.settings, "inputs",
             "none of these loops is on one of its links, at its carrier's pose at the start");
  }

  void add_input(const sensorfarm::DerivedInput& input) override;
  void take(std::uint32_t input, const sensorfarm::Reading& reading) override;
  void read(double time, sensorfarm::DerivedReading out) override;

 private:
  void take_loop(Source& source, const sensorfarm::Reading& reading);
  void take_position(Source& source, double time, glm::dvec2 p, std::optional<double> yaw, double sigma);
  void add_travel(Vehicle& vehicle, std::uint32_t link, double metres, double seconds, double sigma);
  void cross(Vehicle& vehicle, const LinkPlace& from, double straight, double seconds, double sigma);
  void update(double time);

  /// A link or route at the time of a reading.
  struct Travel {
    double seconds = 0.0;
    double variance = 0.0;  ///< [s^2]
    double age = 0.0;       ///< [s] of the newest report; NaN: none
    double length = 0.0;    ///< [m]
    bool valid = true;
  };

  const world::World& world_;
  RoadLinks links_;
  std::vector<std::uint32_t> route_;  ///< rows of links; empty: none
  LinkSpeedSettings settings_;
  estimation::SpeedSpread spread_;
  std::vector<Link> states_;
  std::vector<Source> sources_;
  std::vector<Travel> travels_;    ///< per link, in one reading
  std::uint64_t interval_ = 1;     ///< since the start
  std::optional<double> updated_;  ///< [s]
};

void LinkSpeedSensor::add_input(const sensorfarm::DerivedInput& input) {
  const world::Mover& mover = world_.movers[input.robot];
  Source& source = sources_.emplace_back(Source{input.port, mover.max_forward});
  if (input.port == kLoops) {
    const auto [x, y, z, yaw] = input.sensor.X_RS;
    const Pose X_WL = base::compose(mover.X_WM, {x, y, z, yaw});
    if (const auto place = links_.find({X_WL.x, X_WL.y}, {})) source.link = place->link;
  }
  if (input.port == kSatellites && input.sensor.type == gps_type.name)
    source.sigma = read_gps(input_settings(world_, {input.port, input.robot, kGps, input.sensor.number})).noise;
  source.stated = input.sensor.columns.size() >= kStatedPose && input.sensor.columns[kPoseValidAt] == "valid";
}

void LinkSpeedSensor::take(std::uint32_t input, const sensorfarm::Reading& reading) {
  Source& source = sources_[input];
  const std::span<const double> v = reading.values;
  if (source.port == kLoops) return take_loop(source, reading);
  if (source.port == kSatellites) return take_position(source, reading.time, {v[0], v[1]}, {}, source.sigma * v[2]);
  if (source.stated && v[kPoseValidAt] == 0.0) return;
  const double variance = source.stated ? 0.5 * (v[kPoseXxAt] + v[kPoseYyAt]) : NAN;
  take_position(source, reading.time, {v[0], v[1]}, v[2], variance >= 0.0 ? std::sqrt(variance) : source.sigma);
}

void LinkSpeedSensor::take_loop(Source& source, const sensorfarm::Reading& reading) {
  const double count = reading.values[0], occupancy = reading.values[1], speed = reading.values[2];
  const double passed = std::isfinite(source.count) ? count - source.count : 1.0;
  if (!source.link || source.vehicle.time >= reading.time) return;
  const double seconds = std::isfinite(source.count) ? reading.time - source.vehicle.time : 0.0;
  source.count = count;
  source.vehicle.time = reading.time;
  source.covered = !std::isfinite(speed) && occupancy >= kStandsFrom ? source.covered + seconds : 0.0;
  const bool stands = source.covered >= settings_.filter.correlation, passes = std::isfinite(speed) && passed > 0.0;
  if (!stands && !passes) return;
  Link& link = states_[*source.link];
  link.filter.add_loop(stands ? 0.0 : speed, stands ? seconds / settings_.filter.correlation : passed);
  link.newest = std::max(link.newest, reading.time);
}

/// @param yaw [rad]; nullopt: that of the way
void LinkSpeedSensor::take_position(Source& source, double time, glm::dvec2 p, std::optional<double> yaw,
                                    double sigma) {
  Vehicle& vehicle = source.vehicle;
  if (!std::isfinite(p.x + p.y + sigma) || time <= vehicle.time) return;
  const double seconds = time - vehicle.time;
  const bool known = std::isfinite(vehicle.time);
  const bool jumped = known && !base::is_drivable({vehicle.p.x, vehicle.p.y}, {p.x, p.y}, source.max_speed, seconds);
  if (!known || jumped) vehicle.turned = p, vehicle.yaw.reset();
  if (yaw) vehicle.yaw = yaw;
  if (const glm::dvec2 d = p - vehicle.turned; !yaw && glm::length(d) > kLeastMove + 2.0 * sigma)
    vehicle.yaw = base::atan2(d.y, d.x), vehicle.turned = p;
  const std::optional<LinkPlace> before = jumped ? std::nullopt : vehicle.place;
  const double straight = glm::distance(vehicle.p, p);
  vehicle.place = vehicle.yaw ? links_.find(p, vehicle.yaw) : std::nullopt;
  vehicle.time = time, vehicle.p = p;
  if (!before || !vehicle.place || seconds > kLongestGap) return;
  if (before->link != vehicle.place->link) return cross(vehicle, *before, straight, seconds, sigma);
  add_travel(vehicle, before->link, links_.driven(before->link, before->s, vehicle.place->s), seconds, sigma);
}

/// Adds a way from one link to the next one, across the end, or back, as errors of the position of a vehicle at rest
/// show it. Its time is divided as if it was driven evenly.
/// @param from place at the last report @param straight [m] between both positions
void LinkSpeedSensor::cross(Vehicle& vehicle, const LinkPlace& from, double straight, double seconds, double sigma) {
  const LinkPlace& to = *vehicle.place;
  const RoadLink &left = links_.links()[from.link], &entered = links_.links()[to.link];
  /// [m] on the first link, between both, and on the second.
  const auto way = [](const RoadLink& a, double s_a, const RoadLink& b, double s_b) {
    return std::array{a.length() - s_a, glm::distance(a.points.back(), b.points.front()), s_b};
  };
  const auto sum = [](const std::array<double, 3>& parts) { return parts[0] + parts[1] + parts[2]; };
  std::array<double, 3> parts = way(left, from.s, entered, to.s);
  const std::array<double, 3> back = way(entered, to.s, left, from.s);
  const double sign = sum(parts) <= sum(back) ? 1.0 : -1.0;
  if (sign < 0.0) parts = {back[2], back[1], back[0]};
  if (sum(parts) > kDetour * straight + left.reach + entered.reach) return;
  const double pace = sum(parts) > 0.0 ? seconds / sum(parts) : 0.0;
  add_travel(vehicle, from.link, sign * parts[0], parts[0] * pace, sigma);
  add_travel(vehicle, to.link, sign * parts[2], parts[2] * pace, sigma);
}

void LinkSpeedSensor::add_travel(Vehicle& vehicle, std::uint32_t row, double metres, double seconds, double sigma) {
  if (!(seconds > 0.0)) return;
  states_[row].newest = std::max(states_[row].newest, vehicle.time);
  auto& travels = states_[row].travels;
  if (std::exchange(vehicle.interval, interval_) != interval_) vehicle.travels.clear();
  auto own = std::ranges::find(vehicle.travels, row, &Vehicle::OnLink::link);
  if (own == vehicle.travels.end()) {
    own = vehicle.travels.insert(own, {row, static_cast<std::uint32_t>(travels.size())});
    travels.push_back({.variance = 2.0 * sigma * sigma});  // of the first and the last position
  }
  travels[own->travel].metres += metres;
  travels[own->travel].seconds += seconds;
}

void LinkSpeedSensor::update(double time) {
  const double seconds = updated_ ? time - *updated_ : 0.0;
  for (const Link& link : states_) spread_.add(link.travels);
  for (Link& link : states_) {
    for (const estimation::ProbeTravel& travel : link.travels) link.filter.add_probe(travel);
    link.filter.update(seconds, spread_.variance());
    link.travels.clear();
  }
  updated_ = time;
  ++interval_;
}

/// A row: speed [m/s] and travel time [s].
void fill_row(const sensorfarm::DerivedReading& out, std::size_t row, bool valid, double length, double seconds,
              double variance, double age) {
  double* const values = out.values.data() + 3 * row;
  out.valid[row] = valid;
  values[2] = age;
  if (!valid) return;
  const double slope = -length / (seconds * seconds);  // of the speed over the time
  values[0] = length / seconds, values[1] = seconds;
  const std::array<double, 3> covariance{slope * slope * variance, slope * variance, variance};
  std::ranges::copy(covariance, out.covariance.begin() + static_cast<std::ptrdiff_t>(3 * row));
}

void LinkSpeedSensor::read(double time, sensorfarm::DerivedReading out) {
  update(time);
  travels_.clear();
  for (std::size_t row = 0; row < states_.size(); ++row) {
    const Link& link = states_[row];
    const double length = links_.links()[row].length(), speed = std::max(link.filter.speed(), length / kLongestTravel);
    const double seconds = length / speed, slope = seconds / speed, age = time - link.newest;
    const Travel& travel =
        travels_.emplace_back(Travel{seconds, slope * slope * link.filter.variance(), std::isfinite(age) ? age : NAN,
                                     length, link.filter.known() && age <= settings_.hold});
    fill_row(out, row, travel.valid, length, seconds, travel.variance, travel.age);
  }
  if (route_.empty()) return;
  Travel sum;
  for (const std::uint32_t row : route_) {
    const Travel& travel = travels_[row];
    sum.seconds += travel.seconds, sum.variance += travel.variance, sum.length += travel.length;
    sum.age = std::isnan(travel.age) || std::isnan(sum.age) ? NAN : std::max(sum.age, travel.age);
    sum.valid &= travel.valid;
  }
  fill_row(out, travels_.size(), sum.valid, sum.length, sum.seconds, sum.variance, sum.age);
}

ParsedSensors parse_link_speeds(const world::World& world) {
  ParsedSensors parsed = parse_derived(world, link_speed_type, 1, 0.1);
  std::size_t row = 0;
  for_each_of(world, link_speed_type.word.type, [&](const world::Sensor& sensor, std::uint32_t, std::uint32_t) {
    const RoadLinks links = read_road_links(world, sensor);
    read_link_settings(sensor);
    parsed.rows[row++].elements =
        static_cast<std::uint32_t>(links.links().size()) + !read_link_route(sensor, links).empty();
  });
  return parsed;
}

constexpr std::string_view kLoopColumns[] = {"count", "occupancy", "speed_m_s"};
constexpr std::string_view kPoseColumns[] = {"x_m", "y_m", "yaw_rad"};
constexpr std::uint32_t kMostReports = 1'000'000;
constexpr DerivedPort kPorts[] = {{"loop", kLoopColumns, 0, kMostReports},
                                  {"gps", kGpsColumns, 0, kMostReports},
                                  {"pose", kPoseColumns, 0, kMostReports}};
constexpr DerivedForm kDerived{.ports = kPorts,
                               .quantities = 2,
                               .covariance = true,
                               .extra = 1,
                               .make = [](const DerivedContext& context) -> std::unique_ptr<sensorfarm::DerivedSensor> {
                                 return std::make_unique<LinkSpeedSensor>(context);
                               }};

constexpr std::string_view kKeys[] = {kDerivedKeys[0], kDerivedKeys[1], "links",       "link[]", "lanes", "reach",
                                      "route",         "spread",        "correlation", "drift",  "spot",  "hold"};
constexpr Column kColumns[] = {{"speed_m_s"},    {"travel_time_s"}, {"valid", 1, true}, {"speed_speed_m2_s2"},
                               {"speed_time_m"}, {"time_time_s2"},  {"age_s"}};
constexpr PlainNumber kNumbers[] = {kReal, kReal, {1.0, 0.0, 1.0}, kReal, kReal, kReal, kReal};
constexpr PlainForm kForm{kLinkSpeed, "link-speed", kNumbers};
static_assert(std::size(kNumbers) == kLinkSpeedNumbers);

}  // namespace

constinit const SensorType link_speed_type = plain<kForm>({
    .word = {"link-speed", kKeys, {}, true},
    .base_port = 2000,
    .list = "links",
    .columns = kColumns,
    .derived = &kDerived,
    .parse = parse_link_speeds,
    .make = no_backend,
});

}  // namespace sf::sensors
