#pragma once
// Assembles the readings of one sensor from parts that may arrive late, repeatedly, out of order or never. Keeps the
// newest complete reading.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "netio/sequence_tracker.h"

namespace sf::netio {

/// Identity of a part of a reading.
struct ReadingPart {
  std::uint32_t sequence = 0;
  std::uint32_t part = 0;      ///< below `parts`
  std::uint32_t parts = 1;     ///< >= 1, the same for all parts of a reading
  std::int64_t time = 0;       ///< [ns] time of measurement
  std::uint16_t accuracy = 0;  ///< Header::accuracy
};

/// A complete reading.
struct CompleteReading {
  std::uint32_t sequence = 0;
  std::int64_t time = 0;           ///< [ns] time of measurement by the sender's clock
  std::int64_t arrival = 0;        ///< [ns] arrival of its last part on the receiver's clock
  std::span<const double> values;  ///< valid until the next part; NaN for elements that no part contained
  std::uint16_t accuracy = 0;      ///< Header::accuracy of the first part that arrived
};

/// Result of receiving a part.
enum class PartStatus : std::uint8_t {
  incomplete,  ///< other parts are missing
  complete,    ///< the last missing part: its reading is now the newest
  late,        ///< its reading is not newer than the newest complete one, was abandoned for newer ones, or differs in
               ///< `parts` or `time` from the parts received so far
  duplicate,   ///< the part was received before
  jump,        ///< its sequence or time is implausibly far ahead of the newest, or its time lies before the newest's
  rejected,    ///< not a valid part (Receiver only); counted by its PacketStatus
};

/// The sender numbers readings 0, 1, 2, ...; the number may wrap. Drops a part more than kMaxDropout readings ahead of
/// the newest, or kMaxTimeJump ahead of its expected time. After two seconds (kSenderTimeout) without an accepted part,
/// accepts any part, because the sender may have restarted its count. Single-threaded; allocates nothing once
/// kMaxPartial + 1 readings have been received.
class ReadingAssembler {
 public:
  static constexpr std::size_t kMaxPartial = 8;                 ///< readings in progress; a new one replaces the oldest
  static constexpr std::uint32_t kMaxDropout = 256;             ///< readings that may be lost in a row
  static constexpr std::int64_t kMaxTimeJump = 10'000'000'000;  ///< [ns]

  /// @param value_count number of values in a complete reading
  explicit ReadingAssembler(std::size_t value_count) : value_count_(value_count) {}

  /// Receives a part at `now` [ns], from a clock that does not decrease. If the part is needed, calls
  /// `decode(std::span<double> values)` to write its elements into the values of the complete reading.
  template <class Decode>
  PartStatus take(const ReadingPart& piece, std::int64_t now, Decode&& decode) {
    PartialReading* partial = nullptr;
    const PartStatus status = find_partial(piece, now, partial);
    if (partial == nullptr) return status;
    decode(std::span<double>(partial->values));
    return finish(piece, now, *partial);
  }

  std::optional<CompleteReading> newest() const;
  /// Returns the number of lost parts, counted from the first received one (again after a restart).
  std::uint64_t lost() const { return lost_before_ + netio::lost(tracker_); }
  std::uint64_t restarts() const { return restarts_; }
  /// Drops the newest reading and those in progress, because the sender has changed.
  void restart();

 private:
  struct PartialReading {
    bool used = false;
    ReadingPart piece;
    std::uint32_t missing = 0;
    std::vector<bool> seen;  ///< per part
    std::vector<double> values;
  };
  PartStatus find_partial(const ReadingPart& piece, std::int64_t now, PartialReading*& partial);
  PartStatus finish(const ReadingPart& piece, std::int64_t now, PartialReading& partial);
  bool jumps(const ReadingPart& piece, std::int64_t now) const;
  void count(const ReadingPart& piece);
  PartialReading* find(std::uint32_t sequence);
  PartialReading* begin(const ReadingPart& piece);

  std::size_t value_count_;
  std::array<PartialReading, kMaxPartial> partial_;
  PartialReading newest_;  ///< `used` means valid
  std::int64_t arrival_ = 0;
  std::optional<std::int64_t> last_;   ///< [ns] arrival of the last accepted part
  std::uint32_t highest_ = 0;          ///< highest sequence, once the tracker has begun
  std::optional<std::uint64_t> base_;  ///< index that the tracker counts as 0; nullopt before it begins
  std::uint64_t extended_ = 0;         ///< `highest_`, unwrapped
  SequenceTracker tracker_;
  std::uint64_t lost_before_ = 0;
  std::uint64_t restarts_ = 0;
};

}  // namespace sf::netio
