#include "control/exploration_map.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::control {

namespace {

constexpr int kFiner = 3;         // nodes per side of a map cell
constexpr double kJoined = 0.03;  // [m] endpoints of neighbouring beams within this distance lie on one surface

}  // namespace

ExplorationMap::ExplorationMap(const maps::GridGeometry& geometry, double radius, double reach,
                               const ExplorationMapSettings& settings)
    : grid_(geometry),
      radius_(radius),
      most_clearance_(settings.most_clearance),
      finer_(settings.moving ? 1 : 5),
      cell_(geometry.cell / kFiner),
      columns_(static_cast<Node>(kFiner * maps::columns(geometry))),
      rows_(static_cast<Node>(kFiner * maps::rows(geometry))) {
  const auto count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  if (settings.moving) odds_.emplace(geometry, maps::LogOddsUpdate{});
  taken_.resize((count * finer_ * finer_ + 7) / 8);
  clearance_.assign(count, static_cast<float>(radius + most_clearance_));
  occupied_.resize(count);
  explored_.resize(count);
  unknown_.resize(count);
  driven_.resize(static_cast<std::size_t>(maps::columns(geometry) * maps::rows(geometry)));
  points_.resize(driven_.size());

  // Nodes too close to the map's border always count as unknown.
  rim_ = static_cast<Node>(std::ceil(std::max(radius, reach) / cell_)) + 2;
  for (Node row = 0; row < rows_; ++row) {
    for (Node column = 0; column < columns_; ++column) {
      const bool inner = column >= rim_ && row >= rim_ && column < columns_ - rim_ && row < rows_ - rim_;
      unknown_[static_cast<std::size_t>(row * columns_ + column)] = inner ? 0 : 1;
    }
  }
  for (double row = 0.0; row * cell_ < radius; ++row) {
    Node half = 0;
    while (cell_ * base::hypot(half + 1.0, row) < radius) ++half;
    half_rows_.push_back(half);
  }
  for (std::int64_t row = 0; row < maps::rows(geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(geometry); ++column) count_unknown({column, row}, 1);
}

// Adds `by` to the counts of all nodes whose body covers the cell's middle, which is a node.
void ExplorationMap::count_unknown(maps::CellAt cell, int by) {
  const auto column = static_cast<Node>(kFiner * cell.column + kFiner / 2);
  const auto row = static_cast<Node>(kFiner * cell.row + kFiner / 2), rows = static_cast<Node>(half_rows_.size());
  for (Node r = std::max(row - rows + 1, 0); r < std::min(row + rows, rows_); ++r) {
    const Node half = half_rows_[static_cast<std::size_t>(std::abs(r - row))];
    std::uint16_t* counts = &unknown_[static_cast<std::size_t>(r * columns_)];
    for (Node c = std::max(column - half, 0); c <= std::min(column + half, columns_ - 1); ++c)
      counts[c] = static_cast<std::uint16_t>(counts[c] + by);
  }
}

bool ExplorationMap::contains(glm::dvec2 p) const {
  return maps::contains(grid_.geometry, maps::cell_at(grid_.geometry, p));
}

bool ExplorationMap::surrounds(glm::dvec2 p) const {
  if (!contains(p)) return false;
  const Node node = node_at(p), column = node % columns_, row = node / columns_;
  return std::min(column, row) >= rim_ && column < columns_ - rim_ && row < rows_ - rim_;
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
    const double down = r - row, half = std::sqrt(std::max(0.0, reach * reach - down * down));
    for (Node c = low(column - half); c <= high(column + half, columns_); ++c) {
      const double far = cell_ * std::sqrt((c - column) * (c - column) + down * down);
      if (far < radius) visit(static_cast<std::size_t>(r * columns_ + c), far);
    }
  }
}

void ExplorationMap::explore(maps::CellAt at) {
  auto& stood = driven_[static_cast<std::size_t>(at.row * maps::columns(grid_.geometry) + at.column)];
  if (stood != 0) return;
  stood = 1;
  count_unknown(at, -1);
}

void ExplorationMap::mark_free(glm::dvec2 p, double radius) {
  for (std::int64_t row = 0; row < maps::rows(grid_.geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(grid_.geometry); ++column)
      if (glm::length(maps::middle(grid_.geometry, {column, row}) - p) <= radius) explore({column, row});
}

void ExplorationMap::lower_clearance(glm::dvec2 p) {
  around(p, radius_ + most_clearance_,
         [&](std::size_t node, double far) { clearance_[node] = std::min(clearance_[node], static_cast<float>(far)); });
}

std::size_t ExplorationMap::bit_of(glm::dvec2 p) const {
  const double fine = cell_ / static_cast<double>(finer_);
  const auto column = static_cast<std::size_t>((p.x - grid_.geometry.left) / fine);
  const auto row = static_cast<std::size_t>((grid_.geometry.top - p.y) / fine);
  return row * static_cast<std::size_t>(columns_) * finer_ + column;
}

std::size_t ExplorationMap::key_at(glm::dvec2 p) const {
  return static_cast<std::size_t>(key(maps::cell_at(grid_.geometry, p)));
}

// In a moving world, cells that are free have no points.
bool ExplorationMap::may_be_surface(glm::dvec2 p) const {
  return contains(p) && (!odds_ || grid_.at(maps::cell_at(grid_.geometry, p)) == maps::Cell::occupied);
}

bool ExplorationMap::add_point(glm::dvec2 p) {
  if (!may_be_surface(p)) return false;
  const std::size_t bit = bit_of(p);
  const auto flag = static_cast<std::uint8_t>(1u << bit % 8);
  if (bit / 8 >= taken_.size() || (taken_[bit / 8] & flag) != 0) return false;
  taken_[bit / 8] |= flag;
  points_[key_at(p)].push_back(p);
  if (recording_ && !odds_) changes_.points.push_back(p);
  occupied_[static_cast<std::size_t>(node_at(p))] = 1;
  lower_clearance(p);
  return true;
}

void ExplorationMap::mark_occupied(glm::dvec2 p) {
  const Node node = node_at(p);
  auto& occupied = occupied_[static_cast<std::size_t>(node)];
  if (recording_ && !odds_ && occupied == 0) changes_.nodes.push_back(node);
  occupied = 1;
}

void ExplorationMap::mark_line(glm::dvec2 a, glm::dvec2 b) {
  const int steps = 1 + static_cast<int>(glm::length(b - a) / (0.25 * cell_));
  for (int i = 0; i <= steps; ++i) {
    const glm::dvec2 p = a + (static_cast<double>(i) / steps) * (b - a);
    if (may_be_surface(p)) mark_occupied(p);
  }
}

void ExplorationMap::explore_cell(maps::CellAt cell) {
  explore(cell);
  for (Node k = 0; k < kFiner * kFiner; ++k)
    explored_[static_cast<std::size_t>((kFiner * cell.row + k / kFiner) * columns_ + kFiner * cell.column +
                                       k % kFiner)] = 1;
}

// Removes all surfaces of a cell.
void ExplorationMap::forget(maps::CellAt cell) {
  auto& points = points_[static_cast<std::size_t>(key(cell))];
  for (const glm::dvec2& p : points) {
    const std::size_t bit = bit_of(p);
    taken_[bit / 8] = static_cast<std::uint8_t>(taken_[bit / 8] & ~(1u << bit % 8));
  }
  stale_ = stale_ || !points.empty();
  points.clear();
  for (Node k = 0; k < kFiner * kFiner; ++k)
    occupied_[static_cast<std::size_t>((kFiner * cell.row + k / kFiner) * columns_ + kFiner * cell.column +
                                       k % kFiner)] = 0;
}

void ExplorationMap::refresh() {
  if (!std::exchange(stale_, false)) return;
  std::fill(clearance_.begin(), clearance_.end(), static_cast<float>(radius_ + most_clearance_));
  for (const auto& points : points_)
    for (const glm::dvec2& p : points) lower_clearance(p);
}

// A moving world counts another robot's cell as one scan, and shares no points: the cell's middle stands for them.
void ExplorationMap::merge_cell(maps::CellAt at, maps::Cell state) {
  grid_.set(at, state);
  if (!odds_) return;
  const std::size_t word = grid_.word_of(at);
  const bool occupied = state == maps::Cell::occupied;
  odds_->cells[16 * word + grid_.shift_of(at) / 2] =
      static_cast<std::int16_t>(occupied ? odds_->rule.hit : -odds_->rule.miss);
  odds_->words[word] = grid_.words[word];
  if (occupied)
    add_point(maps::middle(grid_.geometry, at));
  else
    forget(at);
}

bool ExplorationMap::merge(const MapChanges& changes) {
  bool news = false;
  const bool recording = std::exchange(recording_, false);
  for (const auto& [at, state] : changes.cells) {
    const maps::Cell old = grid_.at(at);
    if (old == state || (old == maps::Cell::occupied && !odds_)) continue;
    merge_cell(at, state);
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

// Follows the cells that a scan has changed.
bool ExplorationMap::compare_words(const std::vector<std::uint32_t>& before) {
  bool news = false;
  for (std::size_t word = 0; word < before.size(); ++word) {
    for (int i = 0; before[word] != grid_.words[word] && i < 16; ++i) {
      const std::uint32_t old = before[word] >> 2 * i & 3u, now = grid_.words[word] >> 2 * i & 3u;
      if (old == now) continue;
      const auto wide = static_cast<std::int64_t>(grid_.geometry.word_columns), at = static_cast<std::int64_t>(word);
      const maps::CellAt cell{4 * (at % wide) + i % 4, 4 * (at / wide) + i / 4};
      if (recording_ && now != SF_CELL_UNEXPLORED) changes_.cells.push_back({cell, static_cast<maps::Cell>(now)});
      if (odds_ && old == SF_CELL_OCCUPIED) forget(cell);
      if (old != SF_CELL_UNEXPLORED) continue;
      explore_cell(cell);
      news = true;
    }
  }
  return news;
}

bool ExplorationMap::add(const maps::ScanView& scan) {
  const std::vector<std::uint32_t> before = grid_.words;
  if (odds_) {
    maps::add_scan(*odds_, scan);
    grid_.words = odds_->words;
  } else {
    maps::add_scan(grid_, scan);
  }
  bool news = compare_words(before);
  const double joined = std::max(kJoined, grid_.geometry.cell);
  glm::dvec2 last{HUGE_VAL, HUGE_VAL};
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range = scan.ranges[i];
    if (!(range > scan.range_min && range < scan.range_max)) {
      last = {HUGE_VAL, HUGE_VAL};
      continue;
    }
    const glm::dvec2 p = base::transform(scan.X_WS, range * scan.beams[i]);
    if (add_point(p)) news = true;
    if (glm::length(p - last) < joined) mark_line(last, p);
    last = p;
  }
  return news;
}

double ExplorationMap::nearest(glm::dvec2 p, double most) const {
  double least = most * most;
  const double cell = grid_.geometry.cell;
  const maps::CellAt middle = maps::cell_at(grid_.geometry, p);
  const auto visit = [&](maps::CellAt at) {
    if (!maps::contains(grid_.geometry, at)) return;
    for (const glm::dvec2& q : points_[static_cast<std::size_t>(key(at))])
      least = std::min(least, glm::dot(q - p, q - p));
  };
  // Square rings of cells; points of ring k are at least k - 1 cells away.
  for (std::int64_t k = 0; k < 2 || static_cast<double>(k - 1) * cell < std::sqrt(least); ++k)
    for (std::int64_t i = -k; i <= k; ++i) {
      visit({middle.column + i, middle.row - k});
      if (k > 0) visit({middle.column + i, middle.row + k});
      if (std::abs(i) == k) continue;
      visit({middle.column - k, middle.row + i});
      visit({middle.column + k, middle.row + i});
    }
  return std::sqrt(least);
}

}  // namespace sf::control
