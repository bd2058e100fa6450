#include "scene/field_shadow.h"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>

namespace sf::scene {

/// The rest of a ray, from `t` to `end` [m].
struct FieldShadow::Ray {
  glm::dvec3 p{}, d{};  ///< as `from_` and `to_light_`
  double t = 0.0, end = HUGE_VAL;
  glm::ivec2 cell{};  ///< at `t`
  std::int32_t cell_at(int axis) const { return static_cast<std::int32_t>(std::floor(p[axis] + t * d[axis])); }
};

/// Where a ray leaves a block: through a line x or y = `line`, or nowhere before its end.
struct FieldShadow::Exit {
  double t = 0.0;  ///< [m]
  int axis = -1;
  std::int32_t line = 0;
};

FieldShadow::FieldShadow(const Terrain& terrain, glm::dvec3 p_W, glm::dvec3 to_light) : field_(terrain.field) {
  const glm::dmat3 R_FW = glm::transpose(terrain.X_WF.R);
  const glm::dvec3 unit(1.0 / field_->cell.x, 1.0 / field_->cell.y, 1.0);
  for (int axis = 0; axis < 3; ++axis) X_[axis] = R_FW[axis] * unit;
  from_ = X_ * (p_W - terrain.X_WF.p), to_light_ = X_ * to_light;
}

/// Returns whether a ray is certainly above the surface within its block.
bool FieldShadow::is_clear(const Ray& ray, std::int32_t level, double to) const {
  const HeightField& f = *field_;
  const std::int32_t row = ((ray.cell.y - f.bias) >> level) + f.bias / 2, column = ray.cell.x >> level;
  const BoundingPlane& plane =
      f.above[static_cast<std::size_t>(row) * static_cast<std::size_t>(f.pitch) + static_cast<std::size_t>(column)];
  const double x = ray.p.x - (column << level), y = ray.p.y - (ray.cell.y >> level << level);
  const double slope_x = double{f.slope_unit} * plane.slope[0], slope_y = double{f.slope_unit} * plane.slope[1];
  const double above = ray.p.z - (plane.height + x * slope_x + y * slope_y);
  const double rise = ray.d.z - (ray.d.x * slope_x + ray.d.y * slope_y);
  return above + std::min(ray.t * rise, to * rise) > 0.0;
}

/// Returns whether a ray is below the surface within its cell.
bool FieldShadow::is_hidden(const Ray& ray, double to, double room) const {
  const float* const row = field_->heights.data() + field_->at(ray.cell.x, ray.cell.y);
  const double a = row[0], across = row[1] - a, along = row[field_->columns] - a,
               opposite = row[field_->columns + 1] - a;
  const double x = ray.p.x - ray.cell.x, y = ray.p.y - ray.cell.y, turn = ray.d.x - ray.d.y;
  const auto above = [&](double t) {
    const double px = x + t * ray.d.x, py = y + t * ray.d.y;
    return ray.p.z + t * ray.d.z -
           (a + across * std::max(px - py, 0.0) + along * std::max(py - px, 0.0) + opposite * std::min(px, py));
  };
  const double diagonal = turn != 0.0 ? std::clamp((y - x) / turn, ray.t, to) : to;
  return std::min(std::min(above(ray.t), above(diagonal)), above(to)) < -room;
}

/// Moves a ray to where it may first be below the surface. @return false if it never is
bool FieldShadow::enter(Ray& ray) const {
  const glm::ivec2 cells(field_->columns - 1, field_->rows - 1);
  if (ray.d.z > 0.0) ray.end = std::max(0.0, (field_->highest - ray.p.z) / ray.d.z);
  for (int axis = 0; axis < 2; ++axis) {
    if (ray.d[axis] == 0.0) {
      if (!(ray.p[axis] >= 0.0 && ray.p[axis] <= cells[axis])) return false;
      continue;
    }
    const double one = -ray.p[axis] / ray.d[axis], other = (cells[axis] - ray.p[axis]) / ray.d[axis];
    ray.t = std::max(ray.t, std::min(one, other)), ray.end = std::min(ray.end, std::max(one, other));
  }
  if (!(ray.t <= ray.end && ray.end < HUGE_VAL)) return false;
  for (int axis = 0; axis < 2; ++axis) ray.cell[axis] = std::clamp(ray.cell_at(axis), 0, cells[axis] - 1);
  return true;
}

/// Finds where a ray leaves its block.
FieldShadow::Exit FieldShadow::exit_of(const Ray& ray, std::int32_t level) const {
  Exit exit{.t = ray.end};
  const std::int32_t cells[2] = {field_->columns - 1, field_->rows - 1};
  for (int axis = 0; axis < 2; ++axis) {
    if (ray.d[axis] == 0.0) continue;
    const std::int32_t first = ray.cell[axis] >> level << level;
    const std::int32_t line = ray.d[axis] > 0.0 ? std::min(first + (1 << level), cells[axis]) : first;
    const double t = (line - ray.p[axis]) / ray.d[axis];
    if (t < exit.t) exit = {t, axis, line};
  }
  exit.t = std::max(exit.t, ray.t);
  return exit;
}

/// Moves a ray out of its block. @return false if it leaves the field
bool FieldShadow::leave(Ray& ray, const Exit& exit, std::int32_t level) const {
  const std::int32_t cells[2] = {field_->columns - 1, field_->rows - 1};
  const int along = exit.axis, across = 1 - along;
  const std::int32_t first = ray.cell[across] >> level << level;
  ray.t = exit.t;
  ray.cell[along] = ray.d[along] > 0.0 ? exit.line : exit.line - 1;
  ray.cell[across] = std::clamp(ray.cell_at(across), first, std::min(first + (1 << level), cells[across]) - 1);
  return ray.cell[along] >= 0 && ray.cell[along] < cells[along];
}

bool FieldShadow::hides(glm::vec3 p, float room) const {
  Ray ray{.p = from_ + X_ * glm::dvec3(p), .d = to_light_};
  if (!enter(ray)) return false;
  for (std::int32_t level = 1;;) {
    const Exit exit = exit_of(ray, level);
    if (level > 0 && !is_clear(ray, level, exit.t)) {
      --level;
      continue;
    }
    if (level == 0 && is_hidden(ray, exit.t, room)) return true;
    if (exit.axis < 0 || !leave(ray, exit, level)) return false;
    if (level < field_->levels && (exit.line >> level & 1) == 0) ++level;
  }
}

}  // namespace sf::scene
