#pragma once
// Limits the processor time of sensors: where it is exhausted, readings with the lowest priority are not measured.
//
// A budget is a bucket that fills at a constant rate, up to a limit. Readings that are due together are admitted by
// priority, then in the order in which they were last admitted, as long as the bucket has what they are expected to
// cost: no reading is measured at the expense of one with a higher priority, now or later. What a reading costs is
// learnt per sensor type and element from the time that each call took. The expected cost of types of which nothing is
// admitted falls slowly, so that they are tried again. Time beyond what was expected is paid from what the highest
// priority leaves, unless it alone takes too long. A reading that is not admitted is dropped:
// it is never measured later.

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "farm/dropped_reading.h"
#include "farm/sensor_pipeline.h"
#include "farm/token_bucket.h"
#include "sensors/derived/wiring.h"

namespace sf::farm {

class ProcessorBudget {
 public:
  /// @param rate [s/s] processor time per second @param limit [s] of the bucket
  /// @param derived sensors: their inputs have at least their priorities
  ProcessorBudget(double rate, double limit, std::span<const sensors::DerivedNode> derived);
  /// Call this after the world has gained sensors.
  void set_derived(std::span<const sensors::DerivedNode> derived);

  /// Removes the due readings for which there is no time. @param now [ns]
  void admit(std::int64_t now, std::span<SensorPipeline* const> pipelines);
  /// Readings that the last call of `admit` removed, by type and row. Valid until the next.
  std::span<const DroppedReading> dropped() const { return dropped_; }
  /// States the processor time [s] of the call that `admit` prepared.
  void spent(double seconds);
  /// Returns the learnt cost [s] of one element of a type.
  double cost(std::uint8_t type) const { return costs_[type]; }

 private:
  struct Candidate {
    std::uint8_t priority = 0;
    std::uint64_t last = 0;      ///< call in which it was last admitted
    std::uint32_t pipeline = 0;  ///< row in `pipelines`
    std::uint32_t due = 0;       ///< row in its due readings
    double cost = 0.0;           ///< [s]
    bool admitted = false;
  };
  std::uint8_t priority_of(std::uint8_t type, const sensors::SensorSpec& spec) const;
  std::vector<std::uint64_t>& admitted_of(const SensorPipeline& pipeline);

  TokenBucket bucket_;
  using Key = std::tuple<std::uint8_t, std::uint32_t, std::uint32_t>;  // wire id, mover, number
  std::map<Key, std::uint8_t> input_priorities_;  ///< of inputs of derived sensors: the largest of their consumers
  std::array<double, 64> costs_{};                ///< [s] per wire id and element
  std::array<std::vector<std::uint64_t>, 64> admitted_;  ///< per wire id and row: see Candidate::last
  std::array<double, 64> elements_{};                    ///< admitted in this call, per wire id
  std::vector<Candidate> candidates_;
  std::vector<DroppedReading> dropped_;
  std::uint64_t calls_ = 0;
  bool highest_only_ = true;  ///< this call admitted nothing but the highest priority
};

}  // namespace sf::farm
