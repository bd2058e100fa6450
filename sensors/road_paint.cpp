#include "sensors/road_paint.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>

#include "base/srgb.h"
#include "sensors/lane_markings/outline.h"

namespace sf::sensors {

namespace {

constexpr double kMostCells = 1 << 20;
constexpr double kLeastSide = 0.5;    // [m]
constexpr double kHeightRoom = 1e-3;  // [m] between a marking and its road

}  // namespace

glm::ivec2 RoadPaint::cell_of(glm::dvec2 p) const {
  return glm::clamp(glm::ivec2(glm::floor((p - box_.min) / side_)), glm::ivec2(0), cells_ - 1);
}

/// Visits the cells that a piece meets: no edge has all of the cell outside.
template <class Visit>
void RoadPaint::for_each_cell(std::span<const glm::dvec2> corners, const Piece& piece, const Visit& visit) const {
  base::Box box = base::empty_box();
  for (const glm::dvec2& p : corners) box = base::united(box, base::box_of(p, p));
  const glm::ivec2 low = cell_of(box.min), high = cell_of(box.max);
  for (int y = low.y; y <= high.y; ++y)
    for (int x = low.x; x <= high.x; ++x) {
      const glm::dvec2 from = box_.min + side_ * glm::dvec2(x, y);
      const auto meets = [&](const glm::dvec3& e) {
        return e.x * (e.x > 0.0 ? from.x + side_ : from.x) + e.y * (e.y > 0.0 ? from.y + side_ : from.y) >= e.z - 1e-6;
      };
      if (std::ranges::all_of(piece.edge, meets)) visit(static_cast<std::size_t>(y) * cells_.x + x);
    }
}

RoadPaint::RoadPaint(const world::World& world) {
  std::vector<Quad> quads;
  for (std::size_t i = 0; i < world.lane_markings.size(); ++i) {
    const world::LaneMarking& marking = world.lane_markings[i];
    const auto before = quads.size();
    add_quads(marking, quads);
    world::MarkingHeights at = i < world.marking_heights.size() ? world.marking_heights[i] : world::MarkingHeights{};
    if (!world.terrain.empty()) at = {-HUGE_VAL, HUGE_VAL};
    for (std::size_t q = before; q < quads.size(); ++q) {
      Piece piece{{}, at.z_min - kHeightRoom, at.z_max + kHeightRoom, base::linear_color(marking.color)};
      for (std::size_t k = 0; k < 4; ++k) {
        const glm::dvec2 a = quads[q][k], e = quads[q][(k + 1) % 4] - a;
        piece.edge[k] = {-e.y, e.x, e.x * a.y - e.y * a.x};
        box_ = base::united(box_, base::box_of(a, a));
      }
      pieces_.push_back(piece);
    }
  }
  if (pieces_.empty()) return;
  const glm::dvec2 size = box_.max - box_.min;
  side_ = std::max(kLeastSide, std::sqrt(size.x * size.y / kMostCells));
  side_ = std::max(side_, std::max(size.x, size.y) / kMostCells);
  cells_ = glm::ivec2(glm::floor(size / side_)) + 1;
  first_.resize(static_cast<std::size_t>(cells_.x) * cells_.y + 1);
  for (std::size_t q = 0; q < quads.size(); ++q)
    for_each_cell(quads[q], pieces_[q], [&](std::size_t cell) { ++first_[cell + 1]; });
  for (std::size_t cell = 1; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
  rows_.resize(first_.back());
  std::vector<std::uint32_t> end(first_.begin(), first_.end() - 1);
  for (std::size_t q = 0; q < quads.size(); ++q)
    for_each_cell(quads[q], pieces_[q], [&](std::size_t cell) { rows_[end[cell]++] = static_cast<std::uint32_t>(q); });
}

const glm::vec3* RoadPaint::color_at(glm::dvec3 p) const {
  if (!(p.x >= box_.min.x && p.x <= box_.max.x && p.y >= box_.min.y && p.y <= box_.max.y)) return nullptr;
  const glm::ivec2 at = cell_of(p);
  const std::size_t cell = static_cast<std::size_t>(at.y) * cells_.x + at.x;
  for (std::uint32_t i = first_[cell + 1]; i-- > first_[cell];) {
    const Piece& piece = pieces_[rows_[i]];
    const auto inside = [&](const glm::dvec3& e) { return e.x * p.x + e.y * p.y >= e.z; };
    if (p.z >= piece.z_min && p.z <= piece.z_max && std::ranges::all_of(piece.edge, inside)) return &piece.color;
  }
  return nullptr;
}

}  // namespace sf::sensors
