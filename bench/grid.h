#pragma once
// A plain caster in C++: a uniform grid of segments, walked cell by cell in `double`.
//
// After Amanatides and Woo, "A fast voxel traversal algorithm for ray tracing", Eurographics 1987.

#include "bench/caster.h"

namespace sf::bench {

/// Segments by cell. A segment is in every cell that its bounding box comes within `pad` of.
struct SegmentGrid {
  struct Item {
    double ax, ay, ex, ey;  ///< [m] start and extent
    std::uint32_t model;
  };
  double x = 0.0, y = 0.0;  ///< [m] lower corner
  double cell = 1.0;        ///< [m]
  int columns = 1, rows = 1;
  std::vector<std::uint32_t> first;  ///< per cell and one more: where its items begin
  std::vector<Item> items;
};

SegmentGrid make_grid(const world::World& world, double z, double cell);

/// One sensor's beams. Writes a range and a model, or base::kNoHit, per beam.
using Walk = void (*)(const SegmentGrid& grid, const base::Pose& X_WS, const std::vector<glm::dvec2>& beams,
                      double range_max, double* ranges, std::uint32_t* hits);

/// The same source built twice: for any x86-64, and for the very processor it was built on.
void walk_portable(const SegmentGrid& grid, const base::Pose& X_WS, const std::vector<glm::dvec2>& beams,
                   double range_max, double* ranges, std::uint32_t* hits);
void walk_native(const SegmentGrid& grid, const base::Pose& X_WS, const std::vector<glm::dvec2>& beams,
                 double range_max, double* ranges, std::uint32_t* hits);

/// `scans` must outlive it.
std::unique_ptr<Caster> make_grid_caster(const Scans& scans, const std::string& name, Walk walk);

}  // namespace sf::bench
