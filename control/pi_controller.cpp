#include "control/pi_controller.h"

#include <algorithm>

namespace sf::control {

PiGains read_gains(Settings& settings, const PiGains& defaults) {
  PiGains gains;
  gains.kp = settings.number("kp", defaults.kp, 0.0, 1e3);
  gains.ki = settings.number("ki", defaults.ki, 0.0, 1e3);
  gains.integral_limit = settings.number("integral_limit", defaults.integral_limit, 1e-9, HUGE_VAL);
  return gains;
}

double PiController::steer(double error, std::int64_t time) {
  if (running_) {
    const double elapsed = 1e-9 * static_cast<double>(time - last_time_);
    integral_ += 0.5 * elapsed * (last_error_ + error);
    integral_ = std::clamp(integral_, -gains_.integral_limit, gains_.integral_limit);
  }
  running_ = true;
  last_time_ = time;
  last_error_ = error;
  return gains_.kp * error + gains_.ki * integral_;
}

double PiController::hold(double error) {
  running_ = false;
  return gains_.kp * error + gains_.ki * integral_;
}

}  // namespace sf::control
