#include "viz/top_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "viz/mover_layer.h"
#include "viz/road_layer.h"
#include "viz/signal_layer.h"
#include "viz/wall_layer.h"

namespace sf::viz {
namespace {

constexpr double kMargin = 0.02;  // of the longer side, if the whole world is shown

world::Extent with_margin(const world::Extent& e) {
  const double margin = kMargin * std::max({e.x_max - e.x_min, e.y_max - e.y_min, 1e-3});
  return {e.x_min - margin, e.y_min - margin, e.x_max + margin, e.y_max + margin};
}

void check(const TopViewOptions& options) {
  if (std::min(options.width, options.height) < 1 ||
      std::max(options.width, options.height) > TopViewOptions::kLongestSide)
    throw base::InputError(fmt::format("an image of {} x {} pixels; expected 1 to {} along each side", options.width,
                                       options.height, TopViewOptions::kLongestSide));
  if (!options.extent) return;
  const world::Extent& e = *options.extent;
  if (!std::isfinite(e.x_max - e.x_min) || !std::isfinite(e.y_max - e.y_min) || e.x_max <= e.x_min ||
      e.y_max <= e.y_min)
    throw base::InputError(
        fmt::format("a view of ({}, {}, {}, {}); expected finite x_min, y_min, x_max, y_max [m], "
                    "each minimum below its maximum",
                    e.x_min, e.y_min, e.x_max, e.y_max));
}

/// Centres the requested area in the picture, at the largest scale that shows all of it.
FigureLayout layout_of(const world::World& world, const TopViewOptions& options) {
  check(options);
  const world::Extent e = options.extent ? *options.extent : with_margin(world.extent);
  FigureLayout at;
  at.width = options.width, at.height = options.height;
  at.plot = {0, 0, at.width, at.height};
  at.scale = std::min(at.width / (e.x_max - e.x_min), at.height / (e.y_max - e.y_min));
  const glm::dvec2 middle{0.5 * (e.x_min + e.x_max), 0.5 * (e.y_min + e.y_max)};
  const glm::dvec2 half = glm::dvec2{0.5 * at.width, 0.5 * at.height} / at.scale;
  at.shown = {middle.x - half.x, middle.y - half.y, middle.x + half.x, middle.y + half.y};
  return at;
}

std::vector<std::uint32_t> colors_of(const PixelImage& image) {
  std::vector<std::uint32_t> colors(image.rgb.size() / 3);
  for (std::size_t i = 0; i < colors.size(); ++i)
    colors[i] = 0xFF000000u |
                static_cast<std::uint32_t>(image.rgb[3 * i] << 16 | image.rgb[3 * i + 1] << 8 | image.rgb[3 * i + 2]);
  return colors;
}

}  // namespace

TopView::TopView(const world::World& world, const TopViewOptions& options)
    : world_(&world), options_(options), layout_(layout_of(world, options)) {
  paint_static_layer();
}

void TopView::paint_static_layer() {
  Axes axes(layout_);
  draw_lane_markings(axes, *world_);
  draw_floor_holes(axes, *world_);
  draw_magnets(axes, *world_);
  draw_emitters(axes, *world_);
  draw_walls(axes, *world_, WallColors::of_models);
  static_layer_ = colors_of(paint_pixels(axes.canvas().drawing()));
}

void TopView::look_at(const world::Extent& extent) {
  options_.extent = extent;
  const FigureLayout next = layout_of(*world_, options_);
  const world::Extent &a = next.shown, &b = layout_.shown;
  if (a.x_min == b.x_min && a.y_min == b.y_min && a.x_max == b.x_max && a.y_max == b.y_max) return;
  layout_ = next;
  paint_static_layer();
}

Axes TopView::begin() const {
  Axes axes(layout_);
  axes.canvas().image({0.0, 0.0}, {layout_.width, layout_.height}, {layout_.width, layout_.height, static_layer_});
  return axes;
}

void TopView::draw_bodies(Axes& axes, std::span<const base::Pose> X_WM) const {
  SF_CHECK(X_WM.size() <= world_->movers.size(), "poses: expected at most one per mover");
  for (std::size_t i = 0; i < X_WM.size(); ++i)
    draw_body(axes, world_->movers[i], X_WM[i], body_color(*world_, world_->movers[i]));
}

PixelImage TopView::paint(std::span<const base::Pose> X_WM, double time) const {
  Axes axes = begin();
  draw_lights(axes, *world_, time);
  draw_bodies(axes, X_WM);
  return paint_pixels(axes.canvas().drawing());
}

}  // namespace sf::viz
