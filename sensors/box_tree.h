#pragma once
// A balanced tree of axis-aligned boxes in the plane, for intersection queries. Built once; queries do not allocate and
// are thread-safe.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "world/wall_grid.h"

namespace sf::sensors {

using world::Box;

/// True when two closed boxes share a point.
inline bool meet(const Box& a, const Box& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y;
}

class BoxTree {
 public:
  /// @param boxes finite; their indices are passed to the predicates of queries
  explicit BoxTree(std::span<const Box> boxes = {});

  /// True as soon as `predicate(std::uint32_t index)` is true for a box that meets `box`. Calls it at most once per
  /// box, in a fixed order.
  template <class Predicate>
  bool any(const Box& box, Predicate&& predicate) const {
    return !nodes_.empty() && any_below(0, box, predicate);
  }

 private:
  struct Node {
    Box box;
    std::uint32_t left = 0;   ///< child; 0: this node is a leaf
    std::uint32_t right = 0;  ///< child; in a leaf, the index of its box
  };
  std::uint32_t build(std::span<const Box> boxes, std::span<std::uint32_t> numbers);

  template <class Predicate>
  bool any_below(std::uint32_t at, const Box& box, Predicate& predicate) const {
    const Node& node = nodes_[at];
    if (!meet(node.box, box)) return false;
    if (node.left == 0) return predicate(node.right);
    return any_below(node.left, box, predicate) || any_below(node.right, box, predicate);
  }

  std::vector<Node> nodes_;
};

}  // namespace sf::sensors
