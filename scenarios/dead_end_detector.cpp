#include "scenarios/dead_end_detector.h"

#include <algorithm>

namespace sf::scenarios {

void DeadEndDetector::update(const base::Report& report, bool contact) {
  const glm::dvec2 p{report.X_WM.x, report.X_WM.y};
  time_ += interval_;
  const bool stands = report.velocity.forward == 0.0;
  const bool waits = contact && stands && report.velocity.turn == 0.0;
  if (inside_ && glm::length(p - where_) > length_) {
    inside_ = false;
    reversals_.clear();
  }
  if (waits || inside_) stuck_ += interval_;
  if (waits) stood_ += interval_;
  if (waits && !inside_) waited_ += interval_;
  if (stands) turn(p, report.velocity.turn);
}

void DeadEndDetector::turned_by_hand(const base::Report& report, double angle) {
  turn({report.X_WM.x, report.X_WM.y}, angle);
}

void DeadEndDetector::turn(glm::dvec2 p, double side) {
  if (side == 0.0) return;
  if (side * side_ < 0.0) reverse(p);
  side_ = side;
}

void DeadEndDetector::reverse(glm::dvec2 p) {
  if (inside_) return;
  std::erase_if(reversals_, [&](const Reversal& r) { return glm::length(r.p - p) > length_; });
  if (reversals_.empty()) waited_ = 0.0;
  reversals_.push_back({p, time_});
  if (reversals_.size() < kReversals) return;
  inside_ = true;
  where_ = p;
  ++count_;
  stuck_ += std::max(0.0, time_ - reversals_.front().time - waited_);
}

}  // namespace sf::scenarios
