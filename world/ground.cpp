#include "world/ground.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/elementary.h"
#include "world/terrain.h"

namespace sf::world {

namespace {

constexpr double kBorderSlope = 1e3;  // of a terrain's border, which is upright

base::BoxTree tree_of(std::span<const Ramp> ramps) {
  std::vector<base::Box> boxes;
  for (const Ramp& ramp : ramps) {
    base::Box box = base::box_of(ramp.a, ramp.b);
    box.min -= ramp.half_width, box.max += ramp.half_width;
    boxes.push_back(box);
  }
  return base::BoxTree(boxes, 4);
}

/// Returns the lowest point of a ball whose middle is `offset` [m], less than its radius, from the edge under it.
GroundPoint over(GroundPoint edge, glm::dvec2 offset, double radius) {
  const double squared = glm::dot(offset, offset), height = std::sqrt(radius * radius - squared);
  if (!(squared > 0.0 && height > 0.0)) return edge;
  edge.slope -= glm::dot(edge.slope, offset) / squared * offset + offset / height;
  edge.z -= radius - height;
  return edge;
}

}  // namespace

Ground::Ground(std::span<const Ramp> ramps, std::span<const Terrain> terrain) : ramps_(ramps), tree_(tree_of(ramps)) {
  if (!terrain.empty()) terrain_.emplace(terrain[0]);
}

/// Of the terrain, or of the floor.
GroundPoint Ground::base_at(glm::dvec2 p, double most, double radius) const {
  const std::optional<GroundPoint> inside = terrain_ ? terrain_->at(p) : GroundPoint{};
  const GroundPoint here = inside.value_or(GroundPoint{});
  if (radius == 0.0 || !terrain_) return here;
  const glm::dvec2 border = terrain_->border(p), offset = p - border;
  if (!(glm::dot(offset, offset) < radius * radius)) return here;
  const GroundPoint edge = inside ? GroundPoint{} : terrain_->at(border).value_or(GroundPoint{});
  const GroundPoint round = over(edge, offset, radius);
  return edge.z <= most && round.z > here.z ? round : here;
}

GroundPoint Ground::at(glm::dvec2 p, double most, double radius) const {
  if (is_flat()) return {};
  GroundPoint highest = base_at(p, most, radius), beyond = highest;  // of pieces at p, and of those that end near p
  bool on_piece = false;
  tree_.any({p - radius, p + radius}, [&](std::uint32_t i) {
    const Ramp& ramp = ramps_[i];
    const glm::dvec2 e = ramp.b - ramp.a;
    const double length = glm::length(e), left = base::cross(e, p - ramp.a);
    const bool is_aside = std::abs(left) > ramp.half_width * length;
    if (!(length > 0.0) || (is_aside && radius == 0.0)) return false;
    const double s = glm::dot(p - ramp.a, e) / length;
    const double past = std::max({0.0, -s, s - length}), over_end = past - kOverlap * ramp.half_width;
    const double z = ramp.z_a + std::clamp(s / length, 0.0, 1.0) * (ramp.z_b - ramp.z_a);
    if (z > most || (over_end > 0.0 && radius == 0.0)) return false;
    GroundPoint point{z, past > 0.0 ? glm::dvec2{} : (ramp.z_b - ramp.z_a) / (length * length) * e};
    if (is_aside || over_end > 0.0) {
      const double aside = is_aside ? std::copysign(std::abs(left) / length - ramp.half_width, left) : 0.0;
      const glm::dvec2 local{std::copysign(std::max(0.0, over_end), s), aside};
      if (!(glm::dot(local, local) < radius * radius)) return false;
      point = over(point, (local.x * e + local.y * glm::dvec2{-e.y, e.x}) / length, radius);
    }
    on_piece = on_piece || (!is_aside && past == 0.0);
    GroundPoint& surface = past > 0.0 ? beyond : highest;
    if (point.z > surface.z) surface = point;
    return false;
  });
  // A wheel off the road rolls on to it without a step.
  return beyond.z > highest.z + (radius > 0.0 && !on_piece ? 0.0 : kContact) ? beyond : highest;
}

GroundPoint Ground::contact(const glm::dvec3& p, glm::dvec2 middle, double step, double radius) const {
  const GroundPoint here = at({p.x, p.y}, p.z + step, radius);
  if (here.z <= p.z + step) return here;
  glm::dvec2 in{p.x, p.y}, out = middle;
  if (base_at(out).z > p.z) out = 2.0 * in - middle;
  if (base_at(out).z > p.z) return here;
  for (int k = 0; k < 24; ++k) {
    const glm::dvec2 half = 0.5 * (in + out);
    (base_at(half).z > p.z ? in : out) = half;
  }
  GroundPoint face = base_at(in);
  if (terrain_->at(in).has_value() != terrain_->at(out).has_value()) {
    const glm::dvec2 up = in - terrain_->border(in) + terrain_->border(out) - out;
    if (const double length = glm::length(up); length > 0.0) face.slope = kBorderSlope / length * up;
  }
  if (glm::dot(face.slope, face.slope) < 1.0) return here;
  face.z = p.z + glm::dot(face.slope, glm::dvec2{p.x, p.y} - in);
  return face;
}

double Ground::follow(const base::Pose& from, glm::dvec2 to) const {
  const glm::dvec2 p{from.x, from.y};
  if (p == to) return from.z;
  const double below = height(p, from.z + kContact);
  const double next = height(to, below + kMostStep + kMostSlope * glm::length(to - p));
  return std::abs(from.z - below) <= kContact ? next : from.z + (next - below);
}

Pose Ground::stand(const Pose& from, const Pose& to) const {
  return {to.x, to.y, is_flat() ? from.z : clearance(from) + height({to.x, to.y}, HUGE_VAL), to.yaw};
}

base::Tilt Ground::tilt(const base::Pose& at, double length, double width) const {
  if (!terrain_) return {};
  const auto height_of = [&](double x, double y) { return base_at(base::transform(at, {x * length, y * width})).z; };
  const double front_left = height_of(0.5, 0.5), front_right = height_of(0.5, -0.5);
  const double rear_left = height_of(-0.5, 0.5), rear_right = height_of(-0.5, -0.5);
  const double along = 0.5 * ((front_left - rear_left) + (front_right - rear_right)) / length;
  const double across = 0.5 * ((front_left - front_right) + (rear_left - rear_right)) / width;
  return {.roll = base::atan2(across, base::hypot(1.0, along)), .pitch = -base::atan2(along, 1.0)};
}

double clearance_of(const World& world, const Mover& mover) {
  return Ground(world.ramps, world.terrain).clearance(mover.X_WM);
}

double height_on_road(const World& world, glm::dvec2 p, double clearance) {
  return clearance + Ground(world.ramps, world.terrain).height(p, HUGE_VAL);
}

}  // namespace sf::world
