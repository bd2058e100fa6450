#include "viz/view_sector.h"

#include <cmath>
#include <vector>

#include "viz/color.h"
#include "viz/theme.h"

namespace sf::viz {

void draw_view_sector(Axes& axes, const base::Pose& X_WF, double from, double to, double reach,
                      const SectorStyle& look) {
  std::vector<glm::dvec2> outline;
  if (to - from < 2.0 * M_PI - 1e-3) outline.push_back(axes.pixel({X_WF.x, X_WF.y}));
  for (int i = 0; i <= look.sides; ++i) {
    const double bearing = from + (to - from) * i / look.sides;
    outline.push_back(axes.pixel(transform(X_WF, base::rotate(bearing, {reach, 0.0}))));
  }
  axes.canvas().polygon(outline, with_opacity(look.color, look.inside));
  outline.push_back(outline.front());
  axes.canvas().polyline(outline, theme::kHairline, with_opacity(look.color, look.border));
}

}  // namespace sf::viz
