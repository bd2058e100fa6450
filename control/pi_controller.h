#pragma once
// PI control, u = kp e + ki (integral of e). The integral uses the trapezoid rule over the time between steps (thesis,
// equations 4 to 6).

#include <cmath>
#include <cstdint>

#include "control/settings.h"

namespace sf::control {

struct PiGains {
  double kp = 0.5;                   ///< [rad/s per unit of the error]
  double ki = 0.0;                   ///< [rad/s^2 per unit of the error]
  double integral_limit = HUGE_VAL;  ///< [unit s] bound of the integral's magnitude; > 0
};

/// Reads `kp`, `ki`, `integral_limit`. @throws base::InputError
PiGains read_gains(Settings& settings, const PiGains& defaults);

class PiController {
 public:
  explicit PiController(const PiGains& gains) : gains_(gains) {}

  /// @param time [ns] does not decrease
  /// @return [rad/s]
  double steer(double error, std::int64_t time);

  /// Steers with a held error: the integral is frozen and continues with the next call of `steer`.
  double hold(double error);

  double integral() const { return integral_; }  ///< [unit s]

 private:
  PiGains gains_;
  bool running_ = false;
  std::int64_t last_time_ = 0;
  double last_error_ = 0.0;
  double integral_ = 0.0;
};

}  // namespace sf::control
