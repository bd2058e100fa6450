// Effects of the statements of an RNDF.

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "world/roads/rndf_reader.h"

namespace sf::world {

namespace {

PointId key(int segment, int lane = 0) {
  return {static_cast<std::uint16_t>(segment), static_cast<std::uint16_t>(lane), 0};
}

/// Returns the text of an id; segments and zones are {id, 0, 0}, lanes and spots {id, lane, 0}.
std::string shown(PointId id) {
  if (id.point > 0) return point_id_text(id);
  return id.lane > 0 ? fmt::format("{}.{}", id.segment, id.lane) : fmt::format("{}", id.segment);
}

}  // namespace

void RndfReader::read_declared_count(int least, std::string_view what) {
  DeclaredCount promise{-1, now().line, std::string(now().rest)};
  try {
    promise.count = statements_.whole(0, least, what);
    statements_.expect_fields(1);
  } catch (const base::InputError&) {
    if (diagnostics_.strict()) throw;
    warn(now().line, fmt::format("'{}' is {}, not a number above zero; the actual entries are counted", now().keyword,
                                 quoted(now().rest)));
  }
  open_.back().declared.emplace(now().keyword, promise);
}

void RndfReader::claim(PointId id, std::string_view what) {
  const auto [old, fresh] = claimed_.emplace(id, now().line);
  if (!fresh)
    statements_.fail(fmt::format("{} {} is already in line {}; expected a unique id", what, shown(id), old->second));
}

void RndfReader::begin_segment() {
  const int id = statements_.whole(0, 1, "the segment's id");
  statements_.expect_fields(1);
  claim(key(id), "segment");
  rndf_.segments.push_back({id, {}, {}, now().line});
  open(RndfBlock::segment, fmt::format("segment {}", id));
}

void RndfReader::begin_lane() {
  const PointId id = statements_.pair(0, "the lane's id");
  statements_.expect_fields(1);
  const int segment = rndf_.segments.back().id;
  if (id.segment != segment || id.lane == 0)
    statements_.fail(fmt::format("lane {}.{} is in segment {}; expected {}.1, {}.2, ...", id.segment, id.lane, segment,
                                 segment, segment));
  claim(id, "lane");
  RndfLane lane;
  lane.number = id.lane;
  lane.line = now().line;
  rndf_.segments.back().lanes.push_back(std::move(lane));
  open(RndfBlock::lane, fmt::format("lane {}.{}", id.segment, id.lane));
}

void RndfReader::begin_zone() {
  const int id = statements_.whole(0, 1, "the zone's id");
  statements_.expect_fields(1);
  claim(key(id), "zone or segment");
  rndf_.zones.push_back({id, {}, {}, {}, {}, now().line});
  open(RndfBlock::zone, fmt::format("zone {}", id));
}

void RndfReader::begin_perimeter() {
  const PointId id = statements_.pair(0, "the perimeter's id");
  statements_.expect_fields(1);
  if (id != key(zone().id))
    statements_.fail(
        fmt::format("perimeter {}.{} is in zone {}; expected {}.0", id.segment, id.lane, zone().id, zone().id));
  open(RndfBlock::perimeter, fmt::format("perimeter {}.0", zone().id));
}

void RndfReader::begin_spot() {
  const PointId id = statements_.pair(0, "the spot's id");
  statements_.expect_fields(1);
  if (id.segment != zone().id || id.lane == 0)
    statements_.fail(fmt::format("spot {}.{} is in zone {}; expected {}.1, {}.2, ...", id.segment, id.lane, zone().id,
                                 zone().id, zone().id));
  claim(id, "spot");
  RndfSpot spot;
  spot.number = id.lane;
  spot.line = now().line;
  zone().spots.push_back(std::move(spot));
  open(RndfBlock::spot, fmt::format("spot {}.{}", id.segment, id.lane));
}

void RndfReader::end_file() {
  statements_.expect_fields(0);
  check_name();
  close();
  ended_ = true;
}

std::vector<RndfPoint>& RndfReader::points() {
  switch (open_.back().block) {
    case RndfBlock::lane:
      return lane().points;
    case RndfBlock::perimeter:
      return zone().perimeter;
    case RndfBlock::spot:
      return spot().points;
    default:
      break;
  }
  statements_.fail(fmt::format("{} is in {}; expected way-points only in lanes, perimeters and spots",
                               quoted(now().keyword), open_.back().name));
}

/// Returns the common first parts of ids in the innermost block.
PointId RndfReader::key_of_block() const {
  const RndfBlock block = open_.back().block;
  if (block == RndfBlock::lane) return key(rndf_.segments.back().id, rndf_.segments.back().lanes.back().number);
  return key(rndf_.zones.back().id, block == RndfBlock::spot ? rndf_.zones.back().spots.back().number : 0);
}

// Checks that an id belongs to the block that contains its line.
PointId RndfReader::own(PointId id, std::string_view what) const {
  const PointId here = key_of_block();
  if (id.segment == here.segment && id.lane == here.lane && id.point > 0) return id;
  statements_.fail(fmt::format("{} {} is in {}; expected {}.{}.1, {}.{}.2, ...", what, point_id_text(id),
                               open_.back().name, here.segment, here.lane, here.segment, here.lane));
}

// Same, but accepts an id of a neighbouring block, since its meaning is unambiguous. check_references later checks
// whether the point exists.
PointId RndfReader::own_or_known(PointId id, std::string_view what) {
  const PointId here = key_of_block();
  if (diagnostics_.strict() || id.point == 0 || (id.segment == here.segment && id.lane == here.lane))
    return own(id, what);
  diagnostics_.add_warning(now().line, fmt::format("{} {} is in {}", what, point_id_text(id), open_.back().name), "",
                           fmt::format("it is assigned to {}.{}", id.segment, id.lane));
  return id;
}

void RndfReader::waypoint() {
  std::vector<RndfPoint>& row = points();
  const PointId id = statements_.keyword_point("the way-point");
  unread_.insert(id);
  const RndfPoint point{own(id, "way-point"), statements_.decimal(0, "the latitude"),
                        statements_.decimal(1, "the longitude"), now().line};
  statements_.expect_fields(2);
  if (std::abs(point.latitude) > 90.0)
    statements_.fail(fmt::format("the latitude is {}; expected degrees from -90 to 90", quoted(now().fields[0])));
  if (std::abs(point.longitude) > 180.0)
    statements_.fail(fmt::format("the longitude is {}; expected degrees from -180 to 180", quoted(now().fields[1])));
  claim(point.id, "way-point");
  const int expected = row.empty() ? 1 : row.back().id.point + 1;
  if (point.id.point < expected)
    statements_.fail(fmt::format("way-point {} follows {}; expected them in driving direction, 1, 2, 3, ...",
                                 point_id_text(point.id), point_id_text(row.back().id)));
  if (point.id.point > expected && open_.back().seen.emplace("gap", "").second)
    warn(now().line, fmt::format("way-point {} found where {} was expected; numbers are missing",
                                 point_id_text(point.id), expected));
  row.push_back(point);
  unread_.erase(id);
}

void RndfReader::read_boundary(Boundary& boundary) {
  const auto read = now().fields.empty() ? std::nullopt : boundary_of(now().fields[0]);
  const std::string what = fmt::format("'{}' is {}", now().keyword, quoted(now().rest));
  const std::string remedy = fmt::format("expected one of {}", boundary_words());
  if (now().fields.empty()) return diagnostics_.add_warning(now().line, what, remedy, "assuming no marking");
  if (!read) statements_.fail(what + "; " + remedy);
  statements_.expect_fields(1);
  boundary = *read;
}

// Some files contain 0 for an unknown width.
void RndfReader::read_width(std::optional<double>& width_ft) {
  if (now().fields.empty()) return;
  const double feet = statements_.decimal(0, "the width");
  statements_.expect_fields(1);
  if (feet < 0.0 || feet > kMaxRoadNumber)
    statements_.fail(
        fmt::format("the width is {}; expected feet from 0 to {}", quoted(now().fields[0]), kMaxRoadNumber));
  if (feet > 0.0) width_ft = feet;
}

void RndfReader::read_exit() {
  const RndfExit exit{own_or_known(statements_.point(0, "the exit"), "exit"),
                      statements_.point(1, "the entry of this exit"), now().line};
  statements_.expect_fields(2);
  const auto [old, fresh] = exits_.emplace(std::pair(exit.from, exit.to), exit.line);
  if (!fresh)
    return diagnostics_.add_warning(now().line,
                                    fmt::format("exit {} to {} is already in line {}", point_id_text(exit.from),
                                                point_id_text(exit.to), old->second),
                                    "expected it once", "it is used once");
  (open_.back().block == RndfBlock::lane ? lane().exits : zone().exits).push_back(exit);
}

void RndfReader::read_stop() {
  const RndfStop stop{own_or_known(statements_.point(0, "the stop"), "stop"), now().line};
  statements_.expect_fields(1);
  if (!stops_.insert(stop.at).second)
    return diagnostics_.add_warning(now().line, fmt::format("stop {} is given twice", point_id_text(stop.at)),
                                    "expected it once", "it is used once");
  lane().stops.push_back(stop);
}

void RndfReader::read_checkpoint() {
  const PointId at = own_or_known(statements_.point(0, "the checkpoint's way-point"), "checkpoint");
  const RndfCheckpoint checkpoint{statements_.whole(1, 1, "the checkpoint's id"), at, now().line};
  statements_.expect_fields(2);
  const auto [old, fresh] = checkpoints_.emplace(checkpoint.id, checkpoint);
  if (!fresh) {
    const std::string what = fmt::format("checkpoint {} is already in line {}", checkpoint.id, old->second.line);
    if (old->second.at != at) statements_.fail(what + "; expected a unique id");
    return diagnostics_.add_warning(now().line, what, "expected a unique id", "it is used once");
  }
  (open_.back().block == RndfBlock::lane ? lane().checkpoints : spot().checkpoints).push_back(checkpoint);
}

}  // namespace sf::world
