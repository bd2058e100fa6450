#include "bridges/bridge.h"

namespace sf::bridges {

void Requests::clear() {
  commands.clear();
  placements.clear();
  paused.reset();
  speed.reset();
  steps = dropped_steps = 0;
  joining.clear();
  leaving.clear();
  world.reset();
  reset = false;
  time.reset();
}

void Requests::add(Requests& later) {
  commands.insert(commands.end(), later.commands.begin(), later.commands.end());
  placements.insert(placements.end(), later.placements.begin(), later.placements.end());
  if (later.paused) paused = later.paused;
  if (later.speed) speed = later.speed;
  if (later.time) time = later.time;
  for (Joining& each : later.joining) joining.push_back(std::move(each));
  for (Leaving& each : later.leaving) leaving.push_back(std::move(each));
  if (later.world) world = std::move(later.world);
  steps += later.steps;
  dropped_steps += later.dropped_steps;
  reset = reset || later.reset;
  later.clear();
}

void Bridges::publish(const base::TickRecord& tick, const RunState& state) {
  for (const auto& bridge : bridges_) bridge->publish(tick, state);
}

void Bridges::show_intents(std::span<const base::Intent> intents) {
  for (const auto& bridge : bridges_) bridge->show_intents(intents);
}

void Bridges::show_scene(bool is_new) {
  for (const auto& bridge : bridges_) bridge->show_scene(is_new);
}

void Bridges::publish(const RunState& state) {
  for (const auto& bridge : bridges_) bridge->publish(state);
}

void Bridges::take(Requests& requests) {
  requests.clear();
  for (const auto& bridge : bridges_) bridge->take(requests);
}

std::vector<std::string> Bridges::describe() const {
  std::vector<std::string> lines;
  for (const auto& bridge : bridges_) lines.push_back(bridge->describe());
  return lines;
}

}  // namespace sf::bridges
