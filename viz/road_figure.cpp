#include "viz/road_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

#include "viz/axes.h"
#include "viz/road_view.h"
#include "viz/theme.h"
#include "world/roads/lane_markings.h"

namespace sf::viz {
namespace {

using world::Extent;
using world::RoadLane;
using world::RoadNetwork;
using world::RoadZone;

constexpr double kLanePixels = 9.0;    // desired width of a lane
constexpr double kSpotPixels = 17.0;   // width of a parking spot with room for the id of its checkpoint
constexpr std::uint32_t kCrowded = 6;  // smallest number of spots in a zone that is enlarged

/// [px] Returns the picture size at which the median lane has the desired width.
int picture_size(const RoadNetwork& network) {
  std::vector<double> widths;
  for (const RoadLane& lane : network.lanes) widths.push_back(lane.width);
  std::nth_element(widths.begin(), widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2), widths.end());
  const world::Extent& e = network.extent;
  const double size = std::max(e.x_max - e.x_min, e.y_max - e.y_min);
  const double wanted = kLanePixels * size / widths[widths.size() / 2] + 250.0;
  return static_cast<int>(std::clamp(wanted, 1600.0, 4000.0));
}

// ------------------------------------------------------------------------------------------------- insets

/// An enlarged part of the network in a free corner.
struct Inset {
  Extent part;  ///< [m]
  PixelBox box;
  double scale = 1.0;  ///< [px/m]
};

bool overlap(const Extent& a, const Extent& b) {
  return a.x_min < b.x_max && b.x_min < a.x_max && a.y_min < b.y_max && b.y_min < a.y_max;
}

Extent joined(const Extent& a, const Extent& b) {
  return {std::min(a.x_min, b.x_min), std::min(a.y_min, b.y_min), std::max(a.x_max, b.x_max),
          std::max(a.y_max, b.y_max)};
}

/// Returns zones whose spots are too small for their ids; adjacent ones are merged.
std::vector<Extent> crowded_parts(const RoadView& view, const RoadNetwork& network) {
  std::vector<Extent> parts;
  for (const RoadZone& zone : network.zones) {
    if (zone.spots < kCrowded || network.spots[zone.first_spot].width * view.scale > kSpotPixels) continue;
    const double pad = 4.0 * network.spots[zone.first_spot].width;
    Extent part{INFINITY, INFINITY, -INFINITY, -INFINITY};
    for (const world::PerimeterPoint& point : zone.perimeter)
      part = joined(part, {point.p.x - pad, point.p.y - pad, point.p.x + pad, point.p.y + pad});
    for (std::size_t i = 0; i < parts.size();) {
      if (!overlap(parts[i], part)) {
        ++i;
        continue;
      }
      part = joined(part, parts[i]);
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i));
      i = 0;
    }
    parts.push_back(part);
  }
  return parts;
}

/// Returns the free box of this size that is nearest to `from`.
std::optional<PixelBox> free_box(const RoadView& view, const Labels& labels, glm::dvec2 from, int width, int height) {
  std::optional<PixelBox> best;
  double nearest = INFINITY;
  for (int y = view.box.y_min + 12; y + height < view.box.y_max - 12; y += 16)
    for (int x = view.box.x_min + 12; x + width < view.box.x_max - 12; x += 16) {
      const double away = length(glm::dvec2{x + 0.5 * width, y + 0.5 * height} - from);
      if (away >= nearest || !labels.is_bare({{x - 8.0, y - 8.0}, {x + width + 8.0, y + height + 8.0}})) continue;
      nearest = away;
      best = PixelBox{x, y, x + width, y + height};
    }
  return best;
}

/// Returns the best inset by size and distance: a quarter more in size is worth 750 pixels of distance.
std::optional<Inset> best_inset(const RoadView& view, const Labels& labels, const Extent& part) {
  const glm::dvec2 middle = view.pixel({0.5 * (part.x_min + part.x_max), 0.5 * (part.y_min + part.y_max)});
  std::optional<Inset> best;
  double most = -INFINITY;
  for (double times = 4.0; times >= 1.75; times -= 0.25) {
    const double scale = times * view.scale;
    const auto box = free_box(view, labels, middle, static_cast<int>((part.x_max - part.x_min) * scale),
                              static_cast<int>((part.y_max - part.y_min) * scale));
    if (!box) continue;
    const glm::dvec2 centre{0.5 * (box->x_min + box->x_max), 0.5 * (box->y_min + box->y_max)};
    const double worth = times - length(centre - middle) / 3000.0;
    if (worth <= most) continue;
    most = worth;
    best = Inset{part, *box, scale};
  }
  return best;
}

std::vector<Inset> place_insets(const RoadView& view, const RoadNetwork& network, Labels& labels) {
  std::vector<Inset> insets;
  for (const Extent& part : crowded_parts(view, network)) {
    const auto inset = best_inset(view, labels, part);
    if (!inset) continue;
    const PixelBox& box = inset->box;
    labels.forbid({{box.x_min - 8.0, box.y_min - 8.0}, {box.x_max + 8.0, box.y_max + 8.0}});
    insets.push_back(*inset);
  }
  return insets;
}

void draw_frame(Canvas& canvas, glm::dvec2 low, glm::dvec2 high, double width) {
  const glm::dvec2 corners[] = {low, {high.x, low.y}, high, {low.x, high.y}, low};
  canvas.polyline(corners, width, theme::kFrame);
}

void draw_inset(const RoadView& view, const RoadNetwork& network, const Inset& inset) {
  const glm::dvec2 low{inset.box.x_min + 0.0, inset.box.y_min + 0.0};
  const glm::dvec2 high{inset.box.x_max + 0.0, inset.box.y_max + 0.0};
  const glm::dvec2 part_low = view.pixel({inset.part.x_min, inset.part.y_max});
  const glm::dvec2 part_high = view.pixel({inset.part.x_max, inset.part.y_min});
  draw_frame(view.canvas, part_low, part_high, 1.5);
  const bool above = high.y < part_low.y;
  const Line ties[] = {{{low.x, above ? high.y : low.y}, {part_low.x, above ? part_low.y : part_high.y}},
                       {{high.x, above ? high.y : low.y}, {part_high.x, above ? part_low.y : part_high.y}}};
  view.canvas.lines(ties, theme::kHairline, theme::kInsetTie);

  view.canvas.clip(inset.box);
  const glm::dvec2 corners[] = {low, {high.x, low.y}, high, {low.x, high.y}};
  view.canvas.polygon(corners, theme::kRoadGround);
  const RoadView larger{view.canvas, inset.box, {inset.part.x_min, inset.part.y_min}, inset.scale};
  draw_network(larger, network);
  Labels labels(inset.box);
  avoid_network(larger, network, labels);
  draw_texts(larger, network, labels, {});
  view.canvas.clip(view.box);
  draw_frame(view.canvas, low, high, 2.0);
}

// ------------------------------------------------------------------------------------------------- figure

/// @param shown [m] area of the figure; the legend lists its contents
std::vector<LegendItem> legend_of(const RoadNetwork& network, const Extent& shown) {
  const auto any = [](const auto& all, auto&& in_view) { return std::any_of(all.begin(), all.end(), in_view); };
  const auto has = [&](glm::dvec2 a, glm::dvec2 b) { return is_in_view(std::array{a, b}, shown); };
  std::vector<LegendItem> items;
  if (any(network.lanes, [&](const auto& l) { return is_in_view(l.centre.points, shown, 0.5 * l.width); }))
    items.push_back({LegendMark::block, theme::kAsphalt, "lane", theme::kLaneEdge});
  const auto paint = world::lane_markings_of(network);
  const auto painted = [&](std::uint32_t color) {
    return any(paint, [&](const auto& s) { return s.color == color && is_in_view(s.line, shown); });
  };
  if (painted(world::kYellowPaint)) items.push_back({LegendMark::line, world::kYellowPaint, "yellow lines"});
  if (painted(world::kWhitePaint))
    items.push_back({LegendMark::block, world::kWhitePaint, "white lines", theme::kLaneEdge});
  if (any(network.exits, [&](const auto& e) { return is_in_view(exit_curve(network, e).points, shown); }))
    items.push_back({LegendMark::line, theme::kExit, "exit"});
  if (any(network.stops, [&](const auto& s) { return has(s.left, s.right); }))
    items.push_back({LegendMark::line, theme::kStop, "stop line"});
  if (any(network.checkpoints, [&](const auto& c) { return has(c.p, c.p); }))
    items.push_back({LegendMark::dot, theme::kCheckpoint, "checkpoint and its id"});
  const auto in_zone = [&](const world::RoadZone& zone) {
    std::vector<glm::dvec2> outline;
    for (const auto& point : zone.perimeter) outline.push_back(point.p);
    return is_in_view(outline, shown);
  };
  if (any(network.zones, in_zone)) items.push_back({LegendMark::block, theme::kZone, "zone", theme::kZoneEdge});
  if (any(network.spots, [&](const auto& s) { return has(s.entry, s.end); }))
    items.push_back({LegendMark::block, theme::kSpot, "parking spot"});
  return items;
}

std::string subtitle_of(const RoadNetwork& network) {
  const world::RoadCounts& c = network.counts;
  const auto count = [](std::size_t n, const char* one) { return fmt::format("{} {}{}", n, one, n == 1 ? "" : "s"); };
  std::string text = count(c.segments, "segment") + ", " + count(c.lanes, "lane") + ", " + count(c.zones, "zone") +
                     ", " + count(c.spots, "spot") + ", " + count(c.points, "point") + ", " + count(c.exits, "exit") +
                     ", " + count(c.stops, "stop") + ", " + count(c.checkpoints, "checkpoint");
  const world::Extent& e = network.extent;
  text += fmt::format("; {:.4g} m x {:.4g} m", e.x_max - e.x_min, e.y_max - e.y_min);
  return network.scale == 1.0 ? text : text + fmt::format(", scale {:.4g}", network.scale);
}

}  // namespace

void draw_roads(const RoadNetwork& network, const std::string& path, const Page& page) {
  FigureOptions options;
  options.title =
      printable(network.name.empty() ? std::filesystem::path(network.file).filename().string() : network.name, 120);
  options.subtitle = subtitle_of(network);
  options.extent = network.extent;
  options.background = theme::kRoadGround;
  options.long_side = picture_size(network);
  options.page = page;
  options.legend = legend_of(network, lay_out(options).shown);
  Axes axes(std::move(options));
  const FigureLayout& layout = axes.layout();
  const RoadView view{axes.canvas(), layout.plot, {layout.shown.x_min, layout.shown.y_min}, layout.scale};
  draw_network(view, network);

  Labels labels(layout.plot);
  avoid_network(view, network, labels);
  const std::vector<Inset> insets = place_insets(view, network, labels);
  DetailViews enlarged;
  for (const Inset& inset : insets) enlarged.push_back(inset.part);
  draw_texts(view, network, labels, enlarged);
  for (const Inset& inset : insets) draw_inset(view, network, inset);
  axes.save(path);
}

}  // namespace sf::viz
