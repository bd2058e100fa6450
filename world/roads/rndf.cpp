#include "world/roads/rndf.h"

#include <fmt/format.h>

#include <array>
#include <unordered_set>

#include "base/error.h"
#include "world/entities.h"
#include "world/roads/rndf_reader.h"

namespace sf::world {

namespace {

constexpr std::array<std::pair<std::string_view, Boundary>, 4> kBoundaries{{{"double_yellow", Boundary::double_yellow},
                                                                            {"solid_yellow", Boundary::solid_yellow},
                                                                            {"solid_white", Boundary::solid_white},
                                                                            {"broken_white", Boundary::broken_white}}};

/// What exits, stops and checkpoints may name.
class Places {
 public:
  explicit Places(const Rndf& rndf) : file_(rndf.file) {
    for (const RndfSegment& segment : rndf.segments)
      for (const RndfLane& lane : segment.lanes) add(lane.points);
    for (const RndfZone& zone : rndf.zones) {
      add(zone.perimeter);
      for (const RndfSpot& spot : zone.spots) add_spot(spot.points);
    }
  }

  void require(PointId id, int line, std::string_view what) const {
    if (ways_.count(packed(id)) == 0 && spots_.count(packed(id)) == 0) refuse(id, line, what);
  }
  void require_entry(const RndfExit& exit) const {
    if (spots_.count(packed(exit.to)) > 0)
      throw base::InputError(file_, exit.line,
                             fmt::format("the exit leads to {}, a point of a parking spot; expected a way-point of a "
                                         "lane or a perimeter point of a zone",
                                         text_of(exit.to)));
    if (ways_.count(packed(exit.to)) == 0) refuse(exit.to, exit.line, "the exit leads to");
  }

 private:
  static std::uint64_t packed(PointId id) {
    return std::uint64_t{id.segment} << 32 | std::uint64_t{id.lane} << 16 | id.point;
  }
  void add(const std::vector<RndfPoint>& points) {
    for (const RndfPoint& point : points) ways_.insert(packed(point.id));
  }
  void add_spot(const std::vector<RndfPoint>& points) {
    for (const RndfPoint& point : points) spots_.insert(packed(point.id));
  }
  [[noreturn]] void refuse(PointId id, int line, std::string_view what) const {
    throw base::InputError(
        file_, line,
        fmt::format("{} way-point {}, which does not exist; expected one of this file", what, text_of(id)));
  }

  const std::string& file_;
  std::unordered_set<std::uint64_t> ways_;
  std::unordered_set<std::uint64_t> spots_;
};

void check_references(const Rndf& rndf) {
  const Places places(rndf);
  const auto check_exits = [&](const std::vector<RndfExit>& exits) {
    for (const RndfExit& exit : exits) {
      places.require(exit.from, exit.line, "the exit leaves");
      places.require_entry(exit);
    }
  };
  const auto check_checkpoints = [&](const std::vector<RndfCheckpoint>& checkpoints) {
    for (const RndfCheckpoint& checkpoint : checkpoints)
      places.require(checkpoint.at, checkpoint.line, fmt::format("checkpoint {} names", checkpoint.id));
  };
  for (const RndfSegment& segment : rndf.segments)
    for (const RndfLane& lane : segment.lanes) {
      check_exits(lane.exits);
      check_checkpoints(lane.checkpoints);
      for (const RndfStop& stop : lane.stops) places.require(stop.at, stop.line, "the stop names");
    }
  for (const RndfZone& zone : rndf.zones) {
    check_exits(zone.exits);
    for (const RndfSpot& spot : zone.spots) check_checkpoints(spot.checkpoints);
  }
}

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

Rndf parse_rndf(const std::string& file, std::string_view text) {
  Rndf rndf = RndfReader(file, text).read();
  check_references(rndf);
  return rndf;
}

Rndf read_rndf(const std::string& file) { return parse_rndf(file, read_text(file)); }

}  // namespace sf::world
