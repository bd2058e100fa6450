#include "world/wall_tree.h"

namespace sf::world {

namespace {

constexpr std::size_t kLeafWalls = 8;

double side(glm::dvec2 a, glm::dvec2 b, glm::dvec2 p) { return base::cross(b - a, p - a); }

bool within(double p, double a, double b) { return std::min(a, b) <= p && p <= std::max(a, b); }

}  // namespace

Box box_of(std::span<const Segment> segments) {
  Box box = base::empty_box();
  for (const Segment& segment : segments) box = united(box, box_of(segment.a, segment.b));
  return box;
}

double distance(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) { return length(from_segment(p, a, b)); }

bool segments_meet(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
  const double sc = side(a, b, c);
  const double sd = side(a, b, d);
  if ((sc > 0.0 && sd > 0.0) || (sc < 0.0 && sd < 0.0)) return false;
  const double sa = side(c, d, a);
  const double sb = side(c, d, b);
  if ((sa > 0.0 && sb > 0.0) || (sa < 0.0 && sb < 0.0)) return false;
  if (sa != 0.0 || sb != 0.0 || sc != 0.0 || sd != 0.0) return true;

  // All four points are on one line: the segments meet if their ranges overlap.
  const auto on = [](glm::dvec2 p, glm::dvec2 q, glm::dvec2 r) {
    return within(p.x, q.x, r.x) && within(p.y, q.y, r.y);
  };
  return on(a, c, d) || on(b, c, d) || on(c, a, b);
}

int winding_number(std::span<const Segment> edges, glm::dvec2 p) {
  int sum = 0;
  for (const Segment& e : edges) {
    if (!e.solid_left) continue;
    const bool up = e.a.y <= p.y && e.b.y > p.y, down = e.b.y <= p.y && e.a.y > p.y;
    const double turn = side(e.a, e.b, p);
    if (up && turn > 0.0) ++sum;
    if (down && turn < 0.0) --sum;
  }
  return sum;
}

WallTree::WallTree(std::span<const Segment> walls) {
  std::vector<Box> boxes;
  boxes.reserve(walls.size());
  walls_.reserve(walls.size());
  for (const Segment& wall : walls) boxes.push_back(box_of(wall.a, wall.b));
  tree_ = base::BoxTree(boxes, kLeafWalls);
  for (const std::uint32_t row : tree_.order()) walls_.push_back(walls[row]);
}

}  // namespace sf::world
