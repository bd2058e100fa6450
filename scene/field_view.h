#pragma once
// A height field as seen from the sensor of a scan, and the walk of a beam over it in 64 bits.
//
// Along a beam, F(t) is the beam's height above the surface: continuous, and linear between the lines of the grid and
// the diagonals. Its first change of sign is the range. F is computed once for each line that the beam crosses, by one
// of the cells at the line: no beam passes between cells or their triangles.
//
// Errors of F, with u the rounding unit, z the sensor's height, H the largest height, S the largest difference along an
// edge of a cell, P the sensor's place and D the direction in cells (per metre), p the sensor's place in metres:
// - places of points of the beam in cells: 8 u |P| + 12 u t |D| + 4 u = e; times of crossings move them by as much;
// - F: the surface's slope times 4 e, which is 8 S e at most, and u (16 (H + |z| + t) + 8 |p|) of heights.
// In 32 bits the sensor's cell is subtracted in 64 bits before, hence without P: e = u (4 + 6 t |D|).

#include <cstdint>
#include <glm/ext/vector_double3.hpp>
#include <glm/ext/vector_int2.hpp>

#include "base/rigid_transform.h"
#include "scene/height_field.h"

namespace sf::scene {

/// Direction of a beam in the field's frame: x and y in cells per metre, z in metres per metre.
using FieldRay = glm::dvec3;

/// A triangle of a cell.
struct FieldTriangle {
  glm::ivec2 cell{};
  bool upper = false;  ///< the one on the side of larger y
};

/// Plane of a triangle: height = at + x slope.x + y slope.y, with x and y in cells from the sensor.
struct FieldPlane {
  double at = 0.0;     ///< [m]
  glm::dvec2 slope{};  ///< [m per cell]
};

struct FieldView {
  /// @param X_FS the sensor in the field's frame  @param range_max [m] > 0
  FieldView(const HeightField& field, const base::RigidTransform& X_FS, double range_max);

  const HeightField* field;
  base::RigidTransform X_FS;
  glm::dvec2 per_metre;  ///< [1/m] cells
  glm::ivec2 base;       ///< the sensor's cell, which may be outside of the field
  glm::dvec2 from;       ///< the sensor's place in this cell, in [0, 1]
  double z;              ///< [m] the sensor's height
  double error;          ///< [m] of F in 64 bits
  double border;         ///< [cells] beams this close to the field's border may meet or miss it
  double range_max;
  float error32, error32_per_metre;    ///< [m], [1] of F in 32 bits
  float border32, border32_per_metre;  ///< [cells], as `border`
  bool searchable;                     ///< 32 bits can tell cells apart
  bool near = false;                   ///< the sensor may be on the surface, as 32 bits compute it
  int side = 0;                        ///< 1: it is over the field and above it; -1: below; 0: neither

  FieldRay ray_of(glm::dvec3 direction) const {
    const glm::dmat3& R = X_FS.R;
    return {((R[0].x * direction.x + R[1].x * direction.y) + R[2].x * direction.z) * per_metre.x,
            ((R[0].y * direction.x + R[1].y * direction.y) + R[2].y * direction.z) * per_metre.y,
            (R[0].z * direction.x + R[1].z * direction.y) + R[2].z * direction.z};
  }
  FieldPlane plane_of(const FieldTriangle& triangle) const;
  bool has(glm::ivec2 cell) const {
    return cell.x >= 0 && cell.y >= 0 && cell.x < field->columns - 1 && cell.y < field->rows - 1;
  }
};

/// A point of a beam before which it certainly does not meet the field.
struct FieldStart {
  glm::ivec2 cell{};
  double t = 0.0;  ///< [m]
  int side = 0;    ///< 1: the beam is certainly above the surface; -1: below; 0: unknown
};

struct FieldHit {
  bool found = false;
  bool flagged = false;  ///< the beam may miss this triangle, or meet the surface elsewhere
  FieldTriangle triangle;
};

/// Finds the first triangle that a beam may meet. Its result does not depend on the start.
/// @param end [m] where the search ends, at the latest
FieldHit walk(const FieldView& view, const FieldRay& ray, const FieldStart& start, double end);
/// The same from where the beam enters the field.
FieldHit walk(const FieldView& view, const FieldRay& ray, double end);

}  // namespace sf::scene
