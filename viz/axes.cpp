#include "viz/axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "viz/scales.h"
#include "viz/theme.h"

namespace sf::viz {
namespace {

void draw_grid(Canvas& canvas, const FigureLayout& at) {
  std::vector<Line> lines;
  for (const double x : at.x.at) {
    const double px = crisp(at.plot.x_min + (x - at.shown.x_min) * at.scale);
    lines.push_back({{px, at.plot.y_min + 0.0}, {px, at.plot.y_max + 0.0}});
  }
  for (const double y : at.y.at) {
    const double py = crisp(at.plot.y_max - (y - at.shown.y_min) * at.scale);
    lines.push_back({{at.plot.x_min + 0.0, py}, {at.plot.x_max + 0.0, py}});
  }
  canvas.lines(lines, theme::kHairline, theme::kGridLine);
}

void draw_ticks(Canvas& canvas, const FigureLayout& at) {
  for (const double x : at.x.at) {
    const double px = crisp(at.plot.x_min + (x - at.shown.x_min) * at.scale);
    canvas.line({px, at.plot.y_max + 1.0}, {px, at.plot.y_max + 6.0}, theme::kHairline, theme::kFrame);
    draw_label_across(canvas, {px, at.plot.y_max + 11.0}, tick_text(x, at.x));
  }
  TextStyle style = small_text();
  style.across = Anchor::end;
  for (const double y : at.y.at) {
    const double py = crisp(at.plot.y_max - (y - at.shown.y_min) * at.scale);
    canvas.line({at.plot.x_min - 6.0, py}, {at.plot.x_min - 1.0, py}, theme::kHairline, theme::kFrame);
    canvas.text({at.plot.x_min - 11.0, py}, tick_text(y, at.y), style);
  }
}

/// @param room [px] right end of the space for the name of the x axis
void draw_axis_names(Canvas& canvas, const FigureLayout& at, double edge, double room) {
  const std::string x_name = axis_name("x [m]", at.x);
  TextStyle style = small_text();
  style.across = Anchor::middle;
  const double half = 0.5 * text_size(x_name, style).x;
  const double middle = std::min(0.5 * (at.plot.x_min + at.plot.x_max), room - half);
  canvas.text({std::max(middle, at.plot.x_min + half), at.plot.y_max + 52.0}, x_name, style);
  style.upwards = true;
  canvas.text({edge + 12.0, 0.5 * (at.plot.y_min + at.plot.y_max)}, axis_name("y [m]", at.y), style);
}

/// Draws the scale bar and its text.
/// @return [px] their left end
double draw_scale_bar(Canvas& canvas, const FigureLayout& at) {
  const double metres = round_down((at.plot.x_max - at.plot.x_min) / at.scale / 6.0);
  const double right = crisp(at.plot.x_max);
  const double left = crisp(right - metres * at.scale);
  const double y = at.plot.y_max + 52.5;
  const Line strokes[] = {{{left, y}, {right, y}}, {{left, y - 6}, {left, y + 6}}, {{right, y - 6}, {right, y + 6}}};
  canvas.lines(strokes, theme::kCurve, theme::kFrame);
  TextStyle style = small_text();
  style.across = Anchor::end;
  const std::string text = metres >= 1000.0 ? fmt::format("{:g} km", metres / 1000.0) : fmt::format("{:g} m", metres);
  canvas.text({left - 10.0, y}, text, style);
  return left - 10.0 - text_size(text, style).x;
}

}  // namespace

Axes::Axes(FigureOptions options)
    : options_(std::move(options)), layout_(lay_out(options_)), canvas_(layout_.width, layout_.height, theme::kWhite) {
  canvas_.clip(layout_.plot);
  const PixelBox& p = layout_.plot;
  const glm::dvec2 corners[] = {{p.x_min + 0.0, p.y_min + 0.0},
                                {p.x_max + 0.0, p.y_min + 0.0},
                                {p.x_max + 0.0, p.y_max + 0.0},
                                {p.x_min + 0.0, p.y_max + 0.0}};
  canvas_.polygon(corners, options_.background);
  draw_grid(canvas_, layout_);
}

Axes::Axes(const FigureLayout& layout) : layout_(layout), canvas_(layout_.width, layout_.height, theme::kWhite) {
  canvas_.clip(layout_.plot);
}

void Axes::save(const std::string& path) {
  canvas_.unclip();
  draw_frame(canvas_, layout_.plot);
  draw_ticks(canvas_, layout_);
  draw_heading(canvas_, layout_.plot.x_min, layout_.heading);
  const double bar = draw_scale_bar(canvas_, layout_);
  draw_axis_names(canvas_, layout_, page_edge(options_.page), bar - 20.0);
  draw_legend(canvas_, {legend_left(options_.page, layout_.plot.x_min), layout_.legend_top}, options_.legend,
              layout_.legend);
  save_picture(canvas_.drawing(), path, options_.page);
}

}  // namespace sf::viz
