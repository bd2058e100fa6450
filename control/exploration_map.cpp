#include "control/exploration_map.h"

#include <algorithm>
#include <cmath>

namespace sf::control {

namespace {

constexpr int kFiner = 3;         // nodes per side of a map cell
constexpr int kPointsFiner = 5;   // squares per side of a node's square; each keeps one point
constexpr double kJoined = 0.03;  // [m] endpoints of neighbouring beams within this distance lie on one surface

}  // namespace

ExplorationMap::ExplorationMap(const maps::GridGeometry& geometry, double radius, double reach)
    : grid_(geometry),
      radius_(radius),
      cell_(geometry.cell / kFiner),
      columns_(static_cast<Node>(kFiner * maps::columns(geometry))),
      rows_(static_cast<Node>(kFiner * maps::rows(geometry))) {
  const auto count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  taken_.resize((count * kPointsFiner * kPointsFiner + 7) / 8);
  clearance_.assign(count, static_cast<float>(radius + kMaxClearance));
  occupied_.resize(count);
  explored_.resize(count);
  unknown_.resize(count);
  driven_.resize(static_cast<std::size_t>(maps::columns(geometry) * maps::rows(geometry)));

  // Nodes too close to the map's border always count as unknown.
  const Node rim = static_cast<Node>(std::ceil(std::max(radius, reach) / cell_)) + 2;
  for (Node row = 0; row < rows_; ++row) {
    for (Node column = 0; column < columns_; ++column) {
      const bool inner = column >= rim && row >= rim && column < columns_ - rim && row < rows_ - rim;
      unknown_[static_cast<std::size_t>(row * columns_ + column)] = inner ? 0 : 1;
    }
  }
  for (std::int64_t row = 0; row < maps::rows(geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(geometry); ++column)
      around(maps::middle(geometry, {column, row}), radius_,
             [&](std::size_t node, double) { unknown_[node] = static_cast<std::uint16_t>(unknown_[node] + 1); });
}

bool ExplorationMap::contains(glm::dvec2 p) const {
  return maps::contains(grid_.geometry, maps::cell_at(grid_.geometry, p));
}

Node ExplorationMap::node_at(glm::dvec2 p) const {
  const auto column = static_cast<Node>(std::floor((p.x - grid_.geometry.left) / cell_));
  const auto row = static_cast<Node>(std::floor((grid_.geometry.top - p.y) / cell_));
  return std::clamp(row, 0, rows_ - 1) * columns_ + std::clamp(column, 0, columns_ - 1);
}

glm::dvec2 ExplorationMap::place(Node node) const {
  return {grid_.geometry.left + (node % columns_ + 0.5) * cell_, grid_.geometry.top - (node / columns_ + 0.5) * cell_};
}

// Visits every node within `radius` of p, and passes its distance.
template <typename Visit>
void ExplorationMap::around(glm::dvec2 p, double radius, Visit visit) {
  const double column = (p.x - grid_.geometry.left) / cell_ - 0.5, row = (grid_.geometry.top - p.y) / cell_ - 0.5;
  const double reach = radius / cell_;
  const auto low = [](double v) { return static_cast<Node>(std::max(0.0, std::ceil(v))); };
  const auto high = [](double v, Node most) { return static_cast<Node>(std::min(most - 1.0, std::floor(v))); };
  for (Node r = low(row - reach); r <= high(row + reach, rows_); ++r) {
    for (Node c = low(column - reach); c <= high(column + reach, columns_); ++c) {
      const double far = cell_ * std::hypot(c - column, r - row);
      if (far < radius) visit(static_cast<std::size_t>(r * columns_ + c), far);
    }
  }
}

void ExplorationMap::explore(maps::CellAt at) {
  auto& stood = driven_[static_cast<std::size_t>(at.row * maps::columns(grid_.geometry) + at.column)];
  if (stood != 0) return;
  stood = 1;
  around(maps::middle(grid_.geometry, at), radius_,
         [&](std::size_t node, double) { unknown_[node] = static_cast<std::uint16_t>(unknown_[node] - 1); });
}

void ExplorationMap::mark_free(glm::dvec2 p, double radius) {
  for (std::int64_t row = 0; row < maps::rows(grid_.geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(grid_.geometry); ++column)
      if (glm::length(maps::middle(grid_.geometry, {column, row}) - p) <= radius) explore({column, row});
}

void ExplorationMap::lower_clearance(glm::dvec2 p) {
  around(p, radius_ + kMaxClearance,
         [&](std::size_t node, double far) { clearance_[node] = std::min(clearance_[node], static_cast<float>(far)); });
}

bool ExplorationMap::add_point(glm::dvec2 p) {
  if (!contains(p)) return false;
  const double fine = cell_ / kPointsFiner;
  const auto column = static_cast<std::size_t>((p.x - grid_.geometry.left) / fine);
  const auto row = static_cast<std::size_t>((grid_.geometry.top - p.y) / fine);
  const std::size_t bit = row * static_cast<std::size_t>(columns_) * kPointsFiner + column;
  const auto flag = static_cast<std::uint8_t>(1u << bit % 8);
  if (bit / 8 >= taken_.size() || (taken_[bit / 8] & flag) != 0) return false;
  taken_[bit / 8] |= flag;
  points_.push_back(p);
  if (recording_) changes_.points.push_back(p);
  occupied_[static_cast<std::size_t>(node_at(p))] = 1;
  lower_clearance(p);
  return true;
}

void ExplorationMap::mark_occupied(glm::dvec2 p) {
  const Node node = node_at(p);
  auto& occupied = occupied_[static_cast<std::size_t>(node)];
  if (recording_ && occupied == 0) changes_.nodes.push_back(node);
  occupied = 1;
}

void ExplorationMap::mark_line(glm::dvec2 a, glm::dvec2 b) {
  const int steps = 1 + static_cast<int>(glm::length(b - a) / (0.25 * cell_));
  for (int i = 0; i <= steps; ++i) {
    const glm::dvec2 p = a + (static_cast<double>(i) / steps) * (b - a);
    if (contains(p)) mark_occupied(p);
  }
}

void ExplorationMap::explore_cell(maps::CellAt cell) {
  explore(cell);
  for (Node k = 0; k < kFiner * kFiner; ++k)
    explored_[static_cast<std::size_t>((kFiner * cell.row + k / kFiner) * columns_ + kFiner * cell.column +
                                       k % kFiner)] = 1;
}

bool ExplorationMap::merge(const MapChanges& changes) {
  bool news = false;
  const bool recording = std::exchange(recording_, false);
  for (const auto& [at, state] : changes.cells) {
    const maps::Cell old = grid_.at(at);
    if (old == state || old == maps::Cell::occupied) continue;
    grid_.set(at, state);
    if (old == maps::Cell::unexplored) explore_cell(at);
    news = true;
  }
  for (const glm::dvec2& p : changes.points) {
    if (add_point(p))
      news = true;
    else if (contains(p))
      lower_clearance(p);
  }
  for (const Node node : changes.nodes) occupied_[static_cast<std::size_t>(node)] = 1;
  recording_ = recording;
  return news;
}

void ExplorationMap::set_bodies(std::span<const glm::dvec2> places, std::span<const double> distances) {
  for (const std::size_t node : bodies_) unknown_[node] = static_cast<std::uint16_t>(unknown_[node] - 1);
  bodies_.clear();
  for (std::size_t i = 0; i < places.size(); ++i)
    around(places[i], distances[i], [&](std::size_t node, double) {
      unknown_[node] = static_cast<std::uint16_t>(unknown_[node] + 1);
      bodies_.push_back(node);
    });
}

bool ExplorationMap::add(const maps::ScanView& scan) {
  const std::vector<std::uint32_t> before = grid_.words;
  maps::add_scan(grid_, scan);
  bool news = false;
  for (std::size_t word = 0; word < before.size(); ++word) {
    for (int i = 0; before[word] != grid_.words[word] && i < 16; ++i) {
      const std::uint32_t old = before[word] >> 2 * i & 3u, now = grid_.words[word] >> 2 * i & 3u;
      if (old == now) continue;
      const auto wide = static_cast<std::int64_t>(grid_.geometry.word_columns), at = static_cast<std::int64_t>(word);
      const maps::CellAt cell{4 * (at % wide) + i % 4, 4 * (at / wide) + i / 4};
      if (recording_) changes_.cells.push_back({cell, static_cast<maps::Cell>(now)});
      if (old != SF_CELL_UNEXPLORED) continue;
      explore_cell(cell);
      news = true;
    }
  }

  glm::dvec2 last{HUGE_VAL, HUGE_VAL};
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range = scan.ranges[i];
    if (!(range > scan.range_min && range < scan.range_max)) {
      last = {HUGE_VAL, HUGE_VAL};
      continue;
    }
    const glm::dvec2 p = base::transform(scan.X_WS, range * scan.beams[i]);
    if (add_point(p)) news = true;
    if (glm::length(p - last) < kJoined) mark_line(last, p);
    last = p;
  }
  return news;
}

double ExplorationMap::nearest(glm::dvec2 p, double most) const {
  double least = most * most;
  for (const glm::dvec2& q : points_) least = std::min(least, glm::dot(q - p, q - p));
  return std::sqrt(least);
}

}  // namespace sf::control
