#pragma once
// Mean speed of the vehicles on one stretch of road (a link), from some of them (probes) and from loop detectors.
//
//   LinkSpeed link({});
//   link.add_probe({.metres = 4.0, .seconds = 10.0});   // one vehicle since the last update
//   link.add_loop(0.5, 3);                              // three passed a loop at 0.5 m/s in the mean
//   link.update(10.0);                                  // 10 s after the last update
//
// The state is the space-mean speed: distance driven by all vehicles on the link over the time that they spent there
// (L. C. Edie, Discussion of traffic stream measurements and definitions, 1963). It is a random walk. Of probes, the
// same quotient is measured. A probe that was on the link for `correlation` counts as one independent vehicle. A loop
// measures a time-mean, in which fast vehicles count more often: with the spread S of speeds, mean = space-mean + S /
// space-mean (J. G. Wardrop, Some theoretical aspects of road traffic research, 1952).

namespace sf::estimation {

struct LinkSpeedOptions {
  double spread = 0.2;        ///< [m/s] > 0: standard deviation of single vehicles' speeds, until it is learnt
  double drift = 0.03;        ///< [m/s^(3/2)] >= 0: the mean speed's change, as a random walk: variance per second
  double correlation = 10.0;  ///< [s] > 0: for which a vehicle keeps its difference from the mean speed
  double spot = 0.2;          ///< [m/s] >= 0: standard deviation between the mean speed at a loop and on the whole link
};

/// Distance and time of one vehicle on a link.
struct ProbeTravel {
  double metres = 0.0;
  double seconds = 0.0;   ///< > 0
  double variance = 0.0;  ///< [m^2] of the distance
};

class LinkSpeed {
 public:
  explicit LinkSpeed(const LinkSpeedOptions& options) : options_(options) {}

  /// Adds a vehicle's travel since the last update; ignored without time.
  void add_probe(const ProbeTravel& travel);
  /// Adds vehicles that passed a loop since the last update. @param speed [m/s] >= 0, their mean @param vehicles > 0
  void add_loop(double speed, double vehicles);
  /// Estimates the speed now. @param seconds >= 0, since the last update @param variance [m^2/s^2] > 0, of vehicles'
  /// speeds
  /// @return whether there was a report
  bool update(double seconds, double variance);

  bool known() const { return known_; }
  double speed() const { return speed_; }        ///< [m/s] >= 0; 0 if not known
  double variance() const { return variance_; }  ///< [m^2/s^2] > 0 if known

 private:
  void measure(double speed, double variance);

  LinkSpeedOptions options_;
  bool known_ = false;
  double speed_ = 0.0, variance_ = 0.0;
  ProbeTravel travel_;                         ///< sum since the last update
  double loop_speeds_ = 0.0, vehicles_ = 0.0;  ///< [m/s] sum over vehicles
  double loops_ = 0.0;                         ///< readings of loops
};

/// The spread of single vehicles' speeds: of those that share a link and an interval, about their mean.
class SpeedSpread {
 public:
  explicit SpeedSpread(double spread) : squares_(kPrior * spread * spread) {}
  /// Adds the vehicles of one link and interval, at least one.
  template <class Travels>
  void add(const Travels& travels) {
    double metres = 0.0, seconds = 0.0, squared = 0.0, squares = 0.0;
    for (const ProbeTravel& t : travels) metres += t.metres, seconds += t.seconds, squared += t.seconds * t.seconds;
    if (!(seconds > 0.0)) return;
    const double mean = metres / seconds, freedom = 1.0 - squared / (seconds * seconds);
    if (freedom < kLeastFreedom) return;
    for (const ProbeTravel& t : travels) {
      const double d = t.metres / t.seconds - mean;
      squares += t.seconds * d * d;
    }
    squares_ += squares / seconds;
    freedom_ += freedom;
  }
  double variance() const { return squares_ / freedom_; }  ///< [m^2/s^2] > 0

 private:
  static constexpr double kPrior = 10.0;         // as many degrees of freedom has the stated spread
  static constexpr double kLeastFreedom = 1e-3;  // of vehicles that share an interval
  double squares_, freedom_ = kPrior;
};

/// Returns the space-mean speed [m/s] of vehicles with this time-mean [m/s] and variance of speeds [m^2/s^2]; at least
/// half of the time-mean.
double space_mean(double time_mean, double variance);

}  // namespace sf::estimation
