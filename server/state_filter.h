#pragma once
// Filters the states of movers from their packets, with one track and one sender clock per mover.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/report.h"
#include "netio/packets.h"
#include "robots/estimation/arrival_monitor.h"
#include "robots/estimation/sender_clock.h"
#include "robots/estimation/track_filter.h"
#include "world/world.h"

namespace sf::server {

/// Which senders' states are filtered. Without the filter, the newest state counts, as of its arrival.
enum class FilterMode : std::uint8_t {
  off,
  automatic,  ///< senders whose states arrive late by changing amounts (estimation::ArrivalMonitor)
  on
};

struct StateFilterOptions {
  FilterMode mode = FilterMode::automatic;
  estimation::ClockOptions clock;
  /// With `automatic` and estimated clocks: whether a late sender whose timestamps are Unix time is taken as
  /// synchronised (docs/estimation.md).
  bool unix_time = true;
  std::int64_t stale_after = 1'000'000'000;                        ///< [ns] > 0
  estimation::StalePolicy policy = estimation::StalePolicy::hide;  ///< also without the filter
  /// > 0 (estimation::FilterOptions). Packets always contain a heading, so it is uncertain only after losses.
  std::size_t hypotheses = 16;
  /// [ns] Unix time at time 0 of the receiver's clock, for estimation::ClockSource::trusted and `unix_time`.
  std::int64_t epoch = 0;
  // Standard deviations of reported states. A covariance stated in the packet replaces those of the pose.
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

  /// Removes all that is known of a mover's sender.
  void reset(std::uint32_t row);

  /// Accepts a state of a mover, including late ones.
  /// @param report at the sender's time `header.time`
  /// @return whether its sender is filtered; otherwise the state is to be used as of its arrival
  bool take(const base::Report& report, const netio::Header& header, std::int64_t now);

  /// Predicts all filtered movers with a state to `now`.
  /// @return their reports at that time, valid until the next call
  const std::vector<base::Report>& predict(std::int64_t now);

  // As of the last `predict`.
  const netio::StateQuality& quality(std::uint32_t row) const { return movers_[row].quality; }
  /// Returns whether the state is stale and the policy removes the mover from the world.
  bool is_gone(std::uint32_t row) const { return movers_[row].gone; }

  /// Returns whether the mover's states are filtered, as of its last one.
  bool is_filtered(std::uint32_t row) const { return !movers_.empty() && movers_[row].filtered; }

  const StateFilterOptions& options() const { return options_; }
  /// Sets `StateFilterOptions::epoch`.
  void set_epoch(std::int64_t epoch) { options_.epoch = epoch; }

  /// Returns whether all states are filtered, or any was.
  bool used() const { return options_.mode == FilterMode::on || used_; }
  StateFilterCounts counts() const;
  std::vector<SenderClockState> clocks() const;  ///< of senders with a known clock

 private:
  struct MoverState {
    std::optional<estimation::TrackFilter> track;
    estimation::SenderClock clock;
    estimation::ArrivalMonitor arrivals;
    bool filtered = false;
    bool synchronised = false;  ///< its timestamps are used as Unix time
    std::uint32_t session = 0;
    std::size_t taken = 0;       ///< since the last prediction
    base::Tilt tilt;             ///< of the newest state that was used
    std::int64_t tilt_time = 0;  ///< [ns] of it, on the track's clock
    netio::StateQuality quality;
    bool gone = false;
  };
  estimation::Measurement measurement(const base::Report& report, const netio::Header& header) const;
  bool is_late(MoverState& mover, const netio::Header& header, std::int64_t now);
  bool is_synchronised(const MoverState& mover) const;
  std::int64_t sender_time(const MoverState& mover, std::int64_t now) const;
  std::int64_t epoch() const;
  static void forget(MoverState& mover);
  static void forget_times(MoverState& mover);

  const world::World& world_;
  StateFilterOptions options_;
  estimation::GateLimits gate_limits_ = estimation::gate_limits(estimation::FilterOptions{}.gate);
  std::vector<MoverState> movers_;
  std::vector<base::Report> reports_;
  std::array<std::uint64_t, 4> clock_counts_{};
  std::uint64_t flooded_ = 0;
  bool used_ = false;
};

}  // namespace sf::server
