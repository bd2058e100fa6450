#pragma once
// A plain caster in C++: traverses a uniform grid of segments cell by cell, in `double` (Amanatides and Woo, "A fast
// voxel traversal algorithm for ray tracing", Eurographics 1987).

#include "bench/caster.h"

namespace sf::bench {

/// Segments by cell. A cell contains every segment whose bounding box is within `pad` of it.
struct SegmentGrid {
  struct Item {
    double ax, ay, ex, ey;  ///< [m] start and extent
    std::uint32_t model;
  };
  double x = 0.0, y = 0.0;  ///< [m] lower corner
  double cell = 1.0;        ///< [m]
  int columns = 1, rows = 1;
  std::vector<std::uint32_t> first;  ///< index of each cell's first item; one more entry for the end
  std::vector<Item> items;
};

SegmentGrid make_grid(const world::World& world, double z, double cell);

/// Casts one sensor's beams. Writes a range and a model, or base::kNoHit, per beam.
using Walk = void (*)(const SegmentGrid& grid, const base::Pose& X_WS, const std::vector<glm::dvec2>& beams,
                      double range_max, double* ranges, std::uint32_t* hits);

/// One source compiled twice: for any x86-64 processor, and for the build machine.
void walk_portable(const SegmentGrid& grid, const base::Pose& X_WS, const std::vector<glm::dvec2>& beams,
                   double range_max, double* ranges, std::uint32_t* hits);
void walk_native(const SegmentGrid& grid, const base::Pose& X_WS, const std::vector<glm::dvec2>& beams,
                 double range_max, double* ranges, std::uint32_t* hits);

/// `scans` must outlive it.
std::unique_ptr<Caster> make_grid_caster(const Scans& scans, const std::string& name, Walk walk);

}  // namespace sf::bench
