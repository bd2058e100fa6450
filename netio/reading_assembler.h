#pragma once
// One sensor's readings, put together from parts that may come late, twice, in any order or never. The newest whole
// reading is the one that counts.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "netio/sequence_tracker.h"

namespace sf::netio {

/// Which part of which reading.
struct ReadingPart {
  std::uint32_t sequence = 0;
  std::uint32_t part = 0;   ///< below `parts`
  std::uint32_t parts = 1;  ///< >= 1, the same for all of a reading
  std::int64_t time = 0;    ///< [ns] when it was measured
};

/// A whole reading.
struct CompleteReading {
  std::uint32_t sequence = 0;
  std::int64_t time = 0;           ///< [ns] when it was measured, by its sender's clock
  std::int64_t arrival = 0;        ///< [ns] when its last part came, by the receiver's
  std::span<const double> values;  ///< live until the next piece; not a number where no part said anything
};

/// What became of a piece.
enum class PartStatus : std::uint8_t {
  incomplete,  ///< others are missing yet
  complete,    ///< the last one: this reading is the newest now
  late,        ///< its reading is not newer than the newest whole one, or was given up for newer ones
  duplicate,   ///< it was there
  jump,        ///< its sequence or its time is too far ahead of the newest to be believed
  rejected,    ///< (of Receiver) no piece of such a reading: counted by its PacketStatus
};

/// Readings are numbered 0, 1, 2, ... by their sender and may wrap. One that is more than kMaxDropout readings ahead of
/// the newest, or kMaxTimeJump ahead of the time that it should have, is left out. Once nothing was wanted for two
/// seconds (kClientTimeout) whatever comes is believed: a sender may have started its count again. One thread; nothing
/// is allocated after each of kMaxPartial readings was begun once.
class ReadingAssembler {
 public:
  static constexpr std::size_t kMaxPartial = 8;  ///< readings that parts are awaited of at once; the oldest gives way
  static constexpr std::uint32_t kMaxDropout = 256;             ///< readings that may be lost in a row
  static constexpr std::int64_t kMaxTimeJump = 10'000'000'000;  ///< [ns]

  /// @param value_count values in a whole reading
  explicit ReadingAssembler(std::size_t value_count) : value_count_(value_count) {}

  /// Takes a piece that came at `now` [ns], of a clock that does not go back. Where it is wanted, `decode(values)` is
  /// called to put its numbers into the whole reading's (std::span<double>).
  template <class Decode>
  PartStatus take(const ReadingPart& piece, std::int64_t now, Decode&& decode) {
    PartialReading* partial = nullptr;
    const PartStatus status = find_partial(piece, now, partial);
    if (partial == nullptr) return status;
    decode(std::span<double>(partial->values));
    return finish(piece, now, *partial);
  }

  std::optional<CompleteReading> newest() const;
  /// Of pieces, numbered through all readings from the first that came on (after a restart, again).
  std::uint64_t lost() const { return lost_before_ + netio::lost(tracker_); }
  std::uint64_t restarts() const { return restarts_; }
  /// Forgets the newest reading: the sender is another.
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
  PartialReading newest_;  ///< used: there is one
  std::int64_t arrival_ = 0;
  std::optional<std::int64_t> last_;   ///< [ns] when something wanted came
  std::uint32_t highest_ = 0;          ///< sequence seen, once the track has begun
  std::optional<std::uint64_t> base_;  ///< index that the track calls 0; none before it begins
  std::uint64_t extended_ = 0;         ///< `highest_`, unwrapped
  SequenceTracker tracker_;
  std::uint64_t lost_before_ = 0;
  std::uint64_t restarts_ = 0;
};

}  // namespace sf::netio
