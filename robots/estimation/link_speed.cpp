#include "robots/estimation/link_speed.h"

#include <algorithm>
#include <cmath>

namespace sf::estimation {

double space_mean(double time_mean, double variance) {
  return 0.5 * (time_mean + std::sqrt(std::max(0.0, time_mean * time_mean - 4.0 * variance)));
}

void LinkSpeed::add_probe(const ProbeTravel& travel) {
  if (!(travel.seconds > 0.0)) return;
  travel_.metres += travel.metres;
  travel_.seconds += travel.seconds;
  travel_.variance += travel.variance;
}

void LinkSpeed::add_loop(double speed, double vehicles) {
  loop_speeds_ += speed * vehicles;
  vehicles_ += vehicles;
  ++loops_;
}

bool LinkSpeed::update(double seconds, double variance) {
  variance_ += options_.drift * options_.drift * seconds;
  const bool probed = travel_.seconds > 0.0, counted = vehicles_ > 0.0;
  if (probed) {
    const double time = travel_.seconds;
    measure(travel_.metres / time, variance * options_.correlation / time + travel_.variance / (time * time));
  }
  if (counted) {
    // Vehicles differ; what the loop's place has of its own, they share.
    const double noise = variance / vehicles_ + options_.spot * options_.spot / loops_;
    measure(space_mean(loop_speeds_ / vehicles_, variance), noise);
  }
  travel_ = {};
  loop_speeds_ = vehicles_ = loops_ = 0.0;
  return probed || counted;
}

void LinkSpeed::measure(double speed, double variance) {
  const double gain = known_ ? variance_ / (variance_ + variance) : 1.0;
  speed_ = std::max(0.0, speed_ + gain * (speed - speed_));
  variance_ = known_ ? (1.0 - gain) * variance_ : variance;
  known_ = true;
}

}  // namespace sf::estimation
