#include "world/wall_grid.h"

#include <bit>
#include <cmath>
#include <utility>

#include "base/error.h"

namespace sf::world {

namespace {

constexpr double kGrowth = 8.0;          // cell edge from one level to the next
constexpr double kLongest = 64.0;        // cells that a wall may span on its level
constexpr std::uint32_t kLevels = 12;    // largest cell edge: 8^11 = 8.6e9 finest cells
constexpr std::size_t kPart = 1u << 18;  // buckets filled together
constexpr double kFarthest = 4.0e15;     // cell numbers stay exact integers

double side(glm::dvec2 a, glm::dvec2 b, glm::dvec2 p) { return base::cross(b - a, p - a); }

bool within(double p, double a, double b) { return std::min(a, b) <= p && p <= std::max(a, b); }

}  // namespace

double distance(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) { return length(from_segment(p, a, b)); }

bool segments_meet(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
  const double sc = side(a, b, c);
  const double sd = side(a, b, d);
  if ((sc > 0.0 && sd > 0.0) || (sc < 0.0 && sd < 0.0)) return false;
  const double sa = side(c, d, a);
  const double sb = side(c, d, b);
  if ((sa > 0.0 && sb > 0.0) || (sa < 0.0 && sb < 0.0)) return false;
  if (sa != 0.0 || sb != 0.0 || sc != 0.0 || sd != 0.0) return true;

  // All four points on one line: the segments meet when their ranges overlap.
  const auto on = [](glm::dvec2 p, glm::dvec2 q, glm::dvec2 r) {
    return within(p.x, q.x, r.x) && within(p.y, q.y, r.y);
  };
  return on(a, c, d) || on(b, c, d) || on(c, a, b);
}

int winding_number(std::span<const Segment> edges, glm::dvec2 p) {
  int sum = 0;
  for (const Segment& e : edges) {
    if (!e.solid_left) continue;
    const bool up = e.a.y <= p.y && e.b.y > p.y, down = e.b.y <= p.y && e.a.y > p.y;
    const double turn = side(e.a, e.b, p);
    if (up && turn > 0.0) ++sum;
    if (down && turn < 0.0) --sum;
  }
  return sum;
}

WallGrid::WallGrid(std::vector<Segment> walls, double cell) : walls_(std::move(walls)) {
  SF_CHECK(cell > 0.0 && std::isfinite(cell), "cell edge " + std::to_string(cell));
  for (std::uint32_t level = 0; level < kLevels; ++level) cells_.push_back(cell * std::pow(kGrowth, level));

  // Count, then fill: buckets are contiguous.
  std::size_t count = 0;
  std::vector<bool> used(kLevels, false);
  starts_.assign(2, 0);
  for (const Segment& wall : walls_) {
    used[level_of(wall)] = true;
    for_each_bucket(wall, [&](std::size_t) { ++count; });
  }
  for (std::uint32_t level = 0; level < kLevels; ++level) {
    if (used[level]) used_.push_back(level);
  }
  starts_.assign(std::bit_ceil(std::max<std::size_t>(count, 1)) + 1, 0);
  entries_.resize(count);
  fill();
}

// Writes to buckets are random accesses. So entries are first sorted into parts of buckets that fit into the cache,
// then within each part.
void WallGrid::fill() {
  struct Entry {
    std::uint32_t bucket, row;
  };
  std::vector<std::size_t> ends((starts_.size() - 2) / kPart + 2, 0);
  for (const Segment& wall : walls_) for_each_bucket(wall, [&](std::size_t at) { ++ends[at / kPart + 1]; });
  for (std::size_t part = 1; part < ends.size(); ++part) ends[part] += ends[part - 1];
  std::vector<Entry> entries(entries_.size());
  std::vector<std::size_t> next(ends.begin(), ends.end() - 1);
  for (std::uint32_t row = 0; row < walls_.size(); ++row)
    for_each_bucket(walls_[row], [&](std::size_t at) {
      entries[next[at / kPart]++] = {static_cast<std::uint32_t>(at), row};
    });

  std::vector<std::uint32_t> places(kPart);
  for (std::size_t part = 0; part + 1 < ends.size(); ++part) {
    const std::span<const Entry> own = std::span<const Entry>(entries).subspan(ends[part], ends[part + 1] - ends[part]);
    const std::size_t first = part * kPart, end = std::min(first + kPart, starts_.size() - 1);
    std::fill(places.begin(), places.end(), 0u);
    for (const Entry& e : own) ++places[e.bucket - first];
    auto at = static_cast<std::uint32_t>(ends[part]);
    for (std::size_t bucket = first; bucket < end; ++bucket) {
      starts_[bucket] = at;
      at += std::exchange(places[bucket - first], at);
    }
    for (const Entry& e : own) entries_[places[e.bucket - first]++] = e.row;
  }
  starts_.back() = static_cast<std::uint32_t>(entries_.size());
}

std::int64_t WallGrid::cell_of(double v, double cell) {
  return static_cast<std::int64_t>(std::clamp(std::floor(v / cell), -kFarthest, kFarthest));
}

std::size_t WallGrid::bucket(std::uint32_t level, std::int64_t x, std::int64_t y) const {
  // Finaliser of SplitMix64 (Steele et al., 2014) over the three numbers.
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15u + static_cast<std::uint64_t>(y);
  h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9u + level;
  h = (h ^ (h >> 27)) * 0x94D049BB133111EBu;
  return (h ^ (h >> 31)) & (starts_.size() - 2);
}

std::uint32_t WallGrid::level_of(const Segment& wall) const {
  const double span = std::max(std::abs(wall.b.x - wall.a.x), std::abs(wall.b.y - wall.a.y));
  std::uint32_t level = 0;
  while (level + 1 < kLevels && span > kLongest * cells_[level]) ++level;
  return level;
}

template <class Visit>
void WallGrid::for_each_bucket(const Segment& wall, Visit&& visit) const {
  const std::uint32_t level = level_of(wall);
  const double cell = cells_[level];
  const double slack = 1e-6 * cell;  // far above rounding errors at 100 km, far below a cell
  const glm::dvec2 p = wall.a.x <= wall.b.x ? wall.a : wall.b;
  const glm::dvec2 q = wall.a.x <= wall.b.x ? wall.b : wall.a;

  // Column by column: the cells that the wall crosses in the column.
  const std::int64_t last = cell_of(q.x, cell);
  for (std::int64_t x = cell_of(p.x, cell); x <= last; ++x) {
    const auto y_at = [&](double at) {
      const double t = q.x > p.x ? std::clamp((at - p.x) / (q.x - p.x), 0.0, 1.0) : 0.0;
      return p.y + t * (q.y - p.y);
    };
    double y0 = y_at(static_cast<double>(x) * cell - slack);
    double y1 = q.x > p.x ? y_at(static_cast<double>(x + 1) * cell + slack) : q.y;
    if (y0 > y1) std::swap(y0, y1);
    const std::int64_t top = cell_of(y1 + slack, cell);
    for (std::int64_t y = cell_of(y0 - slack, cell); y <= top; ++y) visit(bucket(level, x, y));
  }
}

}  // namespace sf::world
