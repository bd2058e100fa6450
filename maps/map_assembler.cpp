#include "maps/map_assembler.h"

namespace sf::maps {

namespace {

/// Sequence numbers wrap: a newer number is ahead by less than half of the range.
bool is_newer(std::uint32_t sequence, std::uint32_t than) { return sequence != than && sequence - than < 0x80000000u; }

}  // namespace

void MapAssembler::begin(std::uint32_t sequence, const GridGeometry& geometry, std::uint32_t parts) {
  if (missing_ > 0) ++incomplete_;
  if (!map_ || !(map_->geometry == geometry)) map_.emplace(geometry);
  sequence_ = sequence;
  missing_ = parts;
  here_.assign(parts, false);
  old_sequence_.reset();
}

std::optional<MapPartStatus> MapAssembler::place(std::uint32_t sequence, const GridGeometry& geometry,
                                                 std::uint32_t parts) {
  if (!map_ || is_newer(sequence, sequence_)) {
    begin(sequence, geometry, parts);
    return std::nullopt;
  }
  if (sequence == sequence_) {
    old_sequence_.reset();
    if (!(map_->geometry == geometry)) return MapPartStatus::contradicts;
    return std::nullopt;
  }
  if (old_sequence_ && is_newer(sequence, *old_sequence_)) {
    begin(sequence, geometry, parts);
    return std::nullopt;
  }
  old_sequence_ = sequence;
  return MapPartStatus::late;
}

MapPartStatus MapAssembler::arrived(std::uint32_t part) {
  here_[part] = true;
  if (--missing_ > 0) return MapPartStatus::incomplete;
  ++complete_;
  return MapPartStatus::complete;
}

MapPartStatus MapAssembler::add_part(std::uint32_t sequence, std::span<const std::uint8_t> payload) {
  MapPart part;
  if (read_part(payload, part) != PartFault::none) return MapPartStatus::faulty;
  if (const auto left_out = place(sequence, part.geometry, part.parts)) return *left_out;
  if (here_[part.part]) return MapPartStatus::duplicate;
  true_poses_ = (part.flags & kTruePoses) != 0;
  for (std::uint32_t i = 0; i < part.count; ++i) map_->words[part.first + i] = word_of(part, i);
  return arrived(part.part);
}

MapPartStatus MapAssembler::add_plain_part(std::span<const std::uint8_t> datagram, const GridGeometry& place) {
  PlainPart part;
  if (read_plain(datagram, part) != PartFault::none) return MapPartStatus::faulty;
  if (!part.second) {
    GridGeometry geometry = place;
    geometry.word_columns = part.word_columns;
    geometry.word_rows = part.word_rows;
    begin(sequence_ + 1, geometry, words(geometry) > 1 ? 2 : 1);
  }
  const std::uint32_t all = map_ ? words(map_->geometry) : 0;
  if (part.second && part.count != all - plain_half(all)) return MapPartStatus::orphan;
  const std::uint32_t half = part.second ? 1 : 0;
  if (here_[half]) return MapPartStatus::duplicate;
  const std::uint32_t first = part.second ? plain_half(all) : 0;
  for (std::uint32_t i = 0; i < part.count; ++i) map_->words[first + i] = word_of(part, i);
  return arrived(half);
}

}  // namespace sf::maps
