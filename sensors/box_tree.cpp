#include "sensors/box_tree.h"

#include <numeric>

namespace sf::sensors {

namespace {

Box around(const Box& a, const Box& b) {
  return {{std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y)},
          {std::max(a.max.x, b.max.x), std::max(a.max.y, b.max.y)}};
}

}  // namespace

BoxTree::BoxTree(std::span<const Box> boxes) {
  std::vector<std::uint32_t> numbers(boxes.size());
  std::iota(numbers.begin(), numbers.end(), 0u);
  nodes_.reserve(2 * boxes.size());
  if (!boxes.empty()) build(boxes, numbers);
}

std::uint32_t BoxTree::build(std::span<const Box> boxes, std::span<std::uint32_t> numbers) {
  const auto at = static_cast<std::uint32_t>(nodes_.size());
  Box all = boxes[numbers[0]];
  for (const std::uint32_t n : numbers) all = around(all, boxes[n]);
  nodes_.push_back({all, 0, numbers[0]});
  if (numbers.size() == 1) return at;

  // Split at the median of the longer side. Ties break by index, so that the tree is unique.
  const bool wide = all.max.x - all.min.x >= all.max.y - all.min.y;
  const auto middle = [&](std::uint32_t n) {
    return wide ? boxes[n].min.x + boxes[n].max.x : boxes[n].min.y + boxes[n].max.y;
  };
  std::sort(numbers.begin(), numbers.end(),
            [&](std::uint32_t m, std::uint32_t n) { return middle(m) != middle(n) ? middle(m) < middle(n) : m < n; });
  const std::size_t half = numbers.size() / 2;
  const std::uint32_t left = build(boxes, numbers.first(half));
  const std::uint32_t right = build(boxes, numbers.subspan(half));
  nodes_[at].left = left;
  nodes_[at].right = right;
  return at;
}

}  // namespace sf::sensors
