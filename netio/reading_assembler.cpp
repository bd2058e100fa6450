#include "netio/reading_assembler.h"

#include <algorithm>
#include <string>

#include "base/error.h"
#include "netio/sender_bindings.h"

namespace sf::netio {

PartStatus ReadingAssembler::find_partial(const ReadingPart& piece, std::int64_t now, PartialReading*& partial) {
  SF_CHECK(piece.part < piece.parts, std::to_string(piece.part) + " of " + std::to_string(piece.parts) + " parts");
  const bool silent = !last_ || now - *last_ >= kSenderTimeout;
  if (silent && base_ && !newer(piece.sequence, highest_)) restart();
  if (!silent && jumps(piece, now)) return PartStatus::jump;
  count(piece);

  if (newest_.used && !newer(piece.sequence, newest_.piece.sequence)) {
    const bool same = piece.sequence == newest_.piece.sequence && piece.time == newest_.piece.time;
    return same && piece.parts == newest_.piece.parts ? PartStatus::duplicate : PartStatus::late;
  }
  PartialReading* found = find(piece.sequence);
  if (found == nullptr) found = begin(piece);
  if (found == nullptr) return PartStatus::late;
  // A different number of parts or time means another sender, or a sender that has restarted.
  if (found->piece.parts != piece.parts || found->piece.time != piece.time) return PartStatus::late;
  if (found->seen[piece.part]) return PartStatus::duplicate;
  partial = found;
  return PartStatus::incomplete;
}

bool ReadingAssembler::jumps(const ReadingPart& piece, std::int64_t now) const {
  if (!newest_.used || !newer(piece.sequence, newest_.piece.sequence)) return false;
  const bool far = piece.sequence - newest_.piece.sequence > kMaxDropout;
  return far || piece.time - newest_.piece.time > now - arrival_ + kMaxTimeJump || piece.time < newest_.piece.time;
}

PartStatus ReadingAssembler::finish(const ReadingPart& piece, std::int64_t now, PartialReading& partial) {
  last_ = now;
  partial.seen[piece.part] = true;
  if (--partial.missing > 0) return PartStatus::incomplete;
  std::swap(partial, newest_);
  partial.used = false;
  arrival_ = now;
  return PartStatus::complete;
}

std::optional<CompleteReading> ReadingAssembler::newest() const {
  if (!newest_.used) return std::nullopt;
  return CompleteReading{newest_.piece.sequence, newest_.piece.time, arrival_, newest_.values, newest_.piece.accuracy};
}

/// Counts a part in the tracker, with unwrapped sequences.
void ReadingAssembler::count(const ReadingPart& piece) {
  if (!base_) {
    extended_ = std::uint64_t{1} << 32 | piece.sequence;
    highest_ = piece.sequence;
    base_ = extended_ * piece.parts;
  }
  const auto ahead = static_cast<std::int32_t>(piece.sequence - highest_);
  const std::uint64_t sequence = extended_ + static_cast<std::uint64_t>(std::int64_t{ahead});
  if (ahead > 0) {
    highest_ = piece.sequence;
    extended_ = sequence;
  }
  const std::uint64_t index = sequence * piece.parts + piece.part;
  if (index >= *base_) count_arrival(tracker_, index - *base_);
}

void ReadingAssembler::restart() {
  lost_before_ += netio::lost(tracker_);
  tracker_ = {};
  base_.reset();
  newest_.used = false;
  for (PartialReading& partial : partial_) partial.used = false;
  ++restarts_;
}

ReadingAssembler::PartialReading* ReadingAssembler::find(std::uint32_t sequence) {
  const auto at = std::find_if(partial_.begin(), partial_.end(), [&](const PartialReading& partial) {
    return partial.used && partial.piece.sequence == sequence;
  });
  return at == partial_.end() ? nullptr : &*at;
}

ReadingAssembler::PartialReading* ReadingAssembler::begin(const ReadingPart& piece) {
  PartialReading* free = nullptr;
  for (PartialReading& partial : partial_) {
    if (!partial.used) {
      free = &partial;
      break;
    }
    if (free == nullptr || newer(free->piece.sequence, partial.piece.sequence)) free = &partial;
  }
  if (free->used && !newer(piece.sequence, free->piece.sequence)) return nullptr;
  free->used = true;
  free->piece = piece;
  free->missing = piece.parts;
  free->seen.assign(piece.parts, false);
  free->values.assign(value_count_, std::numeric_limits<double>::quiet_NaN());
  return free;
}

}  // namespace sf::netio
