#include "control/viewpoint_planner.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::control {

namespace {

using maps::Cell;
using maps::CellAt;

constexpr std::size_t kRays = 240;
constexpr double kEdge = 0.02;     // [rad] margin at both ends of the field of view
constexpr int kUnknown = 9;        // nodes of unexplored ground that a line of sight may cross
constexpr double kOther = 4.0;     // nodes between viewpoints tried for one cell
constexpr std::size_t kTries = 6;  // failed viewpoints per cell

}  // namespace

ViewpointPlanner::ViewpointPlanner(const ExplorationMap& map, const ScannerModel& eye)
    : map_(map), headings_(static_cast<std::size_t>(map.nodes())) {
  for (std::size_t i = 0; i < kRays; ++i) {
    const double bearing = 2.0 * M_PI * (static_cast<double>(i) + 0.5) / kRays;
    Ray ray{base::cos(bearing), base::sin(bearing), 0};
    for (int k = 0; k < kHeadings; ++k) {
      const double off = base::wrap_angle(bearing + M_PI - heading_angle(k) - eye.X_MS.yaw);
      if (std::abs(off) <= 0.5 * eye.fov - kEdge) ray.headings = static_cast<std::uint16_t>(ray.headings | 1u << k);
    }
    rays_.push_back(ray);
  }
}

bool ViewpointPlanner::is_target(CellAt cell, bool all) const {
  const maps::OccupancyGrid& grid = map_.grid();
  if (grid.at(cell) != Cell::unexplored) return false;
  if (!all) {
    bool beside = false;
    for (std::int64_t k = 0; k < 9; ++k) {
      const CellAt at{cell.column + k % 3 - 1, cell.row + k / 3 - 1};
      beside = beside || (maps::contains(grid.geometry, at) && grid.at(at) == Cell::free);
    }
    if (!beside) return false;
  }
  const auto tried = unseen_from_.find(map_.key(cell));
  return tried == unseen_from_.end() || tried->second.size() < kTries;
}

// Visits the lattice nodes along a ray from the cell's centre (Amanatides and Woo, "A fast voxel traversal algorithm
// for ray tracing", 1987), until the line of sight is blocked.
template <typename Visit>
void ViewpointPlanner::cast(CellAt cell, std::size_t ray, Visit visit) const {
  const double ux = rays_[ray].x, uy = -rays_[ray].y;
  const Node columns = map_.columns(), rows = map_.nodes() / columns;
  Node column = static_cast<Node>(3 * cell.column + 1), row = static_cast<Node>(3 * cell.row + 1);
  const double dx = 1.0 / std::abs(ux), dy = 1.0 / std::abs(uy);
  double next_x = 0.5 * dx, next_y = 0.5 * dy;
  const double most = range_ / map_.cell();
  int unknown = 0, surfaces = 0;
  for (double far = 0.0; far <= most;) {
    const Node node = row * columns + column;
    if (map_.occupied(node) && ++surfaces > graze_) return;
    if (!map_.explored(node) && ++unknown > kUnknown) return;
    visit(node);
    if (next_x < next_y) {
      far = next_x;
      next_x += dx;
      column += ux > 0.0 ? 1 : -1;
      if (column < 0 || column >= columns) return;
    } else {
      far = next_y;
      next_y += dy;
      row += uy > 0.0 ? 1 : -1;
      if (row < 0 || row >= rows) return;
    }
  }
}

void ViewpointPlanner::add_target(CellAt cell) {
  const auto tried = unseen_from_.find(map_.key(cell));
  const bool afresh = tried == unseen_from_.end();
  for (std::size_t ray = 0; ray < kRays; ++ray) {
    cast(cell, ray, [&](Node node) {
      if (!afresh && std::any_of(tried->second.begin(), tried->second.end(), [&](Node other) {
            return glm::length(map_.place(node) - map_.place(other)) < kOther * map_.cell();
          }))
        return;
      auto& headings = headings_[static_cast<std::size_t>(node)];
      headings = static_cast<std::uint16_t>(headings | rays_[ray].headings);
    });
  }
}

std::size_t ViewpointPlanner::update(bool all, double range, int graze, const std::function<bool(CellAt)>& claimed) {
  range_ = range;
  graze_ = graze;
  std::fill(headings_.begin(), headings_.end(), std::uint16_t{0});
  cells_.clear();
  claimed_ = 0;
  const maps::GridGeometry& geometry = map_.grid().geometry;
  for (std::int64_t row = 0; row < maps::rows(geometry); ++row) {
    for (std::int64_t column = 0; column < maps::columns(geometry); ++column) {
      if (!is_target({column, row}, all)) continue;
      if (claimed && claimed({column, row})) {
        ++claimed_;
        continue;
      }
      cells_.push_back({column, row});
      add_target(cells_.back());
    }
  }
  return cells_.size();
}

std::vector<CellAt> ViewpointPlanner::targets(Node sensor, int heading) const {
  std::vector<CellAt> seen;
  for (const CellAt cell : cells_) {
    const glm::dvec2 d = map_.place(sensor) - maps::middle(map_.grid().geometry, cell);
    if (glm::length(d) > range_ + map_.cell()) continue;
    bool found = false;
    for (std::size_t ray = 0; ray < kRays && !found; ++ray) {
      // Only rays that pass near the sensor.
      const double aside = std::abs(base::cross({rays_[ray].x, rays_[ray].y}, d));
      if (aside > 2.0 * map_.cell() || (rays_[ray].headings >> heading & 1u) == 0) continue;
      cast(cell, ray, [&](Node node) { found = found || node == sensor; });
    }
    if (found) seen.push_back(cell);
  }
  return seen;
}

void ViewpointPlanner::mark_unseen(CellAt cell, Node sensor) { unseen_from_[map_.key(cell)].push_back(sensor); }

}  // namespace sf::control
