#include "cluster/tiles.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::cluster {

Tiles::Tiles(std::span<const glm::dvec2> points, std::span<const double> costs, unsigned count) {
  std::vector<Item> items;
  for (std::size_t i = 0; i < points.size(); ++i) items.push_back({points[i], costs[i]});
  boxes_.reserve(count);
  divide(items, {{-HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, HUGE_VAL}}, 0, count);
}

void Tiles::divide(std::span<Item> items, const base::Box& box, unsigned first, unsigned count) {
  if (count == 1) {
    boxes_.push_back(box);
    return;
  }
  base::Box extent = base::empty_box();
  for (const Item& item : items) extent = base::united(extent, {item.p, item.p});
  const int axis = extent.max.y - extent.min.y > extent.max.x - extent.min.x ? 1 : 0;
  std::stable_sort(items.begin(), items.end(), [&](const Item& a, const Item& b) { return a.p[axis] < b.p[axis]; });
  double whole = 0.0, before = 0.0;
  for (const Item& item : items) whole += item.cost;
  const unsigned lower = count / 2;
  const double due = whole * lower / count;
  std::size_t at = 0;
  while (at < items.size() && before + 0.5 * items[at].cost < due) before += items[at++].cost;

  // Without points the cut is arbitrary; points with equal coordinates stay together.
  const std::size_t low = at > 0 ? at - 1 : 0, high = std::min(at, items.size() - 1);
  const double between = items.empty() ? 0.0 : 0.5 * items[low].p[axis] + 0.5 * items[high].p[axis];
  const double cut = std::clamp(between, box.min[axis], box.max[axis]);
  const auto place = std::partition_point(items.begin(), items.end(), [&](const Item& i) { return i.p[axis] < cut; });
  const std::size_t cut_row = cuts_.size();
  cuts_.push_back({first + lower, axis, cut});
  base::Box below = box, above = box;
  below.max[axis] = above.min[axis] = cut;
  divide({items.begin(), place}, below, first, lower);
  cuts_[cut_row].after = static_cast<std::uint32_t>(cuts_.size());
  divide({place, items.end()}, above, first + lower, count - lower);
}

unsigned Tiles::at(glm::dvec2 p) const {
  unsigned first = 0, last = size();
  for (std::uint32_t i = 0; last - first > 1;) {
    const Cut& cut = cuts_[i];
    const bool lower = p[cut.axis] < cut.at;
    (lower ? last : first) = cut.middle;
    i = lower ? i + 1 : cut.after;
  }
  return first;
}

double Tiles::distance(unsigned tile, glm::dvec2 p) const {
  const base::Box& box = boxes_[tile];
  return base::hypot(std::max({box.min.x - p.x, 0.0, p.x - box.max.x}),
                     std::max({box.min.y - p.y, 0.0, p.y - box.max.y}));
}

}  // namespace sf::cluster
