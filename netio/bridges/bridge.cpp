#include "netio/bridges/bridge.h"

namespace sf::bridges {

void Requests::clear() {
  commands.clear();
  placements.clear();
  paused.reset();
  speed.reset();
  steps = 0;
  reset = false;
  time.reset();
}

void Requests::add(Requests& later) {
  commands.insert(commands.end(), later.commands.begin(), later.commands.end());
  placements.insert(placements.end(), later.placements.begin(), later.placements.end());
  if (later.paused) paused = later.paused;
  if (later.speed) speed = later.speed;
  if (later.time) time = later.time;
  steps += later.steps;
  reset = reset || later.reset;
  later.clear();
}

void Bridges::publish(const base::TickRecord& tick, const RunState& state) {
  for (const auto& bridge : bridges_) bridge->publish(tick, state);
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
