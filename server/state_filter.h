#pragma once
// Filters the states of movers from their packets, with one track and one sender clock per mover.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/report.h"
#include "netio/packets.h"
#include "robots/estimation/sender_clock.h"
#include "robots/estimation/track_filter.h"
#include "world/world.h"

namespace sf::server {

struct StateFilterOptions {
  bool enabled = false;  ///< false: uses the newest state, as of its arrival
  estimation::ClockOptions clock;
  std::int64_t stale_after = 1'000'000'000;  ///< [ns] > 0
  estimation::StalePolicy policy = estimation::StalePolicy::freeze;
  /// > 0 (estimation::FilterOptions). Packets always contain a heading, so it is uncertain only after losses.
  std::size_t hypotheses = 16;
  /// [ns] on the senders' common clock at time 0 of the receiver's clock, for estimation::ClockSource::trusted.
  std::int64_t epoch = 0;
  // Standard deviations of reported states, which packets do not contain.
  double position_sigma = 0.01;  ///< [m] > 0
  double yaw_sigma = 0.02;       ///< [rad] > 0
  double speed_sigma = 0.05;     ///< [m/s] > 0
  double turn_sigma = 0.1;       ///< [rad/s] > 0
};

struct StateFilterCounts {
  estimation::VerdictCounts states{};     ///< states with an accepted clock, by verdict
  std::array<std::uint64_t, 4> clocks{};  ///< all states except flooded ones, by estimation::ClockVerdict
  std::uint64_t flooded = 0;              ///< dropped beyond StateFilter::kMostBetweenPredictions
};

/// The clock of one mover's sender.
struct SenderClockState {
  std::uint32_t mover = 0;
  estimation::ClockState clock;
};

/// Times [ns] are on one monotonic clock. The world must outlive it. Allocates only at the first state of a mover. Not
/// thread-safe.
class StateFilter {
 public:
  /// Maximum number of states of one mover between two predictions; each may reapply a window of measurements.
  static constexpr std::size_t kMostBetweenPredictions = 64;

  StateFilter(const world::World& world, const StateFilterOptions& options);

  /// Adds the mover that was appended to the world.
  void add_mover();

  /// Accepts a state of a mover, including late ones.
  /// @param report at the sender's time `header.time`
  void take(const base::Report& report, const netio::Header& header, std::int64_t now);

  /// Predicts all movers with a state to `now`.
  /// @return their reports at that time, valid until the next call
  const std::vector<base::Report>& predict(std::int64_t now);

  // As of the last `predict`.
  const netio::StateQuality& quality(std::uint32_t row) const { return movers_[row].quality; }
  /// Returns whether the state is stale and the policy removes the mover from the world.
  bool is_gone(std::uint32_t row) const { return movers_[row].gone; }

  const StateFilterOptions& options() const { return options_; }
  /// Sets `StateFilterOptions::epoch`.
  void set_epoch(std::int64_t epoch) { options_.epoch = epoch; }

  StateFilterCounts counts() const;
  std::vector<SenderClockState> clocks() const;  ///< of senders with a known clock

 private:
  struct MoverState {
    std::optional<estimation::TrackFilter> track;
    estimation::SenderClock clock;
    std::uint32_t session = 0;
    std::size_t taken = 0;  ///< since the last prediction
    netio::StateQuality quality;
    bool gone = false;
  };
  estimation::Measurement measurement(const base::Report& report, const netio::Header& header) const;
  std::int64_t epoch() const;
  void forget(MoverState& mover);

  const world::World& world_;
  StateFilterOptions options_;
  estimation::GateLimits gate_limits_ = estimation::gate_limits(estimation::FilterOptions{}.gate);
  std::vector<MoverState> movers_;
  std::vector<base::Report> reports_;
  std::array<std::uint64_t, 4> clock_counts_{};
  std::uint64_t flooded_ = 0;
};

}  // namespace sf::server
