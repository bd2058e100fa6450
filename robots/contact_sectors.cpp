#include "robots/contact_sectors.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/elementary.h"
#include "base/report.h"
#include "robots/fleet_rules.h"
#include "world/wall_tree.h"

namespace sf::robots {

namespace {

using base::kContactSectors;

/// A piece of surface in the mover's frame; heights are above the mover's origin.
struct Surface {
  glm::dvec2 a, b;
  double z_min, z_max;
};

/// Directions of the borders between sectors, in the mover's frame.
const std::array<glm::dvec2, kContactSectors + 1>& borders() {
  static const auto table = [] {
    std::array<glm::dvec2, kContactSectors + 1> directions;
    for (std::uint32_t k = 0; k <= kContactSectors; ++k) directions[k] = contact_border(k);
    return directions;
  }();
  return table;
}

/// An interval of the parameter 0..1 along a surface. Empty unless `from` < `to`.
struct Part {
  double from = 0.0, to = 1.0;
};

/// Restricts the part to side(t) = at_a + t (at_b - at_a) >= 0.
void keep_positive(Part& part, double at_a, double at_b) {
  if (at_a >= 0.0 && at_b >= 0.0) return;
  if (at_a < 0.0 && at_b < 0.0) {
    part = {1.0, 0.0};
    return;
  }
  const double t = at_a / (at_a - at_b);
  if (at_a < 0.0) part.from = std::max(part.from, t);
  if (at_b < 0.0) part.to = std::min(part.to, t);
}

Part within_sector(const Surface& s, std::uint32_t k) {
  const glm::dvec2 right = borders()[k], left = borders()[k + 1];
  Part part;
  keep_positive(part, base::cross(right, s.a), base::cross(right, s.b));
  keep_positive(part, base::cross(s.a, left), base::cross(s.b, left));
  return part;
}

bool overlap(const FootprintEdge& e, const Surface& s) { return e.z_min < s.z_max && s.z_min < e.z_max; }

/// Returns whether the segments ab and cd are within kContactDistance of each other.
bool near(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
  const auto apart = [](double p, double q, double r, double s) {
    return std::min(p, q) > std::max(r, s) + kContactDistance || std::min(r, s) > std::max(p, q) + kContactDistance;
  };
  if (apart(a.x, b.x, c.x, d.x) || apart(a.y, b.y, c.y, d.y)) return false;
  return world::segments_meet(a, b, c, d) || world::distance(a, c, d) <= kContactDistance ||
         world::distance(b, c, d) <= kContactDistance || world::distance(c, a, b) <= kContactDistance ||
         world::distance(d, a, b) <= kContactDistance;
}

/// Returns the edges from the first to the last one near the surface; an empty span if there are none.
std::span<const FootprintEdge> edges_near(const Footprint& outline, const Surface& s) {
  std::size_t first = 0, end = 0;
  for (std::size_t i = 0; i < outline.edges.size(); ++i) {
    const FootprintEdge& e = outline.edges[i];
    if (!overlap(e, s) || !near(s.a, s.b, e.a, e.b)) continue;
    if (end == 0) first = i;
    end = i + 1;
  }
  return {outline.edges.data() + first, end - first};
}

// A part that is not near an edge is wholly inside or wholly outside, so its midpoint decides.
bool presses(const Footprint& outline, std::span<const FootprintEdge> edges, const Surface& s, const Part& part) {
  const glm::dvec2 a = s.a + part.from * (s.b - s.a), b = s.a + part.to * (s.b - s.a);
  for (const FootprintEdge& e : edges)
    if (overlap(e, s) && near(a, b, e.a, e.b)) return true;
  return inside(outline.edges, 0.5 * (a + b), s.z_min, s.z_max);
}

/// The borders that a point is strictly on the left or on the right of, as bits. Border k is the right one of sector k.
struct Sides {
  explicit Sides(glm::dvec2 p) {
    for (std::uint32_t k = 0; k < kContactSectors; ++k) {
      const double side = base::cross(borders()[k], p);
      left |= (side > 0.0 ? 1u : 0u) << k, right |= (side < 0.0 ? 1u : 0u) << k;
    }
  }
  std::uint32_t left = 0, right = 0;
};

/// Returns the wanted sectors that the surface crosses.
std::uint32_t sectors_crossed(const Surface& s, std::uint32_t wanted) {
  static_assert(kContactSectors == 32, "a bit of std::uint32_t per border");
  // A surface wholly on the outer side of one of a sector's borders does not cross it.
  const Sides a(s.a), b(s.b);
  const std::uint32_t outside = (a.right & b.right) | std::rotr(a.left & b.left, 1);
  std::uint32_t crossed = 0;
  for (std::uint32_t left = wanted & ~outside; left != 0; left &= left - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
    const Part part = within_sector(s, k);
    if (part.from < part.to) crossed |= 1u << k;
  }
  return crossed;
}

std::uint32_t sectors_of(const Footprint& outline, const Surface& s, std::uint32_t wanted) {
  if (world::distance({0.0, 0.0}, s.a, s.b) > outline.radius + kContactDistance) return 0;
  if (wanted != kAllSectors && sectors_crossed(s, wanted) == 0) return 0;
  const std::span<const FootprintEdge> edges = edges_near(outline, s);
  if (edges.empty() && !inside(outline.edges, s.a, s.z_min, s.z_max)) return 0;
  std::uint32_t sectors = 0;
  for (std::uint32_t crossed = sectors_crossed(s, wanted); crossed != 0; crossed &= crossed - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(crossed));
    if (presses(outline, edges, s, within_sector(s, k))) sectors |= 1u << k;
  }
  return sectors;
}

}  // namespace

std::uint32_t contact_sectors(const Footprint& outline, const base::Pose& X_WM, const world::Segment& wall) {
  const glm::dvec2 p{X_WM.x, X_WM.y};
  return sectors_of(outline,
                    {base::rotate(-X_WM.yaw, wall.a - p), base::rotate(-X_WM.yaw, wall.b - p), wall.z_min - X_WM.z,
                     wall.z_max - X_WM.z},
                    kAllSectors);
}

std::uint32_t contact_sectors(const Footprint& outline, const base::Pose& X_WM, const Footprint& other,
                              const base::Pose& X_WO, std::uint32_t wanted) {
  const glm::dvec2 apart = glm::dvec2{X_WO.x, X_WO.y} - glm::dvec2{X_WM.x, X_WM.y};
  const glm::dvec2 p_MO = base::rotate(-X_WM.yaw, apart);
  const double turn = X_WO.yaw - X_WM.yaw, lift = X_WO.z - X_WM.z;
  const double reach = outline.radius + kContactDistance;
  const auto [s, c] = base::sin_cos(turn);
  const auto to_mover = [&](glm::dvec2 q) { return p_MO + glm::dvec2{c * q.x - s * q.y, s * q.x + c * q.y}; };
  std::uint32_t sectors = 0;
  for (const FootprintEdge& e : other.edges)
    sectors |= sectors_of(outline, {to_mover(e.a), to_mover(e.b), e.z_min + lift, e.z_max + lift}, wanted);
  if (wanted != kAllSectors || sectors != 0 || length(apart) > reach + other.radius || outline.edges.empty())
    return sectors;
  const FootprintEdge& first = outline.edges.front();
  const glm::dvec2 q = base::rotate(X_WM.yaw - X_WO.yaw, first.a - p_MO);
  return inside(other.edges, q, first.z_min - lift, first.z_max - lift) ? kAllSectors : 0u;
}

std::uint32_t sectors_to_test(const Footprint& outline, const base::Pose& X_WM, const Footprint& other,
                              const base::Pose& X_WO, std::uint32_t known) {
  const glm::dvec2 apart{X_WO.x - X_WM.x, X_WO.y - X_WM.y};
  const double d = length(apart), reach = outline.radius + 2.0 * kContactDistance, r = other.radius;
  if (d > reach + r) return 0;
  if (outline.inner == 0.0 || d + outline.inner <= r) return kAllSectors;
  if (d <= r) return ~known;
  // The part of the other's disc within reach ends at its tangents or where the two circles meet.
  const bool holds_tangents = d * d <= reach * reach + r * r;
  const double half = holds_tangents ? base::asin(r / d)
                                     : base::acos(std::min((d * d + reach * reach - r * r) / (2.0 * d * reach), 1.0));
  const double bearing = base::atan2(apart.y, apart.x) - X_WM.yaw, per_radian = kContactSectors / (2.0 * M_PI);
  const auto first = static_cast<std::int64_t>(std::floor((bearing - half - 1e-6) * per_radian));
  const auto last = static_cast<std::int64_t>(std::floor((bearing + half + 1e-6) * per_radian));
  std::uint32_t sectors = 0;
  for (std::int64_t k = first; k <= last; ++k) sectors |= 1u << (k & (kContactSectors - 1));
  return sectors & ~known;
}

}  // namespace sf::robots
