#pragma once
// Boxes in the plane, many of them: which meet a box? A balanced tree of bounding boxes, built once; queries allocate
// nothing and may run on any thread.

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
  /// @param boxes finite; their numbers are what queries are told
  explicit BoxTree(std::span<const Box> boxes = {});

  /// True as soon as `predicate(std::uint32_t number)` is true for a box that meets `box`. Each is asked about at most
  /// once; the order is fixed.
  template <class Predicate>
  bool any(const Box& box, Predicate&& predicate) const {
    return !nodes_.empty() && any_below(0, box, predicate);
  }

 private:
  struct Node {
    Box box;
    std::uint32_t left = 0;   ///< of its children; 0: a leaf
    std::uint32_t right = 0;  ///< of a leaf: its box's number
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
