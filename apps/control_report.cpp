#include "apps/control_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "apps/text.h"
#include "control/stop_reason.h"

namespace sf::apps {

std::string text_of(const control::ErrorSummary& facts) {
  return fmt::format("mean {:.4f}, mean of its size {:.4f}, of {}", facts.mean, facts.abs_mean,
                     counted(facts.steps, "step"));
}

std::string text_of(const control::LocalizationError& facts) {
  return fmt::format("rms {:.3f} m and {:.2f} degrees, largest {:.3f} m, of {}", facts.rms(),
                     facts.yaw_rms() * 180.0 / M_PI, facts.max, counted(facts.steps, "step"));
}

ControlMetrics::ControlMetrics(const scenarios::Simulation& simulation, std::size_t movers, std::string controller)
    : simulation_(simulation), goals_(movers), rests_(movers) {
  facts_.controller = std::move(controller);
  for (std::uint32_t m = 0; m < movers; ++m) facts_.robots += simulation.controller(m) != nullptr;
}

void ControlMetrics::update(const base::TickRecord& tick) {
  time_ = tick.time;
  for (std::uint32_t m = 0; m < goals_.size(); ++m) {
    const control::Controller* controller = simulation_.controller(m);
    if (controller == nullptr) continue;
    Rest& rest = rests_[m];
    const base::Pose& X_WM = tick.reports[m].X_WM;
    if (tick.time == 0 || X_WM.x != rest.X_WM.x || X_WM.y != rest.X_WM.y || X_WM.yaw != rest.X_WM.yaw)
      rest = {X_WM, tick.time, false};
    rest.contact = tick.contacts[m] != 0;
    if (!simulation_.stepped(m)) continue;
    control::add(facts_.error, controller->error());
    goals_[m].update(controller->intent().checkpoint);
  }
}

std::vector<Standing> ControlMetrics::standing(const world::World& world) const {
  std::map<std::string, Standing> by_reason;
  for (std::uint32_t m = 0; m < rests_.size(); ++m) {
    const control::Controller* controller = simulation_.controller(m);
    const double seconds = 1e-9 * static_cast<double>(time_ - rests_[m].since);
    if (controller == nullptr || controller->done() || seconds < kStill) continue;
    std::string reason = control::stop_reason_of(*controller);
    if (reason.empty()) reason = rests_[m].contact ? "something that it touches stops it" : "no reason stated";
    Standing& all = by_reason[reason];
    all.reason = reason;
    if (all.names.size() < Standing::kNamed) all.names.push_back(world.movers[m].name);
    ++all.robots;
    all.seconds = std::max(all.seconds, seconds);
  }
  std::vector<Standing> sorted;
  for (auto& [reason, all] : by_reason) sorted.push_back(std::move(all));
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Standing& a, const Standing& b) { return a.robots > b.robots; });
  return sorted;
}

std::string text_of(const Standing& standing) {
  std::string names = fmt::format("{}", fmt::join(standing.names, ", "));
  if (standing.robots > standing.names.size())
    names += fmt::format(" and {} more", standing.robots - standing.names.size());
  return fmt::format("{} for {}{:.0f} s: {}", names, standing.robots > 1 ? "up to " : "", standing.seconds,
                     standing.reason);
}

ControlReport ControlMetrics::facts(const world::World& world) const {
  ControlReport facts = facts_;
  for (std::uint32_t m = 0; m < goals_.size(); ++m) {
    const control::Controller* controller = simulation_.controller(m);
    facts.done += controller != nullptr && controller->done();
    facts.has_goals = facts.has_goals || goals_[m].any;
    facts.checkpoints += goals_[m].passed;
    const control::OwnLocalization* own = controller == nullptr ? nullptr : control::localization_of(*controller);
    if (own != nullptr) facts.localization.add(own->error());
  }
  facts.standing = standing(world);
  return facts;
}

}  // namespace sf::apps
