#pragma once
// One sensor's readings, put together from parts that may come late, twice, in any order or never. The newest whole
// reading is the one that counts.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "netio/track.h"

namespace sf::netio {

/// Which part of which reading.
struct Piece {
  std::uint32_t sequence = 0;
  std::uint32_t part = 0;   ///< below `parts`
  std::uint32_t parts = 1;  ///< >= 1, the same for all of a reading
  std::int64_t time = 0;    ///< [ns] when it was measured
};

/// A whole reading.
struct Whole {
  std::uint32_t sequence = 0;
  std::int64_t time = 0;           ///< [ns] when it was measured, by its sender's clock
  std::int64_t came = 0;           ///< [ns] when its last part came, by the receiver's
  std::span<const double> values;  ///< live until the next piece; not a number where no part said anything
};

/// What became of a piece.
enum class Taken : std::uint8_t {
  part,       ///< others are missing yet
  whole,      ///< the last one: this reading is the newest now
  late,       ///< its reading is not newer than the newest whole one, or was given up for newer ones
  duplicate,  ///< it was there
  leap,       ///< its sequence or its time is too far ahead of the newest to be believed
  refused,    ///< (of Receiver) no piece of such a reading: counted by its Reason
};

/// Readings are numbered 0, 1, 2, ... by their sender and may wrap. One that is more than kMostAhead readings ahead of
/// the newest, or kLeap ahead of the time that it should have, is left out. Once nothing was wanted for two seconds
/// (kSilence) whatever comes is believed: a sender may have started its count again. One thread; nothing is allocated
/// after each of kOpen readings was begun once.
class Assembler {
 public:
  static constexpr std::size_t kOpen = 8;  ///< readings that parts are awaited of at once; the oldest gives way
  static constexpr std::uint32_t kMostAhead = 256;       ///< readings that may be lost in a row
  static constexpr std::int64_t kLeap = 10'000'000'000;  ///< [ns]

  /// @param numbers in a whole reading
  explicit Assembler(std::size_t numbers) : numbers_(numbers) {}

  /// Takes a piece that came at `now` [ns], of a clock that does not go back. Where it is wanted, `write(values)` is
  /// called to put its numbers into the whole reading's (std::span<double>).
  template <class Write>
  Taken take(const Piece& piece, std::int64_t now, Write&& write) {
    Open* open = nullptr;
    const Taken fate = place(piece, now, open);
    if (open == nullptr) return fate;
    write(std::span<double>(open->values));
    return update_extent_and_hash(piece, now, *open);
  }

  std::optional<Whole> newest() const;
  /// Of pieces, numbered through all readings from the first that came on (after a restart, again).
  std::uint64_t lost() const { return lost_before_ + netio::lost(track_); }
  std::uint64_t restarts() const { return restarts_; }
  /// Forgets the newest reading: the sender is another.
  void restart();

 private:
  struct Open {
    bool used = false;
    Piece piece;
    std::uint32_t missing = 0;
    std::vector<bool> seen;  ///< per part
    std::vector<double> values;
  };
  Taken place(const Piece& piece, std::int64_t now, Open*& open);
  Taken update_extent_and_hash(const Piece& piece, std::int64_t now, Open& open);
  bool leaps(const Piece& piece, std::int64_t now) const;
  void count(const Piece& piece);
  Open* find(std::uint32_t sequence);
  Open* begin(const Piece& piece);

  std::size_t numbers_;
  std::array<Open, kOpen> open_;
  Open newest_;  ///< used: there is one
  std::int64_t came_ = 0;
  std::optional<std::int64_t> last_;   ///< [ns] when something wanted came
  std::uint32_t highest_ = 0;          ///< sequence seen, once the track has begun
  std::optional<std::uint64_t> base_;  ///< index that the track calls 0; none before it begins
  std::uint64_t extended_ = 0;         ///< `highest_`, unwrapped
  Track track_;
  std::uint64_t lost_before_ = 0;
  std::uint64_t restarts_ = 0;
};

}  // namespace sf::netio
