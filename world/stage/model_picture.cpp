#include "world/stage/model_picture.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "world/picture.h"

namespace sf::world {

namespace {

constexpr std::size_t kMaxRuns = 2'000'000;

// Dark pixels are solid, as in Stage. Transparent pixels are free, unlike in Stage.
TracedBitmap trace_plan(const std::string& file) {
  std::size_t hidden = 0;
  const SolidRule rule = [&](const PixelRow& row, std::uint8_t* solid) {
    for (std::size_t i = 0; i < row.rgba.size(); i += 4, ++solid) {
      const bool dark = row.rgba[i] <= 127;
      *solid = dark && row.rgba[i + 3] >= 128 ? 1 : 0;
      hidden += dark && *solid == 0 ? 1 : 0;
    }
  };
  TracedBitmap traced = trace_bitmap(read_bitmap(file, rule), file);
  traced.hidden = hidden;
  return traced;
}

}  // namespace

PicturePart whole_of(const Bitmap& grid) { return {{}, {grid.width, grid.height}}; }

TracedBitmap trace_bitmap(Bitmap grid, const std::string& file) {
  std::vector<BoundaryRun> runs = trace_boundary(grid, kMaxRuns);
  if (runs.size() > kMaxRuns) {
    throw base::InputError(file, 0,
                           fmt::format("an outline of more than {} straight pieces; expected a floor plan, not a "
                                       "photograph or noise: smooth the picture, or make it smaller",
                                       kMaxRuns));
  }
  PicturePart solid = whole_of(grid);
  if (!runs.empty()) solid = {{grid.width, grid.height}, {}};
  for (const BoundaryRun& run : runs)
    for (const Corner& corner : {run.a, run.b}) {
      solid.low = {std::min(solid.low.i, corner.i), std::min(solid.low.j, corner.j)};
      solid.high = {std::max(solid.high.i, corner.i), std::max(solid.high.j, corner.j)};
    }
  return {{grid.width, grid.height, {}}, std::move(runs), solid};
}

double pixel_of(StageContext& context, BitmapCache& bitmaps, const Entity& entity, const Size& size) {
  if (find(entity, "bitmap") == nullptr) return 0.0;
  const auto [low, high] = part_of(context, bitmap_of(context, bitmaps, entity));
  return std::max(size.x / (high.i - low.i), size.y / (high.j - low.j));
}

std::vector<Segment> bitmap_segments(const TracedBitmap& traced, const PicturePart& part, const Size& size) {
  std::vector<Segment> segments(traced.runs.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    segments[i].a = corner_position(part, traced.runs[i].a, size.x, size.y);
    segments[i].b = corner_position(part, traced.runs[i].b, size.x, size.y);
    segments[i].z_max = size.z;
  }
  return segments;
}

const TracedBitmap& bitmap_of(StageContext& context, BitmapCache& bitmaps, const Entity& entity) {
  const SourceLocation at = find(entity, "bitmap")->at;
  const std::string file = file_of(context, entity, "bitmap");
  const std::string other = file_in_stage(context.document, text(context, entity, "bitmap", ""), file);
  if (!other.empty()) warn(context, at, fmt::format("the picture is {}; Stage uses {}", file, other));
  try {
    if (bitmaps.count(file) == 0) bitmaps.emplace(file, trace_plan(file));
  } catch (const base::InputError& error) {
    fail(context, at, fmt::format("'bitmap': {}", error.what()));
  }
  return bitmaps.at(file);
}

PicturePart part_of(const StageContext& context, const TracedBitmap& plan) {
  return context.old_shapes ? whole_of(plan.grid) : plan.solid;
}

void warn_of_picture(StageContext& context, const Entity& entity, const TracedBitmap& plan, const Size& size) {
  const SourceLocation at = find(entity, "bitmap")->at;
  const Bitmap& grid = plan.grid;
  if (find(entity, "size") == nullptr)
    warn(context, at,
         fmt::format("'{}' shows a picture of {} x {} pixels but has no 'size': it is {:g} x {:g} m; write size "
                     "[x y z] of the picture's solid part",
                     entity.word, grid.width, grid.height, size.x, size.y));
  if (plan.hidden > 0)
    warn(context, at,
         fmt::format("{} dark pixels of the picture are transparent and therefore free; Stage ignores transparency and "
                     "treats them as walls",
                     plan.hidden));
  if (plan.runs.empty()) warn(context, at, "the picture has no dark pixel, so it has no walls");
  const auto& [low, high] = plan.solid;
  if (context.old_shapes || (low.i == 0 && low.j == 0 && high.i == grid.width && high.j == grid.height)) return;
  warn(context, at,
       fmt::format("the picture's solid part is scaled to 'size', as in Stage: its margins of {} (left), {} (right), "
                   "{} (below) and {} (above) of {} x {} pixels are left out; the world key old_shapes 1 includes them",
                   low.i, grid.width - high.i, low.j, grid.height - high.j, grid.width, grid.height));
}

}  // namespace sf::world
