#include "viz/labels.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sf::viz {
namespace {

constexpr double kCell = 4.0;  // [px]
constexpr int kDirections = 16;
constexpr double kRing = 9.0;  // [px] from one distance tried to the next
constexpr std::uint32_t kLeader = 0xB0606060u;

/// The box of `size` whose side or corner towards `mark` is `away` from it in direction `angle`.
LabelBox box_beside(Vec2 mark, double angle, double away, Vec2 size) {
  const Vec2 d{std::cos(angle), std::sin(angle)};
  const Vec2 middle = mark + away * d + Vec2{0.5 * size.x * d.x, 0.5 * size.y * d.y};
  return {middle - 0.5 * size, middle + 0.5 * size};
}

Vec2 nearest_in(const LabelBox& box, Vec2 p) {
  return {std::clamp(p.x, box.low.x, box.high.x), std::clamp(p.y, box.low.y, box.high.y)};
}

}  // namespace

Labels::Labels(const PixelBox& plot)
    : plot_(plot),
      columns_(static_cast<int>((plot.x_max - plot.x_min) / kCell) + 1),
      rows_(static_cast<int>((plot.y_max - plot.y_min) / kCell) + 1),
      ground_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0) {}

void Labels::mark(Vec2 p, double radius) {
  const auto cell = [](double x, int least, int most) { return std::clamp(static_cast<int>(x / kCell), least, most); };
  const double x = p.x - plot_.x_min;
  const double y = p.y - plot_.y_min;
  if (!(x > -radius && y > -radius && x < kCell * columns_ + radius && y < kCell * rows_ + radius)) return;
  for (int j = cell(y - radius, 0, rows_ - 1); j <= cell(y + radius, 0, rows_ - 1); ++j)
    for (int i = cell(x - radius, 0, columns_ - 1); i <= cell(x + radius, 0, columns_ - 1); ++i)
      ground_[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i)] = 1;
}

void Labels::avoid(std::span<const Vec2> line, double width) {
  const double radius = std::max(0.5 * width, 1.0);
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vec2 d = line[i + 1] - line[i];
    const int steps = static_cast<int>(std::min(length(d) / kCell, 1e4)) + 1;
    for (int k = 0; k <= steps; ++k) mark(line[i] + (static_cast<double>(k) / steps) * d, radius);
  }
}

bool Labels::is_free(const LabelBox& box) const {
  const bool inside = box.low.x > plot_.x_min + 2 && box.low.y > plot_.y_min + 2 && box.high.x < plot_.x_max - 2 &&
                      box.high.y < plot_.y_max - 2;
  return inside && std::none_of(taken_.begin(), taken_.end(), [&](const LabelBox& b) { return overlap(box, b); });
}

// The part of the box that lies over something, in [0, 1].
double Labels::covered(const LabelBox& box) const {
  const auto cell = [](double x, int most) { return std::clamp(static_cast<int>(x / kCell), 0, most); };
  int hit = 0;
  int all = 0;
  for (int j = cell(box.low.y - plot_.y_min, rows_ - 1); j <= cell(box.high.y - plot_.y_min, rows_ - 1); ++j)
    for (int i = cell(box.low.x - plot_.x_min, columns_ - 1); i <= cell(box.high.x - plot_.x_min, columns_ - 1); ++i) {
      ++all;
      hit += ground_[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i)];
    }
  return all > 0 ? static_cast<double>(hit) / all : 0.0;
}

bool Labels::place(Canvas& canvas, std::span<const Vec2> marks, const std::string& text, const TextStyle& style,
                   const LabelRules& rules) {
  const Vec2 size = text_size(text, style) + Vec2{4.0, 2.0};
  struct Best {
    LabelBox box;
    Vec2 mark;
    double away;
  };
  std::optional<Best> best;
  double least = INFINITY;
  for (const Vec2 mark : marks)
    for (double away = rules.nearest; away <= rules.farthest; away += kRing)
      for (int k = 0; k < kDirections; ++k) {
        const double cost = away / 40.0;
        if (cost >= least) continue;
        const LabelBox box = box_beside(mark, (k * 2.0 - 2.0) * M_PI / kDirections, away, size);
        const double whole = cost + 3.0 * rules.clear_cost * covered(box);
        if (whole >= least || !is_free(box)) continue;
        least = whole;
        best = Best{box, mark, away};
      }
  if (!best) return false;

  const LabelBox& box = best->box;
  if (best->away > rules.leader) canvas.line(best->mark, nearest_in(box, best->mark), 1.0, kLeader);
  TextStyle centred = style;
  centred.across = Anchor::middle;
  centred.down = Anchor::middle;
  canvas.text(0.5 * (box.low + box.high), text, centred);
  taken_.push_back(box);
  return true;
}

}  // namespace sf::viz
