#pragma once
// Bounding volume hierarchy of boxes in the plane, used to index static geometry. Built once. Queries do not allocate
// and are thread-safe.
//
//   tree.any(base::box_around(p, 2.0), [&](std::uint32_t i) { return distance(p, segments[i]) < 2.0; })

#include <cstdint>
#include <span>
#include <vector>

#include "base/box.h"

namespace sf::base {

class BoxTree {
 public:
  /// Nodes are stored depth first. The children of inner node i are node i + 1 and the node that follows its subtree.
  struct Node {
    Box box;                  ///< bounds of the whole subtree
    std::uint32_t end = 0;    ///< first node after this node's subtree
    std::uint32_t first = 0;  ///< first box of a leaf in `order`
    std::uint32_t count = 0;  ///< number of boxes in a leaf; 0 for an inner node
  };

  /// @param boxes finite  @param leaf_boxes largest number of boxes in a leaf; a query visits the boxes of a leaf
  /// together
  explicit BoxTree(std::span<const Box> boxes = {}, std::size_t leaf_boxes = 1);

  /// Returns true as soon as `predicate(index)` is true for a box in a leaf that meets `box`. Calls it at most once per
  /// box, in a fixed order.
  template <class Predicate>
  bool any(const Box& box, Predicate&& predicate) const {
    return any_place(box, [&](std::uint32_t place) { return predicate(order_[place]); });
  }
  /// Same as `any`, but passes places in `order` instead of indices.
  template <class Predicate>
  bool any_place(const Box& box, Predicate&& predicate) const {
    for (std::uint32_t i = 0; i < nodes_.size();) {
      const Node& node = nodes_[i];
      const bool near = meet(node.box, box);
      i = near ? i + 1 : node.end;
      for (std::uint32_t at = node.first; near && at < node.first + node.count; ++at)
        if (predicate(at)) return true;
    }
    return false;
  }

  Box extent() const { return nodes_.empty() ? empty_box() : nodes_.front().box; }
  std::span<const Node> nodes() const { return nodes_; }
  /// Returns the indices of the boxes, leaf by leaf.
  std::span<const std::uint32_t> order() const { return order_; }

 private:
  struct Item {
    Box box;
    std::uint32_t index;
  };
  void build(std::span<Item> items, std::size_t leaf_boxes);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

}  // namespace sf::base
