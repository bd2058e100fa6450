#pragma once
// Estimate of a sender's clock from the timestamps and arrivals of its packets.
//
// A packet stamped s on the sender's clock arrives at a = s + gap, gap = offset + drift s + delay with delay >= least
// delay. The line below all points (s, gap) that is nearest to them is the edge of their lower convex hull under the
// middle of the window: S. B. Moon, P. Skelly, D. Towsley, Estimation and removal of clock skew from network delay
// measurements, INFOCOM 1999. Only the packets with the least delay of each slot of the window count, so jitter is
// harmless. One-way packets cannot tell offset from the least delay: it is given, and 0 unless known better.

#include <array>
#include <cstdint>
#include <string_view>

namespace sf::estimation {

/// The clock that times of measurements follow.
enum class ClockSource : std::uint8_t {
  estimated,  ///< from the packets
  trusted,    ///< sender and receiver are synchronised (PTP, NTP): timestamps count as they are
  arrival     ///< timestamps are ignored: a measurement is true when it arrives
};

struct ClockOptions {
  ClockSource source = ClockSource::estimated;
  std::int64_t least_delay = 0;            ///< [ns] >= 0 of the link, for `estimated`
  std::int64_t max_future = 250'000'000;   ///< [ns] >= 0 of arrival before the estimate's least delay
  std::int64_t max_delay = 1'000'000'000;  ///< [ns] > 0 beyond the least one
};

enum class ClockVerdict : std::uint8_t {
  used,
  stepped,  ///< used: the sender's clock was set anew, shown by kConfirmations packets that agree
  future,   ///< refused: from the future by more than `max_future`
  late      ///< refused: delayed by more than `max_delay`
};

struct ClockState {
  std::int64_t offset = 0;    ///< [ns] receiver's time minus sender's, at the newest timestamp
  double drift = 0.0;         ///< [s/s] of that offset, within kMaxDrift; 0 until kDriftSpan of timestamps are known
  bool synchronised = false;  ///< the offset is known, from packets: never with `trusted` and `arrival`
  bool drift_known = false;
  std::uint64_t steps = 0;  ///< of the sender's clock
};

/// Bounded: kSlots points. The result depends on the packets' order of arrival only where a step is judged. No clock is
/// read. One thread.
class SenderClock {
 public:
  static constexpr std::int64_t kWindow = 64'000'000'000;     ///< [ns] of timestamps that the estimate uses
  static constexpr std::int64_t kDriftSpan = 10'000'000'000;  ///< [ns] that an estimate of the drift needs
  static constexpr double kMaxDrift = 5e-4;                   ///< of crystals, with a wide margin
  static constexpr int kConfirmations = 5;

  explicit SenderClock(const ClockOptions& options = {}) : options_(options) {}

  /// Takes a packet's timestamp `sent` on the sender's clock and its arrival on the receiver's, both in [0, 2^62] ns.
  ClockVerdict take(std::int64_t sent, std::int64_t arrival);

  /// [ns] The sender's time at the receiver's time `own` in [0, 2^61]. `trusted`, `arrival`: `own`.
  std::int64_t to_sender(std::int64_t own) const;

  const ClockState& state() const { return state_; }
  /// For a sender that restarts.
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
  std::array<Point, kSlots> points_;  ///< of each slot the one with the least gap; slot k at k modulo kSlots
  std::int64_t newest_ = 0;           ///< [ns] timestamp at which `state_.offset` holds
  // Refused packets in a row that agree with each other.
  ClockVerdict refusal_ = ClockVerdict::used;
  std::int64_t refused_gap_ = 0;
  int refusals_ = 0;
};

std::string_view name(ClockVerdict verdict);

}  // namespace sf::estimation
