#include "world/stage/model_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "world/picture.h"
#include "world/stage/polygon.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kMaxPoints = 2'000;
constexpr double kMaxCornerPairs = 1e8;  // of all blocks; the self-intersection check of a polygon is quadratic
constexpr std::size_t kMaxRuns = 2'000'000;
constexpr double kMaxSegments = kMaxRuns;
constexpr double kBoundary = 0.01;  // [m] thickness of the walls that `boundary 1` adds

struct Block {
  std::vector<glm::dvec2> points;
  double z_min = 0.0;
  double z_max = 1.0;
};

glm::dvec2 read_point(const StageContext& context, const Entity& entity, const std::string& key) {
  const auto point = tuple(context, entity, key, 2, "[x y]");
  if (!point) fail(context, entity.at, fmt::format("'{}' of this '{}' is missing", key, entity.word));
  const SourceLocation at = find(entity, key)->at;
  return {to_metres(context, at, (*point)[0]), to_metres(context, at, (*point)[1])};
}

/// @param prefix empty for `block( ... )`, `block[2].` for the older form inside the model.
Block read_block(StageContext& context, const Entity& entity, const std::string& prefix) {
  Block block;
  if (find(entity, prefix + "points") == nullptr) {
    fail(context, entity.at, fmt::format("'{}points' is missing; expected the number of corners", prefix));
  }
  const std::uint32_t count = whole(context, entity, prefix + "points", 0, 2, kMaxPoints);
  for (std::uint32_t i = 0; i < count; ++i) {
    block.points.push_back(read_point(context, entity, fmt::format("{}point[{}]", prefix, i)));
  }
  const std::string beyond = fmt::format("{}point[{}]", prefix, count);
  if (const Property* extra = find(entity, beyond)) {
    warn(context, extra->at, fmt::format("'{}' is not used: 'points' says {}", beyond, count));
  }
  if (const auto z = tuple(context, entity, prefix + "z", 2, "[min max]")) {
    const SourceLocation at = find(entity, prefix + "z")->at;
    block.z_min = to_metres(context, at, (*z)[0]);
    block.z_max = to_metres(context, at, (*z)[1]);
    if (block.z_max < block.z_min) fail(context, at, "'z' expects [min max] with min not above max");
  }
  return block;
}

std::vector<Block> read_blocks(StageContext& context, const Entity& entity) {
  std::vector<Block> blocks;
  const std::uint32_t old_form = whole(context, entity, "blocks", 0, 0, kMaxPoints);
  for (std::uint32_t i = 0; i < old_form; ++i)
    blocks.push_back(read_block(context, entity, fmt::format("block[{}].", i)));
  for (const Entity& child : entity.children) {
    if (child.type == "block") blocks.push_back(read_block(context, child, ""));
  }
  return blocks;
}

/// The bounding box of all blocks of a model.
struct Span {
  glm::dvec2 low{HUGE_VAL, HUGE_VAL};
  glm::dvec2 high{-HUGE_VAL, -HUGE_VAL};
  double top = 0.0;  ///< [m]

  Size size() const { return {high.x - low.x, high.y - low.y, top}; }
};

Span span_of(const std::vector<Block>& blocks) {
  Span span;
  for (const Block& block : blocks) {
    for (const glm::dvec2& p : block.points) {
      span.low = {std::min(span.low.x, p.x), std::min(span.low.y, p.y)};
      span.high = {std::max(span.high.x, p.x), std::max(span.high.y, p.y)};
    }
    span.top = std::max(span.top, block.z_max);
  }
  return span;
}

// All blocks of a model are scaled together: their bounding box becomes size.x by size.y about the origin, their
// greatest height size.z. An extent of zero stays zero.
void scale_to(std::vector<Block>& blocks, const Span& span, const Size& size) {
  const auto scaled = [](double value, double from, double to, double target) {
    return to > from ? ((value - from) / (to - from) - 0.5) * target : 0.0;
  };
  for (Block& block : blocks) {
    for (glm::dvec2& p : block.points)
      p = {scaled(p.x, span.low.x, span.high.x, size.x), scaled(p.y, span.low.y, span.high.y, size.y)};
    if (span.top <= 0.0) continue;
    block.z_min *= size.z / span.top;
    block.z_max *= size.z / span.top;
  }
}

/// Warns about blocks that seem to be in metres: without a size they become a box of 10 cm.
void warn_unsized(StageContext& context, const Entity& entity, const Span& span, const Size& size) {
  const Size written = span.size();
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-3 * b; };
  if (find(entity, "size") != nullptr || (near(written.x, size.x) && near(written.y, size.y))) return;
  const double unit = context.metres_per_unit;
  warn(context, entity.at,
       fmt::format("'{}' has blocks of {:.4g} x {:.4g} m but no 'size': they are scaled to {:g} x {:g} x {:g} m; write "
                   "size [{:.6g} {:.6g} {:.6g}] for the size of the blocks",
                   entity.word, written.x, written.y, size.x, size.y, size.z, written.x / unit, written.y / unit,
                   written.z / unit));
}

void append(std::vector<Segment>& segments, const std::vector<glm::dvec2>& points, double z_min, double z_max) {
  const Polygon outline = make_polygon(points);
  for (const PolygonEdge& edge : outline.edges) {
    Segment segment;
    segment.a = edge.a;
    segment.b = edge.b;
    segment.z_min = z_min;
    segment.z_max = z_max;
    segment.solid_left = outline.solid_left;
    segments.push_back(segment);
  }
}

std::vector<glm::dvec2> rectangle(double x, double y) {
  return {{-x / 2, -y / 2}, {x / 2, -y / 2}, {x / 2, y / 2}, {-x / 2, y / 2}};
}

// A frame around the model: the outer faces of four walls and the inner faces, which point inwards.
void append_boundary(std::vector<Segment>& segments, const Size& size) {
  append(segments, rectangle(size.x, size.y), 0.0, size.z);
  if (size.x <= 2 * kBoundary || size.y <= 2 * kBoundary) return;
  const std::size_t inner = segments.size();
  append(segments, rectangle(size.x - 2 * kBoundary, size.y - 2 * kBoundary), 0.0, size.z);
  for (std::size_t i = inner; i < segments.size(); ++i) std::swap(segments[i].a, segments[i].b);
}

// Stage's rule: dark is solid. Transparent is free. The picture's top row is the plan's far (+y) edge. Converted in
// place, since plans are large.
Bitmap grid_of(Picture picture) {
  std::vector<std::uint8_t>& cells = picture.value;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool opaque = picture.opaque.empty() || picture.opaque[i] != 0;
    cells[i] = opaque && cells[i] <= 127 ? 1 : 0;
  }
  const auto row = [&](std::uint32_t y) { return cells.begin() + static_cast<std::ptrdiff_t>(y) * picture.width; };
  for (std::uint32_t y = 0; y < picture.height / 2; ++y)
    std::swap_ranges(row(y), row(y + 1), row(picture.height - 1 - y));
  return {picture.width, picture.height, std::move(cells)};
}

const TracedBitmap& bitmap_of(StageContext& context, BitmapCache& bitmaps, const Entity& entity) {
  const SourceLocation at = find(entity, "bitmap")->at;
  const std::string file = file_of(context, entity, "bitmap");
  auto& traced = bitmaps[file];
  try {
    if (!traced) traced = trace_bitmap(grid_of(read_picture(file, Channel::first)), file);
  } catch (const base::InputError& error) {
    fail(context, at, fmt::format("'bitmap': {}", error.what()));
  }
  return *traced;
}

}  // namespace

std::shared_ptr<const TracedBitmap> trace_bitmap(Bitmap grid, const std::string& file) {
  std::vector<BoundaryRun> runs = trace_boundary(grid, kMaxRuns);
  if (runs.size() > kMaxRuns) {
    throw base::InputError(file, 0,
                           fmt::format("an outline of more than {} straight pieces; expected a floor plan, not a "
                                       "photograph or noise: smooth the picture, or make it smaller",
                                       kMaxRuns));
  }
  return std::make_shared<const TracedBitmap>(TracedBitmap{{grid.width, grid.height, {}}, std::move(runs)});
}

double pixel_of(StageContext& context, BitmapCache& bitmaps, const Entity& entity, const Size& size) {
  if (find(entity, "bitmap") == nullptr) return 0.0;
  const Bitmap& grid = bitmap_of(context, bitmaps, entity).grid;
  return std::max(size.x / grid.width, size.y / grid.height);
}

std::vector<Segment> bitmap_segments(const TracedBitmap& traced, const Size& size) {
  std::vector<Segment> segments(traced.runs.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    segments[i].a = corner_position(traced.grid, traced.runs[i].a, size.x, size.y);
    segments[i].b = corner_position(traced.grid, traced.runs[i].b, size.x, size.y);
    segments[i].z_max = size.z;
  }
  return segments;
}

namespace {

/// Charges the body's segments before they are created.
void count_segments(StageContext& context, const Entity& entity, std::size_t runs, const std::vector<Block>& blocks) {
  double segments = static_cast<double>(runs) + 8.0;  // a boundary, or a box
  double pairs = 0.0;
  for (const Block& block : blocks) {
    const auto corners = static_cast<double>(block.points.size());
    segments += corners;
    pairs += 0.5 * corners * corners;
  }
  const char* remedy = "leave out models, or give them simpler outlines";
  charge(context, entity.at, context.usage.segments, segments, kMaxSegments, "segments", remedy);
  charge(context, entity.at, context.usage.corner_pairs, pairs, kMaxCornerPairs, "pairs of edges in blocks", remedy);
}

}  // namespace

std::vector<Segment> shape_of(StageContext& context, BitmapCache& bitmaps, const Entity& entity, const Size& size,
                              bool is_box) {
  std::vector<Segment> segments;
  if (flag(context, entity, "noblocks", false)) return segments;
  const bool has_bitmap = find(entity, "bitmap") != nullptr;
  const bool has_boundary = flag(context, entity, "boundary", false);
  std::vector<Block> blocks = read_blocks(context, entity);

  if (has_bitmap && (size.x <= 0.0 || size.y <= 0.0)) {
    fail(context, find(entity, "bitmap")->at, "a bitmap needs a 'size' above zero in x and y");
  }
  const TracedBitmap* plan = has_bitmap ? &bitmap_of(context, bitmaps, entity) : nullptr;
  count_segments(context, entity, plan != nullptr ? plan->runs.size() : 0, blocks);
  if (plan != nullptr) {
    segments = bitmap_segments(*plan, size);
    if (find(entity, "size") == nullptr)
      warn(context, find(entity, "bitmap")->at,
           fmt::format("'{}' shows a picture of {} x {} pixels but has no 'size': it is {:g} x {:g} m; write size "
                       "[x y z] of the whole picture",
                       entity.word, plan->grid.width, plan->grid.height, size.x, size.y));
  }
  const Span span = span_of(blocks);
  if (!blocks.empty()) warn_unsized(context, entity, span, size);
  scale_to(blocks, span, size);
  for (const Block& block : blocks) append(segments, block.points, block.z_min, block.z_max);
  if (has_boundary) append_boundary(segments, size);
  if (is_box && !has_bitmap && !has_boundary && blocks.empty())
    append(segments, rectangle(size.x, size.y), 0.0, size.z);

  const auto vanished = [](const Segment& s) { return s.a.x == s.b.x && s.a.y == s.b.y; };
  segments.erase(std::remove_if(segments.begin(), segments.end(), vanished), segments.end());
  return segments;
}

Size size_of(const StageContext& context, const Entity& entity, const Size& fallback) {
  const auto values = tuple(context, entity, "size", 2, "[x y z]");
  if (!values) return fallback;
  const SourceLocation at = find(entity, "size")->at;
  const auto& v = *values;
  const Size size{to_metres(context, at, v[0]), to_metres(context, at, v[1]),
                  v.size() > 2 ? to_metres(context, at, v[2]) : fallback.z};
  if (size.x < 0.0 || size.y < 0.0 || size.z < 0.0) fail(context, at, "'size' expects lengths that are not negative");
  return size;
}

}  // namespace sf::world
