#include "raycast/crowds.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "raycast/wall_blocks.h"

namespace sf::raycast {

namespace {

/// Sizes of the two tables of lines by direction. The coarse one finds a line that hides an edge at a large angle; the
/// fine one finds one of hundreds at a small angle.
constexpr std::size_t kFewDirections = 256;
constexpr std::size_t kMostDirections = 16384;
/// On each side of an edge's direction, the search ends after this many lines or this many directions.
constexpr int kLinesAside = 3;
constexpr std::size_t kMostTurns = 12;

/// Returns the index of a direction. It is monotonic in the bearing, so neighbours differ by a few degrees at most.
std::size_t direction_of(glm::dvec2 n, std::size_t directions) {
  const double part = n.y / (std::abs(n.x) + std::abs(n.y));
  const double turn = n.x < 0.0 ? 2.0 - part : part + (n.y < 0.0 ? 4.0 : 0.0);  // [quarters] in [0, 4]
  return static_cast<std::size_t>(turn * (static_cast<double>(directions) / 4.0)) % directions;
}

/// The two smallest values that belong to different movers.
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

/// Lines through edges of the members: for each direction, the nearest two of different movers.
struct Crowds::Lines {
  struct Line {
    glm::dvec2 normal;         ///< unit vector, outward
    double offset = HUGE_VAL;  ///< [m] from the cell's centre
    std::uint32_t mover = kNoMover;
  };
  using Nearest = std::vector<std::array<Line, 2>>;  ///< by direction
  std::array<Nearest, 2> tables;                     ///< coarse and fine; the second may be empty
  double margin = 0.0;                               ///< [m] beyond a line, larger than the rounding of 64-bit ranges
  TwoLeast reach{HUGE_VAL};                          ///< [m] farthest corners of the outlines that contain the viewers

  /// Removes all lines. @param expected number of lines that will be added
  void clear(std::size_t expected) {
    tables[0].assign(kFewDirections, {});
    tables[1].assign(expected > kFewDirections ? std::min(kMostDirections, std::bit_ceil(expected)) : 0, {});
    reach = TwoLeast(HUGE_VAL);
  }
  void add(const Line& line) {
    for (Nearest& table : tables)
      if (!table.empty()) add(line, table[direction_of(line.normal, table.size())]);
  }
  static void add(const Line& line, std::array<Line, 2>& nearest) {
    auto& [first, second] = nearest;
    if (line.offset < first.offset) {
      if (line.mover != first.mover) second = first;
      first = line;
    } else if (line.offset < second.offset && line.mover != first.mover) {
      second = line;
    }
  }

  /// Clips ab at lines of about the direction `normal`. @param start, end smallest fractions of its length, from a and
  /// from b, at which a line starts to hide it
  void find_hidden(glm::dvec2 a, glm::dvec2 b, glm::dvec2 normal, TwoLeast& start, TwoLeast& end) const {
    const auto cut_by = [&](const std::array<Line, 2>& nearest) {
      int lines = 0;
      for (const Line& line : nearest) {
        if (line.mover == kNoMover) continue;
        ++lines;
        const double at_a = dot(line.normal, a) - line.offset, at_b = dot(line.normal, b) - line.offset;
        if (at_a > margin) start.add(at_b > margin ? 0.0 : (margin - at_b) / (at_a - at_b), line.mover);
        if (at_b > margin) end.add(at_a > margin ? 0.0 : (margin - at_a) / (at_b - at_a), line.mover);
      }
      return lines;
    };
    const auto cut_to_side = [&](const Nearest& table, std::size_t direction, std::size_t turn, std::size_t most) {
      int lines = 0;
      for (std::size_t k = 1; k <= most && lines < kLinesAside; ++k)
        lines += cut_by(table[(direction + k * turn) % table.size()]);
    };
    for (const Nearest& table : tables) {
      if (table.empty() || start.second + end.second <= 1.0) return;
      const std::size_t direction = direction_of(normal, table.size()), most = &table == &tables[0] ? 1 : kMostTurns;
      cut_by(table[direction]);
      cut_to_side(table, direction, 1, most);
      cut_to_side(table, direction, table.size() - 1, most);
    }
  }
};

struct Crowds::Scratch {
  std::vector<std::uint32_t> members;
  Lines lines;
  std::vector<CandidateWall> found;
  BearingIndex::Scratch index;
};

Crowds::Crowds(const MoverGeometry& movers) : movers_(movers) {}
Crowds::~Crowds() = default;

void Crowds::find(std::span<const Viewpoint> views, base::ThreadPool& thread_pool) {
  scratch_.resize(thread_pool.threads());
  find_places(views, thread_pool);
  if (cells_.size() < places_.size()) cells_.resize(places_.size());
  thread_pool.parallel_for(places_.size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t k = first; k < last; ++k) build(viewers_of(k), scratch_[thread], cells_[k]);
  });
}

/// Assigns crowded views to large cells if nearly all movers at the cell contain it, and otherwise to small cells.
void Crowds::find_places(std::span<const Viewpoint> views, base::ThreadPool& thread_pool) {
  if (size_ == 0.0) size_ = std::max(0.25 * movers_.smallest_inner(), movers_.largest_radius() / 64.0);
  place_of_view_.assign(views.size(), kNowhere);
  for (std::size_t i = 0; i < views.size(); ++i)
    if (is_crowded(views[i])) place_of_view_[i] = place_of(views[i], kLarge);
  collect_places(views);
  serves_.assign(places_.size(), 0);
  thread_pool.parallel_for(places_.size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t k = first; k < last; ++k) serves_[k] = serves(viewers_of(k), scratch_[thread]) ? 1 : 0;
  });
  if (std::all_of(serves_.begin(), serves_.end(), [](std::uint8_t serves) { return serves != 0; })) return;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (place_of_[i] != kNoPlace && serves_[place_of_[i]] == 0) place_of_view_[i] = place_of(views[i], 1);
  collect_places(views);
}

Crowds::Place Crowds::place_of(const Viewpoint& view, std::int32_t scale) const {
  const auto cell_of = [&](double at) {
    return std::llround(std::floor(std::clamp(at / (scale * size_), -4e15, 4e15)));
  };
  return {view.X_WS.z, scale, cell_of(view.X_WS.x), cell_of(view.X_WS.y), movers_.grid().copies.copy_of(view.self)};
}

/// Lists the places of the views and computes the bounding box of the viewers in each.
void Crowds::collect_places(std::span<const Viewpoint> views) {
  places_.clear();
  std::copy_if(place_of_view_.begin(), place_of_view_.end(), std::back_inserter(places_),
               [](const Place& place) { return place != kNowhere; });
  std::sort(places_.begin(), places_.end());
  places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
  place_of_.assign(places_.empty() ? 0 : views.size(), kNoPlace);
  boxes_.assign(places_.size(), base::empty_box());
  for (std::size_t i = 0; i < place_of_.size(); ++i) {
    if (place_of_view_[i] == kNowhere) continue;
    const auto place = std::lower_bound(places_.begin(), places_.end(), place_of_view_[i]) - places_.begin();
    const glm::dvec2 p{views[i].X_WS.x, views[i].X_WS.y};
    place_of_[i] = static_cast<std::uint32_t>(place);
    boxes_[place_of_[i]] = base::united(boxes_[place_of_[i]], base::box_of(p, p));
  }
}

Crowds::Disc Crowds::viewers_of(std::size_t place) const {
  const base::Box& box = boxes_[place];
  return {0.5 * (box.min + box.max),
          0.5 * length(box.max - box.min) * (1.0 + 1e-6) + 1e-9 + 1e-15 * (std::abs(box.max.x) + std::abs(box.max.y)),
          places_[place].z, places_[place].copy};
}

/// Returns whether nearly all movers that contain the centre of a large cell's viewers also contain all of these
/// viewers.
bool Crowds::serves(const Disc& viewers, Scratch& s) const {
  find_members({viewers.centre, 0.0, viewers.z, viewers.copy}, s.members);
  const std::size_t most = s.members.size();
  find_members(viewers, s.members);
  return s.members.size() >= kCrowd && s.members.size() + most / 16 >= most;
}

/// Returns whether enough movers for a crowd are near the view.
bool Crowds::is_crowded(const Viewpoint& view) const {
  const MoverGrid& grid = movers_.grid();
  const glm::dvec2 at = glm::dvec2{view.X_WS.x, view.X_WS.y} - grid.low;
  const std::uint32_t copy = grid.copies.copy_of(view.self);
  const int left = grid.column_of(at.x - grid.largest_radius), right = grid.column_of(at.x + grid.largest_radius);
  std::uint32_t movers = 0;
  const int last = grid.row_of(at.y + grid.largest_radius, copy);
  for (int row = grid.row_of(at.y - grid.largest_radius, copy); row <= last; ++row)
    movers += grid.begin_of(right + 1, row) - grid.begin_of(left, row);
  return movers > kCrowd;
}

void Crowds::build(const Disc& viewers, Scratch& s, CrowdCell& cell) const {
  cell.centre = viewers.centre;
  cell.blocks.clear(), cell.bounds.clear(), cell.members.clear();
  find_members(viewers, s.members);
  if (s.members.size() < kCrowd) return;

  std::size_t edges = 0;
  for (const std::uint32_t m : s.members) edges += outline_of(m, viewers).edges;
  const double most = movers_.largest_radius();
  Lines& lines = s.lines;
  lines.clear(edges);
  lines.margin = 1e-12 * most * (1.0 + most / size_);
  cell.members.resize((movers_.states().size() + 63) / 64);
  for (const std::uint32_t m : s.members) {
    cell.members[m / 64] |= std::uint64_t{1} << m % 64;
    const OutlineTable::Outline& outline = outline_of(m, viewers);
    for (const OutlineTable::Loop& loop :
         std::span(movers_.outlines().loops).subspan(outline.first_loop, outline.loops))
      if (holds(m, loop, viewers)) add_loop(m, loop, viewers, lines);
  }
  cell.horizon = lines.reach.second;
  s.found.clear();
  for (const std::uint32_t m : s.members) add_edges(m, lines, viewers, s.found);
  cell.by_bearing.build(
      s.found, viewers.radius, [&](std::uint32_t row) { return movers_.exact()[row - movers_.first_rows().front()]; },
      s.index);
  append_blocks(s.found, cell.blocks, cell.bounds);
  cell.bounds.resize(cell.blocks.size() + kBlock);
}

/// Lists the movers with an outline that contains the viewers, without twins.
void Crowds::find_members(const Disc& viewers, std::vector<std::uint32_t>& members) const {
  const MoverGrid& grid = movers_.grid();
  const glm::dvec2 at = viewers.centre - grid.low;
  const double reach = grid.largest_radius;
  const int left = grid.column_of(at.x - reach), right = grid.column_of(at.x + reach);
  const auto x = static_cast<float>(at.x), y = static_cast<float>(at.y);
  members.clear();
  for (int row = grid.row_of(at.y - reach, viewers.copy); row <= grid.row_of(at.y + reach, viewers.copy); ++row)
    for (std::uint32_t k = grid.begin_of(left, row); k < grid.begin_of(right + 1, row); ++k) {
      const float dx = grid.x[k] - x, dy = grid.y[k] - y, most = 1.0001f * grid.radius[k] + grid.error;
      if (dx * dx + dy * dy > most * most || grid.twin[k] != kNoMover) continue;
      const OutlineTable::Outline& outline = outline_of(grid.mover[k], viewers);
      const auto loops = std::span(movers_.outlines().loops).subspan(outline.first_loop, outline.loops);
      if (std::any_of(loops.begin(), loops.end(),
                      [&](const OutlineTable::Loop& loop) { return holds(grid.mover[k], loop, viewers); }))
        members.push_back(grid.mover[k]);
    }
}

/// Returns the outline of a mover at the height of the viewers.
const OutlineTable::Outline& Crowds::outline_of(std::uint32_t mover, const Disc& viewers) const {
  return movers_.outlines().at(mover, viewers.z - movers_.states()[mover].X_WM.z);
}

/// Returns edge `number` of a mover, relative to `centre`.
Crowds::Edge Crowds::edge_of(std::uint32_t mover, std::uint32_t number, glm::dvec2 centre) const {
  const ExactSegment& s = movers_.exact()[movers_.first_rows()[mover] - movers_.first_rows().front() + number];
  return {{s.ax - centre.x, s.ay - centre.y}, {s.bx - centre.x, s.by - centre.y}};
}

/// Returns whether all viewers are inside `loop` and away from its edges.
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

/// Adds the parts of a mover's edges that the viewers may see.
void Crowds::add_edges(std::uint32_t mover, const Lines& lines, const Disc& viewers,
                       std::vector<CandidateWall>& found) const {
  const OutlineTable::Outline& outline = outline_of(mover, viewers);
  for (const std::uint32_t number : std::span(movers_.outlines().edges).subspan(outline.first_edge, outline.edges)) {
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
