#include "server/signal_messages.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/refusal.h"
#include "v2x/frame.h"
#include "world/roads/roads.h"

namespace sf::server {
namespace {

using world::LightState;

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr std::int64_t kNewYear2026 = 1'767'225'600'000;  ///< [ms]

world::Light light(const std::vector<world::LightPhase>& phases, double offset = 0.0) {
  world::Light made;
  made.phases = phases;
  made.offset = offset;
  return made;
}

/// One light of 8 s green, 2 s yellow, 14 s red; one that remains dark.
world::World two_lights() {
  world::World world;
  world.lights.push_back(light({{LightState::green, 8.0}, {LightState::yellow, 2.0}, {LightState::red, 14.0}}));
  world.lights.push_back(light({{LightState::dark, 1.0}}));
  return world;
}

/// Sets the states contained in a message.
std::size_t read(const v2x::Spat& spat, std::span<const Intersection> all, std::int64_t utc,
                 std::vector<world::Signal>& signals) {
  return read_spat(spat, all, utc, [&](std::uint32_t row, const world::Signal& signal) { signals.at(row) = signal; });
}

struct Town {
  world::World world = world::load_world(SF_SOURCE_DIR "/worlds/simville/simville.world");
  world::RoadNetwork roads = *world::roads_of(world);
  std::vector<Intersection> intersections = intersections_of(world, &roads);
};

const v2x::MovementEvent& event(const v2x::Spat& spat, std::size_t row) {
  return spat.intersections.at(0).states.at(0).events.at(row);
}

/// Returns the nodes of a lane in the world, from the intersection's middle [m].
std::vector<glm::dvec2> points_of(const v2x::GenericLane& lane) {
  std::vector<glm::dvec2> points;
  glm::dvec2 p;
  for (const v2x::Node& node : lane.nodes.nodes) {
    p += 0.01 * glm::dvec2(node.delta.xy.x, node.delta.xy.y);
    points.push_back(p);
  }
  return points;
}

v2x::Frame round_trip(const v2x::MapData& map) {
  v2x::Frame frame, again;
  frame.message = map;
  base::Bytes bytes;
  v2x::encode(frame, bytes);
  EXPECT_TRUE(v2x::decode(bytes, again).ok());
  EXPECT_TRUE(frame == again);
  return again;
}

TEST(SignalMessages, LightsWithoutRoadsAreSeparateIntersections) {
  const auto all = intersections_of(two_lights(), nullptr);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[1].id, 2);
  EXPECT_EQ(all[1].lights, (std::vector<std::uint32_t>{1}));
}

TEST(SignalMessages, SpatHasTheStateAndTheNextOne) {
  const world::World world = two_lights();
  const auto all = intersections_of(world, nullptr);
  const v2x::Spat spat = spat_of(all[0], world::forecasts_at(world, 3.0), kNewYear2026 + 61'250);
  EXPECT_EQ(spat.intersections[0].minute, 1u);
  EXPECT_EQ(spat.intersections[0].milliseconds, 1250);
  EXPECT_EQ(event(spat, 0).state, v2x::PhaseState::permissive_movement_allowed);
  EXPECT_EQ(event(spat, 0).timing->min_end, 663);  // 61.25 s + 5 s, rounded up
  EXPECT_EQ(event(spat, 0).timing->max_end, 663);
  EXPECT_EQ(event(spat, 1).state, v2x::PhaseState::permissive_clearance);
  EXPECT_EQ(event(spat, 1).timing->start, 663);
  EXPECT_EQ(event(spat, 1).timing->min_end, 683);
}

TEST(SignalMessages, MarksAtTheirLimits) {
  world::World world = two_lights();
  const auto all = intersections_of(world, nullptr);
  // Across the hour: 3599 s + 5 s is second 4 of the next hour.
  EXPECT_EQ(event(spat_of(all[0], world::forecasts_at(world, 3.0), kNewYear2026 + 3'599'000), 0).timing->min_end, 40);
  // A permanent state has no end time and no next state.
  const v2x::Spat dark = spat_of(all[1], world::forecasts_at(world, 3.0), kNewYear2026);
  EXPECT_EQ(event(dark, 0).timing->min_end, v2x::kUnknownTime);
  EXPECT_EQ(dark.intersections[0].states[0].events.size(), 1u);
  // More than an hour ahead.
  world.lights[0] = light({{LightState::red, 3601.0}, {LightState::green, 1.0}});
  EXPECT_EQ(event(spat_of(all[0], world::forecasts_at(world, 0.0), kNewYear2026), 0).timing->min_end,
            v2x::kMoreThanAnHour);
  // The last minute of a leap year.
  const std::int64_t last = kNewYear2026 + (365 + 365 + 366) * 86'400'000LL - 1;
  EXPECT_EQ(spat_of(all[0], world::forecasts_at(world, 0.0), last).intersections[0].minute, 366u * 1440u - 1u);
}

/// [ms] Returns the time from `utc` to a mark, by a receiver that assigns every mark to the hour that begins now.
std::int64_t ahead_of(v2x::TimeMark mark, std::int64_t utc) {
  return ((mark * 100 - utc % 3'600'000) % 3'600'000 + 3'600'000) % 3'600'000;
}

/// Checks the marks of an event, in tenths of a second after `utc`.
void expect_marks(const v2x::MovementEvent& event, double left, std::int64_t utc) {
  const std::int64_t least = ahead_of(event.timing->min_end, utc), most = ahead_of(*event.timing->max_end, utc);
  EXPECT_GE(static_cast<double>(least), 1e3 * left - 1e-3) << utc << ": earlier than the change";
  EXPECT_LT(static_cast<double>(least), 1e3 * left + 100.0) << utc << ": as much as a mark too late";
  EXPECT_GE(most, least) << utc;
  EXPECT_LE(ahead_of(event.timing->start.value_or(event.timing->min_end), utc), least) << utc;
}

/// At every 10 ms, across the hour, with phases that are not whole marks.
TEST(SignalMessages, NoMarkIsBeforeTheMessage) {
  world::World world;
  world.lights.push_back(
      light({{LightState::green, 8.04}, {LightState::yellow, 1.999}, {LightState::red, 14.0}}, 0.01));
  const auto all = intersections_of(world, nullptr);
  for (std::int64_t ms = 0; ms < 60'000; ms += 10) {
    const std::int64_t utc = kNewYear2026 + 3'570'000 + ms;
    const auto forecasts = world::forecasts_at(world, 1e-3 * static_cast<double>(ms));
    const v2x::Spat spat = spat_of(all[0], forecasts, utc);
    expect_marks(event(spat, 0), forecasts[0].now.left, utc);
    expect_marks(event(spat, 1), forecasts[0].next->left, utc);
    EXPECT_EQ(event(spat, 1).timing->start, event(spat, 0).timing->min_end);
    std::vector<world::Signal> signals(1);
    read(spat, all, utc, signals);
    EXPECT_NEAR(signals[0].left, forecasts[0].now.left + 0.05, 0.0501) << ms;
  }
}

/// Remaining times, each with a reason.
TEST(SignalMessages, MarksOfRemainingTimes) {
  const world::World world = two_lights();
  const auto all = intersections_of(world, nullptr);
  const auto marks = [&](std::int64_t utc, double earliest, double latest) {
    std::vector<world::SignalForecast> forecasts(2);
    forecasts[0] = {{LightState::green, earliest}, latest, std::nullopt};
    const v2x::Spat spat = spat_of(all[0], forecasts, kNewYear2026 + utc);
    return std::pair<int, int>(event(spat, 0).timing->min_end, *event(spat, 0).timing->max_end);
  };
  using Marks = std::pair<int, int>;
  EXPECT_EQ(marks(8'030, 0.01, 0.01), Marks(81, 81)) << "8.04 s, not 8.0, which is over";
  EXPECT_EQ(marks(8'000, 0.0, 0.0), Marks(80, 80)) << "now, at a mark";
  EXPECT_EQ(marks(8'001, 0.0, 0.0), Marks(81, 81)) << "now, behind a mark";
  EXPECT_EQ(marks(8'000, -1.0, -1.0), Marks(80, 80)) << "overdue";
  EXPECT_EQ(marks(0, 0.7 + 0.1 + 1e-10, 3.0), Marks(8, 30)) << "rounding errors of sums are ignored";
  EXPECT_EQ(marks(0, 3.0, 2.0), Marks(30, 30)) << "never the latest before the earliest";
  EXPECT_EQ(marks(3'599'990, 0.02, 5.0), Marks(1, 50)) << "in the next hour";
  EXPECT_EQ(marks(3'599'990, 0.01, 0.01), Marks(0, 0)) << "its first mark";
  EXPECT_EQ(marks(50, 3'599.9, 3'599.9), Marks(0, 0)) << "59 min 59.95 s ahead";
  EXPECT_EQ(marks(0, 3'599.9, 3'599.95), Marks(35'999, v2x::kMoreThanAnHour)) << "rounded up to an hour, not to 0";
  EXPECT_EQ(marks(50, 3'599.96, 3'600.0), Marks(v2x::kMoreThanAnHour, v2x::kMoreThanAnHour)) << "0.1 s is over";
  EXPECT_EQ(marks(0, 1.0, kForever), Marks(10, v2x::kUnknownTime));
  EXPECT_EQ(marks(0, 1e300, kForever), Marks(v2x::kMoreThanAnHour, v2x::kUnknownTime));
}

/// Marks from 36000 on are not times.
TEST(SignalMessages, MarksBeyondTheHourAreRead) {
  const world::World world = two_lights();
  const auto all = intersections_of(world, nullptr);
  v2x::Spat spat = spat_of(all[0], world::forecasts_at(world, 0.0), kNewYear2026);
  std::vector<world::Signal> signals(2);
  const auto left = [&](v2x::TimeMark mark) {
    spat.intersections[0].states[0].events[0].timing->min_end = mark;
    read(spat, all, kNewYear2026, signals);
    return signals[0].left;
  };
  EXPECT_NEAR(left(17'999), 1'799.9, 1e-9) << "the last one that is not late";
  EXPECT_EQ(left(18'000), 0.0);
  EXPECT_EQ(left(35'999), 0.0) << "0.1 s late";
  for (const int mark : {36'000, 36'001, 36'111}) EXPECT_EQ(left(static_cast<v2x::TimeMark>(mark)), kForever) << mark;
}

TEST(SignalMessages, StatesRoundTripAtAnyTime) {
  const Town town;
  for (double time = 0.05; time < 30.0; time += 0.37) {
    const std::int64_t utc = kNewYear2026 + 3'590'000 + std::llround(1e3 * time);  // across an hour
    std::vector<world::Signal> signals(town.world.lights.size(), {LightState::dark, -1.0});
    std::size_t set = 0;
    for (const Intersection& one : town.intersections)
      set += read(spat_of(one, world::forecasts_at(town.world, time), utc), town.intersections, utc, signals);
    EXPECT_EQ(set, town.world.lights.size());
    for (std::size_t i = 0; i < signals.size(); ++i) {
      const world::Signal truth = signal_at(town.world.lights[i], time);
      EXPECT_EQ(signals[i].state, truth.state) << town.world.lights[i].name << " at " << time;
      EXPECT_NEAR(signals[i].left, truth.left + 0.05, 0.0501) << "rounded up to 0.1 s";
    }
  }
}

TEST(SignalMessages, UnknownPartsAreIgnored) {
  const world::World world = two_lights();
  const auto all = intersections_of(world, nullptr);
  std::vector<world::Signal> signals(2, {LightState::green, 7.0});
  v2x::Spat spat = spat_of(all[1], world::forecasts_at(world, 0.0), kNewYear2026);
  spat.intersections[0].states[0].signal_group = 2;  // the light is group 1
  EXPECT_EQ(read(spat, all, kNewYear2026, signals), 0u);
  spat.intersections[0].states[0].signal_group = 0;  // unknown
  EXPECT_EQ(read(spat, all, kNewYear2026, signals), 0u);
  spat.intersections[0].states[0].signal_group = 1;
  spat.intersections[0].id.id = 3;  // of another town
  EXPECT_EQ(read(spat, all, kNewYear2026, signals), 0u);
  EXPECT_EQ(signals[1].state, LightState::green);
  spat.intersections[0].id.id = 2;
  spat.intersections[0].states[0].events[0].timing.reset();
  EXPECT_EQ(read(spat, all, kNewYear2026, signals), 1u);
  EXPECT_EQ(signals[1].state, LightState::dark);
  EXPECT_EQ(signals[1].left, kForever);
}

TEST(SignalMessages, AnOverdueChangeIsDueNow) {
  const world::World world = two_lights();
  const auto all = intersections_of(world, nullptr);
  std::vector<world::Signal> signals(2);
  v2x::Spat spat = spat_of(all[0], world::forecasts_at(world, 0.0), kNewYear2026);
  read(spat, all, kNewYear2026 + 8'300, signals);
  EXPECT_NEAR(signals[0].left, 8.0, 1e-9) << "by the message's own time";
  spat.intersections[0].minute = v2x::kInvalidMinute;
  read(spat, all, kNewYear2026 + 8'300, signals);
  EXPECT_EQ(signals[0].left, 0.0) << "a message without a valid minute is from now";
  spat.intersections[0].minute = 0;
  spat.intersections[0].milliseconds.reset();
  read(spat, all, kNewYear2026 + 8'300, signals);  // sent 8.3 s ago, its change was due 0.3 s ago
  EXPECT_EQ(signals[0].left, 0.0);
}

TEST(SignalMessages, EachStateOfALightHasItsPhase) {
  std::set<v2x::PhaseState> phases;
  for (const LightState state : {LightState::dark, LightState::red, LightState::yellow, LightState::green,
                                 LightState::flashing_red, LightState::flashing_yellow}) {
    EXPECT_EQ(light_of(phase_of(state)), state);
    phases.insert(phase_of(state));
  }
  EXPECT_EQ(phases.size(), 6u);
  EXPECT_EQ(light_of(v2x::PhaseState::unavailable), LightState::dark);
  EXPECT_EQ(light_of(v2x::PhaseState::pre_movement), LightState::red);
  EXPECT_EQ(light_of(v2x::PhaseState::protected_movement_allowed), LightState::green);
  EXPECT_EQ(light_of(v2x::PhaseState::protected_clearance), LightState::yellow);
}

TEST(MapMessage, SimVilleHasTwoIntersections) {
  const Town town;
  ASSERT_EQ(town.intersections.size(), 2u);
  EXPECT_EQ(town.intersections[0].lights, (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(town.intersections[1].lights, (std::vector<std::uint32_t>{4, 5, 6}));
  EXPECT_EQ(town.intersections[0].stops.size(), 4u);
}

using PointKind = world::PointRef::Kind;

/// Two lanes of one way-point each with a stop line, at (0, 0) and (4, 0). Behind each stop line, an exit leads to
/// `ends`, of a lane or of a zone.
struct TwoStops {
  world::World world;
  world::RoadNetwork roads;

  TwoStops(PointKind kind, const std::vector<glm::dvec2>& ends, const std::vector<std::uint32_t>& to) {
    const auto add_lane = [&](std::uint16_t segment, glm::dvec2 p) {
      world::RoadLane& lane = roads.lanes.emplace_back();
      lane.width = 3.0;
      lane.points.push_back({.id = {segment, 1, 1}, .p = p});
      lane.centre.points = {p};
    };
    for (std::uint16_t i = 0; i < 2; ++i) {
      const auto segment = static_cast<std::uint16_t>(1 + i);
      add_lane(segment, {4.0 * i, 0.0});
      const world::PointRef at{PointKind::lane, i, 0};
      roads.stops.push_back({.at = at, .left = {}, .right = {}});
      roads.index.push_back({{segment, 1, 1}, at});
      world.lights.push_back(light({{LightState::red, 1.0}}));
      world.lights.back().points = {fmt::format("{}.1.1", segment)};
    }
    world::RoadZone& zone = roads.zones.emplace_back();
    for (std::uint16_t i = 0; i < ends.size(); ++i) {
      add_lane(static_cast<std::uint16_t>(3 + i), ends[i]);
      zone.perimeter.push_back({{9, 0, static_cast<std::uint16_t>(1 + i)}, ends[i]});
    }
    for (std::uint32_t i = 0; i < 2; ++i)
      roads.exits.push_back(
          {.from = roads.stops[i].at,
           .to = kind == PointKind::lane ? world::PointRef{kind, 2 + to[i], 0} : world::PointRef{kind, 0, to[i]}});
  }
  std::size_t intersections() const { return intersections_of(world, &roads).size(); }
};

/// Lights belong together if the exits behind them meet: in one lane, or by crossing. Exits to a zone meet in it, where
/// no light governs.
TEST(MapMessage, AnIntersectionIsWhereExitsMeet) {
  const std::vector<glm::dvec2> apart{{0.0, 5.0}, {4.0, 5.0}}, crossed{{4.0, 5.0}, {0.0, 5.0}};
  EXPECT_EQ(TwoStops(PointKind::lane, apart, {0, 1}).intersections(), 2u) << "side by side";
  EXPECT_EQ(TwoStops(PointKind::lane, crossed, {0, 1}).intersections(), 1u) << "crossing ways into two lanes";
  EXPECT_EQ(TwoStops(PointKind::lane, apart, {0, 0}).intersections(), 1u) << "into one lane";
  EXPECT_EQ(TwoStops(PointKind::perimeter, apart, {0, 0}).intersections(), 2u) << "into one zone by one point";
  EXPECT_EQ(TwoStops(PointKind::perimeter, crossed, {0, 1}).intersections(), 2u) << "into one zone, crossing";
}

TEST(MapMessage, LanesBeginAtStopLinesAndEntries) {
  const Town town;
  for (const Intersection& one : town.intersections) {
    const auto map = map_of(town.roads, one, {40.0, -83.0});
    ASSERT_TRUE(map);
    round_trip(*map);
    const v2x::IntersectionGeometry& geometry = map->intersections.at(0);
    glm::dvec2 middle;
    for (const world::PointRef& stop : one.stops) middle += position_of(town.roads, stop);
    middle /= static_cast<double>(one.stops.size());
    for (std::size_t i = 0; i < one.stops.size(); ++i) {
      const v2x::GenericLane& lane = geometry.lanes[i];
      EXPECT_EQ(lane.attributes.direction, 2);
      const auto points = points_of(lane);
      ASSERT_GE(points.size(), 2u);
      // The stop line, and upstream of it the way-points of the lane, each within half a centimetre.
      const auto& waypoints = town.roads.lanes[one.stops[i].row].points;
      for (std::size_t k = 0; k < points.size(); ++k) {
        const glm::dvec2 p = waypoints[one.stops[i].index - k].p - middle;
        EXPECT_LE(std::abs(points[k].x - p.x), 0.00501);
        EXPECT_LE(std::abs(points[k].y - p.y), 0.00501);
      }
      EXPECT_FALSE(lane.connections.empty());
      for (const v2x::Connection& to : lane.connections) {
        EXPECT_EQ(to.signal_group, one.groups[i]);
        EXPECT_EQ(geometry.lanes.at(to.to.lane - 1u).id, to.to.lane);
        EXPECT_EQ(geometry.lanes.at(to.to.lane - 1u).attributes.direction, 1);
      }
    }
  }
}

TEST(MapMessage, ManeuversFollowTheTurn) {
  // West Street northwards over First Street: straight on to 7.1, left into 10.1 or right into 11.2 by their
  // directions.
  const Town town;
  const auto map = map_of(town.roads, town.intersections[0], {});
  const v2x::GenericLane& lane = map->intersections[0].lanes[0];
  ASSERT_EQ(lane.connections.size(), 3u);
  EXPECT_EQ(lane.connections[0].to.maneuver, 0b1000'0000'0000);
  std::set<unsigned> turns{*lane.connections[1].to.maneuver, *lane.connections[2].to.maneuver};
  EXPECT_EQ(turns, (std::set<unsigned>{0b0100'0000'0000, 0b0010'0000'0000}));
  EXPECT_EQ(lane.maneuvers, 0b1110'0000'0000);
}

TEST(MapMessage, TheReferencePointIsInThePlaneOfTheOrigin) {
  const Town town;
  for (const world::Geodetic origin :
       {world::Geodetic{0.0, 0.0}, {40.0, -83.0}, {-89.0, 179.0}, {70.0, 20.0}, {0.0, 179.99999}, {0.0, -179.99999}}) {
    const auto map = map_of(town.roads, town.intersections[0], origin);
    const v2x::Position& at = map->intersections[0].reference;
    EXPECT_GT(at.longitude, -1'800'000'000);
    EXPECT_LE(at.longitude, 1'800'000'000);
    const glm::dvec2 p = world::LocalPlane(origin).east_north({1e-7 * at.latitude, 1e-7 * at.longitude});
    glm::dvec2 middle;
    for (const world::PointRef& stop : town.intersections[0].stops) middle += 0.25 * position_of(town.roads, stop);
    EXPECT_NEAR(p.x, middle.x, 0.006);  // 5e-8 degrees
    EXPECT_NEAR(p.y, middle.y, 0.006);
  }
}

/// 17 lanes with 16 connections each, in one network in which exits lead from each lane to each of 16 others.
TEST(MapMessage, ConnectionIdsAreUniqueOrAbsent) {
  world::RoadNetwork roads;
  Intersection one{.id = 1, .lights = {0}, .stops = {}, .groups = {}};
  for (std::uint32_t row = 0; row < 33; ++row) {
    world::RoadLane& lane = roads.lanes.emplace_back();
    lane.width = 3.0;
    lane.points.push_back({.id = {}, .p = {static_cast<double>(row), row < 17 ? 0.0 : 20.0}, .s = 0.0, .yaw = 0.0});
    if (row >= 17) continue;
    one.stops.push_back({world::PointRef::Kind::lane, row, 0});
    one.groups.push_back(1);
    for (std::uint32_t to = 17; to < 33; ++to)
      roads.exits.push_back({one.stops.back(), {world::PointRef::Kind::lane, to, 0}});
  }
  const auto map = map_of(roads, one, {});
  ASSERT_TRUE(map);
  std::set<std::uint8_t> ids;
  std::size_t connections = 0, without = 0;
  for (const v2x::GenericLane& lane : map->intersections.at(0).lanes)
    for (const v2x::Connection& to : lane.connections) {
      ++connections;
      without += !to.id;
      EXPECT_TRUE(!to.id || ids.insert(*to.id).second);
    }
  EXPECT_EQ(connections, 17u * 16u);
  EXPECT_EQ(without, 17u * 16u - 255u);
  round_trip(*map);
}

/// Parallel lanes, each with a stop line at its end.
struct StopLanes {
  world::RoadNetwork roads;
  Intersection one{.id = 1, .lights = {0}, .stops = {}, .groups = {}};

  StopLanes(std::uint32_t lanes, const std::vector<glm::dvec2>& points) {
    for (std::uint32_t row = 0; row < lanes; ++row) {
      world::RoadLane& lane = roads.lanes.emplace_back();
      lane.width = 2.5;
      for (const glm::dvec2& p : points) lane.points.push_back({.id = {}, .p = p + glm::dvec2(2.5 * row, 0.0)});
      one.stops.push_back({PointKind::lane, row, static_cast<std::uint32_t>(points.size() - 1)});
      one.groups.push_back(1);
    }
  }
};

TEST(MapMessage, NodesAreInsertedBetweenPointsOutOfReach) {
  const StopLanes far(1, {{-600.0, -800.0}, {0.0, 0.0}});  // 1000 m: four steps of at most 327 m
  const auto map = map_of(far.roads, far.one, {});
  ASSERT_TRUE(map);
  const std::vector<v2x::Node>& nodes = map->intersections.at(0).lanes.at(0).nodes.nodes;
  ASSERT_EQ(nodes.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(nodes[i].delta.xy.x, i == 0 ? 0 : -15'000) << i;
    EXPECT_EQ(nodes[i].delta.xy.y, i == 0 ? 0 : -20'000) << i;
  }
  round_trip(*map);
}

TEST(MapMessage, HoldsAsManyLanesAsThereAreIds) {
  const std::vector<glm::dvec2> points{{0.0, -9.0}, {0.0, 0.0}};
  const StopLanes most(255, points), more(256, points);
  const auto map = map_of(most.roads, most.one, {});
  ASSERT_TRUE(map);
  EXPECT_EQ(map->intersections.at(0).lanes.back().id, 255);
  round_trip(*map);
  expect_in("has 256 lanes; a MAP message holds 255", refusal_of([&] { map_of(more.roads, more.one, {}); }));
}

TEST(MapMessage, ALaneHasOnlyItsFirstSixteenConnections) {
  StopLanes fan(1, {{0.0, -9.0}, {0.0, 0.0}});
  for (std::uint32_t to = 1; to <= 17; ++to) {
    world::RoadLane& lane = fan.roads.lanes.emplace_back();
    lane.width = 2.5;
    lane.points.push_back({.id = {}, .p = {static_cast<double>(to), 20.0}});
    fan.roads.exits.push_back({fan.one.stops[0], {PointKind::lane, to, 0}});
  }
  const auto map = map_of(fan.roads, fan.one, {});
  ASSERT_TRUE(map);
  EXPECT_EQ(map->intersections.at(0).lanes.at(0).connections.size(), 16u);
  round_trip(*map);
}

TEST(MapMessage, AnIntersectionWithoutStopLinesHasNoMap) {
  const Town town;
  EXPECT_FALSE(map_of(town.roads, {.id = 1, .lights = {0}, .stops = {}, .groups = {}}, {}));
}

}  // namespace
}  // namespace sf::server
