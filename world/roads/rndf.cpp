#include "world/roads/rndf.h"

#include <array>

#include "base/files.h"
#include "world/roads/rndf_reader.h"

namespace sf::world {

namespace {

constexpr std::array<std::pair<std::string_view, Boundary>, 4> kBoundaries{{{"double_yellow", Boundary::double_yellow},
                                                                            {"solid_yellow", Boundary::solid_yellow},
                                                                            {"solid_white", Boundary::solid_white},
                                                                            {"broken_white", Boundary::broken_white}}};

}  // namespace

std::string_view word_of(Boundary boundary) {
  for (const auto& [word, value] : kBoundaries)
    if (value == boundary) return word;
  return "none";
}

std::optional<Boundary> boundary_of(std::string_view word) {
  for (const auto& [known, value] : kBoundaries)
    if (known == word) return value;
  return std::nullopt;
}

std::string boundary_words() {
  std::string words;
  for (const auto& [word, value] : kBoundaries) words += (words.empty() ? "" : ", ") + std::string(word);
  return words;
}

RoadCounts count(const Rndf& rndf) {
  RoadCounts counts;
  counts.segments = rndf.segments.size();
  counts.zones = rndf.zones.size();
  for (const RndfSegment& segment : rndf.segments) {
    counts.lanes += segment.lanes.size();
    for (const RndfLane& lane : segment.lanes) {
      counts.lane_waypoints += lane.points.size();
      counts.exits += lane.exits.size();
      counts.stops += lane.stops.size();
      counts.checkpoints += lane.checkpoints.size();
    }
  }
  counts.points = counts.lane_waypoints;
  for (const RndfZone& zone : rndf.zones) {
    counts.spots += zone.spots.size();
    counts.exits += zone.exits.size();
    counts.points += zone.perimeter.size();
    for (const RndfSpot& spot : zone.spots) {
      counts.points += spot.points.size();
      counts.checkpoints += spot.checkpoints.size();
    }
  }
  return counts;
}

Rndf parse_rndf(const std::string& file, std::string_view text, bool strict) {
  return RndfReader(file, text, strict).read();
}

Rndf read_rndf(const std::string& file, bool strict) { return parse_rndf(file, base::read_text(file), strict); }

}  // namespace sf::world
