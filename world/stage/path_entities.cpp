#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "world/arc.h"
#include "world/path_geometry.h"
#include "world/stage/magnet_row.h"
#include "world/stage/road_entities.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kMaxPieces = 10'000;
constexpr int kMaxDashes = 1'000'000;
constexpr double kMaxPaintPoints = 4e6;  // points of the lane markings of all paths

PathPiece read_straight(const StageContext& context, const Property& property) {
  const auto& v = property.values;
  if (v.size() < 2 || v[0].is_text || v[1].is_text)
    fail(context, property.at, fmt::format("'{}' expects [length width]", property.key));
  return {{}, to_metres(context, property.at, v[0].number), 0.0, to_metres(context, property.at, v[1].number)};
}

PathPiece read_arc(const StageContext& context, const Property& property) {
  const auto& v = property.values;
  if (v.size() < 3 || v[0].is_text || v[1].is_text || v[2].is_text)
    fail(context, property.at, fmt::format("'{}' expects [radius turn width]", property.key));
  const double radius = to_metres(context, property.at, v[0].number);
  const double turn = context.radians_per_unit * v[1].number;
  const double width = to_metres(context, property.at, v[2].number);
  if (!(radius > 0.0) || !(std::abs(turn) <= 2.0 * std::numbers::pi * (1.0 + 1e-12)))
    fail(context, property.at, fmt::format("'{}' expects a radius above zero and at most one turn", property.key));
  if (!(width < 2.0 * radius))
    fail(context, property.at,
         fmt::format("'{}' is wider than its bend: expected a width below twice the radius", property.key));
  return {{}, radius * std::abs(turn), std::copysign(1.0 / radius, turn), width};
}

std::vector<PathPiece> read_pieces(BuildState& b, const Entity& entity) {
  StageContext& context = b.context;
  const std::uint32_t count = whole(context, entity, "pieces", 0, 1, kMaxPieces);
  if (count == 0) fail(context, entity.at, "a path requires 'pieces', and a straight[i] or an arc[i] for each");
  std::vector<PathPiece> pieces;
  Pose X = pose(b.context, entity, "pose");
  for (std::uint32_t i = 0; i < count; ++i) {
    const Property* straight = find(entity, fmt::format("straight[{}]", i));
    const Property* arc = find(entity, fmt::format("arc[{}]", i));
    if ((straight == nullptr) == (arc == nullptr))
      fail(context, find(entity, "pieces")->at,
           fmt::format("expected either straight[{0}] or arc[{0}]: 'pieces' is {1}", i, count));
    PathPiece piece = straight != nullptr ? read_straight(context, *straight) : read_arc(context, *arc);
    if (!(piece.length > 0.0) || !(piece.width > 0.0))
      fail(context, (straight != nullptr ? straight : arc)->at, "expected a length and a width above zero");
    piece.X_WP = X;
    X = pose_at(piece, piece.length);
    pieces.push_back(piece);
  }
  return pieces;
}

/// The lane marking on one side of the lane.
struct Paint {
  std::uint32_t color = 0xFFFFFFFFu;
  double width = 0.0;  ///< [m]
  double dash = 0.0;   ///< [m] along the centre line; 0: solid
  double gap = 0.0;    ///< [m]
  bool twice = false;  ///< two lines, one line width apart
  bool none = true;
};

Paint read_paint(StageContext& context, const Entity& entity, const char* side) {
  constexpr std::uint32_t kYellow = 0xFFFFCC00u;
  Paint paint;
  const std::string word = text(context, entity, side, "none");
  paint.none = word == "none";
  if (paint.none) return paint;
  paint.width = above_zero(context, entity, "paint_width", 0.02);
  if (word == "double_yellow" || word == "solid_yellow") {
    paint.color = kYellow;
    paint.twice = word == "double_yellow";
  } else if (word == "broken_white") {
    const auto dash = tuple(context, entity, "dash", 2, "[length gap]").value_or(std::vector<double>{0.1, 0.1});
    paint.dash = context.metres_per_unit * dash[0];
    paint.gap = context.metres_per_unit * dash[1];
    if (!(paint.dash > 0.0) || !(paint.gap > 0.0))
      fail(context, find(entity, "dash")->at, "'dash' expects two lengths above zero: [length gap]");
  } else if (word != "solid_white") {
    fail(context, find(entity, side)->at,
         fmt::format("'{}' is \"{}\"; expected \"double_yellow\", \"solid_yellow\", \"solid_white\", \"broken_white\" "
                     "or \"none\"",
                     side, word));
  }
  return paint;
}

/// Returns the number of chords within `kArcError` of an arc at `offset` to the left of its centre line.
double chords_of(const PathPiece& piece, double length, double offset, const Paint& paint) {
  if (piece.curvature == 0.0) return 1.0;
  const double outer = 1.0 / std::abs(piece.curvature) + std::abs(offset) + paint.width;
  return chord_count(outer, length * std::abs(piece.curvature), kArcError);
}

/// Returns the marking between `from` and `to` along the centre line [m], `offset` to its left.
LaneMarking marking_of(const PathPiece& piece, double from, double to, double offset, const Paint& paint) {
  LaneMarking marking{{}, paint.width, paint.color};
  const auto chords = static_cast<std::uint32_t>(chords_of(piece, to - from, offset, paint));
  for (std::uint32_t i = 0; i <= chords; ++i)
    marking.line.push_back(transform(pose_at(piece, from + (to - from) * i / chords), {0.0, offset}));
  return marking;
}

/// Paints one side of a piece. Dashes continue across pieces: `start` is the distance of the piece's start along the
/// path.
void paint_edge(World& world, const PathPiece& piece, double start, double offset, const Paint& paint) {
  if (paint.dash == 0.0) {
    world.lane_markings.push_back(marking_of(piece, 0.0, piece.length, offset, paint));
    return;
  }
  const double period = paint.dash + paint.gap;
  for (double k = std::floor(start / period);; ++k) {
    const double from = std::max(0.0, k * period - start);
    const double to = std::min(piece.length, k * period + paint.dash - start);
    if (from >= piece.length) return;
    if (to - from > kArcError) world.lane_markings.push_back(marking_of(piece, from, to, offset, paint));
  }
}

void check_dashes(StageContext& context, const Entity& entity, const char* side, const Paint& paint, double total) {
  if (paint.none || paint.dash == 0.0 || total / (paint.dash + paint.gap) <= kMaxDashes) return;
  const bool said = find(entity, "dash") != nullptr;
  fail(context, location_of(entity, said ? "dash" : side),
       fmt::format("{} gives more than {} dashes; expected longer ones{}",
                   said ? "'dash'" : fmt::format("'{}' without a 'dash'", side), kMaxDashes,
                   said ? "" : ": dash [length gap]"));
}

/// Charges the points of one side's markings before they are created. An arc is counted by its chords.
void count_paint(StageContext& context, const Entity& entity, const Path& path, const Paint& paint) {
  if (paint.none) return;
  for (std::size_t i = 0; i < path.pieces.size(); ++i) {
    const PathPiece& piece = path.pieces[i];
    const double dashes = paint.dash > 0.0 ? std::ceil(piece.length / (paint.dash + paint.gap)) + 1.0 : 1.0;
    const double points = chords_of(piece, piece.length, 0.5 * piece.width + 2.5 * paint.width, paint) + 2.0 * dashes;
    const std::string key = fmt::format("{}[{}]", piece.curvature == 0.0 ? "straight" : "arc", i);
    charge(context, location_of(entity, key), context.usage.paint_points, (paint.twice ? 2.0 : 1.0) * points,
           kMaxPaintPoints, "points of paint along paths",
           "give '" + key + "' a smaller radius, a shorter path, longer dashes or no paint");
  }
}

void paint_side(World& world, const PathPiece& piece, double start, double side, const Paint& paint) {
  if (paint.none) return;
  const double middle = 0.5 * (piece.width + paint.width);
  paint_edge(world, piece, start, side * middle, paint);
  if (paint.twice) paint_edge(world, piece, start, side * (middle + 2.0 * paint.width), paint);
}

}  // namespace

void add_path(BuildState& b, const Entity& entity) {
  check_keys(b.context, entity, KeyScope::path);
  Path path{"", read_pieces(b, entity)};
  const Paint left = read_paint(b.context, entity, "left");
  const Paint right = read_paint(b.context, entity, "right");
  Model model;
  model.name = text(b.context, entity, "name", "path");
  model.name = free_name(b, model.name);
  model.type = "path";
  model.X_WM = path.pieces.front().X_WP;
  path.name = model.name;
  b.world.models.push_back(model);
  const double total = length_of(path);
  for (const auto& [side, paint] : {std::pair("left", &left), std::pair("right", &right)}) {
    check_dashes(b.context, entity, side, *paint, total);
    count_paint(b.context, entity, path, *paint);
  }
  double start = 0.0;
  for (const PathPiece& piece : path.pieces) {
    paint_side(b.world, piece, start, 1.0, left);
    paint_side(b.world, piece, start, -1.0, right);
    start += piece.length;
  }
  if (const auto row = read_magnet_row(b.context, entity))
    place_magnets(b, entity, *row, total, [&](double s) { return pose_at(path, s); });
  b.world.paths.push_back(std::move(path));
}

}  // namespace sf::world
