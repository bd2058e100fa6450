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

/// The two least of values that belong to different movers.
struct TwoLeast {
  double first, second;
  std::uint32_t mover = kNoMover;  ///< of `first`

  explicit TwoLeast(double most) : first(most), second(most) {}
  void add(double value, std::uint32_t by) {
    if (by == mover) {
      first = std::min(first, value);
    } else if (value < first) {
      second = first;
      first = value, mover = by;
    } else {
      second = std::min(second, value);
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
  double margin;             ///< [m] beyond a line, more than the rounding of 64-bit ranges
  TwoLeast reach{HUGE_VAL};  ///< [m] farthest corners of the outlines that hold the viewers

  void add(const Line& line) {
    auto& [first, second] = nearest[direction_of(line.normal)];
    if (line.offset < first.offset) {
      if (line.mover != first.mover) second = first;
      first = line;
    } else if (line.offset < second.offset && line.mover != first.mover) {
      second = line;
    }
  }

  /// Finds what lines of about the direction `normal` leave of ab: parts of its length, up to its end but for what is
  /// hidden at its start, and the other way round.
  void find_hidden(glm::dvec2 a, glm::dvec2 b, glm::dvec2 normal, TwoLeast& start, TwoLeast& end) const {
    const std::size_t direction = direction_of(normal);
    for (const std::size_t turn : {kDirections - 1, std::size_t{0}, std::size_t{1}})
      for (const Line& line : nearest[(direction + turn) % kDirections]) {
        if (line.mover == kNoMover) continue;
        const double at_a = dot(line.normal, a) - line.offset, at_b = dot(line.normal, b) - line.offset;
        if (at_a > margin) start.add(at_b > margin ? 0.0 : (margin - at_b) / (at_a - at_b), line.mover);
        if (at_b > margin) end.add(at_a > margin ? 0.0 : (margin - at_a) / (at_b - at_a), line.mover);
      }
  }
};

void Crowds::find(std::span<const Viewpoint> views, const std::function<std::uint32_t(std::uint32_t)>& height_of,
                  base::ThreadPool& thread_pool) {
  find_places(views, height_of);
  if (cells_.size() < places_.size()) cells_.resize(places_.size());
  scratch_.resize(thread_pool.threads());
  thread_pool.parallel_for(places_.size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t k = first; k < last; ++k) {
      const base::Box& box = boxes_[k];
      const Disc viewers{0.5 * (box.min + box.max), 0.5 * length(box.max - box.min) * (1.0 + 1e-6) + 1e-9 +
                                                        1e-15 * (std::abs(box.max.x) + std::abs(box.max.y))};
      build(movers_.outlines(places_[k].height), viewers, scratch_[thread], cells_[k]);
    }
  });
}

void Crowds::find_places(std::span<const Viewpoint> views,
                         const std::function<std::uint32_t(std::uint32_t)>& height_of) {
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
  boxes_.assign(places_.size(), base::empty_box());
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (place_of_view_[i] == kNowhere) continue;
    const auto place = std::lower_bound(places_.begin(), places_.end(), place_of_view_[i]) - places_.begin();
    const glm::dvec2 p{views[i].X_WS.x, views[i].X_WS.y};
    place_of_[i] = static_cast<std::uint32_t>(place);
    boxes_[place_of_[i]] = base::united(boxes_[place_of_[i]], base::box_of(p, p));
  }
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

void Crowds::build(const OutlineTable& outlines, const Disc& viewers, Scratch& s, CrowdCell& cell) const {
  cell.centre = viewers.centre;
  cell.blocks.clear(), cell.bounds.clear(), cell.members.clear();
  find_members(outlines, viewers, s.members);
  if (s.members.size() < kCrowd) return;

  const double most = movers_.largest_radius();
  Lines lines;
  lines.margin = 1e-12 * most * (1.0 + most / size_);
  cell.members.resize((movers_.states().size() + 63) / 64);
  for (const std::uint32_t m : s.members) {
    cell.members[m / 64] |= std::uint64_t{1} << m % 64;
    const OutlineTable::Outline& outline = outlines.of_mover[m];
    for (const OutlineTable::Loop& loop : std::span(outlines.loops).subspan(outline.first_loop, outline.loops))
      if (holds(m, loop, viewers)) add_loop(m, loop, viewers, lines);
  }
  cell.horizon = lines.reach.second;
  s.found.clear();
  for (const std::uint32_t m : s.members) add_edges(m, outlines, lines, viewers, s.found);
  append_blocks(s.found, cell.blocks, cell.bounds);
  cell.bounds.resize(cell.blocks.size() + kBlock);
}

/// Lists the movers with an outline that holds the viewers, without those that others coincide with.
void Crowds::find_members(const OutlineTable& outlines, const Disc& viewers,
                          std::vector<std::uint32_t>& members) const {
  const MoverGrid& grid = movers_.grid();
  const glm::dvec2 at = viewers.centre - grid.low;
  const double reach = grid.largest_radius;
  const int left = grid.column_of(at.x - reach), right = grid.column_of(at.x + reach);
  const auto x = static_cast<float>(at.x), y = static_cast<float>(at.y);
  members.clear();
  for (int row = grid.row_of(at.y - reach); row <= grid.row_of(at.y + reach); ++row)
    for (std::uint32_t k = grid.begin_of(left, row); k < grid.begin_of(right + 1, row); ++k) {
      const float dx = grid.x[k] - x, dy = grid.y[k] - y, most = 1.0001f * grid.radius[k] + grid.error;
      if (dx * dx + dy * dy > most * most || grid.twin[k] != kNoMover) continue;
      const OutlineTable::Outline& outline = outlines.of_mover[grid.mover[k]];
      const auto loops = std::span(outlines.loops).subspan(outline.first_loop, outline.loops);
      if (std::any_of(loops.begin(), loops.end(),
                      [&](const OutlineTable::Loop& loop) { return holds(grid.mover[k], loop, viewers); }))
        members.push_back(grid.mover[k]);
    }
}

/// Edge `number` of a mover, relative to `centre`.
Crowds::Edge Crowds::edge_of(std::uint32_t mover, std::uint32_t number, glm::dvec2 centre) const {
  const ExactSegment& s = movers_.exact()[movers_.first_rows()[mover] - movers_.first_rows().front() + number];
  return {{s.ax - centre.x, s.ay - centre.y}, {s.bx - centre.x, s.by - centre.y}};
}

/// Whether all viewers are inside `loop`, away from its edges.
bool Crowds::holds(std::uint32_t mover, const OutlineTable::Loop& loop, const Disc& viewers) const {
  for (std::uint32_t k = 0; k < loop.count; ++k) {
    const Edge edge = edge_of(mover, loop.first + k, viewers.centre);
    const glm::dvec2 e = edge.b - edge.a;
    if (base::cross(edge.a, e) < (viewers.radius + size_ / 8.0) * length(e)) return false;
  }
  return true;
}

void Crowds::add_loop(std::uint32_t mover, const OutlineTable::Loop& loop, const Disc& viewers, Lines& lines) const {
  double farthest = 0.0;
  for (std::uint32_t k = 0; k < loop.count; ++k) {
    const Edge edge = edge_of(mover, loop.first + k, viewers.centre);
    const glm::dvec2 e = edge.b - edge.a, normal = 1.0 / length(e) * glm::dvec2{e.y, -e.x};
    farthest = std::max(farthest, length(edge.a));
    if (length(e) > 0.0) lines.add({normal, dot(normal, edge.a), mover});
  }
  lines.reach.add((farthest + viewers.radius) * (1.0 + 1e-6), mover);
}

/// Adds what the viewers may see of a mover's edges.
void Crowds::add_edges(std::uint32_t mover, const OutlineTable& outlines, const Lines& lines, const Disc& viewers,
                       std::vector<CandidateWall>& found) const {
  const OutlineTable::Outline& outline = outlines.of_mover[mover];
  for (const std::uint32_t number : std::span(outlines.edges).subspan(outline.first_edge, outline.edges)) {
    const auto [a, b] = edge_of(mover, number, viewers.centre);
    const glm::dvec2 e = b - a;
    if (length(e) == 0.0) continue;
    TwoLeast start(1.0), end(1.0);
    lines.find_hidden(a, b, {e.y, -e.x}, start, end);
    if (start.second + end.second <= 1.0) continue;
    const glm::dvec2 from = a + (1.0 - start.second) * e, to = b - (1.0 - end.second) * e;
    const double side = base::cross(a, e) / length(e);  // [m] of the centre from the edge: positive on its left
    const std::uint32_t row = movers_.first_rows()[mover] + number;
    if (side < viewers.radius) found.push_back(candidate_wall(from, to, row, viewers.radius));
    if (side > -viewers.radius) found.push_back(candidate_wall(to, from, row, viewers.radius));
  }
}

}  // namespace sf::raycast
