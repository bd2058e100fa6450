#include "sensors/magnetic_field/magnet_tree.h"

#include <algorithm>
#include <cmath>

namespace sf::sensors {

namespace {

/// A node stands for its magnets when it is smaller than this fraction of its distance or of the query box. The bound
/// is then too large by some per cent, or by less than the box itself adds.
constexpr double kOpening = 0.25;
constexpr double kOpeningToBox = 0.5;

double gap(double low_a, double high_a, double low_b, double high_b) {
  return std::max({0.0, low_b - high_a, low_a - high_b});
}

double least_distance(const Box& a, const Box& b) {
  return std::hypot(gap(a.low.x, a.high.x, b.low.x, b.high.x), gap(a.low.y, a.high.y, b.low.y, b.high.y));
}

double greatest_distance(const Box& a, const Box& b) {
  return std::hypot(std::max(a.high.x - b.low.x, b.high.x - a.low.x), std::max(a.high.y - b.low.y, b.high.y - a.low.y));
}

Box joined(const Box& a, const Box& b) {
  return {{std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y)},
          {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y)}};
}

}  // namespace

double strength_of(const world::Magnet& magnet) { return kPermeability * std::abs(magnet.moment); }

double field_beyond(double k, double along, double above) {
  const double squared = along * along + above * above;
  return k * std::sqrt(along * along + 4.0 * above * above) / (squared * squared);
}

MagnetTree::MagnetTree(std::span<const world::Magnet> magnets, double height) {
  std::vector<Item> items;
  for (const world::Magnet& magnet : magnets)
    items.push_back({magnet.p, strength_of(magnet), std::abs(height - magnet.z)});
  nodes_.reserve(2 * items.size());
  if (!items.empty()) build(items);
}

void MagnetTree::build(std::span<Item> items) {
  const std::size_t at = nodes_.size();
  Node node{{items[0].p, items[0].p}, 0.0, items[0].above, 0, items.size() == 1};
  for (const Item& item : items) {
    node.box = joined(node.box, {item.p, item.p});
    node.strength += item.strength;
    node.above = std::min(node.above, item.above);
  }
  nodes_.push_back(node);
  if (!node.leaf) {
    const bool wide = node.box.high.x - node.box.low.x > node.box.high.y - node.box.low.y;
    const auto middle = items.begin() + static_cast<std::ptrdiff_t>(items.size() / 2);
    std::nth_element(items.begin(), middle, items.end(),
                     [&](const Item& a, const Item& b) { return wide ? a.p.x < b.p.x : a.p.y < b.p.y; });
    build(items.first(items.size() / 2));
    build(items.subspan(items.size() / 2));
  }
  nodes_[at].skip = static_cast<std::uint32_t>(nodes_.size());
}

double MagnetTree::bound(const Box& box, double cutoff) const {
  const double side = std::max(box.high.x - box.low.x, box.high.y - box.low.y);
  double sum = 0.0;
  for (std::uint32_t i = 0; i < nodes_.size();) {
    const Node& node = nodes_[i];
    if (greatest_distance(box, node.box) <= cutoff) {
      i = node.skip;
      continue;
    }
    const double along = std::max(cutoff, least_distance(box, node.box));
    const double size = std::max(node.box.high.x - node.box.low.x, node.box.high.y - node.box.low.y);
    if (node.leaf || size <= std::max(kOpening * along, kOpeningToBox * side)) {
      sum += field_beyond(node.strength, along, node.above);
      i = node.skip;
    } else {
      ++i;
    }
  }
  return sum;
}

Box MagnetTree::extent() const { return nodes_.empty() ? Box{} : nodes_.front().box; }

}  // namespace sf::sensors
