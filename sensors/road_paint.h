#pragma once
// Colours of road markings at points of the ground: exact outlines, found by a grid.

#include <array>
#include <cstdint>
#include <glm/ext/vector_double2.hpp>
#include <glm/ext/vector_double3.hpp>
#include <glm/ext/vector_float3.hpp>
#include <glm/ext/vector_int2.hpp>
#include <span>
#include <vector>

#include "base/box.h"
#include "world/world.h"

namespace sf::sensors {

/// Immutable once built; any number of threads may read it.
class RoadPaint {
 public:
  explicit RoadPaint(const world::World& world);
  bool empty() const { return pieces_.empty(); }
  /// Returns the linear colour of the last marking painted at a point [m] of the ground; null: none.
  const glm::vec3* color_at(glm::dvec3 p) const;

 private:
  /// Part of a marking along one piece of its line. A point p is inside if edge[k].x p.x + edge[k].y p.y >= edge[k].z
  /// for all k.
  struct Piece {
    std::array<glm::dvec3, 4> edge;
    double z_min = 0.0, z_max = 0.0;  ///< [m]
    glm::vec3 color;
  };
  glm::ivec2 cell_of(glm::dvec2 p) const;
  template <class Visit>
  void for_each_cell(std::span<const glm::dvec2> corners, const Piece& piece, const Visit& visit) const;

  std::vector<Piece> pieces_;
  base::Box box_ = base::empty_box();
  double side_ = 1.0;                 ///< [m] of a cell
  glm::ivec2 cells_{};                ///< along x and y
  std::vector<std::uint32_t> first_;  ///< per cell, plus one: index in `rows_`
  std::vector<std::uint32_t> rows_;   ///< of `pieces_`, per cell ascending
};

}  // namespace sf::sensors
