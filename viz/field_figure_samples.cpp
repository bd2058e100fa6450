// The view of the field figure and its samples.

#include <algorithm>
#include <cmath>

#include "sensors/magnetic_field/sampling.h"
#include "viz/field_figure.h"

namespace sf::viz {

namespace {

using world::Extent;

// [px] around the map.
constexpr int kLeft = 78;              // plus the page's edge: labels and name of the axis
constexpr int kTop = 100;              // a heading of two lines
constexpr double kFieldBelow = 320.0;  // heading, labels and legend, without the profile
constexpr double kMapPart = 0.65;      // of the page height shared by map and profile
constexpr double kLowestProfile = 90.0;
constexpr double kNarrowest = 640.0;
constexpr int kWidest = 1180;
constexpr double kUsualEdge = 26.0;
constexpr double kLowest = 220.0;
constexpr double kHighest = 900.0;

constexpr int kFinestCell = 2;        // [px]
constexpr int kCoarsestCell = 10;     // [px]
constexpr double kMaxPairs = 1.5e10;  // pairs of a magnet and a cell: about ten seconds on two cores
constexpr int kProfilePoints = 1201;

/// Bounding box of all magnets in the loaded world, with their maximum and minimum height; without magnets, the
/// world's.
struct MagnetBox {
  Extent flat{1e300, 1e300, -1e300, -1e300};
  double low = 1e300, high = -1e300;

  void add(glm::dvec2 p, double z) {
    flat = {std::min(flat.x_min, p.x), std::min(flat.y_min, p.y), std::max(flat.x_max, p.x), std::max(flat.y_max, p.y)};
    low = std::min(low, z);
    high = std::max(high, z);
  }
};

MagnetBox box_of(const world::World& world) {
  MagnetBox box;
  for (const world::Magnet& m : world.magnets) box.add(m.p, m.z);
  for (const world::Mover& mover : world.movers)
    for (const world::Magnet& m : mover.magnets) box.add(transform(mover.X_WM, m.p), mover.X_WM.z + m.z);
  const Extent& e = world.extent;
  if (box.high < box.low) box.add({e.x_min, e.y_min}, 0.0), box.add({e.x_max, e.y_max}, 0.0);
  return box;
}

/// The field decays to a tenth within 1.5 times the height above the magnets; at the magnets' own height, within a few
/// radii.
Extent default_extent(const MagnetBox& box, double height) {
  const double above = std::max(std::abs(height - box.low), std::abs(height - box.high));
  const Extent& b = box.flat;
  const double longest = std::max(b.x_max - b.x_min, b.y_max - b.y_min);
  const double margin = std::max({1.5 * std::min(above, std::max(longest, 1.0)), 0.04 * longest, 0.05});
  return {b.x_min - margin, b.y_min - margin, b.x_max + margin, b.y_max + margin};
}

Line default_line(const MagnetBox& box, const Extent& shown) {
  const Extent& b = box.flat;
  const glm::dvec2 middle{0.5 * (b.x_min + b.x_max), 0.5 * (b.y_min + b.y_max)};
  if (b.y_max - b.y_min > b.x_max - b.x_min) return {{middle.x, shown.y_min}, {middle.x, shown.y_max}};
  return {{shown.x_min, middle.y}, {shown.x_max, middle.y}};
}

/// Extends the shorter side to limit the aspect ratio of the map.
void place_map(FieldView& view, const Page& page) {
  Extent& shown = view.extent;
  const double wide = shown.x_max - shown.x_min;
  const double high = shown.y_max - shown.y_min;
  const int left = kLeft + static_cast<int>(page_edge(page));
  if (page_edge(page) < kUsualEdge) view.right = 112;
  const double widest = page_pixels(page, page.width, kWidest + left + view.right) - left - view.right;
  const double both = page_pixels(page, page.height, 0) - kFieldBelow;
  const double highest = page.height > 0.0 ? std::max(kMapPart * both, kLowestProfile) : kHighest;
  const double lowest = std::min({kLowest, highest, 0.8 * widest});
  const double scale = std::min(widest / wide, highest / high);
  const double width = std::round(std::max(wide * scale, std::min(kNarrowest, widest)));
  const double height = std::round(std::max(high * scale, lowest));
  const double profile = std::min(view.profile + 0.0, 0.75 * width);
  view.profile =
      static_cast<int>(page.height > 0.0 ? std::max(std::min(both - height, profile), kLowestProfile) : profile);
  const double more_x = 0.5 * (width / scale - wide);
  const double more_y = 0.5 * (height / scale - high);
  shown = {shown.x_min - more_x, shown.y_min - more_y, shown.x_max + more_x, shown.y_max + more_y};
  view.map = {left, kTop, left + static_cast<int>(width), kTop + static_cast<int>(height)};
}

/// Estimates the number of magnets summed per cell.
double magnets_counted(const world::World& world, const FieldView& view) {
  const double all = static_cast<double>(world.magnets.size());
  const double area = (view.extent.x_max - view.extent.x_min) * (view.extent.y_max - view.extent.y_min);
  const double near = world.magnet_cutoff > 0.0 ? M_PI * world.magnet_cutoff * world.magnet_cutoff / area : 1.0;
  return std::max(1.0, all * std::min(1.0, near));
}

int cell_pixels(const world::World& world, const FieldView& view) {
  const double pixels = static_cast<double>(view.map.x_max - view.map.x_min) * (view.map.y_max - view.map.y_min);
  int cell = kFinestCell;
  while (cell < kCoarsestCell && pixels / (cell * cell) * magnets_counted(world, view) > kMaxPairs) ++cell;
  return cell;
}

std::vector<sensors::FieldPoint> map_places(const FieldView& view, const FieldSamples& samples) {
  const Extent& e = view.extent;
  std::vector<sensors::FieldPoint> places;
  for (int row = 0; row < samples.rows; ++row)
    for (int column = 0; column < samples.columns; ++column)
      places.push_back({e.x_min + (column + 0.5) / samples.columns * (e.x_max - e.x_min),
                        e.y_max - (row + 0.5) / samples.rows * (e.y_max - e.y_min), view.height});
  return places;
}

}  // namespace

FieldView field_view(const world::World& world, const FieldRequest& wish) {
  const MagnetBox box = box_of(world);
  FieldView view;
  view.height = wish.height;
  view.extent = wish.extent.value_or(default_extent(box, wish.height));
  const Extent wanted = view.extent;
  place_map(view, wish.page);
  view.line = wish.line.value_or(default_line(box, wanted));
  return view;
}

FieldSamples sample_field(const world::World& world, gpu::Device& device, const FieldView& view,
                          const std::function<void(double)>& progress) {
  FieldSamples samples;
  const int cell = cell_pixels(world, view);
  samples.columns = std::max(1, (view.map.x_max - view.map.x_min) / cell);
  samples.rows = std::max(1, (view.map.y_max - view.map.y_min) / cell);
  for (const sensors::FieldSum& b :
       sensors::sample_field(world, device, map_places(view, samples), {.progress = progress}))
    samples.map.push_back(std::hypot(b.x, b.y, b.z));

  const glm::dvec2 along = view.line.b - view.line.a;
  std::vector<sensors::FieldPoint> places;
  for (int i = 0; i < kProfilePoints; ++i) {
    const double part = static_cast<double>(i) / (kProfilePoints - 1);
    const glm::dvec2 p = view.line.a + part * along;
    samples.profile.push_back({part * glm::length(along), p, {}});
    places.push_back({p.x, p.y, view.height});
  }
  const auto sums = sensors::sample_field(world, device, places, {.magnitudes = true});
  for (std::size_t i = 0; i < sums.size(); ++i) samples.profile[i].field = sums[i];
  return samples;
}

}  // namespace sf::viz
