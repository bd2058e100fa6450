#include "apps/control_facts.h"

#include <fmt/format.h>

#include <cmath>

#include "apps/wording.h"

namespace sf::apps {

void add(ErrorFacts& facts, double error) {
  if (!std::isfinite(error)) return;
  ++facts.steps;
  const auto steps = static_cast<double>(facts.steps);
  facts.mean += (error - facts.mean) / steps;
  facts.abs_mean += (std::abs(error) - facts.abs_mean) / steps;
}

std::string text_of(const ErrorFacts& facts) {
  return fmt::format("mean {:.4f}, mean of its size {:.4f}, of {}", facts.mean, facts.abs_mean,
                     counted(facts.steps, "step"));
}

ControlTally::ControlTally(const scenarios::Simulation& simulation, std::size_t movers, std::string controller)
    : simulation_(simulation), goals_(movers) {
  facts_.controller = std::move(controller);
  for (std::uint32_t m = 0; m < movers; ++m) facts_.robots += simulation.controller(m) != nullptr;
}

void ControlTally::look() {
  for (std::uint32_t m = 0; m < goals_.size(); ++m) {
    const control::Controller* controller = simulation_.controller(m);
    if (controller == nullptr || !simulation_.stepped(m)) continue;
    add(facts_.error, controller->error());
    goals_[m].look(controller->intent().checkpoint);
  }
}

ControlFacts ControlTally::facts() const {
  ControlFacts facts = facts_;
  for (std::uint32_t m = 0; m < goals_.size(); ++m) {
    const control::Controller* controller = simulation_.controller(m);
    facts.done += controller != nullptr && controller->done();
    facts.has_goals = facts.has_goals || goals_[m].any;
    facts.checkpoints += goals_[m].passed;
  }
  return facts;
}

}  // namespace sf::apps
