#include "vision/rendering/patch_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <span>
#include <utility>

#include "base/elementary.h"

namespace sf::vision {

namespace {

constexpr double kLayer = 5e-5;   // [m]
constexpr double kMargin = 4.0;   // [px] for the curvature between the points of an outline
constexpr int kDiscCorners = 64;  // even

/// Returns the cells on one side of a tag, without its border.
int cells_of(const Patch& patch) { return patch.pattern.cells; }

/// [m] Returns half of the size of a patch, including the border of a tag.
glm::dvec2 half_of(const Patch& patch) {
  const bool tag = patch.shape == Patch::Shape::tag;
  return 0.5 * patch.size + (tag ? patch.border * patch.size.x / cells_of(patch) : 0.0);
}

void add_rectangle(glm::dvec2 low, glm::dvec2 high, std::uint32_t material, scene::Mesh& mesh) {
  if (!(low.x < high.x && low.y < high.y)) return;
  const std::array<glm::dvec3, 4> corners{{{low, 0.0}, {high.x, low.y, 0.0}, {high, 0.0}, {low.x, high.y, 0.0}}};
  mesh.add(corners, std::nullopt);
  mesh.materials.push_back(material);
}

void add_disc(glm::dvec2 half, std::uint32_t material, scene::Mesh& mesh) {
  const auto corner = [&](int i) { return glm::dvec3(half * base::direction(2.0 * M_PI * i / kDiscCorners), 0.0); };
  for (int i = 0; i + 3 < kDiscCorners; i += 2) {
    const std::array<glm::dvec3, 4> corners{corner(0), corner(i + 1), corner(i + 2), corner(i + 3)};
    mesh.add(corners, std::nullopt);
    mesh.materials.push_back(material);
  }
}

/// Adds the cells of a tag, and its border, row by row in runs of one colour.
/// @param dark material, followed by the light one
void add_tag(const Patch& patch, std::uint32_t dark, scene::Mesh& mesh) {
  const int n = cells_of(patch);
  const double half = half_of(patch).x, cell = patch.size.x / n;
  // Row -1 and column -1 are the border, and so are those after the last.
  const auto edge = [&](int i) { return i < 0 ? -half : i > n ? half : (i - 0.5 * n) * cell; };
  const auto is_light = [&](int row, int column) {
    const bool border = row < 0 || column < 0 || row >= n || column >= n;
    return border || patch.pattern.white[static_cast<std::size_t>(row * n + column)] != 0;
  };
  for (int row = -1; row <= n; ++row)
    for (int first = -1, column = -1; column <= n; ++column) {
      if (column < n && is_light(row, column + 1) == is_light(row, first)) continue;
      const std::uint32_t material = dark + (is_light(row, first) ? 1 : 0);
      add_rectangle({edge(first), -edge(row + 1)}, {edge(column + 1), -edge(row)}, material, mesh);
      first = column + 1;
    }
}

/// Returns points on the outline of a square of half side 1, or of the disc in it, in order around it.
std::vector<glm::dvec2> outline_of(Patch::Shape shape) {
  constexpr int kSteps = 16;  // along each side, since distortion bends straight lines
  std::vector<glm::dvec2> points;
  for (int i = 0; i < 4 * kSteps; ++i) {
    const glm::dvec2 p = base::direction(2.0 * M_PI * i / (4 * kSteps));
    const bool disc = shape == Patch::Shape::disc;
    points.push_back(p / (disc ? base::cos(M_PI / (4 * kSteps)) : std::max(std::abs(p.x), std::abs(p.y))));
  }
  return points;
}

/// Returns the points of a patch's outline, at the start and the end of the exposure [px]; those of the whole image if
/// one cannot be projected.
std::vector<glm::dvec2> imaged_outline(const Camera& camera, const Patch& patch, double middle) {
  const double seconds = 0.5 * (camera.exposure + camera.readout);
  const glm::dvec2 half = half_of(patch) + seconds * std::abs(patch.turn) * glm::length(half_of(patch));
  const base::Pose X_WP = pose_at(patch, middle);
  std::vector<glm::dvec2> image;
  for (const glm::dvec2& point : outline_of(patch.shape))
    for (const double t : {-seconds, seconds}) {
      const glm::dvec2 p = glm::dvec2{X_WP.x, X_WP.y} + t * patch.velocity + base::rotate(X_WP.yaw, half * point);
      const auto pixel = project(camera, {p.x, p.y, X_WP.z});
      const glm::dvec2 size(camera.intrinsics.width, camera.intrinsics.height);
      if (!pixel) return {{0.0, 0.0}, {size.x, 0.0}, size, {0.0, size.y}};
      image.push_back(*pixel);
    }
  return image;
}

/// Returns the corners of the convex hull of points, in order around it (A. Andrew's monotone chains, 1979).
std::vector<glm::dvec2> hull_of(std::vector<glm::dvec2> points) {
  std::ranges::sort(points, [](glm::dvec2 a, glm::dvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  std::vector<glm::dvec2> hull;
  const auto add_chain = [&](auto first, auto last) {
    for (const std::size_t start = hull.size(); first != last; ++first) {
      const auto turns = [&](glm::dvec2 a, glm::dvec2 b) {
        return (b.x - a.x) * (first->y - a.y) - (b.y - a.y) * (first->x - a.x) > 0.0;
      };
      while (hull.size() >= start + 2 && !turns(hull[hull.size() - 2], hull.back())) hull.pop_back();
      hull.push_back(*first);
    }
    hull.pop_back();  // the first of the other chain
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  return hull;
}

/// Returns the first and the last column of a row within kMargin of a convex hull; none if the first is the larger.
std::array<int, 2> columns_of(std::span<const glm::dvec2> hull, int v, int width) {
  double low = width, high = -1.0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    // The part of the edge between the rows v - kMargin and v + kMargin.
    const glm::dvec2 a = hull[i], b = hull[(i + 1) % hull.size()];
    const double top = std::clamp(v - kMargin, std::min(a.y, b.y), std::max(a.y, b.y)),
                 bottom = std::clamp(v + kMargin, std::min(a.y, b.y), std::max(a.y, b.y));
    if (std::max(a.y, b.y) < v - kMargin || std::min(a.y, b.y) > v + kMargin) continue;
    for (const double y : {top, bottom}) {
      const double x = a.y == b.y ? a.x : a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
      low = std::min(low, x), high = std::max(high, x);
    }
  }
  return {static_cast<int>(std::clamp(std::floor(low - kMargin), 0.0, static_cast<double>(width))),
          static_cast<int>(std::clamp(std::ceil(high + kMargin), -1.0, width - 1.0))};
}

bool may_overlap(std::span<const glm::dvec2> a, std::span<const glm::dvec2> b) {
  const auto apart = [&](const auto& axis) {
    const auto [a_low, a_high] = std::ranges::minmax(a, {}, axis);
    const auto [b_low, b_high] = std::ranges::minmax(b, {}, axis);
    return axis(a_high) + kMargin < axis(b_low) || axis(b_high) + kMargin < axis(a_low);
  };
  return !apart([](glm::dvec2 p) { return p.x; }) && !apart([](glm::dvec2 p) { return p.y; });
}

}  // namespace

scene::Mesh PatchSurfaces::mesh_of(const Patch& patch) {
  scene::Mesh mesh;
  const auto material = static_cast<std::uint32_t>(albedos_.size());
  const glm::dvec2 half = half_of(patch);
  if (patch.shape == Patch::Shape::tag) {
    albedos_.insert(albedos_.end(), {patch.dark, patch.light});
    add_tag(patch, material, mesh);
    return mesh;
  }
  albedos_.push_back(patch.albedo);
  if (patch.shape == Patch::Shape::disc)
    add_disc(half, material, mesh);
  else
    add_rectangle(-half, half, material, mesh);
  return mesh;
}

/// Returns how far a patch is lifted above earlier ones at its height.
double PatchSurfaces::lift_of(std::size_t row) const {
  const Surface& s = surfaces_[row];
  double lift = 0.0;
  for (std::size_t i = 0; i < row; ++i)
    if (surfaces_[i].patch->X_WP.z == s.patch->X_WP.z && may_overlap(surfaces_[i].hull, s.hull))
      lift = std::max(lift, surfaces_[i].lift + kLayer);
  return lift;
}

void PatchSurfaces::place(const Camera& camera, const Scene& scene, double middle) {
  width_ = camera.intrinsics.width;
  surfaces_.clear(), albedos_.clear();
  for (const Patch& patch : scene.patches) {
    Surface s{&patch, scene::build_tree(mesh_of(patch)), 0.0, hull_of(imaged_outline(camera, patch, middle))};
    const auto [first, last] = std::ranges::minmax(s.hull, {}, &glm::dvec2::y);
    s.top = first.y - kMargin, s.bottom = last.y + kMargin;
    surfaces_.push_back(std::move(s));
    surfaces_.back().lift = lift_of(surfaces_.size() - 1);
  }
}

double PatchSurfaces::speed(const Camera& camera) const {
  double most = 0.0;
  for (const Surface& s : surfaces_) {
    const double speed = glm::length(s.patch->velocity) + std::abs(s.patch->turn) * glm::length(half_of(*s.patch)),
                 distance = std::max(0.1, std::abs(camera.position.z - s.patch->X_WP.z));
    most = std::max(most, speed * std::max(camera.intrinsics.focal.x, camera.intrinsics.focal.y) / distance);
  }
  return most;
}

void PatchSurfaces::list_columns(int v, std::vector<int>& out) const {
  out.clear();
  std::vector<std::array<int, 2>> spans;
  for (const Surface& s : surfaces_)
    if (s.top <= v && v <= s.bottom) spans.push_back(columns_of(s.hull, v, width_));
  std::ranges::sort(spans);
  int next = 0;
  for (const auto& [left, right] : spans)
    for (next = std::max(next, left); next <= right; ++next) out.push_back(next);
}

void PatchSurfaces::list(int first, int last, double t, std::vector<scene::Instance>& out) const {
  out.clear();
  for (const Surface& s : surfaces_) {
    if (s.tree.empty() || s.bottom < first || s.top > last) continue;
    const base::Pose X_WP = pose_at(*s.patch, t);
    const glm::dvec2 x = base::direction(X_WP.yaw);
    out.push_back(
        {&s.tree, {{{x, 0.0}, {-x.y, x.x, 0.0}, {0.0, 0.0, 1.0}}, {X_WP.x, X_WP.y, X_WP.z + s.lift}}, false, 0});
  }
}

}  // namespace sf::vision
