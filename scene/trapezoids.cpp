#include "scene/trapezoids.h"

#include <algorithm>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <iterator>
#include <utility>

#include "base/box_tree.h"
#include "base/pose.h"

namespace sf::scene {

namespace {

/// An edge with its lower end first.
struct Side {
  glm::dvec2 low, high;
  int winding = 0;  ///< change of the winding number from left to right

  double x_at(double y) const {
    if (y == low.y) return low.x;
    if (y == high.y) return high.x;
    return low.x + (high.x - low.x) * ((y - low.y) / (high.y - low.y));
  }
};

class Sweep {
 public:
  explicit Sweep(std::span<const RegionEdge> edges);
  std::vector<Trapezoid> run();

 private:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;  ///< left and right side
  /// The piece on the right of a side.
  struct Open {
    std::uint32_t right = 0xFFFFFFFFu;  ///< its other side; if there is no piece, none
    double from = 0.0;                  ///< height of its lower side
    std::size_t last = 0;               ///< step of the sweep in which it was found again
  };
  void activate(double y0, double y1);
  void find_pairs(std::vector<Pair>& pairs) const;
  void close(std::vector<Pair>& pairs, double to);

  std::vector<Side> sides_;  ///< by the height of their lower ends
  std::vector<double> heights_;
  std::vector<std::uint32_t> active_;  ///< from left to right
  std::vector<double> x_;              ///< per side: where it is in the middle between two heights
  std::size_t next_ = 0;               ///< first side above the sweep line
  std::vector<Open> open_;             ///< per side
  std::vector<Trapezoid> out_;
};

Sweep::Sweep(std::span<const RegionEdge> edges) {
  for (const RegionEdge& e : edges) {
    heights_.push_back(e.a.y), heights_.push_back(e.b.y);
    if (e.a.y == e.b.y) continue;  // bounds the pieces above and below it
    sides_.push_back(e.a.y < e.b.y ? Side{e.a, e.b, -1} : Side{e.b, e.a, 1});
  }
  std::ranges::sort(sides_, {}, [](const Side& side) { return side.low.y; });
  std::ranges::sort(heights_);
  const auto same = std::ranges::unique(heights_);
  heights_.erase(same.begin(), same.end());
  x_.resize(sides_.size()), open_.resize(sides_.size());
}

/// Sorts the sides between two heights. Those that were active keep their order, unless they cross.
void Sweep::activate(double y0, double y1) {
  std::erase_if(active_, [&](std::uint32_t i) { return sides_[i].high.y <= y0; });
  const auto known = static_cast<std::ptrdiff_t>(active_.size());
  for (; next_ < sides_.size() && sides_[next_].low.y <= y0; ++next_)
    active_.push_back(static_cast<std::uint32_t>(next_));
  for (const std::uint32_t i : active_) x_[i] = sides_[i].x_at(0.5 * (y0 + y1));
  const auto before = [&](std::uint32_t i, std::uint32_t j) { return std::pair(x_[i], i) < std::pair(x_[j], j); };
  std::sort(active_.begin() + known, active_.end(), before);
  std::inplace_merge(active_.begin(), active_.begin() + known, active_.end(), before);
  if (!std::ranges::is_sorted(active_, before)) std::ranges::sort(active_, before);
}

/// Finds the pairs of active sides between which the region lies.
void Sweep::find_pairs(std::vector<Pair>& pairs) const {
  pairs.clear();
  int winding = 0;
  for (std::size_t k = 0, left = 0; k < active_.size(); ++k) {
    const int before = std::exchange(winding, winding + sides_[active_[k]].winding);
    if (before <= 0 && winding > 0) left = k;
    if (before > 0 && winding <= 0) pairs.emplace_back(active_[left], active_[k]);
  }
}

/// Ends the pieces of pairs.
void Sweep::close(std::vector<Pair>& pairs, double to) {
  std::ranges::sort(pairs);
  for (const auto& [l, r] : pairs) {
    const Side &left = sides_[l], &right = sides_[r];
    const double from = open_[l].from;
    out_.push_back(
        {glm::dvec2{left.x_at(from), from}, {right.x_at(from), from}, {right.x_at(to), to}, {left.x_at(to), to}});
    open_[l] = {};
  }
}

std::vector<Trapezoid> Sweep::run() {
  std::vector<Pair> before, now, ended;
  for (std::size_t k = 0; k + 1 < heights_.size(); ++k) {
    activate(heights_[k], heights_[k + 1]);
    find_pairs(now);
    for (const auto& [left, right] : now)
      if (open_[left].right == right) open_[left].last = k;
    ended.clear();
    std::ranges::copy_if(before, std::back_inserter(ended),
                         [&](const Pair& pair) { return open_[pair.first].last != k; });
    close(ended, heights_[k]);
    for (const auto& [left, right] : now)
      if (open_[left].right != right) open_[left] = {right, heights_[k], k};
    std::swap(before, now);
  }
  close(before, heights_.empty() ? 0.0 : heights_.back());
  return std::move(out_);
}

}  // namespace

std::vector<Trapezoid> trapezoids_of(std::span<const RegionEdge> edges) { return Sweep(edges).run(); }

std::vector<RegionEdge> split_at_crossings(std::span<const RegionEdge> edges) {
  std::vector<base::Box> boxes;
  for (const RegionEdge& e : edges) boxes.push_back({glm::min(e.a, e.b), glm::max(e.a, e.b)});
  const base::BoxTree tree(boxes);
  std::vector<std::vector<glm::dvec2>> cuts(edges.size());
  for (std::uint32_t i = 0; i < edges.size(); ++i)
    tree.any(boxes[i], [&](std::uint32_t j) {
      if (j <= i) return false;
      const glm::dvec2 p = edges[i].b - edges[i].a, q = edges[j].b - edges[j].a, r = edges[j].a - edges[i].a;
      const double area = base::cross(p, q), s = base::cross(r, q) / area, t = base::cross(r, p) / area;
      if (!(area != 0.0 && s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0)) return false;
      cuts[i].push_back(edges[i].a + s * p);
      cuts[j].push_back(cuts[i].back());
      return false;
    });
  std::vector<RegionEdge> pieces;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    std::ranges::sort(cuts[i], {}, [&](glm::dvec2 p) { return glm::distance(p, edges[i].a); });
    cuts[i].push_back(edges[i].b);
    glm::dvec2 from = edges[i].a;
    for (const glm::dvec2& to : cuts[i])
      if (to != from) pieces.push_back({from, to}), from = to;
  }
  return pieces;
}

}  // namespace sf::scene
