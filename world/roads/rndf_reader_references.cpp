// Checks the points to which exits, stops and checkpoints of an RNDF refer.

#include <fmt/format.h>

#include <unordered_map>

#include "world/roads/rndf_reader.h"

namespace sf::world {

namespace {

enum class PlaceKind { unread, lane, perimeter, spot };

class Places {
 public:
  Places(const Rndf& rndf, const std::set<PointId>& unread, Diagnostics& diagnostics) : diagnostics_(diagnostics) {
    for (const PointId id : unread) places_.emplace(packed(id), PlaceKind::unread);
    for (const RndfSegment& segment : rndf.segments)
      for (const RndfLane& lane : segment.lanes) add(lane.points, PlaceKind::lane);
    for (const RndfZone& zone : rndf.zones) {
      add(zone.perimeter, PlaceKind::perimeter);
      for (const RndfSpot& spot : zone.spots) add(spot.points, PlaceKind::spot);
    }
  }

  /// @param what the statement's text about `id`, such as "the exit leads to"
  void require(PointId id, int line, std::string_view what, PlaceKind no) const {
    const auto found = places_.find(packed(id));
    if (found == places_.end())
      return diagnostics_.add_error(
          line,
          fmt::format("{} way-point {}, which does not exist; expected one of this file", what, point_id_text(id)));
    if (found->second == no)
      diagnostics_.add_error(
          line, fmt::format("{} {}, a point of a {}; expected a way-point of a lane or a {}", what, point_id_text(id),
                            no == PlaceKind::spot ? "parking spot" : "zone's perimeter",
                            no == PlaceKind::spot ? "perimeter point of a zone" : "point of a spot"));
  }

  void require_lane(PointId id, int line, std::string_view what) const {
    const auto found = places_.find(packed(id));
    if (found == places_.end()) return require(id, line, what, PlaceKind::spot);
    if (found->second != PlaceKind::lane && found->second != PlaceKind::unread)
      diagnostics_.add_error(line, fmt::format("{} {}; expected a way-point of a lane", what, point_id_text(id)));
  }

 private:
  static std::uint64_t packed(PointId id) {
    return std::uint64_t{id.segment} << 32 | std::uint64_t{id.lane} << 16 | id.point;
  }
  void add(const std::vector<RndfPoint>& points, PlaceKind kind) {
    for (const RndfPoint& point : points) places_.insert_or_assign(packed(point.id), kind);
  }

  Diagnostics& diagnostics_;
  std::unordered_map<std::uint64_t, PlaceKind> places_;
};

void check_exits(const Places& places, const std::vector<RndfExit>& exits) {
  for (const RndfExit& exit : exits) {
    places.require(exit.from, exit.line, "the exit leaves", PlaceKind::spot);
    places.require(exit.to, exit.line, "the exit leads to", PlaceKind::spot);
  }
}

void check_checkpoints(const Places& places, const std::vector<RndfCheckpoint>& checkpoints) {
  for (const RndfCheckpoint& checkpoint : checkpoints)
    places.require(checkpoint.at, checkpoint.line, fmt::format("checkpoint {} names", checkpoint.id),
                   PlaceKind::perimeter);
}

}  // namespace

void check_references(const Rndf& rndf, const std::set<PointId>& unread, Diagnostics& diagnostics) {
  const Places places(rndf, unread, diagnostics);
  for (const RndfSegment& segment : rndf.segments)
    for (const RndfLane& lane : segment.lanes) {
      check_exits(places, lane.exits);
      check_checkpoints(places, lane.checkpoints);
      for (const RndfStop& stop : lane.stops) places.require_lane(stop.at, stop.line, "the stop names");
    }
  for (const RndfZone& zone : rndf.zones) {
    check_exits(places, zone.exits);
    for (const RndfSpot& spot : zone.spots) check_checkpoints(places, spot.checkpoints);
  }
}

}  // namespace sf::world
