#include "vision/moving_patches.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "base/elementary.h"

namespace sf::vision {

base::Pose pose_at(const Patch& patch, double t) {
  const base::Pose& X_WP = patch.X_WP;
  const double dt = t - patch.time;
  return {X_WP.x + dt * patch.velocity.x, X_WP.y + dt * patch.velocity.y, X_WP.z, X_WP.yaw + dt * patch.turn};
}

double MovingPatches::albedo_at(std::uint32_t i, glm::dvec2 p, double dt) const {
  const MovingPatch& m = patches_[i];
  const Patch& patch = *m.patch;
  const glm::dvec2 d = p - (m.at + dt * patch.velocity);
  // Rotation by the angle turned during the exposure, to third order.
  const double a = dt * patch.turn;
  const double c1 = 1.0 - 0.5 * a * a, s1 = a * (1.0 - a * a / 6.0);
  const double c = m.cosine * c1 - m.sine * s1, s = m.sine * c1 + m.cosine * s1;
  const glm::dvec2 q{c * d.x + s * d.y, c * d.y - s * d.x};
  if (std::abs(q.x) > m.half.x || std::abs(q.y) > m.half.y) return -1.0;
  if (patch.shape == Patch::Shape::rectangle) return patch.albedo;
  if (patch.shape == Patch::Shape::disc)
    return q.x * q.x / (m.half.x * m.half.x) + q.y * q.y / (m.half.y * m.half.y) <= 1.0 ? patch.albedo : -1.0;
  const int n = patch.pattern.cells;
  const int column = static_cast<int>(std::floor(q.x / m.cell + 0.5 * n));
  const int row = static_cast<int>(std::floor(0.5 * n - q.y / m.cell));
  if (column < 0 || row < 0 || column >= n || row >= n) return patch.light;
  return patch.pattern.white[static_cast<std::size_t>(row * n + column)] != 0 ? patch.light : patch.dark;
}

void MovingPatches::place(const Camera& camera, const Scene& scene, double middle) {
  patches_.clear();
  for (const Patch& patch : scene.patches) {
    const base::Pose X_WP = pose_at(patch, middle);
    MovingPatch m{&patch, {X_WP.x, X_WP.y}, base::cos(X_WP.yaw), base::sin(X_WP.yaw), 0.5 * patch.size, 1.0};
    if (patch.shape == Patch::Shape::tag) {
      m.cell = patch.size.x / patch.pattern.cells;
      m.half += glm::dvec2{patch.border * m.cell};
    }
    patches_.push_back(m);
  }
  std::reverse(patches_.begin(), patches_.end());
  std::stable_sort(patches_.begin(), patches_.end(),
                   [](const MovingPatch& a, const MovingPatch& b) { return a.patch->X_WP.z > b.patch->X_WP.z; });
  list(camera);
}

/// Computes the bounding box of a patch in the image during the exposure; the whole image if a part of the outline
/// cannot be projected.
void MovingPatches::box_of(const Camera& camera, const MovingPatch& m, glm::dvec2& low, glm::dvec2& high) {
  constexpr int kSteps = 16;  // along each side, since distortion bends straight lines
  const double seconds = 0.5 * (camera.exposure + camera.readout);
  const double swing = seconds * std::abs(m.patch->turn) * glm::length(m.half);
  const glm::dvec2 half = m.half + swing;
  low = glm::dvec2{std::numeric_limits<double>::infinity()};
  high = -low;
  for (int side = 0; side < 4; ++side)
    for (int i = 0; i < kSteps; ++i)
      for (const double t : {-seconds, seconds}) {
        const double along = 2.0 * i / kSteps - 1.0;
        const glm::dvec2 corner =
            side < 2 ? glm::dvec2{along, side == 0 ? 1.0 : -1.0} : glm::dvec2{side == 2 ? 1.0 : -1.0, -along};
        const glm::dvec2 q = half * corner;
        const glm::dvec2 p =
            m.at + t * m.patch->velocity + glm::dvec2{m.cosine * q.x - m.sine * q.y, m.sine * q.x + m.cosine * q.y};
        const auto pixel = project(camera, {p.x, p.y, m.patch->X_WP.z});
        low = pixel ? glm::min(low, *pixel) : glm::dvec2{-1e9};
        high = pixel ? glm::max(high, *pixel) : glm::dvec2{1e9};
        if (!pixel) return;
      }
}

/// Adds each patch to the tiles that its bounding box overlaps.
void MovingPatches::list(const Camera& camera) {
  constexpr double kMargin = 4.0;  // [px] for the curvature between the points of a box
  columns_ = (camera.intrinsics.width + kTile - 1) / kTile;
  rows_ = (camera.intrinsics.height + kTile - 1) / kTile;
  tiles_.resize(static_cast<std::size_t>(columns_) * rows_);
  for (auto& tile : tiles_) tile.clear();
  for (std::uint32_t i = 0; i < patches_.size(); ++i) {
    glm::dvec2 low, high;
    box_of(camera, patches_[i], low, high);
    const auto tile_of = [](double pixel, int count) {
      return static_cast<int>(std::clamp(std::floor(pixel / kTile), -1.0, static_cast<double>(count)));
    };
    const int top = std::max(0, tile_of(low.y - kMargin, rows_)),
              left = std::max(0, tile_of(low.x - kMargin, columns_));
    const int bottom = std::min(rows_ - 1, tile_of(high.y + kMargin, rows_));
    const int right = std::min(columns_ - 1, tile_of(high.x + kMargin, columns_));
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) tiles_[static_cast<std::size_t>(y * columns_ + x)].push_back(i);
  }
}

}  // namespace sf::vision
