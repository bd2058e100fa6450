#pragma once
// A small world with every kind of object that figures show.

#include "tests/sensors/edit_laser.h"
#include "tests/viz/scenes.h"
#include "world/world.h"

namespace sf::scenes {

/// One wall of each kind: solid, seen but passable, not seen by lasers, overhead; a solid without a known inside.
inline void add_walls(world::World& world) {
  const std::uint32_t plan = add_model(world, "plan", 0xFF404040u, true),
                      crate = add_model(world, "crate", 0xFFB5651Du);
  add_box(world, 0.0, 0.0, 8.0, 5.0, plan, true);
  add_box(world, -0.2, -0.2, 8.2, 5.2, plan);
  add_box(world, 5.5, 3.2, 6.5, 4.1, crate);
  add_box(world, 1.0, 3.5, 1.8, 4.3, crate);
  for (std::size_t i = 12; i < 16; ++i) world.walls[i].stops_robots = false;
  world.walls.push_back({{3.0, 1.0}, {3.5, 0.4}, 0.0, 1.0, plan, false, false, true});
  world.walls.push_back({{6.0, 0.5}, {7.5, 0.9}, 2.5, 3.0, crate, false, true, true});
  world.walls.push_back({{4.0, 4.6}, {4.9, 4.8}, 0.0, 1.0, 99, false, true, true});
}

inline void add_ground(world::World& world) {
  world.lane_markings.push_back({{{0.5, 2.4}, {3.0, 2.4}, {4.0, 2.7}, {7.5, 2.7}}, 0.02, 0xFFFFFFFFu});
  world.lane_markings.push_back({{{0.5, 1.9}, {3.0, 1.9}, {4.0, 2.2}, {7.5, 2.2}}, 0.06, 0xFFF2B800u});
  for (const double x : {1.0, 1.4, 1.8}) world.magnets.push_back({{x, 2.15}, 0.0, 1.0, 0.0125, 0});
  for (const double x : {2.2, 2.6}) world.magnets.push_back({{x, 2.15}, 0.0, -1.0, 0.05, 0});
  world.paths.push_back({"lane", {{{0.5, 2.15, 0, 0}, 2.5, 0.0, 0.5}, {{3.0, 2.15, 0, 0}, 1.0, 0.4, 0.5}}});
  world.floor_holes.push_back({{{7.0, 1.2}, {7.6, 1.2}, {7.6, 1.7}, {7.0, 1.6}}, 0});
}

/// One light in each state at time 0, and another a second later.
inline void add_signals(world::World& world) {
  using world::LightState;
  double x = 0.4;
  for (const LightState state : {LightState::dark, LightState::red, LightState::yellow, LightState::green,
                                 LightState::flashing_red, LightState::flashing_yellow}) {
    world::Light light;
    light.name = fmt::format("light{:.1f}", x);
    light.X_WL = {x, 4.7, 0.0, x};
    light.phases = {{state, 1.0}, {LightState::green, 2.0}};
    world.lights.push_back(light);
    x += 0.5;
  }
  world.emitters.push_back({world::Emitter::Kind::virtual_wall, 0, {7.7, 4.7, 0.1, 3.5}, 1.3, 0.4, 0.2});
  world.emitters.push_back({world::Emitter::Kind::dock, 0, {0.2, 0.3, 0.1, 0.3}, 1.1, 0.7, 0.35});
}

inline void add_movers(world::World& world) {
  world.movers.push_back(make_robot(world, 1, {2.2, 3.3, 0.0, 0.4}, 0xFF2E7D32u, 2.0));
  world::Mover second = make_robot(world, 2, {4.6, 1.4, 0.0, 2.0}, 0xFF6A1B9Au, 1.2);
  edit_laser(second)->fov = 2.0 * M_PI;
  second.sensors.push_back({"laneedge", "e", {0.1, 0.0, 0.0, 0.5}, 0.01, 1.0, M_PI / 180.0, {}, 1, "x.world"});
  second.sensors.push_back({"magnetometer", "m", {0.3, -0.1, 0.0, 0.0}, 0.01, 1.0, M_PI / 180.0, {}, 2, "x.world"});
  world.movers.push_back(second);
  world::Mover dot = make_robot(world, 3, {6.9, 3.6, 0.0, -1.0}, 0xFF1565C0u, 0.9);
  for (world::Segment& s : dot.body) s.a = 0.1 * s.a, s.b = 0.1 * s.b;
  dot.radius = 0.0165;
  dot.sensors.clear();
  world.movers.push_back(dot);
  world::Mover tag = make_robot(world, 4, {1.1, 1.1, 0.0, 1.0}, 0xFFAD1457u, 0.9);
  tag.sensors.clear();
  tag.is_tag = true;
  tag.name = "tagged <&>";
  world.movers.push_back(tag);
}

inline world::World rich_world() {
  world::World world;
  world.name = "rich";
  add_walls(world);
  add_ground(world);
  add_signals(world);
  add_movers(world);
  world.extent = {-0.2, -0.2, 8.2, 5.2};
  return world;
}

}  // namespace sf::scenes
