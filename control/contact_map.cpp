#include "control/contact_map.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <queue>
#include <utility>

namespace sf::control {

void ContactMap::add(const glm::dvec2& p) {
  if (points_.size() == kMostPoints) points_.erase(points_.begin());
  points_.push_back(p);
}

bool ContactMap::is_near(const glm::dvec2& p, double distance) const {
  return std::any_of(points_.begin(), points_.end(),
                     [&](const glm::dvec2& point) { return glm::distance(p, point) < distance; });
}

std::size_t ContactMap::cell_of(const glm::dvec2& p) const {
  const auto index = [](double at, std::size_t count) {
    return static_cast<std::size_t>(std::clamp(std::floor(at / kCell), 0.0, static_cast<double>(count - 1)));
  };
  return index(p.y - corner_.y, rows_) * columns_ + index(p.x - corner_.x, columns_);
}

glm::dvec2 ContactMap::middle_of(std::size_t cell) const {
  const glm::dvec2 index{cell % columns_, cell / columns_};
  return corner_ + kCell * (index + 0.5);
}

void ContactMap::frame(const glm::dvec2& robot, std::span<const glm::dvec2> goals) {
  const glm::dvec2 most{kMostExtent, kMostExtent};
  glm::dvec2 low = robot, high = robot;
  for (const std::span<const glm::dvec2> list : {goals, std::span<const glm::dvec2>(points_)})
    for (const glm::dvec2& p : list) low = glm::min(low, p), high = glm::max(high, p);
  corner_ = glm::clamp(low - kSurround, -most, most);
  const glm::dvec2 size = glm::clamp(high + kSurround, -most, most) - corner_;
  columns_ = static_cast<std::size_t>(size.x / kCell) + 1;
  rows_ = static_cast<std::size_t>(size.y / kCell) + 1;
}

template <class Visit>
void ContactMap::for_each_neighbour(std::size_t cell, const Visit& visit) const {
  const std::size_t column = cell % columns_, row = cell / columns_;
  for (std::size_t r = row > 0 ? row - 1 : 0; r <= std::min(row + 1, rows_ - 1); ++r)
    for (std::size_t c = column > 0 ? column - 1 : 0; c <= std::min(column + 1, columns_ - 1); ++c)
      if (r != row || c != column) visit(r * columns_ + c, r != row && c != column ? std::sqrt(2.0f) : 1.0f);
}

void ContactMap::plan(const glm::dvec2& robot, std::span<const glm::dvec2> goals) {
  frame(robot, goals);
  cost_.assign(columns_ * rows_, std::numeric_limits<float>::infinity());
  using Entry = std::pair<float, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const glm::dvec2& goal : goals) queue.emplace(cost_[cell_of(goal)] = 0.0f, cell_of(goal));
  while (!queue.empty()) {
    const auto [cost, cell] = queue.top();
    queue.pop();
    if (cost > cost_[cell]) continue;
    const float step = is_free(middle_of(cell)) ? 1.0f : kBlocked;
    for_each_neighbour(cell, [&](std::size_t other, float length) {
      const float through = cost + step * length;
      if (through < cost_[other]) queue.emplace(cost_[other] = through, other);
    });
  }
}

bool ContactMap::is_clear(const glm::dvec2& from, const glm::dvec2& to) const {
  const double steps = std::ceil(glm::distance(from, to) / kCell);
  for (double k = 0.0; k <= steps; ++k)
    if (!is_free(from + (steps > 0.0 ? k / steps : 0.0) * (to - from))) return false;
  return true;
}

glm::dvec2 ContactMap::next(const glm::dvec2& robot) const {
  constexpr int kAhead = 12;  // cells
  std::size_t cell = cell_of(robot);
  glm::dvec2 best = middle_of(cell);
  for (int k = 0; k < kAhead && cost_[cell] > 0.0f; ++k) {
    std::size_t least = cell;
    for_each_neighbour(cell, [&](std::size_t other, float) {
      if (cost_[other] < cost_[least]) least = other;
    });
    cell = least;
    if (k < 2 || is_clear(robot, middle_of(cell))) best = middle_of(cell);
  }
  return best;
}

}  // namespace sf::control
