#include "maps/map_assembler.h"

namespace sf::maps {

namespace {

/// Counters wrap: a newer number is less than half of the range ahead.
bool is_newer(std::uint32_t sequence, std::uint32_t than) { return sequence != than && sequence - than < 0x80000000u; }

}  // namespace

void MapAssembler::begin(std::uint32_t sequence, const GridGeometry& plan, std::uint32_t parts) {
  if (missing_ > 0) ++incomplete_;
  if (!map_ || !(map_->plan == plan)) map_.emplace(plan);
  sequence_ = sequence;
  missing_ = parts;
  here_.assign(parts, false);
  old_sequence_.reset();
}

std::optional<PartStatus> MapAssembler::place(std::uint32_t sequence, const GridGeometry& plan, std::uint32_t parts) {
  if (!map_ || is_newer(sequence, sequence_)) {
    begin(sequence, plan, parts);
    return std::nullopt;
  }
  if (sequence == sequence_) {
    old_sequence_.reset();
    if (!(map_->plan == plan)) return PartStatus::contradicts;
    return std::nullopt;
  }
  if (old_sequence_ && is_newer(sequence, *old_sequence_)) {
    begin(sequence, plan, parts);
    return std::nullopt;
  }
  old_sequence_ = sequence;
  return PartStatus::late;
}

PartStatus MapAssembler::arrived(std::uint32_t part) {
  here_[part] = true;
  if (--missing_ > 0) return PartStatus::incomplete;
  ++complete_;
  return PartStatus::complete;
}

PartStatus MapAssembler::add_part(std::uint32_t sequence, std::span<const std::uint8_t> payload) {
  MapPart part;
  if (read_part(payload, part) != PartFault::none) return PartStatus::faulty;
  if (const auto left_out = place(sequence, part.plan, part.parts)) return *left_out;
  if (here_[part.part]) return PartStatus::duplicate;
  true_poses_ = (part.flags & kTruePoses) != 0;
  for (std::uint32_t i = 0; i < part.count; ++i) map_->words[part.first + i] = word_of(part, i);
  return arrived(part.part);
}

PartStatus MapAssembler::add_plain_part(std::span<const std::uint8_t> datagram, const GridGeometry& place) {
  PlainPart part;
  if (read_plain(datagram, part) != PartFault::none) return PartStatus::faulty;
  if (!part.second) {
    GridGeometry plan = place;
    plan.word_columns = part.word_columns;
    plan.word_rows = part.word_rows;
    begin(sequence_ + 1, plan, words(plan) > 1 ? 2 : 1);
  }
  const std::uint32_t all = map_ ? words(map_->plan) : 0;
  if (part.second && part.count != all - plain_half(all)) return PartStatus::orphan;
  const std::uint32_t half = part.second ? 1 : 0;
  if (here_[half]) return PartStatus::duplicate;
  const std::uint32_t first = part.second ? plain_half(all) : 0;
  for (std::uint32_t i = 0; i < part.count; ++i) map_->words[first + i] = word_of(part, i);
  return arrived(half);
}

}  // namespace sf::maps
