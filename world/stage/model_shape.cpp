#include "world/stage/model_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "base/error.h"
#include "world/stage/polygon.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kMaxPoints = 2'000;
constexpr double kMaxCornerPairs = 1e8;  // over all blocks; the self-intersection check of a polygon is quadratic
constexpr double kBoundary = 0.01;       // [m] thickness of the walls added by `boundary 1`

struct Block {
  std::vector<glm::dvec2> points;
  double z_min = 0.0;
  double z_max = 1.0;
};

/// @return whether the point exists
bool read_point(StageContext& context, const Entity& entity, const std::string& key, glm::dvec2& out) {
  const auto point = tuple(context, entity, key, 2, "[x y]");
  if (!point) return false;
  const SourceLocation at = find(entity, key)->at;
  out = {to_metres(context, at, (*point)[0]), to_metres(context, at, (*point)[1])};
  return true;
}

/// @param prefix empty for `block( ... )`, `block[2].` for the older form inside the model
Block read_block(StageContext& context, const Entity& entity, const std::string& prefix) {
  Block block;
  if (find(entity, prefix + "points") == nullptr) {
    fail(context, entity.at, fmt::format("'{}points' is missing; expected the number of corners", prefix));
  }
  const std::uint32_t count = whole(context, entity, prefix + "points", 0, 2, kMaxPoints);
  block.points.resize(count);
  std::vector<std::string> missing;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::string key = fmt::format("{}point[{}]", prefix, i);
    if (!read_point(context, entity, key, block.points[i])) missing.push_back(std::move(key));
  }
  if (!missing.empty())
    warn(context, entity.at,
         fmt::format("'{}'{} of this '{}' is missing: [0 0] is used, as in Stage", missing[0],
                     missing.size() > 1 ? fmt::format(" (and {} more)", missing.size() - 1) : "", entity.word));
  const std::string beyond = fmt::format("{}point[{}]", prefix, count);
  if (const Property* extra = find(entity, beyond)) {
    warn(context, extra->at, fmt::format("'{}' is not used: 'points' is {}", beyond, count));
  }
  if (const auto z = tuple(context, entity, prefix + "z", 2, "[min max]")) {
    const SourceLocation at = find(entity, prefix + "z")->at;
    block.z_min = to_metres(context, at, (*z)[0]);
    block.z_max = to_metres(context, at, (*z)[1]);
    if (block.z_max < block.z_min) fail(context, at, "'z' expects [min max] with min not above max");
  } else if (prefix.empty()) {
    warn(context, entity.at, "this block has no 'z': it is read as [0 1]; Stage 4 gives it no height");
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

/// The bounding box of a body.
struct Span {
  glm::dvec2 low{HUGE_VAL, HUGE_VAL};
  glm::dvec2 high{-HUGE_VAL, -HUGE_VAL};
  double bottom = HUGE_VAL, top = 0.0;  ///< [m]

  Size size() const { return {high.x - low.x, high.y - low.y, top}; }
  void add(glm::dvec2 p) { low = glm::min(low, p), high = glm::max(high, p); }
  void add(double z_min, double z_max) { bottom = std::min(bottom, z_min), top = std::max(top, z_max); }
};

Span span_of(const std::vector<Block>& blocks) {
  Span span;
  for (const Block& block : blocks) {
    for (const glm::dvec2& p : block.points) span.add(p);
    span.add(block.z_min, block.z_max);
  }
  return span;
}

// Scales the whole body: its bounding box becomes size.x by size.y about the origin, and its greatest height size.z. An
// extent of zero stays zero.
struct Scale {
  Span span;
  Size size;

  static double scaled(double value, double from, double to, double target) {
    return to > from ? ((value - from) / (to - from) - 0.5) * target : 0.0;
  }
  void apply(glm::dvec2& p) const {
    p = {scaled(p.x, span.low.x, span.high.x, size.x), scaled(p.y, span.low.y, span.high.y, size.y)};
  }
  void apply(double& z_min, double& z_max) const {
    if (span.top <= 0.0) return;
    z_min *= size.z / span.top;
    z_max *= size.z / span.top;
  }
  void apply(std::vector<Segment>& segments) const {
    for (Segment& s : segments) apply(s.a), apply(s.b), apply(s.z_min, s.z_max);
  }
};

// Stage 4 divides by the blocks' own height, and so raises them above `size`.
void warn_raised(StageContext& context, const Entity& entity, const Span& span, const Size& size) {
  if (span.bottom == 0.0 || span.top <= span.bottom || span.top <= 0.0) return;
  const double ours = size.z / span.top, stages = size.z / (span.top - span.bottom);
  warn(context, entity.at,
       fmt::format(
           "the blocks of '{}' do not begin at z 0: they reach from {:.4g} to {:.4g} m, in Stage 4 from {:.4g} to "
           "{:.4g} m",
           entity.word, ours * span.bottom, ours * span.top, stages * span.bottom, stages * span.top));
}

/// Warns about blocks that appear to be in metres: without a size they become a box of 10 cm.
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

// Adds a frame around the model: the outer faces of four walls, and the inner faces, which point inwards.
void append_boundary(std::vector<Segment>& segments, const Size& size) {
  append(segments, rectangle(size.x, size.y), 0.0, size.z);
  if (size.x <= 2 * kBoundary || size.y <= 2 * kBoundary) return;
  const std::size_t inner = segments.size();
  append(segments, rectangle(size.x - 2 * kBoundary, size.y - 2 * kBoundary), 0.0, size.z);
  for (std::size_t i = inner; i < segments.size(); ++i) std::swap(segments[i].a, segments[i].b);
}

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

/// The parts of a body other than its blocks.
struct Parts {
  bool bitmap = false;
  bool boundary = false;
  bool noblocks = false;  ///< no default box

  bool any() const { return bitmap || boundary; }
};

// Stage creates the box, bitmap and boundary of a model before it reads its blocks. The first block replaces the box
// and the boundary around it.
void warn_of_parts(StageContext& context, const Entity& entity, const Parts& parts, bool has_blocks) {
  if (parts.noblocks && (parts.any() || has_blocks))
    warn(context, location_of(entity, "noblocks"),
         fmt::format("'noblocks' removes only the default box, as in Stage: the {} of '{}' stays; the world key "
                     "old_shapes 1 removes everything",
                     parts.bitmap     ? "bitmap"
                     : parts.boundary ? "boundary"
                                      : "block",
                     entity.word));
  if (parts.boundary && has_blocks && !parts.bitmap && !parts.noblocks)
    warn(context, location_of(entity, "boundary"),
         fmt::format("'{}' has a boundary and blocks: Stage omits the boundary, the farm keeps both", entity.word));
  if (has_blocks && (parts.bitmap || (parts.boundary && parts.noblocks)))
    warn(context, location_of(entity, parts.bitmap ? "bitmap" : "boundary"),
         fmt::format("'{}' also has blocks: their points are in metres from its middle, as in Stage; the world key "
                     "old_shapes 1 scales them to 'size'",
                     entity.word));
}

/// Returns the scale of a body's blocks. @param fills other parts fill `size`: all form one body in metres
Scale scale_of(StageContext& context, const Entity& entity, const std::vector<Block>& blocks, bool fills,
               const Size& size) {
  Scale scale{span_of(blocks), size};
  if (blocks.empty()) return scale;
  if (!fills) warn_unsized(context, entity, scale.span, size);
  if (fills) {
    scale.span.add({-size.x / 2, -size.y / 2});
    scale.span.add({size.x / 2, size.y / 2});
    scale.span.add(0.0, size.z);
  }
  warn_raised(context, entity, scale.span, size);
  return scale;
}

}  // namespace

std::vector<Segment> shape_of(StageContext& context, BitmapCache& bitmaps, const Entity& entity, const Size& size,
                              bool is_box) {
  const Parts parts{find(entity, "bitmap") != nullptr, flag(context, entity, "boundary", false),
                    flag(context, entity, "noblocks", false)};
  if (parts.noblocks && context.old_shapes) return {};
  std::vector<Block> blocks = read_blocks(context, entity);
  if (parts.bitmap && (size.x <= 0.0 || size.y <= 0.0))
    fail(context, find(entity, "bitmap")->at, "a bitmap requires a 'size' above zero in x and y");
  const TracedBitmap* plan = parts.bitmap ? &bitmap_of(context, bitmaps, entity) : nullptr;
  count_segments(context, entity, plan != nullptr ? plan->runs.size() : 0, blocks);
  if (!context.old_shapes) warn_of_parts(context, entity, parts, !blocks.empty());

  if (plan != nullptr) warn_of_picture(context, entity, *plan, size);

  const bool fills = !context.old_shapes && (parts.bitmap || (parts.boundary && parts.noblocks));
  const Scale scale = scale_of(context, entity, blocks, fills, size);
  std::vector<Segment> segments, boundary;
  if (plan != nullptr) segments = bitmap_segments(*plan, part_of(context, *plan), size);
  if (parts.boundary) append_boundary(boundary, size);
  if (fills && !blocks.empty()) scale.apply(segments), scale.apply(boundary);
  for (Block& block : blocks) {
    for (glm::dvec2& p : block.points) scale.apply(p);
    scale.apply(block.z_min, block.z_max);
    append(segments, block.points, block.z_min, block.z_max);
  }
  segments.insert(segments.end(), boundary.begin(), boundary.end());
  if (is_box && !parts.noblocks && !parts.any() && blocks.empty())
    append(segments, rectangle(size.x, size.y), 0.0, size.z);

  const auto vanished = [](const Segment& s) { return s.a.x == s.b.x && s.a.y == s.b.y; };
  segments.erase(std::remove_if(segments.begin(), segments.end(), vanished), segments.end());
  return segments;
}

Size size_of(StageContext& context, const Entity& entity, const Size& fallback) {
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
