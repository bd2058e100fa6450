#include "viz/wiring_figure.h"

#include <algorithm>
#include <cmath>

#include "viz/canvas.h"
#include "viz/heading.h"

namespace sf::viz {

namespace {

// [px]
constexpr double kBoxHeight = 64.0, kBoxGap = 22.0, kColumnGap = 110.0, kPadding = 16.0;
constexpr double kHead = 12.0;  // length of an arrow's head

TextStyle detail_style() {
  TextStyle style;
  style.size = 15;
  style.color = theme::kLabel;
  return style;
}

/// Widths of the columns and places of the boxes. Each column is centred.
struct Layout {
  std::vector<glm::dvec2> corners;  ///< upper left, per box
  std::vector<double> widths;       ///< per column
  double width = 0.0, height = 0.0;
};

Layout arrange(const std::vector<WiringBox>& boxes) {
  Layout layout;
  std::vector<double> used;
  for (const WiringBox& box : boxes) {
    if (layout.widths.size() <= box.column) layout.widths.resize(box.column + 1), used.resize(box.column + 1, -kBoxGap);
    const double text = std::max(text_size(box.name, {}).x, text_size(box.detail, detail_style()).x);
    layout.widths[box.column] = std::max(layout.widths[box.column], text + 2.0 * kPadding);
    used[box.column] += kBoxHeight + kBoxGap;
  }
  layout.height = used.empty() ? 0.0 : *std::ranges::max_element(used);
  std::vector<double> left, next;
  for (std::size_t c = 0; c < used.size(); ++c) {
    left.push_back(layout.width);
    next.push_back(0.5 * (layout.height - used[c]));
    layout.width += layout.widths[c] + (c + 1 < used.size() ? kColumnGap : 0.0);
  }
  for (const WiringBox& box : boxes) {
    layout.corners.emplace_back(left[box.column], next[box.column]);
    next[box.column] += kBoxHeight + kBoxGap;
  }
  return layout;
}

void draw_arrow(Canvas& canvas, glm::dvec2 from, glm::dvec2 to) {
  canvas.line(from, {to.x - kHead, to.y}, 2.0, theme::kLabel);
  const glm::dvec2 head[] = {to, {to.x - kHead, to.y - 0.45 * kHead}, {to.x - kHead, to.y + 0.45 * kHead}};
  canvas.polygon(head, theme::kLabel);
}

void draw_box(Canvas& canvas, glm::dvec2 at, double width, const WiringBox& box) {
  const glm::dvec2 outline[] = {at, {at.x + width, at.y}, {at.x + width, at.y + kBoxHeight}, {at.x, at.y + kBoxHeight}};
  canvas.polygon(outline, box.column == 0 ? theme::kRoadGround : theme::kWhite);
  const glm::dvec2 closed[] = {outline[0], outline[1], outline[2], outline[3], outline[0]};
  canvas.polyline(closed, box.column == 0 ? 1.0 : 2.0, theme::kFrame);
  canvas.text({at.x + kPadding, at.y + 0.33 * kBoxHeight}, box.name, {});
  canvas.text({at.x + kPadding, at.y + 0.7 * kBoxHeight}, box.detail, detail_style());
}

}  // namespace

void draw_wiring(const std::vector<WiringBox>& boxes, const std::string& subtitle, const std::string& path,
                 const Page& page) {
  const Layout layout = arrange(boxes);
  const double side = page_edge(page);
  const double width = std::max(layout.width, 500.0);
  const Heading heading = make_heading("Derived sensors", subtitle, width, page);
  Canvas canvas(static_cast<int>(std::ceil(width + 2.0 * side)),
                static_cast<int>(std::ceil(heading.height + layout.height + side)), theme::kWhite);
  draw_heading(canvas, side, heading);
  const glm::dvec2 origin{side, heading.height};
  const auto middle = [&](std::size_t k) { return origin + layout.corners[k] + glm::dvec2{0.0, 0.5 * kBoxHeight}; };
  for (std::size_t k = 0; k < boxes.size(); ++k)
    for (const std::size_t input : boxes[k].inputs)
      draw_arrow(canvas, middle(input) + glm::dvec2{layout.widths[boxes[input].column], 0.0}, middle(k));
  for (std::size_t k = 0; k < boxes.size(); ++k)
    draw_box(canvas, origin + layout.corners[k], layout.widths[boxes[k].column], boxes[k]);
  save_picture(canvas.drawing(), path, page);
}

}  // namespace sf::viz
