#include "viz/labels.h"

#include "viz/theme.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sf::viz {
namespace {

constexpr double kCell = 4.0;  // [px]
constexpr int kDirections = 16;
constexpr double kRing = 9.0;  // [px] step between the distances that are tried

/// Returns the box of `size` in direction `angle` from `mark`, with its nearest side or corner at distance `away`.
LabelBox box_beside(glm::dvec2 mark, double angle, double away, glm::dvec2 size) {
  const glm::dvec2 d{std::cos(angle), std::sin(angle)};
  const glm::dvec2 middle = mark + away * d + glm::dvec2{0.5 * size.x * d.x, 0.5 * size.y * d.y};
  return {middle - 0.5 * size, middle + 0.5 * size};
}

glm::dvec2 nearest_in(const LabelBox& box, glm::dvec2 p) {
  return {std::clamp(p.x, box.low.x, box.high.x), std::clamp(p.y, box.low.y, box.high.y)};
}

}  // namespace

Labels::Labels(const PixelBox& plot)
    : plot_(plot),
      columns_(static_cast<int>((plot.x_max - plot.x_min) / kCell) + 1),
      rows_(static_cast<int>((plot.y_max - plot.y_min) / kCell) + 1),
      cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), bare) {}

Labels::Cells Labels::cells_of(const LabelBox& box) const {
  const auto cell = [](double x, int most) {
    return static_cast<int>(std::clamp(std::floor(x / kCell), 0.0, static_cast<double>(most)));
  };
  return {cell(box.low.x - plot_.x_min, columns_ - 1), cell(box.high.x - plot_.x_min, columns_ - 1),
          cell(box.low.y - plot_.y_min, rows_ - 1), cell(box.high.y - plot_.y_min, rows_ - 1)};
}

void Labels::mark(const LabelBox& box, Cell as) {
  const bool outside =
      box.high.x < plot_.x_min || box.low.x > plot_.x_max || box.high.y < plot_.y_min || box.low.y > plot_.y_max;
  if (outside || !std::isfinite(box.low.x + box.high.x + box.low.y + box.high.y)) return;
  const Cells c = cells_of(box);
  for (int j = c.j_min; j <= c.j_max; ++j)
    for (int i = c.i_min; i <= c.i_max; ++i) at(i, j) = static_cast<std::uint8_t>(at(i, j) | as);
}

void Labels::forbid(const LabelBox& box) { mark(box, taken); }

void Labels::avoid(std::span<const glm::dvec2> line, double width) {
  const double radius = std::max(0.5 * width, 1.0);
  const glm::dvec2 reach{radius, radius};
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const glm::dvec2 d = line[i + 1] - line[i];
    const int steps = static_cast<int>(std::min(length(d) / kCell, 1e4)) + 1;
    for (int k = 0; k <= steps; ++k) {
      const glm::dvec2 p = line[i] + (static_cast<double>(k) / steps) * d;
      mark({p - reach, p + reach}, drawn);
    }
  }
}

bool Labels::is_without(const LabelBox& box, int bits) const {
  const bool inside = box.low.x > plot_.x_min + 2 && box.low.y > plot_.y_min + 2 && box.high.x < plot_.x_max - 2 &&
                      box.high.y < plot_.y_max - 2;
  if (!inside) return false;
  const Cells c = cells_of(box);
  for (int j = c.j_min; j <= c.j_max; ++j)
    for (int i = c.i_min; i <= c.i_max; ++i)
      if ((at(i, j) & bits) != 0) return false;
  return true;
}

// Returns the part of the box that covers drawings, in [0, 1].
double Labels::covered(const LabelBox& box) const {
  const Cells c = cells_of(box);
  int hit = 0;
  for (int j = c.j_min; j <= c.j_max; ++j)
    for (int i = c.i_min; i <= c.i_max; ++i) hit += (at(i, j) & drawn) != 0 ? 1 : 0;
  return static_cast<double>(hit) / ((c.i_max - c.i_min + 1) * (c.j_max - c.j_min + 1));
}

bool Labels::place(Canvas& canvas, std::span<const glm::dvec2> marks, const std::string& text, const TextStyle& style,
                   const LabelRules& rules) {
  const glm::dvec2 size = text_size(text, style) + glm::dvec2{4.0, 2.0};
  struct Best {
    LabelBox box;
    glm::dvec2 mark;
    double away;
  };
  std::optional<Best> best;
  double least = INFINITY;
  for (const glm::dvec2& mark : marks)
    for (double away = rules.nearest; away <= rules.farthest; away += kRing)
      for (int k = 0; k < kDirections; ++k) {
        const double cost = away / 40.0;
        if (cost >= least) continue;
        const LabelBox box = box_beside(mark, (k * 2.0 - 2.0) * M_PI / kDirections, away, size);
        const double whole = cost + 3.0 * rules.clear_cost * covered(box);
        if (whole >= least || !is_without(box, taken)) continue;
        least = whole;
        best = Best{box, mark, away};
      }
  if (!best) return false;

  const LabelBox& box = best->box;
  if (best->away > rules.leader) canvas.line(best->mark, nearest_in(box, best->mark), theme::kHairline, theme::kLeader);
  TextStyle centred = style;
  centred.across = Anchor::middle;
  centred.down = Anchor::middle;
  canvas.text(0.5 * (box.low + box.high), text, centred);
  forbid({box.low + glm::dvec2{1.0, 1.0}, box.high - glm::dvec2{1.0, 1.0}});
  return true;
}

}  // namespace sf::viz
