#pragma once
// Estimates a sender's clock from the timestamps and arrival times of its packets.
//
// A packet stamped s on the sender's clock arrives at a = s + gap, where gap = offset + drift s + delay and delay >=
// least delay. The closest line below all points (s, gap) is the edge of their lower convex hull under the middle of
// the window: S. B. Moon, P. Skelly, D. Towsley, Estimation and removal of clock skew from network delay measurements,
// INFOCOM 1999. Only the packet with the least delay in each slot of the window counts, so jitter does no harm. One-way
// packets cannot separate the offset from the least delay, so the least delay is a parameter with default 0.

#include <array>
#include <cstdint>
#include <string_view>

namespace sf::estimation {

/// The clock that timestamps of measurements refer to.
enum class ClockSource : std::uint8_t {
  estimated,  ///< estimated from the packets
  trusted,    ///< sender and receiver are synchronised (PTP, NTP): timestamps are used unchanged
  arrival     ///< timestamps are ignored: a measurement is dated by its arrival
};

struct ClockOptions {
  ClockSource source = ClockSource::estimated;
  std::int64_t least_delay = 0;            ///< [ns] >= 0 least delay of the link, for `estimated`
  std::int64_t max_future = 250'000'000;   ///< [ns] >= 0 by which a packet may arrive before the estimated least delay
  std::int64_t max_delay = 1'000'000'000;  ///< [ns] > 0 in excess of the least delay
};

enum class ClockVerdict : std::uint8_t {
  used,
  stepped,  ///< used: the sender's clock was reset, as shown by kConfirmations packets that agree
  future,   ///< rejected: more than `max_future` in the future
  late      ///< rejected: delayed by more than `max_delay`
};

struct ClockState {
  std::int64_t offset = 0;    ///< [ns] receiver's time minus sender's, at the newest timestamp
  double drift = 0.0;         ///< [s/s] drift of the offset, within kMaxDrift; 0 until the timestamps span kDriftSpan
  bool synchronised = false;  ///< the offset was estimated from packets; always false with `trusted` and `arrival`
  bool drift_known = false;
  std::uint64_t steps = 0;  ///< number of times that the sender's clock was reset
};

/// Uses bounded memory: kSlots points. The result depends on the order of arrival only when a clock step is detected.
/// Does not read any clock. Not thread-safe.
class SenderClock {
 public:
  static constexpr std::int64_t kWindow = 64'000'000'000;     ///< [ns] span of timestamps used for the estimate
  static constexpr std::int64_t kDriftSpan = 10'000'000'000;  ///< [ns] span of timestamps required for a drift estimate
  static constexpr double kMaxDrift = 5e-4;                   ///< crystals drift less, by a wide margin
  static constexpr int kConfirmations = 5;

  explicit SenderClock(const ClockOptions& options = {}) : options_(options) {}

  /// Processes a packet's timestamp `sent` on the sender's clock and its `arrival` on the receiver's, both in [0, 2^62]
  /// ns.
  ClockVerdict take(std::int64_t sent, std::int64_t arrival);

  /// Returns the sender's time [ns] at the receiver's time `own` in [0, 2^61]. With `trusted` and `arrival`, returns
  /// `own`.
  std::int64_t to_sender(std::int64_t own) const;

  const ClockState& state() const { return state_; }
  /// Resets the estimate, for a sender that restarts.
  void reset();

 private:
  struct Point {
    bool set = false;
    std::int64_t sent = 0;
    std::int64_t gap = 0;
  };
  static constexpr std::int64_t kSlots = 64;
  static constexpr std::int64_t kSlot = kWindow / kSlots;  ///< [ns]

  bool confirms_step(ClockVerdict refusal, std::int64_t gap);
  void begin(std::int64_t sent, std::int64_t gap);
  bool add(std::int64_t sent, std::int64_t gap);
  void fit();

  ClockOptions options_;
  ClockState state_;
  std::array<Point, kSlots> points_;  ///< the point with the least gap in each slot; slot k is at k modulo kSlots
  std::int64_t newest_ = 0;           ///< [ns] timestamp for which `state_.offset` is valid
  // Consecutive rejected packets that agree with each other.
  ClockVerdict refusal_ = ClockVerdict::used;
  std::int64_t refused_gap_ = 0;
  int refusals_ = 0;
};

std::string_view name(ClockVerdict verdict);

}  // namespace sf::estimation
