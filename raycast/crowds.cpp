#include "raycast/crowds.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raycast/wall_blocks.h"

namespace sf::raycast {

namespace {

constexpr std::size_t kDirections = 256;  ///< of lines

/// Index of a direction: monotonic in its bearing, so that neighbours lie within a few degrees.
std::size_t direction_of(glm::dvec2 n) {
  const double part = n.y / (std::abs(n.x) + std::abs(n.y));
  const double turn = n.x < 0.0 ? 2.0 - part : part + (n.y < 0.0 ? 4.0 : 0.0);  // [quarters] in [0, 4]
  return static_cast<std::size_t>(turn * (kDirections / 4.0)) % kDirections;
}

/// The part of an edge, from one of its ends, that two movers hide: the second largest of the movers' parts.
struct HiddenPart {
  double most = 0.0, second = 0.0;
  std::uint32_t mover = kNoMover;  ///< that hides `most`

  void add(double part, std::uint32_t by) {
    if (by == mover) {
      most = std::max(most, part);
    } else if (part > most) {
      second = most;
      most = part, mover = by;
    } else {
      second = std::max(second, part);
    }
  }
};

}  // namespace

/// Lines through edges of the members: for each direction the two nearest, of different movers.
struct Crowds::Lines {
  struct Line {
    glm::dvec2 normal;         ///< unit vector, outward
    double offset = HUGE_VAL;  ///< [m] from the cell's centre
    std::uint32_t mover = kNoMover;
  };
  std::array<std::array<Line, 2>, kDirections> nearest;
  double margin;  ///< [m] beyond a line, more than the rounding of 64-bit ranges
  double radius;  ///< [m] of the disc that holds all viewers

  void add(const Line& line) {
    auto& [first, second] = nearest[direction_of(line.normal)];
    if (line.offset < first.offset) {
      if (line.mover != first.mover) second = first;
      first = line;
    } else if (line.offset < second.offset && line.mover != first.mover) {
      second = line;
    }
  }

  /// Finds the part of ab that is hidden from its start, and from its end, by lines of about the direction `normal`.
  void find_hidden(glm::dvec2 a, glm::dvec2 b, glm::dvec2 normal, HiddenPart& start, HiddenPart& end) const {
    const std::size_t direction = direction_of(normal);
    for (const std::size_t turn : {kDirections - 1, std::size_t{0}, std::size_t{1}})
      for (const Line& line : nearest[(direction + turn) % kDirections]) {
        if (line.mover == kNoMover) continue;
        const double at_a = dot(line.normal, a) - line.offset, at_b = dot(line.normal, b) - line.offset;
        if (at_a > margin) start.add(at_b > margin ? 1.0 : (at_a - margin) / (at_a - at_b), line.mover);
        if (at_b > margin) end.add(at_a > margin ? 1.0 : (at_b - margin) / (at_b - at_a), line.mover);
      }
  }
};

void Crowds::find(std::span<const Viewpoint> views, const std::function<std::uint32_t(std::uint32_t)>& height_of,
                  base::ThreadPool& thread_pool) {
  if (size_ == 0.0) size_ = std::max(0.25 * movers_.smallest_inner(), movers_.largest_radius() / 64.0);
  constexpr Place kNowhere{kNoPlace, 0, 0};
  const auto cell_of = [this](double at) { return std::llround(std::floor(std::clamp(at / size_, -4e15, 4e15))); };
  place_of_view_.assign(views.size(), kNowhere);
  places_.clear();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Pose& X = views[i].X_WS;
    if (!is_crowded({X.x, X.y})) continue;
    places_.push_back(place_of_view_[i] = {height_of(views[i].config), cell_of(X.x), cell_of(X.y)});
  }
  if (places_.empty()) return;
  std::sort(places_.begin(), places_.end());
  places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
  place_of_.assign(views.size(), kNoPlace);
  for (std::size_t i = 0; i < views.size(); ++i)
    if (place_of_view_[i] != kNowhere)
      place_of_[i] = static_cast<std::uint32_t>(
          std::lower_bound(places_.begin(), places_.end(), place_of_view_[i]) - places_.begin());
  if (cells_.size() < places_.size()) cells_.resize(places_.size());
  scratch_.resize(thread_pool.threads());
  thread_pool.parallel_for(places_.size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t k = first; k < last; ++k) build(places_[k], scratch_[thread], cells_[k]);
  });
}

/// Whether enough movers for a crowd are near `p`.
bool Crowds::is_crowded(glm::dvec2 p) const {
  const MoverGrid& grid = movers_.grid();
  const glm::dvec2 at = p - grid.low;
  const int left = grid.column_of(at.x - grid.largest_radius), right = grid.column_of(at.x + grid.largest_radius);
  std::uint32_t movers = 0;
  for (int row = grid.row_of(at.y - grid.largest_radius); row <= grid.row_of(at.y + grid.largest_radius); ++row)
    movers += grid.begin_of(right + 1, row) - grid.begin_of(left, row);
  return movers > kCrowd;
}

void Crowds::build(const Place& place, Scratch& s, CrowdCell& cell) const {
  cell.centre = {size_ * (static_cast<double>(place.x) + 0.5), size_ * (static_cast<double>(place.y) + 0.5)};
  cell.blocks.clear(), cell.bounds.clear(), cell.members.clear();
  find_members(place, cell.centre, s.members);
  if (s.members.size() < kCrowd) return;

  const double most = movers_.largest_radius();
  Lines lines;
  lines.radius = CellShape{size_}.radius() + 1e-15 * (std::abs(cell.centre.x) + std::abs(cell.centre.y));
  lines.margin = 1e-12 * most * (1.0 + most / size_);
  const OutlineTable& outlines = movers_.outlines(place.height);
  cell.members.resize((movers_.states().size() + 63) / 64);
  for (const std::uint32_t m : s.members) {
    cell.members[m / 64] |= std::uint64_t{1} << m % 64;
    const OutlineTable::Outline& outline = outlines.of_mover[m];
    for (const OutlineTable::Loop& loop : std::span(outlines.loops).subspan(outline.first_loop, outline.loops))
      if (holds(m, loop, cell.centre)) add_lines(m, loop, cell.centre, lines);
  }
  s.found.clear();
  for (const std::uint32_t m : s.members) add_edges(m, outlines, lines, cell.centre, s.found);
  append_blocks(s.found, cell.blocks, cell.bounds);
  cell.bounds.resize(cell.blocks.size() + kBlock);
}

/// Lists the movers with an outline that holds the cell, without those that others coincide with.
void Crowds::find_members(const Place& place, glm::dvec2 centre, std::vector<std::uint32_t>& members) const {
  const MoverGrid& grid = movers_.grid();
  const OutlineTable& outlines = movers_.outlines(place.height);
  const glm::dvec2 at = centre - grid.low;
  const double reach = grid.largest_radius + size_;
  const int left = grid.column_of(at.x - reach), right = grid.column_of(at.x + reach);
  members.clear();
  for (int row = grid.row_of(at.y - reach); row <= grid.row_of(at.y + reach); ++row)
    for (std::uint32_t k = grid.begin_of(left, row); k < grid.begin_of(right + 1, row); ++k) {
      if (grid.twin[k] != kNoMover) continue;
      const OutlineTable::Outline& outline = outlines.of_mover[grid.mover[k]];
      const auto loops = std::span(outlines.loops).subspan(outline.first_loop, outline.loops);
      if (std::any_of(loops.begin(), loops.end(),
                      [&](const OutlineTable::Loop& loop) { return holds(grid.mover[k], loop, centre); }))
        members.push_back(grid.mover[k]);
    }
}

/// Edge `number` of a mover, relative to `centre`.
Crowds::Edge Crowds::edge_of(std::uint32_t mover, std::uint32_t number, glm::dvec2 centre) const {
  const ExactSegment& s = movers_.exact()[movers_.first_rows()[mover] - movers_.first_rows().front() + number];
  return {{s.ax - centre.x, s.ay - centre.y}, {s.bx - centre.x, s.by - centre.y}};
}

/// Whether all viewers in the cell are inside `loop`, at least a quarter of the cell from its edges.
bool Crowds::holds(std::uint32_t mover, const OutlineTable::Loop& loop, glm::dvec2 centre) const {
  const Pose& X = movers_.states()[mover].X_WM;
  if (std::hypot(X.x - centre.x, X.y - centre.y) > movers_.largest_radius()) return false;
  for (std::uint32_t k = 0; k < loop.count; ++k) {
    const Edge edge = edge_of(mover, loop.first + k, centre);
    const glm::dvec2 e = edge.b - edge.a;
    if (base::cross(edge.a, e) < size_ * length(e)) return false;
  }
  return true;
}

void Crowds::add_lines(std::uint32_t mover, const OutlineTable::Loop& loop, glm::dvec2 centre, Lines& lines) const {
  for (std::uint32_t k = 0; k < loop.count; ++k) {
    const Edge edge = edge_of(mover, loop.first + k, centre);
    const glm::dvec2 e = edge.b - edge.a, normal = 1.0 / length(e) * glm::dvec2{e.y, -e.x};
    if (length(e) > 0.0) lines.add({normal, dot(normal, edge.a), mover});
  }
}

/// Adds what viewers in the cell may see of a mover's edges.
void Crowds::add_edges(std::uint32_t mover, const OutlineTable& outlines, const Lines& lines, glm::dvec2 centre,
                       std::vector<CandidateWall>& found) const {
  const OutlineTable::Outline& outline = outlines.of_mover[mover];
  for (const std::uint32_t number : std::span(outlines.edges).subspan(outline.first_edge, outline.edges)) {
    const auto [a, b] = edge_of(mover, number, centre);
    const glm::dvec2 e = b - a;
    if (length(e) == 0.0) continue;
    HiddenPart start, end;
    lines.find_hidden(a, b, {e.y, -e.x}, start, end);
    if (start.second + end.second >= 1.0) continue;
    const glm::dvec2 from = a + start.second * e, to = b - end.second * e;
    const double side = base::cross(a, e) / length(e);  // [m] of the centre from the edge: positive on its left
    const std::uint32_t row = movers_.first_rows()[mover] + number;
    if (side < lines.radius) found.push_back(candidate_wall(from, to, row, lines.radius));
    if (side > -lines.radius) found.push_back(candidate_wall(to, from, row, lines.radius));
  }
}

}  // namespace sf::raycast
