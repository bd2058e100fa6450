#include "apps/reports/strayed_robots.h"

#include <algorithm>
#include <cmath>

#include "apps/reports/text.h"

namespace sf::apps {

StrayedRobots::StrayedRobots(const world::World& world) : world_(world), known_(world) {}

void StrayedRobots::write(const base::TickRecord& tick) {
  if (world_.ros_map.empty()) return;
  outside_.resize(world_.movers.size());  // robots may join during a run
  for (std::size_t m = 0; m < outside_.size(); ++m) {
    const base::Pose& X_WM = tick.reports[m].X_WM;
    if (outside_[m] || world_.movers[m].is_tag || std::isnan(X_WM.x) || known_.contains({X_WM.x, X_WM.y})) continue;
    if (std::find(outside_.begin(), outside_.end(), true) == outside_.end())
      print_message(
          "'{}' left the known space of {} at ({:.2f}, {:.2f}) after {:.1f} s; the summary lists all robots that do",
          world_.movers[m].name, world_.ros_map, X_WM.x, X_WM.y, 1e-9 * static_cast<double>(tick.time));
    outside_[m] = true;
  }
}

std::optional<std::vector<std::string>> StrayedRobots::names() const {
  if (world_.ros_map.empty()) return std::nullopt;
  std::vector<std::string> names;
  for (std::size_t m = 0; m < outside_.size(); ++m)
    if (outside_[m]) names.push_back(world_.movers[m].name);
  return names;
}

}  // namespace sf::apps
