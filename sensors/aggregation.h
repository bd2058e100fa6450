#pragma once
// Base class of derived sensors that state one quantity from unlike sensors, as they come and go.
//
// Properties that they share:
//   choose "first"   the first input, in the order of `inputs`, whose newest reading is valid and fresh
//          "best"    the one with the smallest variance
//          "weighted"      all of them, weighted by their covariances, as if their errors were independent
//          "intersection"  covariance intersection, for errors with unknown correlation
//   max_age 1.5    [s] older readings are not used
//   drift 0.2      [unit/s] standard deviation by which the quantity may change: (drift * age)^2 is added to variances
//   noise [2 0 1]  standard deviation of each input, in the order of `inputs`; 0: as it states itself

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "robots/estimation/fusion.h"
#include "sensors/derived/derived_type.h"

namespace sf::sensors {

enum class Choice : std::uint8_t { first, best, weighted, intersection };

struct AggregationSettings {
  Choice choice = Choice::first;
  double max_age = 1.5;       ///< [s] > 0
  double drift = 0.0;         ///< [unit/s]
  std::vector<double> noise;  ///< [unit] per text in `inputs`; 0: as it states itself
};

inline constexpr std::string_view kChooseKey = "choose", kMaxAgeKey = "max_age", kDriftKey = "drift",
                                  kNoiseKey = "noise";

/// @param drift default @throws base::InputError, also for more numbers in `noise` than inputs
AggregationSettings read_aggregation(const DerivedContext& context, double drift);

/// Returns the place of each input.
std::vector<std::uint32_t> places_of(std::span<const WiredInput> inputs);

/// Refuses inputs without an error if all must have one. @param states returns whether input k states its own error
void require_errors(const DerivedContext& context, const AggregationSettings& settings,
                    const std::function<bool(std::size_t input)>& states);

/// The quantity at one time.
struct Aggregate {
  estimation::Stated estimate;  ///< NaN covariance: none is stated
  double source = 0.0;          ///< row of the text in `inputs` that names its sensor; -1: of several sensors
  double age = 0.0;             ///< [s] of the oldest reading that it is from
};

/// The newest values of the inputs.
class Aggregation {
 public:
  /// @param places per value: row of the text in `inputs` that names its sensor
  Aggregation(AggregationSettings settings, std::vector<std::uint32_t> places)
      : settings_(std::move(settings)), places_(std::move(places)), newest_(places_.size()) {}

  /// @param stated nullopt: the sensor has no value now, and its earlier ones are not used any more
  void take(std::size_t value, double time, const std::optional<estimation::Stated>& stated);
  /// Adds a value of the same kind as the last one, of a robot that joined.
  void add_value() { newest_.emplace_back(), places_.push_back(places_.back()); }
  /// Returns one value at `time`, if it is fresh.
  std::optional<Aggregate> of(std::size_t value, double time) const;
  /// Returns nullopt if no input is fresh.
  std::optional<Aggregate> at(double time);
  /// Returns the standard deviation that the settings give a value; 0: none.
  double noise(std::size_t value) const { return settings_.noise[places_[value]]; }

 private:
  struct Newest {
    double time = -std::numeric_limits<double>::infinity();
    estimation::Stated stated;
  };
  AggregationSettings settings_;
  std::vector<std::uint32_t> places_;  ///< per value, like `newest_`
  std::vector<Newest> newest_;
  std::vector<estimation::Stated> fresh_;
};

}  // namespace sf::sensors
