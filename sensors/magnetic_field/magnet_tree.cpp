#include "sensors/magnetic_field/magnet_tree.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::sensors {

namespace {

using base::Box;

/// A node represents its magnets when it is smaller than this fraction of its distance or of the query box. The bound
/// is then too large by some per cent, or by less than the box itself adds.
constexpr double kOpening = 0.25;
constexpr double kOpeningToBox = 0.5;

double gap(double low_a, double high_a, double low_b, double high_b) {
  return std::max({0.0, low_b - high_a, low_a - high_b});
}

double least_distance(const Box& a, const Box& b) {
  return base::hypot(gap(a.min.x, a.max.x, b.min.x, b.max.x), gap(a.min.y, a.max.y, b.min.y, b.max.y));
}

double greatest_distance(const Box& a, const Box& b) {
  return base::hypot(std::max(a.max.x - b.min.x, b.max.x - a.min.x), std::max(a.max.y - b.min.y, b.max.y - a.min.y));
}

double side_of(const Box& box) { return std::max(box.max.x - box.min.x, box.max.y - box.min.y); }

base::BoxTree tree_of(std::span<const world::Magnet> magnets) {
  std::vector<Box> boxes;
  for (const world::Magnet& magnet : magnets) boxes.push_back({magnet.p, magnet.p});
  return base::BoxTree(boxes);
}

}  // namespace

double strength_of(const world::Magnet& magnet) { return kPermeability * std::abs(magnet.moment); }

double field_beyond(double k, double along, double above) {
  const double squared = along * along + above * above;
  return k * std::sqrt(along * along + 4.0 * above * above) / (squared * squared);
}

MagnetTree::MagnetTree(std::span<const world::Magnet> magnets, double height)
    : tree_(tree_of(magnets)), sums_(tree_.nodes().size()) {
  for (std::size_t i = sums_.size(); i-- > 0;) {
    const base::BoxTree::Node& node = tree_.nodes()[i];
    if (node.count > 0) {
      const world::Magnet& magnet = magnets[tree_.order()[node.first]];
      sums_[i] = {strength_of(magnet), std::abs(height - magnet.z)};
    } else {
      const Sum &a = sums_[i + 1], &b = sums_[tree_.nodes()[i + 1].end];
      sums_[i] = {a.strength + b.strength, std::min(a.above, b.above)};
    }
  }
}

double MagnetTree::bound(const Box& box, double cutoff) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < sums_.size();) {
    const base::BoxTree::Node& node = tree_.nodes()[i];
    const double along = std::max(cutoff, least_distance(box, node.box));
    const bool counts = greatest_distance(box, node.box) > cutoff;
    const bool whole = node.count > 0 || side_of(node.box) <= std::max(kOpening * along, kOpeningToBox * side_of(box));
    if (counts && whole) sum += field_beyond(sums_[i].strength, along, sums_[i].above);
    i = counts && !whole ? i + 1 : node.end;
  }
  return sum;
}

}  // namespace sf::sensors
