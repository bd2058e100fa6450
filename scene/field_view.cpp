#include "scene/field_view.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scene/rasterizer.h"

namespace sf::scene {

namespace {

constexpr double kRounding = 0x1p-53;
constexpr double kRounding32 = 0x1p-24;

/// Heights of a cell's corners: a at its smallest x and y, b at larger x, d at larger y, e opposite.
struct Corners {
  double a, b, d, e;
  Corners(const HeightField& field, glm::ivec2 cell) {
    const float* const row = field.heights.data() + field.at(cell.x, cell.y);
    const float* const next = row + field.columns;
    a = row[0], b = row[1], d = next[0], e = next[1];
  }
  /// @param x, y in the cell
  double height(double x, double y) const {
    return a + (b - a) * std::max(x - y, 0.0) + (d - a) * std::max(y - x, 0.0) + (e - a) * std::min(x, y);
  }
};

class Walk {
 public:
  Walk(const FieldView& view, const FieldRay& ray, const FieldStart& start, double end)
      : v_(view), ray_(ray), end_(end), margin_(view.error) {
    cell_ = start.cell, t_ = start.t, side_ = start.side;
  }
  FieldHit run();

 private:
  double exit_of(int axis) const;
  bool visit(double t, bool upper, const Corners& corners, glm::dvec2 place);
  void finish(const FieldTriangle& triangle, bool flagged);
  double fall(const FieldTriangle& triangle) const;
  bool near_border(const FieldTriangle& triangle) const;

  const FieldView& v_;
  const FieldRay& ray_;
  double end_;
  double margin_;  ///< [m] error of F
  glm::ivec2 cell_{};
  double t_ = 0.0;
  int side_ = 0;
  bool touched_ = false;     ///< F was within the error at the last crossings: at a line, or several at a point
  double touched_at_ = 0.0;  ///< [m] the first of these
  bool below_ = false;       ///< F was not above 0 there
  bool along_ = false;       ///< the beam runs along the surface
  FieldHit hit_;             ///< with the triangle before the first of these crossings
};

/// [m] where the beam leaves the cell. Beams along the border stay in the field.
double Walk::exit_of(int axis) const {
  if (ray_[axis] == 0.0) return HUGE_VAL;
  const bool up = ray_[axis] > 0.0;
  const int line = cell_[axis] + up, last = (axis == 0 ? v_.field->columns : v_.field->rows) - 1;
  const double distance = (line - v_.base[axis]) - v_.from[axis];
  if (up ? line == last : line == 0) return (distance + (up ? v_.border : -v_.border)) / ray_[axis];
  return distance / ray_[axis];
}

/// Rate at which the beam sinks towards a triangle.
double Walk::fall(const FieldTriangle& triangle) const {
  const FieldPlane plane = v_.plane_of(triangle);
  return std::abs(ray_.z - (plane.slope.x * ray_.x + plane.slope.y * ray_.y));
}

bool Walk::near_border(const FieldTriangle& triangle) const {
  const FieldPlane plane = v_.plane_of(triangle);
  const double t = (v_.z - plane.at) / ((plane.slope.x * ray_.x + plane.slope.y * ray_.y) - ray_.z);
  for (int axis = 0; axis < 2; ++axis) {
    const double place = v_.base[axis] + (v_.from[axis] + t * ray_[axis]);
    if (place <= v_.border || place >= (axis == 0 ? v_.field->columns : v_.field->rows) - 1 - v_.border) return true;
  }
  return false;
}

void Walk::finish(const FieldTriangle& triangle, bool flagged) {
  hit_ = {true, hit_.flagged || flagged || near_border(triangle), triangle};
}

/// Takes the end of a part of the beam over one triangle. @return true if this decides where the beam meets the surface
bool Walk::visit(double t, bool upper, const Corners& corners, glm::dvec2 place) {
  const double above = v_.z + t * ray_.z - corners.height(place.x + t * ray_.x, place.y + t * ray_.y);
  const FieldTriangle triangle{cell_, upper};
  if (side_ == 0) {  // at the sensor or the border
    side_ = above > margin_ ? 1 : above < -margin_ ? -1 : 0;
    return false;
  }
  const double f = side_ * above;
  if (f > margin_) {
    if (touched_) finish(hit_.triangle, true);
    return touched_;
  }
  if (f >= -margin_) {
    if (!touched_) touched_ = true, touched_at_ = t, below_ = f <= 0.0, hit_.triangle = triangle;
    along_ = t - touched_at_ > 0.25 * kRangeError;
    return false;
  }
  if (!touched_) return finish(triangle, false), true;
  const double slow = 4.0 * margin_ / kRangeError;
  finish(below_ ? hit_.triangle : triangle, along_ || fall(hit_.triangle) < slow || fall(triangle) < slow);
  return true;
}

FieldHit Walk::run() {
  if (side_ == 0) {
    const glm::dvec2 place = v_.from - glm::dvec2(cell_ - v_.base);
    visit(t_, false, Corners(*v_.field, cell_), place);
    hit_.flagged = side_ == 0;
  }
  while (v_.has(cell_) && t_ <= end_) {
    const Corners corners(*v_.field, cell_);
    const glm::dvec2 place = v_.from - glm::dvec2(cell_ - v_.base);
    const double x = exit_of(0), y = exit_of(1), out = std::max(std::min(std::min(x, y), end_), t_);
    const double turn = ray_.x - ray_.y, gap = place.y - place.x;
    const double diagonal = turn != 0.0 ? gap / turn : gap > 0.0 ? HUGE_VAL : -HUGE_VAL;
    const bool first = turn >= 0.0;  // the triangle before the diagonal is the upper one
    if (diagonal > t_ && diagonal < out && visit(diagonal, first, corners, place)) return hit_;
    if (visit(out, diagonal < out ? !first : first, corners, place)) return hit_;
    if (out >= end_) break;
    t_ = out;
    const int axis = x <= y ? 0 : 1;
    cell_[axis] += ray_[axis] > 0.0 ? 1 : -1;
  }
  if (touched_) finish(hit_.triangle, true);
  return hit_;
}

}  // namespace

FieldView::FieldView(const HeightField& f, const base::RigidTransform& X, double range)
    : field(&f), X_FS(X), per_metre(1.0 / f.cell), z(X.p.z), range_max(range) {
  constexpr double kFarthest = 1 << 22;
  const glm::dvec2 place = glm::dvec2(X.p) * per_metre;
  const glm::dvec2 cell = glm::clamp(glm::floor(place), -kFarthest, kFarthest);
  const glm::dvec2 last(f.columns - 2, f.rows - 2);
  const bool inside = place.x >= 0.0 && place.y >= 0.0 && place.x <= last.x + 1.0 && place.y <= last.y + 1.0;
  base = inside ? glm::min(cell, last) : cell;
  from = place - glm::dvec2(base);
  const double height = std::max(std::abs(f.lowest), std::abs(f.highest));
  const double cells = range * std::max(per_metre.x, per_metre.y);
  border = kRounding * (8.0 * std::max(std::abs(place.x), std::abs(place.y)) + 12.0 * cells + 4.0);
  error = kRounding * (16.0 * (height + std::abs(z) + range) + 8.0 * glm::length(X.p)) + 8.0 * border * f.steepest;
  error32 = static_cast<float>(kRounding32 * 1.01 * (10.0 * (height + std::abs(z)) + 32.0 * f.steepest));
  error32_per_metre =
      static_cast<float>(kRounding32 * 1.01 * (8.0 + 48.0 * f.steepest * std::max(per_metre.x, per_metre.y)));
  border32 = static_cast<float>(kRounding32 * 16.0);
  border32_per_metre = static_cast<float>(kRounding32 * 24.0 * std::max(per_metre.x, per_metre.y));
  searchable = cells < 0x1p20 && std::max(std::abs(place.x), std::abs(place.y)) < 0x1p21;
  constexpr double kRim = 0x1p-8;  // [cells] beams from here enter the field as from outside
  if (!inside || place.x < kRim || place.y < kRim || place.x > last.x + 1.0 - kRim || place.y > last.y + 1.0 - kRim)
    return;
  const double above = z - Corners(f, base).height(from.x, from.y);
  near = std::abs(above) <= error32;
  if (!near) side = above > 0.0 ? 1 : -1;
}

FieldPlane FieldView::plane_of(const FieldTriangle& triangle) const {
  const Corners c(*field, triangle.cell);
  const glm::dvec2 slope = triangle.upper ? glm::dvec2{c.e - c.d, c.d - c.a} : glm::dvec2{c.b - c.a, c.e - c.b};
  const glm::dvec2 place = from - glm::dvec2(triangle.cell - base);
  return {c.a + (slope.x * place.x + slope.y * place.y), slope};
}

FieldHit walk(const FieldView& view, const FieldRay& ray, const FieldStart& start, double end) {
  return Walk(view, ray, start, end).run();
}

FieldHit walk(const FieldView& view, const FieldRay& ray, double end) {
  double in = 0.0, out = end;
  for (int axis = 0; axis < 2; ++axis) {
    const double from = view.base[axis] + view.from[axis];
    const double last = (axis == 0 ? view.field->columns : view.field->rows) - 1;
    const double low = -view.border - from, high = last + view.border - from;
    if (ray[axis] == 0.0) {
      if (low > 0.0 || high < 0.0) return {};
      continue;
    }
    in = std::max(in, (ray[axis] > 0.0 ? low : high) / ray[axis]);
    out = std::min(out, (ray[axis] > 0.0 ? high : low) / ray[axis]);
  }
  if (in > out) return {};
  const glm::dvec2 at = view.from + in * glm::dvec2(ray);
  const glm::ivec2 cell = view.base + glm::ivec2(glm::floor(at));
  return walk(view, ray, {glm::clamp(cell, glm::ivec2(0), {view.field->columns - 2, view.field->rows - 2}), in, 0},
              end);
}

}  // namespace sf::scene
