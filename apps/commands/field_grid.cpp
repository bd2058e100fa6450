#include "apps/commands/field_grid.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "sensors/magnetic_field/sampling.h"

namespace sf::apps {

namespace {

constexpr double kMostCells = 400.0;  ///< along the longer side

}  // namespace

std::optional<viz::GridData> field_grid(const world::World& world, gpu::Device& device, double height) {
  if (world.magnets.empty()) return std::nullopt;
  const world::Extent& e = world.extent;
  const double wide = e.x_max - e.x_min, high = e.y_max - e.y_min;
  const double cell = std::max(std::max(wide, high) / kMostCells, 1e-3);
  viz::GridData grid{e.x_min,
                     e.y_min,
                     height,
                     cell,
                     cell,
                     static_cast<int>(std::ceil(wide / cell)) + 1,
                     static_cast<int>(std::ceil(high / cell)) + 1,
                     {}};
  std::vector<sensors::FieldPoint> points;
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i)
      points.push_back({grid.x + (i + 0.5) * cell, grid.y + (j + 0.5) * cell, height});
  viz::DataArray magnitude{"magnitude", 1, {}}, field{"B", 3, {}}, in_plane{"in_plane", 3, {}};
  for (const sensors::FieldSum& b : sensors::sample_field(world, device, points)) {
    magnitude.values.push_back(base::hypot(b.x, b.y, b.z));
    field.values.insert(field.values.end(), {b.x, b.y, b.z});
    in_plane.values.insert(in_plane.values.end(), {b.x, b.y, 0.0});
  }
  grid.cell_data = {std::move(magnitude), std::move(field), std::move(in_plane)};
  return grid;
}

}  // namespace sf::apps
