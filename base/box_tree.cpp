#include "base/box_tree.h"

namespace sf::base {

BoxTree::BoxTree(std::span<const Box> boxes, std::size_t leaf_boxes) {
  std::vector<Item> items;
  items.reserve(boxes.size());
  for (const Box& box : boxes) items.push_back({box, static_cast<std::uint32_t>(items.size())});
  order_.reserve(items.size());
  if (!items.empty()) build(items, leaf_boxes);
}

/// Splits at the median of the longer side.
void BoxTree::build(std::span<Item> items, std::size_t leaf_boxes) {
  const std::size_t at = nodes_.size();
  Box all = empty_box();
  for (const Item& item : items) all = united(all, item.box);
  nodes_.push_back({.box = all});
  if (items.size() <= leaf_boxes) {
    nodes_[at].first = static_cast<std::uint32_t>(order_.size());
    nodes_[at].count = static_cast<std::uint32_t>(items.size());
    for (const Item& item : items) order_.push_back(item.index);
  } else {
    const bool wide = all.max.x - all.min.x > all.max.y - all.min.y;
    const auto middle = [&](const Box& box) { return wide ? box.min.x + box.max.x : box.min.y + box.max.y; };
    const std::size_t half = items.size() / 2;
    std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
                     [&](const Item& a, const Item& b) { return middle(a.box) < middle(b.box); });
    build(items.first(half), leaf_boxes);
    build(items.subspan(half), leaf_boxes);
  }
  nodes_[at].end = static_cast<std::uint32_t>(nodes_.size());
}

}  // namespace sf::base
