#include "apps/reports/control_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "apps/reports/text.h"
#include "base/bytes.h"
#include "control/stop_reason.h"

namespace sf::apps {

std::string error_summary_text(const control::ErrorSummary& facts) {
  return fmt::format("mean {:.4f}, mean absolute {:.4f}, of {}", facts.mean, facts.abs_mean,
                     counted(facts.steps, "step"));
}

std::string localization_error_text(const control::LocalizationError& facts) {
  return fmt::format("rms {:.3f} m and {:.2f} degrees, largest {:.3f} m, of {}", facts.rms(),
                     facts.yaw_rms() * 180.0 / M_PI, facts.max, counted(facts.steps, "step"));
}

ControlMetrics::ControlMetrics(const scenarios::Simulation& simulation, std::size_t movers, std::string controller)
    : simulation_(simulation), goals_(movers), rests_(movers) {
  facts_.controller = std::move(controller);
  for (std::uint32_t m = 0; m < movers; ++m) facts_.robots += simulation.status(m).drives;
}

void ControlMetrics::add_mover() {
  goals_.emplace_back();
  rests_.emplace_back();
}

void ControlMetrics::update(const base::TickRecord& tick) {
  time_ = tick.time;
  for (std::uint32_t m = 0; m < goals_.size(); ++m) {
    const scenarios::ControlStatus status = simulation_.status(m);
    if (!status.drives) continue;
    Rest& rest = rests_[m];
    const base::Pose& X_WM = tick.reports[m].X_WM;
    if (tick.time == 0 || X_WM.x != rest.X_WM.x || X_WM.y != rest.X_WM.y || X_WM.yaw != rest.X_WM.yaw)
      rest = {X_WM, tick.time, false};
    rest.contact = tick.contacts[m] != 0;
    if (!status.stepped) continue;
    control::add(facts_.error, status.error);
    goals_[m].update(simulation_.intent(m).checkpoint);
  }
}

bool ControlMetrics::stands(std::uint32_t mover) const {
  const scenarios::ControlStatus status = simulation_.status(mover);
  return status.drives && !status.done && 1e-9 * static_cast<double>(time_ - rests_[mover].since) >= kStill;
}

std::vector<ControlMetrics::End> ControlMetrics::ends() const {
  std::vector<End> ends(rests_.size());
  for (std::uint32_t m = 0; m < ends.size(); ++m) {
    const control::Controller* controller = simulation_.controller(m);
    if (controller == nullptr) continue;
    if (const control::OwnLocalization* own = control::localization_of(*controller))
      ends[m].localization = own->error();
    if (stands(m)) ends[m].reason = control::stop_reason_of(*controller);
  }
  return ends;
}

std::vector<Standing> ControlMetrics::standing(const world::World& world, const std::vector<End>& ends) const {
  std::map<std::string, Standing> by_reason;
  for (std::uint32_t m = 0; m < rests_.size(); ++m) {
    if (!stands(m)) continue;
    const double seconds = 1e-9 * static_cast<double>(time_ - rests_[m].since);
    std::string reason = ends[m].reason;
    if (reason.empty()) reason = rests_[m].contact ? "blocked by contact" : "no reason given";
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

std::string standing_text(const Standing& standing) {
  std::string names = fmt::format("{}", fmt::join(standing.names, ", "));
  if (standing.robots > standing.names.size())
    names += fmt::format(" and {} more", standing.robots - standing.names.size());
  return fmt::format("{} for {}{:.0f} s: {}", names, standing.robots > 1 ? "up to " : "", standing.seconds,
                     standing.reason);
}

void ControlMetrics::add_ends_of_others(cluster::Ranks& ranks, std::vector<End>& ends) {
  base::Bytes block;
  base::ByteWriter out(block);
  for (std::uint32_t m = 0; m < ends.size(); ++m) {
    if (!ends[m].localization && ends[m].reason.empty()) continue;
    out.put(m);
    out.put_string(ends[m].reason);
    out.put(ends[m].localization.has_value());
    const control::LocalizationError error = ends[m].localization.value_or(control::LocalizationError{});
    out.put(error.steps);
    out.put(error.squares);
    out.put(error.yaw_squares);
    out.put(error.max);
  }
  for (const cluster::Block other : ranks.exchange(block))
    for (base::ByteReader in(other); in.left() > 0;) {
      End& end = ends.at(in.get<std::uint32_t>());
      end.reason = in.get_string();
      const bool localizes = in.get<bool>();
      control::LocalizationError error;
      error.steps = in.get<std::uint64_t>();
      error.squares = in.get<double>();
      error.yaw_squares = in.get<double>();
      error.max = in.get<double>();
      if (localizes) end.localization = error;
    }
}

ControlReport ControlMetrics::facts(const world::World& world, cluster::Ranks* ranks) const {
  ControlReport facts = facts_;
  std::vector<End> ends = this->ends();
  if (ranks != nullptr) add_ends_of_others(*ranks, ends);
  for (std::uint32_t m = 0; m < goals_.size(); ++m) {
    facts.done += simulation_.status(m).done;
    facts.has_goals = facts.has_goals || goals_[m].any;
    facts.checkpoints += goals_[m].passed;
    if (ends[m].localization) facts.localization.add(*ends[m].localization);
  }
  facts.standing = standing(world, ends);
  return facts;
}

}  // namespace sf::apps
