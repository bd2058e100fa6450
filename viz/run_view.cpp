#include "viz/run_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>

#include "base/report.h"
#include "viz/labels.h"
#include "viz/signal_layer.h"
#include "viz/theme.h"
#include "viz/ticks.h"

namespace sf::viz {
namespace {

constexpr std::size_t kMostNames = 12;
constexpr double kEdge = 14.0;         // [px] between texts and the picture's edge
constexpr double kSmallestRing = 6.0;  // [px]

TextStyle text_style(const FigureLayout& layout, double part) {
  TextStyle style;
  style.size = std::clamp(static_cast<int>(part * layout.height), 9, 48);
  style.halo = theme::kWhite;
  return style;
}

std::vector<std::size_t> robots_in_view(const world::World& world, const world::Extent& shown,
                                        std::span<const base::Pose> X_WM) {
  std::vector<std::size_t> seen;
  for (std::size_t i = 0; i < X_WM.size(); ++i) {
    const base::Pose& at = X_WM[i];
    if (!world.movers[i].is_tag && at.x > shown.x_min && at.x < shown.x_max && at.y > shown.y_min && at.y < shown.y_max)
      seen.push_back(i);
  }
  return seen;
}

}  // namespace

RunView::RunView(const world::World& world, const RunViewOptions& options)
    : world_(world), options_(options), view_(world, options.view) {}

/// Moves to the bounding box of all followed movers with a margin. If all of them are absent, the camera does not move.
void RunView::follow(const RunFrame& frame) {
  std::optional<world::Extent> box;
  for (const std::size_t mover : options_.followed) {
    const base::Pose& at = frame.X_WM[mover];
    if (base::is_absent(at)) continue;
    if (!box) box = {at.x, at.y, at.x, at.y};
    *box = {std::min(box->x_min, at.x), std::min(box->y_min, at.y), std::max(box->x_max, at.x),
            std::max(box->y_max, at.y)};
  }
  const double around = options_.around;
  if (box) view_.look_at({box->x_min - around, box->y_min - around, box->x_max + around, box->y_max + around});
}

void RunView::draw_contacts(Axes& axes, const RunFrame& frame) const {
  for (std::size_t i = 0; i < frame.contacts.size(); ++i) {
    const base::Pose& at = frame.X_WM[i];
    if (frame.contacts[i] == 0 || world_.movers[i].is_tag || base::is_absent(at)) continue;
    axes.canvas().ring(axes.pixel({at.x, at.y}), std::max(world_.movers[i].radius * axes.scale() + 3.0, kSmallestRing),
                       theme::kBold, theme::kContact);
  }
}

/// Below the robots, unless another name is there.
void RunView::draw_names(Axes& axes, const RunFrame& frame) const {
  const std::vector<std::size_t> seen = robots_in_view(world_, axes.layout().shown, frame.X_WM);
  if (seen.size() > kMostNames) return;
  TextStyle style = text_style(axes.layout(), 0.022);
  style.across = Anchor::middle;
  style.down = Anchor::start;
  Labels labels(axes.layout().plot);
  for (const std::size_t i : seen) {
    const double below = std::max(world_.movers[i].radius * axes.scale(), kSmallestRing) + 4.0;
    const glm::dvec2 at = axes.pixel({frame.X_WM[i].x, frame.X_WM[i].y}) + glm::dvec2{0.0, below};
    const glm::dvec2 size = text_size(world_.movers[i].name, style);
    const LabelBox box{at - glm::dvec2{0.5 * size.x, 0.0}, at + glm::dvec2{0.5 * size.x, size.y}};
    if (!labels.is_bare(box)) continue;
    axes.canvas().text(at, world_.movers[i].name, style);
    labels.forbid(box);
  }
}

/// Draws the time at the upper left and the scale bar at the lower right.
void RunView::draw_texts(Axes& axes, const RunFrame& frame) const {
  Canvas& canvas = axes.canvas();
  TextStyle style = text_style(axes.layout(), 0.03);
  style.down = Anchor::start;
  canvas.text({kEdge, kEdge}, fmt::format("{:.1f} s{}", frame.time, options_.note), style);

  const double metres = round_down(canvas.width() / axes.scale() / 6.0);
  const double right = crisp(canvas.width() - kEdge), left = crisp(right - metres * axes.scale());
  const double y = crisp(canvas.height() - kEdge);
  const Line strokes[] = {{{left, y}, {right, y}}, {{left, y - 5}, {left, y + 5}}, {{right, y - 5}, {right, y + 5}}};
  canvas.lines(strokes, 5.0, theme::kWhite);
  canvas.lines(strokes, theme::kCurve, theme::kFrame);
  style = text_style(axes.layout(), 0.022);
  style.across = Anchor::end;
  style.down = Anchor::end;
  canvas.text({right, y - 7.0},
              metres >= 1000.0 ? fmt::format("{:g} km", metres / 1000.0) : fmt::format("{:g} m", metres), style);
}

PixelImage RunView::paint(const RunFrame& frame) {
  if (!options_.followed.empty()) follow(frame);
  Axes axes = view_.begin();
  for (const RangeReading& reading : frame.ranges) draw_ranges(axes, reading);
  if (frame.lights.empty())
    draw_lights(axes, world_, frame.time);
  else
    draw_lights(axes, world_, frame.lights, frame.X_WM);
  view_.draw_bodies(axes, frame.X_WM);
  draw_contacts(axes, frame);
  draw_names(axes, frame);
  draw_texts(axes, frame);
  return paint_pixels(axes.canvas().drawing());
}

}  // namespace sf::viz
