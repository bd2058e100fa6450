#include "netio/assembler.h"

#include <algorithm>
#include <string>

#include "base/error.h"
#include "netio/bindings.h"

namespace sf::netio {

Taken Assembler::place(const Piece& piece, std::int64_t now, Open*& open) {
  SF_CHECK(piece.part < piece.parts, std::to_string(piece.part) + " of " + std::to_string(piece.parts) + " parts");
  const bool silent = !last_ || now - *last_ >= kSilence;
  if (silent && base_ && !newer(piece.sequence, highest_)) restart();
  if (!silent && leaps(piece, now)) return Taken::leap;
  count(piece);

  if (newest_.used && !newer(piece.sequence, newest_.piece.sequence)) {
    const bool same = piece.sequence == newest_.piece.sequence && piece.time == newest_.piece.time;
    return same && piece.parts == newest_.piece.parts ? Taken::duplicate : Taken::late;
  }
  Open* found = find(piece.sequence);
  if (found == nullptr) found = begin(piece);
  if (found == nullptr) return Taken::late;
  // What does not fit is of another sender, or of one that began anew.
  if (found->piece.parts != piece.parts || found->piece.time != piece.time) return Taken::late;
  if (found->seen[piece.part]) return Taken::duplicate;
  open = found;
  return Taken::part;
}

bool Assembler::leaps(const Piece& piece, std::int64_t now) const {
  if (!newest_.used || !newer(piece.sequence, newest_.piece.sequence)) return false;
  const bool far = piece.sequence - newest_.piece.sequence > kMostAhead;
  return far || piece.time - newest_.piece.time > now - came_ + kLeap || piece.time < newest_.piece.time;
}

Taken Assembler::update_extent_and_hash(const Piece& piece, std::int64_t now, Open& open) {
  last_ = now;
  open.seen[piece.part] = true;
  if (--open.missing > 0) return Taken::part;
  std::swap(open, newest_);
  open.used = false;
  came_ = now;
  return Taken::whole;
}

std::optional<Whole> Assembler::newest() const {
  if (!newest_.used) return std::nullopt;
  return Whole{newest_.piece.sequence, newest_.piece.time, came_, newest_.values};
}

/// Sequences wrap; the track counts on.
void Assembler::count(const Piece& piece) {
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
  if (index >= *base_) see(track_, index - *base_);
}

void Assembler::restart() {
  lost_before_ += netio::lost(track_);
  track_ = {};
  base_.reset();
  newest_.used = false;
  for (Open& open : open_) open.used = false;
  ++restarts_;
}

Assembler::Open* Assembler::find(std::uint32_t sequence) {
  const auto at = std::find_if(open_.begin(), open_.end(),
                               [&](const Open& open) { return open.used && open.piece.sequence == sequence; });
  return at == open_.end() ? nullptr : &*at;
}

Assembler::Open* Assembler::begin(const Piece& piece) {
  Open* free = nullptr;
  for (Open& open : open_) {
    if (!open.used) {
      free = &open;
      break;
    }
    if (free == nullptr || newer(free->piece.sequence, open.piece.sequence)) free = &open;
  }
  if (free->used && !newer(piece.sequence, free->piece.sequence)) return nullptr;
  free->used = true;
  free->piece = piece;
  free->missing = piece.parts;
  free->seen.assign(piece.parts, false);
  free->values.assign(numbers_, std::numeric_limits<double>::quiet_NaN());
  return free;
}

}  // namespace sf::netio
