// robots/contact_sectors.h and Fleet::body_contact in kernels.

#include "shaders/lib/fleet_motion.glsl"

#define SF_CONTACT_DISTANCE 1e-3LF  // robots::kContactDistance
#define SF_CONTACT_SECTORS 32
#define SF_ALL_SECTORS 0xFFFFFFFFu
#define SF_WHOLE 1099511627776.0LF  // fixed point: 2^40

/// A piece of surface in the mover's frame.
struct Surface {
  dvec2 a, b;
  double z_min, z_max;
};

dvec2 border(int k) {
  const FleetBorder b = load_FleetBorder(borders, k);
  return dvec2(b.x, b.y);
}

/// Restricts the part (from, to) to where side(t) = at_a + t (at_b - at_a) >= 0.
dvec2 keep_positive(dvec2 part, double at_a, double at_b) {
  if (at_a >= 0.0LF && at_b >= 0.0LF) return part;
  if (at_a < 0.0LF && at_b < 0.0LF) return dvec2(1.0LF, 0.0LF);
  precise double t = at_a / (at_a - at_b);
  return dvec2(at_a < 0.0LF ? most(part.x, t) : part.x, at_b < 0.0LF ? least(part.y, t) : part.y);
}

dvec2 within_sector(Surface s, int k) {
  const dvec2 right = border(k), left = border(k + 1);
  const dvec2 part = keep_positive(dvec2(0.0LF, 1.0LF), cross64(right, s.a), cross64(right, s.b));
  return keep_positive(part, cross64(s.a, left), cross64(s.b, left));
}

bool are_ranges_apart(double p, double q, double r, double s) {
  precise double r_high = most(r, s) + SF_CONTACT_DISTANCE;
  precise double p_high = most(p, q) + SF_CONTACT_DISTANCE;
  return least(p, q) > r_high || least(r, s) > p_high;
}

/// Returns whether the segments ab and cd are in contact.
bool are_near(dvec2 a, dvec2 b, dvec2 c, dvec2 d) {
  if (are_ranges_apart(a.x, b.x, c.x, d.x) || are_ranges_apart(a.y, b.y, c.y, d.y)) return false;
  return segments_meet(a, b, c, d) || distance64(a, c, d) <= SF_CONTACT_DISTANCE ||
         distance64(b, c, d) <= SF_CONTACT_DISTANCE || distance64(c, a, b) <= SF_CONTACT_DISTANCE ||
         distance64(d, a, b) <= SF_CONTACT_DISTANCE;
}

/// Returns the sectors that the surface crosses. A surface wholly on the outer side of one of a sector's borders does not
/// cross it.
uint sectors_crossed(Surface s) {
  uint lefts = 0u, rights = 0u;
  for (int k = 0; may_turn(1u) && k < SF_CONTACT_SECTORS; ++k) {
    const double at_a = cross64(border(k), s.a), at_b = cross64(border(k), s.b);
    lefts |= (at_a > 0.0LF && at_b > 0.0LF ? 1u : 0u) << k;
    rights |= (at_a < 0.0LF && at_b < 0.0LF ? 1u : 0u) << k;
  }
  const uint candidates = ~(rights | lefts >> 1 | lefts << 31);
  uint crossed = 0u;
  for (uint rest = candidates; may_turn(1u) && rest != 0u; rest &= rest - 1u) {
    const int k = findLSB(rest);
    const dvec2 part = within_sector(s, k);
    crossed |= (part.x < part.y ? 1u : 0u) << k;
  }
  return crossed;
}

/// Returns whether the part of the surface is near one of the edges or inside the outline.
bool presses(Placed outline, int first, int end, Surface s, dvec2 part) {
  precise dvec2 a = s.a + part.x * (s.b - s.a);
  precise dvec2 b = s.a + part.y * (s.b - s.a);
  bool pressed = false;
  for (int i = first; may_turn(1u) && i < end && !pressed; ++i) {
    const Edge e = edge_of(outline, i);
    pressed = overlap(e, s.z_min, s.z_max) && are_near(a, b, e.a, e.b);
  }
  precise dvec2 middle = 0.5LF * (a + b);
  return pressed || is_inside(outline, middle, s.z_min, s.z_max);
}

uint sectors_of(Placed outline, Surface s) {
  precise double reach = outline.radius + SF_CONTACT_DISTANCE;
  if (distance64(dvec2(0.0LF), s.a, s.b) > reach) return 0u;
  int first = 0, end = 0;
  for (int i = 0; may_turn(1u) && i < outline.count; ++i) {
    const Edge e = edge_of(outline, i);
    const bool is_contact = overlap(e, s.z_min, s.z_max) && are_near(s.a, s.b, e.a, e.b);
    first = is_contact && end == 0 ? i : first;
    end = is_contact ? i + 1 : end;
  }
  if (end == 0 && !is_inside(outline, s.a, s.z_min, s.z_max)) return 0u;
  uint sectors = 0u;
  for (uint crossed = sectors_crossed(s); may_turn(3u) && crossed != 0u; crossed &= crossed - 1u) {
    const int k = findLSB(crossed);
    sectors |= (presses(outline, first, end, s, within_sector(s, k)) ? 1u : 0u) << k;
  }
  return sectors;
}

uint sectors_of_wall(FleetFootprint outline, FleetPose X_WM, FleetWall wall) {
  const dvec2 p = origin_of(X_WM), to_mover = sin_cos64(-X_WM.yaw);
  precise double z_min = wall.z_min - X_WM.z;
  precise double z_max = wall.z_max - X_WM.z;
  return sectors_of(unplaced(outline), Surface(turned(minus(dvec2(wall.ax, wall.ay), p), to_mover.x, to_mover.y),
                                               turned(minus(dvec2(wall.bx, wall.by), p), to_mover.x, to_mover.y), z_min, z_max));
}

uint sectors_of_mover(FleetFootprint outline, FleetPose X_WM, FleetFootprint other, FleetPose X_WO) {
  const dvec2 apart = minus(origin_of(X_WO), origin_of(X_WM));
  const dvec2 to_mover = sin_cos64(-X_WM.yaw);
  const dvec2 p_MO = turned(apart, to_mover.x, to_mover.y);
  precise double turn = X_WO.yaw - X_WM.yaw;
  precise double lift = X_WO.z - X_WM.z;
  precise double back = X_WM.yaw - X_WO.yaw;
  const dvec2 relative = sin_cos64(turn);
  const Placed its = Placed(p_MO, other.radius, relative.x, relative.y, lift, int(other.first), int(other.count));
  uint sectors = 0u;
  for (int i = 0; may_turn(8u) && i < its.count; ++i) {
    const Edge e = edge_of(its, i);
    sectors |= sectors_of(unplaced(outline), Surface(plus(p_MO, e.a), plus(p_MO, e.b), e.z_min, e.z_max));
  }
  precise double reach = outline.radius + SF_CONTACT_DISTANCE + other.radius;
  if (sectors != 0u || length64(apart) > reach || outline.count == 0u) return sectors;
  const Edge front = edge_of(unplaced(outline), 0);
  const dvec2 to_other = sin_cos64(back);
  precise double z_min = front.z_min - lift;
  precise double z_max = front.z_max - lift;
  const dvec2 q = turned(minus(front.a, p_MO), to_other.x, to_other.y);
  return is_inside(unplaced(other), q, z_min, z_max) ? SF_ALL_SECTORS : 0u;
}

/// Returns the fixed-point number nearest to v in [-1, 1], as std::llround does.
double fixed_point(double v) {
  precise double scaled = SF_WHOLE * v;
  const double size = abs(scaled), whole = nearest64(size);
  precise double rest = size - whole;
  precise double up = whole + 1.0LF;
  return with_sign(rest == 0.5LF ? up : whole, scaled);
}

struct BodyContact {
  uint sectors;
  dvec2 away;  // sum of the unit vectors from the touching surfaces to the mover's origin
};

/// Sums fixed-point numbers exactly: multiples of 2^30, and the rest.
void add_exactly(inout dvec2 sums, double whole) {
  precise double part = whole * 9.31322574615478515625e-10LF;  // 2^-30
  const double many = nearest64(part);
  precise double rest = whole - many * 1073741824.0LF;
  precise dvec2 total = dvec2(sums.x + many, sums.y + rest);
  sums = total;
}

double exact_sum(dvec2 sums) {
  precise double sum = (1.0LF / SF_WHOLE) * (sums.x * 1073741824.0LF + sums.y);
  return sum;
}

/// @param strikes marks the other movers that touch it in `struck`
BodyContact body_contact(FleetPose X_WM, bool strikes) {
  const FleetFootprint outline = footprint_at(own_row);
  const dvec2 p = origin_of(X_WM);
  precise double reach = outline.radius + SF_CONTACT_DISTANCE;
  precise double wall_reach = reach + 1e-6LF;
  uint sectors = 0u;
  dvec2 sum_x = dvec2(0.0LF), sum_y = dvec2(0.0LF);
  // Walls first, then movers.
  const dvec4 box = box_around(p, reach);
  WallWalk walk = WallWalk(0, 0, 0);
  const FleetTick now = load_FleetTick(tick, 0);
  precise double mover_reach = reach + now.widest + now.farthest;
  MoverWalk movers = movers_around(p, mover_reach);
  bool walks = true;
  int other = 0;
  while (may_turn(19u) && other >= 0) {
    uint touched = 0u;
    dvec2 away = dvec2(0.0LF);
    walks = walks && find_wall(walk, box);
    if (walks) {
      const FleetWall wall = load_FleetWall(walls, walk.at);
      away = from_segment(p, dvec2(wall.ax, wall.ay), dvec2(wall.bx, wall.by));
      if (length64(away) <= wall_reach) touched = sectors_of_wall(outline, X_WM, wall);
      ++walk.at;
    } else if ((other = next_mover(movers)) >= 0) {
      const FleetFootprint its = footprint_at(other);
      const FleetPose X_WO = load_FleetPose(poses, other);
      away = minus(p, origin_of(X_WO));
      precise double apart = reach + its.radius;
      precise double square = apart * apart;
      if (other != own_row && imageLoad(absent, other).x == 0u && dot64(away, away) <= square)
        touched = sectors_of_mover(outline, X_WM, its, X_WO);
      if (touched != 0u && strikes) imageStore(struck, other, uvec4(1u));
    }
    const dvec2 direction = unit64(away);
    if (touched != 0u) {
      add_exactly(sum_x, fixed_point(direction.x));
      add_exactly(sum_y, fixed_point(direction.y));
    }
    sectors |= touched;
  }
  return BodyContact(sectors, dvec2(exact_sum(sum_x), exact_sum(sum_y)));
}
