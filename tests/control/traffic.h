#pragma once
// A fleet on SimVille's streets, on the host: all robots drive by V2V, contacts are those of Fleet.

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "control/controllers.h"
#include "control/route.h"
#include "control/route_plan.h"
#include "robots/fleet.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"
#include "world/roads/lane_control.h"
#include "world/roads/roads.h"

namespace sf::traffic {

using base::Pose;
using base::Twist;
using control::Setting;

inline world::RoadNetwork simville() {
  std::vector<world::Warning> warnings;
  return world::load_roads(SF_SOURCE_DIR "/worlds/simville/simville.rndf", warnings);
}

/// Returns a pose on a lane, `s` metres along it.
inline Pose on_lane(const world::RoadNetwork& roads, const std::string& name, double s) {
  for (const world::RoadLane& lane : roads.lanes) {
    if (lane_name(roads, lane) != name) continue;
    const glm::dvec2 p = point_at(lane.centre, s);
    const glm::dvec2 d = point_at(lane.centre, s + 0.01) - point_at(lane.centre, s - 0.01);
    return {p.x, p.y, height_at(lane, s), std::atan2(d.y, d.x)};
  }
  return {};
}

/// Returns the network without heights.
inline world::RoadNetwork flat(world::RoadNetwork roads) {
  for (world::RoadLane& lane : roads.lanes)
    for (world::LanePoint& point : lane.points) point.z = 0.0;
  return roads;
}

/// Returns a light of SimVille with one phase plan for some stop lines.
inline world::Light light(const std::string& name, std::vector<std::string> points,
                          std::vector<world::LightPhase> phases, double offset = 0.0) {
  world::Light light;
  light.name = name;
  light.points = std::move(points);
  light.phases = std::move(phases);
  light.offset = offset;
  return light;
}

class Streets {
 public:
  explicit Streets(const world::RoadNetwork& network = simville()) : roads(network), world(scenes::empty_world()) {
    world.ramps = ramps_of(roads);
  }

  /// The two crossings with lights, each 20 s: red ways alternate.
  void add_lights() {
    using enum world::LightState;
    const std::vector<world::LightPhase> plan{{green, 8.0}, {yellow, 2.0}, {red, 10.0}};
    world.lights = {light("a", {"6.1.3", "7.2.4"}, plan), light("b", {"10.2.3", "11.1.3"}, plan, 10.0),
                    light("c", {"3.1.11", "4.2.5"}, plan), light("d", {"12.1.7"}, plan, 10.0)};
  }

  void add(const Pose& X_WM, const std::string& controller, std::vector<Setting> settings) {
    scenes::add_create(world, X_WM);
    plans_.push_back({controller, std::move(settings)});
  }

  void begin(std::uint64_t seed = 1) {
    fleet = std::make_unique<robots::Fleet>(world);
    for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
      control::Settings settings("controller '" + plans_[row].controller + "'", plans_[row].settings);
      const control::ControllerContext context{world, row, seed, &roads};
      controllers.push_back(control::find_controller(plans_[row].controller)->make(context, settings));
      settings.require_all_read();
    }
    commands_.resize(world.movers.size());
    intents.resize(world.movers.size());
  }

  /// Requests the use of a lane.
  void use(const std::string& lane, const std::string& word) {
    if (!lanes) lanes.emplace(roads);
    lanes->request(lane_named(roads, lane), world::lane_use_of(word));
  }

  void tick() {
    const auto reports = fleet->reports();
    if (lanes) lanes->update(time, reports);
    signals.clear();
    for (const world::Light& light : world.lights) signals.push_back(signal_at(light, 1e-9 * double(time)));
    std::vector<control::Neighbour> others;
    for (std::uint32_t row = 0; row < controllers.size(); ++row) {
      others.clear();
      for (std::uint32_t o = 0; o < controllers.size(); ++o) {
        const glm::dvec2 d{reports[o].X_WM.x - reports[row].X_WM.x, reports[o].X_WM.y - reports[row].X_WM.y};
        if (o != row && length(d) <= controllers[row]->v2v_range())
          others.push_back({world.movers[o].id, reports[o], intents[o]});
      }
      commands_[row] = controllers[row]->step({.time = time,
                                               .state = reports[row],
                                               .readings = {},
                                               .contact = fleet->contacts()[row] != 0,
                                               .others = others,
                                               .signals = signals,
                                               .roads = lanes ? lanes->network() : nullptr});
    }
    for (std::uint32_t row = 0; row < controllers.size(); ++row) intents[row] = controllers[row]->intent();
    fleet->move(commands_, kTick);
    for (const auto contact : fleet->contacts()) contacts += contact;
    time += kTick;
  }

  const Pose& pose(std::uint32_t row) const { return fleet->reports()[row].X_WM; }
  /// The foremost point of a robot's body.
  glm::dvec2 front(std::uint32_t row) const { return base::transform(pose(row), {0.165, 0.0}); }
  control::Route& route(std::uint32_t row) { return static_cast<control::Route&>(*controllers[row]); }
  double distance(std::uint32_t a, std::uint32_t b) const {
    return std::hypot(pose(a).x - pose(b).x, pose(a).y - pose(b).y);
  }

  world::RoadNetwork roads;
  world::World world;
  std::unique_ptr<robots::Fleet> fleet;
  std::vector<std::unique_ptr<control::Controller>> controllers;
  std::vector<base::Intent> intents;
  std::vector<world::Signal> signals;
  std::optional<world::LaneControl> lanes;  ///< since the first request
  std::int64_t time = 0;
  int contacts = 0;

 private:
  struct Plan {
    std::string controller;
    std::vector<Setting> settings;
  };
  std::vector<Plan> plans_;
  std::vector<Twist> commands_;
};

using Numbers = std::vector<double>;

/// Returns settings of a route through checkpoints.
inline std::vector<Setting> go(Numbers checkpoints, std::vector<Setting> more = {}) {
  more.push_back({"checkpoints", std::move(checkpoints), "test: "});
  return more;
}

/// Never moves.
struct Idle final : control::Controller {
  Twist step(const control::ControllerInput&) override { return {}; }
};

}  // namespace sf::traffic
