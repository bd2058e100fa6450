#include "scene/trapezoids.h"

#include <algorithm>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
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
  std::vector<Pair> pairs_between(double y0, double y1);
  void close(const Pair& pair, double from, double to);

  std::vector<Side> sides_;  ///< by the height of their lower ends
  std::vector<double> heights_;
  std::vector<std::uint32_t> active_;
  std::size_t next_ = 0;  ///< first side above the sweep line
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
}

/// Returns the pairs of sides between which the region lies.
std::vector<Sweep::Pair> Sweep::pairs_between(double y0, double y1) {
  std::erase_if(active_, [&](std::uint32_t i) { return sides_[i].high.y <= y0; });
  for (; next_ < sides_.size() && sides_[next_].low.y <= y0; ++next_)
    active_.push_back(static_cast<std::uint32_t>(next_));
  const double middle = 0.5 * (y0 + y1);
  std::ranges::sort(active_, {}, [&](std::uint32_t i) { return std::pair(sides_[i].x_at(middle), i); });
  std::vector<Pair> pairs;
  int winding = 0;
  for (std::size_t k = 0, left = 0; k < active_.size(); ++k) {
    const int before = std::exchange(winding, winding + sides_[active_[k]].winding);
    if (before <= 0 && winding > 0) left = k;
    if (before > 0 && winding <= 0) pairs.emplace_back(active_[left], active_[k]);
  }
  return pairs;
}

void Sweep::close(const Pair& pair, double from, double to) {
  const Side &left = sides_[pair.first], &right = sides_[pair.second];
  out_.push_back(
      {glm::dvec2{left.x_at(from), from}, {right.x_at(from), from}, {right.x_at(to), to}, {left.x_at(to), to}});
}

std::vector<Trapezoid> Sweep::run() {
  std::map<Pair, double> open;  // with the height of their lower side
  for (std::size_t k = 0; k + 1 < heights_.size(); ++k) {
    std::map<Pair, double> continued;
    for (const Pair& pair : pairs_between(heights_[k], heights_[k + 1])) {
      const auto known = open.find(pair);
      continued[pair] = known == open.end() ? heights_[k] : known->second;
      if (known != open.end()) open.erase(known);
    }
    for (const auto& [pair, from] : open) close(pair, from, heights_[k]);
    open = std::move(continued);
  }
  for (const auto& [pair, from] : open) close(pair, from, heights_.back());
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
