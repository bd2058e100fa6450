#include "server/signal_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "netio/packets.h"
#include "world/roads/rndf_statement_reader.h"
#include "world/wall_tree.h"

namespace sf::server {

namespace {

using v2x::PhaseState;
using world::LightState;
using world::PointRef;
using world::RoadNetwork;

constexpr std::int64_t kMark = 100, kMinute = 60'000, kHour = 3'600'000;  ///< [ms]
constexpr std::size_t kMaxGroups = 254;                                   ///< signal groups 0 and 255 are reserved

/// The path to a lane behind a stop line.
struct ExitPath {
  PointRef to;
  std::vector<glm::dvec2> points;  ///< [m]
};

/// The stop line of a way-point, the light that governs it, and the paths behind it.
struct LightStop {
  std::uint32_t light = 0;
  PointRef at;
  std::vector<ExitPath> exits;
};

std::vector<ExitPath> exits_of(const RoadNetwork& roads, PointRef from) {
  std::vector<ExitPath> exits;
  for (const world::RoadExit& exit : roads.exits)
    if (exit.from == from && exit.to.kind == PointRef::Kind::lane)
      exits.push_back({exit.to, exit_curve(roads, exit).points});
  return exits;
}

std::vector<LightStop> stops_of(const world::World& world, const RoadNetwork& roads) {
  std::vector<LightStop> stops;
  for (std::uint32_t light = 0; light < world.lights.size(); ++light)
    for (const std::string& name : world.lights[light].points) {
      const auto id = world::read_point_id(name);
      const auto at = id ? find_point(roads, *id) : std::nullopt;
      for (const world::StopLine& stop : roads.stops)
        if (stop.at == at) stops.push_back({light, stop.at, exits_of(roads, stop.at)});
    }
  return stops;
}

bool meet(const std::vector<glm::dvec2>& a, const std::vector<glm::dvec2>& b) {
  for (std::size_t i = 0; i + 1 < a.size(); ++i)
    for (std::size_t j = 0; j + 1 < b.size(); ++j)
      if (world::segments_meet(a[i], a[i + 1], b[j], b[j + 1])) return true;
  return false;
}

bool share_a_crossing(const LightStop& a, const LightStop& b) {
  for (const ExitPath& of_a : a.exits)
    for (const ExitPath& of_b : b.exits)
      if (of_a.to == of_b.to || meet(of_a.points, of_b.points)) return true;
  return false;
}

/// Returns the first light of each light's intersection.
std::vector<std::uint32_t> first_lights(std::size_t lights, std::span<const LightStop> stops) {
  std::vector<std::uint32_t> first(lights);
  std::iota(first.begin(), first.end(), 0u);
  for (std::size_t i = 0; i < stops.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const std::uint32_t a = first[stops[i].light], b = first[stops[j].light];
      if (a == b || !(stops[i].light == stops[j].light || share_a_crossing(stops[i], stops[j]))) continue;
      std::replace(first.begin(), first.end(), std::max(a, b), std::min(a, b));
    }
  return first;
}

/// Rounds up: a receiver assigns a mark before the message's own time to the next hour.
v2x::TimeMark mark_of(std::int64_t utc, double left) {
  constexpr double kRounding = 1e-6;  // [0.1 s] tolerance for sums of durations
  if (!std::isfinite(left)) return v2x::kUnknownTime;
  const std::int64_t now = utc % kHour;
  const double ms = 1e3 * std::max(left, 0.0);
  if (ms >= static_cast<double>(kHour)) return v2x::kMoreThanAnHour;
  const double end = (static_cast<double>(now) + ms) / static_cast<double>(kMark);
  const auto mark = static_cast<std::int64_t>(std::ceil(end - kRounding));
  return mark * kMark - now < kHour ? static_cast<v2x::TimeMark>(mark % (kHour / kMark)) : v2x::kMoreThanAnHour;
}

v2x::MovementEvent event_of(const world::Signal& signal, double latest, std::int64_t utc) {
  v2x::MovementEvent event;
  event.state = phase_of(signal.state);
  event.timing.emplace().min_end = mark_of(utc, signal.left);
  event.timing->max_end = mark_of(utc, std::max(signal.left, latest));
  return event;
}

/// [ms] since the start of the year; nullopt if the message has no time.
std::optional<std::int64_t> time_of(const v2x::IntersectionState& state) {
  if (!state.minute || *state.minute == v2x::kInvalidMinute) return std::nullopt;
  if (!state.milliseconds || *state.milliseconds >= kMinute) return std::nullopt;
  return *state.minute * kMinute + *state.milliseconds;
}

double seconds_until(v2x::TimeMark mark, std::int64_t utc) {
  if (mark >= v2x::kMoreThanAnHour) return std::numeric_limits<double>::infinity();
  // A change that was due within the last half hour is overdue, not 59 minutes ahead.
  const std::int64_t ahead = ((mark * kMark - utc % kHour) % kHour + kHour) % kHour;
  return ahead < kHour / 2 ? 1e-3 * static_cast<double>(ahead) : 0.0;
}

}  // namespace

PhaseState phase_of(LightState state) {
  switch (state) {
    case LightState::dark:
      return PhaseState::dark;
    case LightState::red:
      return PhaseState::stop_and_remain;
    case LightState::yellow:
      return PhaseState::permissive_clearance;
    case LightState::green:
      return PhaseState::permissive_movement_allowed;
    case LightState::flashing_red:
      return PhaseState::stop_then_proceed;
    case LightState::flashing_yellow:
      return PhaseState::caution_conflicting_traffic;
  }
  return PhaseState::unavailable;
}

LightState light_of(PhaseState phase) {
  switch (phase) {
    case PhaseState::unavailable:
    case PhaseState::dark:
      return LightState::dark;
    case PhaseState::stop_then_proceed:
      return LightState::flashing_red;
    case PhaseState::stop_and_remain:
    case PhaseState::pre_movement:
      return LightState::red;
    case PhaseState::permissive_movement_allowed:
    case PhaseState::protected_movement_allowed:
      return LightState::green;
    case PhaseState::permissive_clearance:
    case PhaseState::protected_clearance:
      return LightState::yellow;
    case PhaseState::caution_conflicting_traffic:
      return LightState::flashing_yellow;
  }
  return LightState::dark;
}

std::vector<Intersection> intersections_of(const world::World& world, const RoadNetwork* roads, std::uint32_t first) {
  const std::vector<LightStop> stops = roads != nullptr ? stops_of(world, *roads) : std::vector<LightStop>{};
  const std::vector<std::uint32_t> leads = first_lights(world.lights.size(), stops);
  std::vector<Intersection> all;
  for (std::uint32_t light = 0; light < leads.size(); ++light) {
    if (leads[light] != light) continue;
    const std::uint32_t post = carrier_of(world, world.lights[light]);
    const std::size_t id = post != world::kNone ? world.movers[post].id : first + all.size();
    if (id > netio::kMaxId)
      throw base::InputError(world.file, 0,
                             fmt::format("the intersection of light '{}' would have the id {}; expected at most {}",
                                         world.lights[light].name, id, netio::kMaxId));
    Intersection& one = all.emplace_back();
    one.id = static_cast<std::uint16_t>(id);
    for (std::uint32_t other = light; other < leads.size(); ++other) {
      if (leads[other] != light) continue;
      one.lights.push_back(other);
      for (const LightStop& stop : stops) {
        if (stop.light != other) continue;
        one.stops.push_back(stop.at);
        one.groups.push_back(static_cast<std::uint32_t>(one.lights.size()));
      }
    }
    if (one.lights.size() > kMaxGroups)
      throw base::InputError(world.file, 0,
                             fmt::format("the intersection of light '{}' has {} lights; a message holds {}",
                                         world.lights[light].name, one.lights.size(), kMaxGroups));
  }
  return all;
}

v2x::Spat spat_of(const Intersection& intersection, std::span<const world::SignalForecast> forecasts,
                  std::int64_t utc) {
  v2x::Spat spat;
  v2x::IntersectionState& state = spat.intersections.emplace_back();
  state.id.id = intersection.id;
  const auto since = std::chrono::sys_time<std::chrono::milliseconds>(std::chrono::milliseconds(utc));
  const std::chrono::year_month_day today{std::chrono::floor<std::chrono::days>(since)};
  const auto year = std::chrono::sys_days{today.year() / 1 / 1};
  state.minute = static_cast<std::uint32_t>(std::chrono::floor<std::chrono::minutes>(since - year).count());
  state.milliseconds = static_cast<std::uint16_t>(utc % kMinute);
  for (std::size_t i = 0; i < intersection.lights.size(); ++i) {
    const world::SignalForecast& light = forecasts[intersection.lights[i]];
    v2x::MovementState& group = state.states.emplace_back();
    group.signal_group = static_cast<std::uint8_t>(i + 1);
    group.events.push_back(event_of(light.now, light.latest, utc));
    if (!light.next) continue;
    group.events.push_back(event_of(*light.next, light.next->left, utc));
    group.events.back().timing->start = group.events.front().timing->min_end;
  }
  return spat;
}

std::size_t read_spat(const v2x::Spat& spat, std::span<const Intersection> intersections, std::int64_t utc,
                      const std::function<void(std::uint32_t light, const world::Signal&)>& take) {
  std::size_t taken = 0;
  for (const v2x::IntersectionState& state : spat.intersections) {
    const auto found = std::find_if(intersections.begin(), intersections.end(),
                                    [&](const Intersection& one) { return one.id == state.id.id; });
    if (found == intersections.end()) continue;
    const std::int64_t sent = time_of(state).value_or(utc);
    for (const v2x::MovementState& group : state.states) {
      const std::size_t k = group.signal_group;
      if (k == 0 || k > found->lights.size() || group.events.empty()) continue;
      const v2x::MovementEvent& now = group.events.front();
      const v2x::TimeMark end = now.timing ? now.timing->min_end : v2x::kUnknownTime;
      take(found->lights[k - 1], {light_of(now.state), seconds_until(end, sent)});
      ++taken;
    }
  }
  return taken;
}

}  // namespace sf::server
