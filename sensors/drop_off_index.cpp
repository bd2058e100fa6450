#include "sensors/drop_off_index.h"

#include <algorithm>

namespace sf::sensors {

namespace {

Box box_of(const world::FloorHole& drop) {
  Box box = world::box_around(drop.outline.empty() ? glm::dvec2{} : drop.outline.front(), 0.0);
  for (const glm::dvec2& p : drop.outline) {
    box.min = {std::min(box.min.x, p.x), std::min(box.min.y, p.y)};
    box.max = {std::max(box.max.x, p.x), std::max(box.max.y, p.y)};
  }
  return box;
}

std::vector<Box> boxes_of(std::span<const world::FloorHole> drops) {
  std::vector<Box> boxes;
  for (const world::FloorHole& drop : drops) boxes.push_back(box_of(drop));
  return boxes;
}

/// True when the edge ab passes `p` on the right, along +x. Both ends are taken relative to `p` and in one order, so
/// that polygons that share the edge decide alike.
bool passes(glm::dvec2 a, glm::dvec2 b, glm::dvec2 p) {
  if ((a.y <= p.y) == (b.y <= p.y)) return false;
  if (a.y > b.y) std::swap(a, b);
  return base::cross(b - a, p - a) > 0.0;
}

}  // namespace

bool holds(std::span<const glm::dvec2> outline, glm::dvec2 p) {
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) inside ^= passes(outline[i], outline[(i + 1) % outline.size()], p);
  return inside;
}

DropOffIndex::DropOffIndex(std::span<const world::FloorHole> drops) : drop_offs_(drops), boxes_(boxes_of(drops)) {}

bool DropOffIndex::hold(glm::dvec2 p) const {
  return boxes_.any(world::box_around(p, 0.0), [&](std::uint32_t i) { return holds(drop_offs_[i].outline, p); });
}

}  // namespace sf::sensors
