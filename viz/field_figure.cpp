#include "viz/field_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "viz/color.h"
#include "viz/heading.h"
#include "viz/legend.h"
#include "viz/scales.h"
#include "viz/theme.h"

namespace sf::viz {

namespace {

constexpr double kGauss = 1e-4;  // [T]
constexpr std::size_t kShades = 160;

// [px]
constexpr double kRoomForMarks = 9.0;  // per magnet; in denser areas marks would hide the field
constexpr double kGap = 96.0;          // between the map and the profile
constexpr double kLegendBelow = 72.0;  // for the labels of the profile
constexpr double kFieldFoot = 18.0;

/// A plot: its pixel box and the values at its edges.
struct Plot {
  PixelBox box;
  double x0 = 0.0, x1 = 1.0, y0 = 0.0, y1 = 1.0;

  glm::dvec2 pixel(glm::dvec2 p) const {
    return {box.x_min + (p.x - x0) / (x1 - x0) * (box.x_max - box.x_min),
            box.y_max - (p.y - y0) / (y1 - y0) * (box.y_max - box.y_min)};
  }
};

void draw_axes(Canvas& canvas, const Plot& plot, const std::string& x_name, const std::string& y_name, bool grid,
               double edge) {
  const PixelBox& b = plot.box;
  TextStyle style = small_text();
  style.across = Anchor::middle;
  style.down = Anchor::start;
  const Ticks xs = ticks_across(plot.x0, plot.x1, b.x_max - b.x_min);
  for (const double x : xs.at) {
    const double px = crisp(plot.pixel({x, plot.y0}).x);
    if (grid) canvas.line({px, b.y_min + 0.0}, {px, b.y_max + 0.0}, theme::kHairline, theme::kGridLine);
    canvas.line({px, b.y_max + 1.0}, {px, b.y_max + 6.0}, theme::kHairline, theme::kFrame);
    draw_label_across(canvas, {px, b.y_max + 11.0}, tick_text(x, xs));
  }
  canvas.text({0.5 * (b.x_min + b.x_max), b.y_max + 40.0}, axis_name(x_name, xs), style);
  style.across = Anchor::end;
  style.down = Anchor::middle;
  const Ticks ys = ticks_up(plot.y0, plot.y1, b.y_max - b.y_min);
  for (const double y : ys.at) {
    const double py = crisp(plot.pixel({plot.x0, y}).y);
    if (grid) canvas.line({b.x_min + 0.0, py}, {b.x_max + 0.0, py}, theme::kHairline, theme::kGridLine);
    canvas.line({b.x_min - 6.0, py}, {b.x_min - 1.0, py}, theme::kHairline, theme::kFrame);
    canvas.text({b.x_min - 11.0, py}, tick_text(y, ys), style);
  }
  style.across = Anchor::middle;
  style.upwards = true;
  canvas.text({edge, 0.5 * (b.y_min + b.y_max)}, axis_name(y_name, ys), style);
  draw_frame(canvas, b);
}

std::vector<std::uint32_t> shades() {
  std::vector<std::uint32_t> colors;
  for (std::size_t i = 0; i < kShades; ++i) colors.push_back(scale_color(static_cast<double>(i) / (kShades - 1)));
  return colors;
}

/// [Gauss] Returns the upper end of the colour scale: the maximum on the map, or a default if the field is zero.
double top_of(const FieldSamples& samples) {
  const double most = *std::max_element(samples.map.begin(), samples.map.end()) / kGauss;
  return most > 0.0 ? most : 1.0;
}

void draw_bar(Canvas& canvas, const Plot& map, double top) {
  const Plot bar{{map.box.x_max + 16, map.box.y_min, map.box.x_max + 34, map.box.y_max}, 0.0, 1.0, 0.0, top};
  std::vector<std::uint32_t> colors = shades();
  std::reverse(colors.begin(), colors.end());
  canvas.image({bar.box.x_min + 0.0, bar.box.y_min + 0.0}, {bar.box.x_max + 0.0, bar.box.y_max + 0.0},
               {1, static_cast<int>(colors.size()), colors});
  draw_frame(canvas, bar.box);
  const Ticks ticks = ticks_up(0.0, top, bar.box.y_max - bar.box.y_min);
  for (const double value : ticks.at) {
    const double y = crisp(bar.pixel({0.0, value}).y);
    canvas.line({bar.box.x_max + 1.0, y}, {bar.box.x_max + 6.0, y}, theme::kHairline, theme::kFrame);
    canvas.text({bar.box.x_max + 11.0, y}, tick_text(value, ticks), small_text());
  }
  TextStyle style = small_text();
  style.across = Anchor::middle;
  style.upwards = true;
  canvas.text({bar.box.x_max + widest_label(ticks) + 28.0, 0.5 * (bar.box.y_min + bar.box.y_max)},
              axis_name("|B| [G]", ticks), style);
}

std::vector<world::Magnet> all_magnets(const world::World& world) {
  std::vector<world::Magnet> all = world.magnets;
  for (const world::Mover& mover : world.movers)
    for (world::Magnet m : mover.magnets) {
      m.p = transform(mover.X_WM, m.p);
      all.push_back(m);
    }
  return all;
}

/// Draws one circle per magnet, filled if the south pole is up.
void draw_marks(Canvas& canvas, const world::World& world, const Plot& map) {
  const double scale = (map.box.x_max - map.box.x_min) / (map.x1 - map.x0);
  std::vector<world::Magnet> shown;
  glm::dvec2 low{1e300, 1e300}, high{-1e300, -1e300};
  for (const world::Magnet& m : all_magnets(world)) {
    if (m.p.x < map.x0 || m.p.x > map.x1 || m.p.y < map.y0 || m.p.y > map.y1) continue;
    low = {std::min(low.x, m.p.x), std::min(low.y, m.p.y)};
    high = {std::max(high.x, m.p.x), std::max(high.y, m.p.y)};
    shown.push_back(m);
  }
  if (shown.empty()) return;
  const double wide = scale * (high.x - low.x), tall = scale * (high.y - low.y);
  const auto count = static_cast<double>(shown.size());
  const double room = shown.size() > 1 ? std::max(std::sqrt(wide * tall / count), std::max(wide, tall) / count) : 50.0;
  if (room < kRoomForMarks) return;
  for (const world::Magnet& m : shown) {
    const double radius = std::clamp(m.radius * scale, 1.5, std::min(7.0, 0.2 * room));
    const double pen = std::min(1.6, 0.6 * radius);
    canvas.ring(map.pixel(m.p), radius, 2.5 * pen, theme::kMapHalo);
    canvas.ring(map.pixel(m.p), radius, pen, theme::kMapInk);
    if (m.moment < 0.0) canvas.disc(map.pixel(m.p), radius, theme::kMapInk);
  }
}

void draw_map(Canvas& canvas, const world::World& world, const FieldView& view, const FieldSamples& samples,
              const Plot& map, double edge) {
  const double top = top_of(samples);
  const std::vector<std::uint32_t> colors = shades();
  std::vector<std::uint32_t> cells;
  for (const double tesla : samples.map)
    cells.push_back(colors[static_cast<std::size_t>(std::lround(tesla / kGauss / top * (kShades - 1)))]);
  canvas.image({map.box.x_min + 0.0, map.box.y_min + 0.0}, {map.box.x_max + 0.0, map.box.y_max + 0.0},
               {samples.columns, samples.rows, cells});

  canvas.clip(map.box);
  draw_marks(canvas, world, map);
  const Line across[] = {{map.pixel(view.line.a), map.pixel(view.line.b)}};
  canvas.lines(across, 3.0, with_opacity(theme::kMapHalo, 0.35));
  draw_dashes(canvas, across, 1.4, 9.0, 6.0, with_opacity(theme::kMapInk, 0.8));
  canvas.unclip();
  draw_axes(canvas, map, "x [m]", "y [m]", false, edge);
  draw_bar(canvas, map, top);
}

void draw_curve(Canvas& canvas, const Plot& plot, const std::vector<ProfilePoint>& profile, std::uint32_t color,
                double (*value)(const ProfilePoint&), std::span<const double> dash = {}) {
  std::vector<glm::dvec2> points;
  for (const ProfilePoint& p : profile) points.push_back(plot.pixel({p.along, value(p)}));
  canvas.polyline(points, 2.2, color, dash);
}

double vectors(const ProfilePoint& p) { return std::hypot(p.field.x, p.field.y, p.field.z) / kGauss; }
double magnitudes(const ProfilePoint& p) { return p.field.magnitudes / kGauss; }

std::array<LegendItem, 2> curves(const Page& page) {
  LegendItem sum{LegendMark::line, theme::kBlue, "vector sum, as on the map"};
  LegendItem sizes{LegendMark::line, theme::kVermillion, "sum of magnitudes"};
  if (page.line_styles) sizes.dash = line_style(1);
  return {sum, sizes};
}

std::string profile_name(const FieldView& view, double width) {
  const std::string text = with_minus(fmt::format("along the line from ({:.4g}, {:.4g}) to ({:.4g}, {:.4g}) [m]",
                                                  view.line.a.x, view.line.a.y, view.line.b.x, view.line.b.y));
  return text_size(text, small_text()).x <= width ? text : "along the line [m]";
}

void draw_profile(Canvas& canvas, const FieldView& view, const FieldSamples& samples, Plot plot, const Page& page) {
  double top = 0.0;
  for (const ProfilePoint& p : samples.profile) top = std::max({top, vectors(p), magnitudes(p)});
  plot.x1 = glm::length(view.line.b - view.line.a);
  plot.y1 = top > 0.0 ? 1.06 * top : 1.0;
  draw_axes(canvas, plot, profile_name(view, plot.box.x_max - plot.box.x_min), "|B| [G]", true, page_edge(page));
  const auto legend = curves(page);
  canvas.clip(plot.box);
  draw_curve(canvas, plot, samples.profile, theme::kVermillion, magnitudes, legend[1].dash);
  draw_curve(canvas, plot, samples.profile, theme::kBlue, vectors);
  canvas.unclip();
  const double left = legend_left(page, plot.box.x_min);
  const auto places = place_legend(legend, canvas.width() - left - page_edge(page));
  draw_legend(canvas, {left, plot.box.y_max + kLegendBelow}, legend, places);
}

std::string title_of(const world::World& world) {
  const std::string file = std::filesystem::path(world.file).filename().string();
  return "Magnetic field of " + (world.name.empty() ? file : world.name);
}

std::string subtitle_of(const world::World& world, const FieldView& view, const FieldSamples& samples) {
  std::size_t magnets = world.magnets.size();
  for (const world::Mover& mover : world.movers) magnets += mover.magnets.size();
  std::string text = fmt::format("{} magnet{}, {:g} m above the ground, at most {:.3g} Gauss", magnets,
                                 magnets == 1 ? "" : "s", view.height, top_of(samples));
  if (world.earth_field != glm::dvec3{})
    text += fmt::format(", with the Earth's field of {:.3g} Gauss", glm::length(world.earth_field) / kGauss);
  if (world.magnet_cutoff > 0.0) text += fmt::format(", cut off at {:g} m", world.magnet_cutoff);
  return text;
}

}  // namespace

void draw_field(const world::World& world, const FieldView& view, const FieldSamples& samples, const std::string& path,
                const Page& page) {
  const double left = legend_left(page, view.map.x_min);
  const Heading heading = make_heading(title_of(world), subtitle_of(world, view, samples),
                                       view.map.x_max + view.right - left - page_edge(page), page);
  PixelBox place = view.map;  // below the heading, regardless of its number of lines
  place.y_max += static_cast<int>(heading.height) - place.y_min;
  place.y_min = static_cast<int>(heading.height);
  const double top = place.y_max + kGap;
  const Plot map{place, view.extent.x_min, view.extent.x_max, view.extent.y_min, view.extent.y_max};
  const Plot profile{
      {place.x_min, static_cast<int>(top), place.x_max, static_cast<int>(top) + view.profile}, 0, 1, 0, 1};
  const int width = place.x_max + view.right;
  const int rows = place_legend(curves(page), width - legend_left(page, place.x_min) - page_edge(page)).back().row + 1;
  const double high = top + view.profile + kLegendBelow + rows * kLegendRow + kFieldFoot;
  Canvas canvas(width, static_cast<int>(high), theme::kWhite);
  draw_heading(canvas, left, heading);
  draw_map(canvas, world, view, samples, map, page_edge(page));
  draw_profile(canvas, view, samples, profile, page);
  save_picture(canvas.drawing(), path, page);
}

}  // namespace sf::viz
