#include "viz/mover_layer.h"

#include <algorithm>
#include <vector>

#include "base/report.h"
#include "viz/color.h"
#include "viz/theme.h"

namespace sf::viz {

namespace {

using world::Mover;

void draw_heading(Axes& axes, const base::Pose& X_WM, double reach, double line_width, std::uint32_t color) {
  const glm::dvec2 at = axes.pixel({X_WM.x, X_WM.y});
  axes.canvas().line(at, at + base::rotate(-X_WM.yaw, {reach, 0.0}), line_width, color);
}

}  // namespace

std::uint32_t body_color(const world::World& world, const Mover& mover) {
  return mover.model < world.models.size() ? world.models[mover.model].color | theme::kBlack : theme::kNeutral;
}

void draw_body(Axes& axes, const Mover& mover, const base::Pose& X_WM, std::uint32_t color) {
  if (base::is_absent(X_WM)) return;
  const std::uint32_t edge = mix(color, theme::kBlack, 0.45);
  const double radius = mover.radius * axes.scale();
  Canvas& canvas = axes.canvas();
  if (radius < kSmallestMark || mover.body.empty()) {
    canvas.disc(axes.pixel({X_WM.x, X_WM.y}), std::max(radius, 2.4), color);
    return draw_heading(axes, X_WM, std::max(2.2 * radius, 6.0), 1.2, edge);
  }
  std::vector<Line> outline;
  std::vector<Line> closed;
  for (const world::Segment& s : mover.body) {
    outline.push_back({axes.pixel(transform(X_WM, s.a)), axes.pixel(transform(X_WM, s.b))});
    if (s.solid_left) closed.push_back(outline.back());
  }
  canvas.area(closed, with_opacity(color, 0.75));
  canvas.lines(outline, 1.4, edge);
  draw_heading(axes, X_WM, radius, std::clamp(radius / 8.0, 1.4, 3.0), edge);
}

}  // namespace sf::viz
