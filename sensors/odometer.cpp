#include "sensors/odometer.h"

#include <cmath>

#include "base/elementary.h"

namespace sf::sensors {

namespace {

constexpr double kStep = 0.01;              // [m] step of the random walk
constexpr std::uint64_t kMostSteps = 1024;  // drawn one by one; a longer distance in one advance is a single step of
                                            // equal variance

}  // namespace

Rolled roll(const base::Pose& before, const base::Pose& after, double track) {
  const double turn = base::wrap_angle(after.yaw - before.yaw);
  const double half = 0.5 * turn;
  const glm::dvec2 chord{after.x - before.x, after.y - before.y};
  const double along = glm::dot(chord, base::rotate(before.yaw + half, {1.0, 0.0}));
  const double arc = along * (std::abs(half) < 1e-4 ? 1.0 + half * half / 6.0 : half / base::sin(half));
  return {arc - 0.5 * track * turn, arc + 0.5 * track * turn};
}

double Slippage::step(std::uint64_t number) const {
  base::RandomKey draw = walk_;
  draw.c = number;
  return slip_ * std::sqrt(kStep) * base::random_normal(draw, wheel_)[0];
}

void Slippage::advance(double distance) {
  if (slip_ <= 0.0 || distance <= 0.0) return;
  rolled_ += distance / kStep;
  const auto steps = static_cast<std::uint64_t>(rolled_);
  if (steps - steps_ <= kMostSteps) {
    for (; steps_ < steps; ++steps_) whole_ += step(steps_);
  } else {
    whole_ += std::sqrt(static_cast<double>(steps - steps_)) * step(steps_);
    steps_ = steps;
  }
  error_ = whole_ + (rolled_ - static_cast<double>(steps_)) * step(steps_);
}

}  // namespace sf::sensors
