#include "viz/signal_layer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/report.h"
#include "viz/color.h"
#include "viz/theme.h"
#include "viz/view_sector.h"
#include "world/lights.h"

namespace sf::viz {

namespace {

using world::Emitter;
using world::LightState;

constexpr SectorStyle kWallBeam{theme::kVirtualWall, 0.14, 0.55};
constexpr SectorStyle kRedBuoy{theme::kRedBuoy, 0.14, 0.55};
constexpr SectorStyle kGreenBuoy{theme::kGreenBuoy, 0.14, 0.55};
constexpr SectorStyle kField{theme::kForceField, 0.14, 0.55};
constexpr double kLightRadius = 6.0;  // [px]
constexpr double kLampRadius = 4.0;   // [px]

/// Shows a state by colour and shape, so that it is recognizable without colours, too.
struct LightMark {
  LightState state;
  LegendMark mark;
  std::uint32_t color;
};
constexpr std::array<LightMark, 6> kLightMarks{
    {{LightState::green, LegendMark::outlined_dot, theme::kLightGreen},
     {LightState::yellow, LegendMark::diamond, theme::kLightYellow},
     {LightState::flashing_yellow, LegendMark::hollow_diamond, theme::kLightYellow},
     {LightState::red, LegendMark::square, theme::kLightRed},
     {LightState::flashing_red, LegendMark::hollow_square, theme::kLightRed},
     {LightState::dark, LegendMark::crossed_dot, theme::kLightOff}}};

const LightMark& mark_of(LightState state) {
  return *std::find_if(kLightMarks.begin(), kLightMarks.end(), [&](const LightMark& m) { return m.state == state; });
}

void draw_emitter(Axes& axes, const Emitter& emitter) {
  const double fov = emitter.fov;
  if (emitter.kind == Emitter::Kind::virtual_wall) {
    if (emitter.halo > 0.0) draw_view_sector(axes, emitter.X_WE, 0.0, 2.0 * M_PI, emitter.halo, kWallBeam);
    return draw_view_sector(axes, emitter.X_WE, -0.5 * fov, 0.5 * fov, emitter.range, kWallBeam);
  }
  if (emitter.halo > 0.0) draw_view_sector(axes, emitter.X_WE, 0.0, 2.0 * M_PI, emitter.halo, kField);
  // The beams of the two buoys overlap by a quarter (sensors/irreceiver.h).
  draw_view_sector(axes, emitter.X_WE, -0.125 * fov, 0.875 * fov, emitter.range, kRedBuoy);
  draw_view_sector(axes, emitter.X_WE, -0.875 * fov, 0.125 * fov, emitter.range, kGreenBuoy);
}

/// Draws a sun: a disc, and rays over the lamp's beam.
void draw_lamp(Axes& axes, const world::Lamp& lamp) {
  const glm::dvec2 at = axes.pixel({lamp.X_WL.x, lamp.X_WL.y});
  constexpr int kRays = 8;
  const bool all_round = lamp.fov >= 2.0 * M_PI;
  for (int i = 0; i < kRays; ++i) {
    const double part = all_round ? (i + 0.5) / kRays : i / (kRays - 1.0);
    const glm::dvec2 ray = base::rotate(-lamp.X_WL.yaw - (part - 0.5) * lamp.fov, {1.0, 0.0});
    axes.canvas().line(at + 1.3 * kLampRadius * ray, at + 2.1 * kLampRadius * ray, theme::kHairline, theme::kInk);
  }
  axes.canvas().disc(at, kLampRadius, theme::kLightYellow);
  axes.canvas().ring(at, kLampRadius, theme::kHairline, theme::kInk);
}

bool has(const world::World& world, Emitter::Kind kind) {
  return std::any_of(world.emitters.begin(), world.emitters.end(), [&](const Emitter& e) { return e.kind == kind; });
}

}  // namespace

void draw_floor_holes(Axes& axes, const world::World& world) {
  for (const world::FloorHole& drop : world.floor_holes) {
    std::vector<glm::dvec2> outline;
    for (const glm::dvec2& p : drop.outline) outline.push_back(axes.pixel(p));
    axes.canvas().polygon(outline, with_opacity(theme::kFloorHole, 0.85));
  }
}

void draw_emitters(Axes& axes, const world::World& world) {
  for (const Emitter& emitter : world.emitters) draw_emitter(axes, emitter);
  for (const world::Lamp& lamp : world.lamps) draw_lamp(axes, lamp);
}

void draw_lights(Axes& axes, const world::World& world, double time) {
  std::vector<LightState> states;
  for (const world::Light& light : world.lights) states.push_back(signal_at(light, time).state);
  draw_lights(axes, world, states);
}

void draw_lights(Axes& axes, const world::World& world, std::span<const LightState> states,
                 std::span<const base::Pose> X_WM) {
  for (std::size_t i = 0; i < states.size(); ++i) {
    const world::Light& light = world.lights[i];
    const std::uint32_t mover = carrier_of(world, light);
    const base::Pose& X_WL = mover == world::kNone ? light.X_WL : mover < X_WM.size() ? X_WM[mover] : base::kAbsent;
    if (base::is_absent(X_WL)) continue;
    const glm::dvec2 at = axes.pixel({X_WL.x, X_WL.y});
    axes.canvas().line(at, at + base::rotate(-X_WL.yaw, {2.2 * kLightRadius, 0.0}), theme::kBold, theme::kInk);
    const LightMark& shown = mark_of(states[i]);
    draw_signal(axes.canvas(), at, kLightRadius, shown.mark, shown.color);
  }
}

LegendItem signal_legend_item(LightState state) {
  return {mark_of(state).mark, mark_of(state).color, fmt::format("light, {}", light_state_name(state))};
}

std::vector<LegendItem> lights_legend(const world::World& world, double time) {
  std::vector<LegendItem> items;
  for (const LightMark& m : kLightMarks) {
    const bool shown = std::any_of(world.lights.begin(), world.lights.end(),
                                   [&](const world::Light& light) { return signal_at(light, time).state == m.state; });
    if (shown) items.push_back(signal_legend_item(m.state));
  }
  return items;
}

std::vector<LegendItem> signal_layer_legend(const world::World& world) {
  std::vector<LegendItem> items;
  for (const LegendItem& item : lights_legend(world, 0.0)) items.push_back(item);
  if (has(world, Emitter::Kind::virtual_wall))
    items.push_back({LegendMark::block, with_opacity(kWallBeam.color, kWallBeam.inside), "virtual wall",
                     with_opacity(kWallBeam.color, kWallBeam.border)});
  if (has(world, Emitter::Kind::dock))
    items.push_back({LegendMark::block, with_opacity(kRedBuoy.color, kRedBuoy.inside),
                     "dock: red and green buoy, force field", with_opacity(kRedBuoy.color, kRedBuoy.border)});
  if (!world.lamps.empty()) items.push_back({LegendMark::outlined_dot, theme::kLightYellow, "lamp"});
  if (!world.floor_holes.empty())
    items.push_back({LegendMark::block, with_opacity(theme::kFloorHole, 0.85), "hole in the floor"});
  return items;
}

}  // namespace sf::viz
