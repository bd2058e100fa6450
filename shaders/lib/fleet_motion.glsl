// robots::Fleet in kernels: kinematics and neighbours. Needs the tables of a fleet.

#include "shaders/lib/outlines.glsl"
#include "shaders/lib/fleet_walls.glsl"
#include "shaders/lib/fleet_grid.glsl"

dvec3 velocity_of(FleetMotion m) { return dvec3(m.forward, m.left, m.turn); }
bool moves(dvec3 v) { return v.x != 0.0LF || v.y != 0.0LF || v.z != 0.0LF; }

FleetPose advance(FleetPose X_WM, dvec3 v, double dt) {
  precise double half_turn = 0.5LF * v.z * dt;
  precise double chord = sinc64(half_turn) * dt;
  precise double heading = X_WM.yaw + half_turn;
  precise dvec2 along = dvec2(chord * v.x, chord * v.y);
  const dvec2 middle = sin_cos64(heading);
  const dvec2 d = turned(along, middle.x, middle.y);
  precise double x = X_WM.x + d.x;
  precise double y = X_WM.y + d.y;
  precise double yaw = X_WM.yaw + v.z * dt;
  const double wrapped = wrap_angle64(yaw);
  const dvec2 end = sin_cos64(wrapped);
  return FleetPose(x, y, X_WM.z, wrapped, end.x, end.y);
}

FleetFootprint footprint_at(int row) { return load_FleetFootprint(footprints, int(load_FleetBody(bodies, row).footprint)); }

/// [m] Largest travel of any point of the mover in the rest of the tick.
double sweep_of(FleetMotion m, double radius) {
  const double speed = length64(dvec2(m.forward, m.left));
  precise double sweep = (speed + abs(m.turn) * radius) * m.remaining;
  return sweep;
}

/// [m] The same plus the largest push-off.
double reach_of(FleetMotion m, double radius, double travel) {
  precise double reach = travel + abs(m.turn) * radius * m.remaining;
  return reach;
}

bool comes_near(FleetFootprint outline, FleetPose from, double sweep, FleetFootprint other, FleetPose X_WO) {
  const dvec2 d = minus(origin_of(X_WO), origin_of(from));
  precise double apart = outline.radius + sweep + other.radius;
  precise double square = apart * apart;
  return outline.count > 0u && other.count > 0u && dot64(d, d) <= square;
}

bool has_moved(int row) {
  const FleetPose from = load_FleetPose(poses, row), to = load_FleetPose(proposed_poses, row);
  return from.x != to.x || from.y != to.y || from.yaw != to.yaw;
}

/// The movers near a mover's path, up to SF_NEAR of them. A longer list is replaced by all of the grid that `is_near`.
#define SF_NEAR 32
struct Path {
  FleetFootprint outline;
  FleetPose from;
  double reach;
};
int near_rows[SF_NEAR];
int near_count;

bool is_near(Path path, int other) {
  if (other == own_row || imageLoad(absent, other).x != 0u) return false;
  precise double sweep = path.reach + load_FleetShared(shared_states, other).travel;
  return comes_near(path.outline, path.from, sweep, footprint_at(other), load_FleetPose(poses, other));
}

MoverWalk movers_around_path(Path path) {
  const FleetTick now = load_FleetTick(tick, 0);
  precise double reach = path.outline.radius + path.reach + now.widest + 2.0LF * now.farthest;
  return movers_around(origin_of(path.from), reach);
}

Path find_near(FleetMotion motion) {
  const FleetFootprint outline = footprint_at(own_row);
  const double reach = reach_of(motion, outline.radius, load_FleetShared(shared_states, own_row).travel);
  const Path path = Path(outline, load_FleetPose(poses, own_row), reach);
  MoverWalk walk = movers_around_path(path);
  near_count = 0;
  int other = next_mover(walk);
  while (may_turn(2u) && other >= 0) {
    const bool near = is_near(path, other);
    if (near && near_count < SF_NEAR) near_rows[near_count] = other;
    near_count += near ? 1 : 0;
    other = next_mover(walk);
  }
  return path;
}

/// Position among the near movers.
struct NearWalk {
  int at;
  MoverWalk walk;
};

NearWalk near_movers(Path path) { return NearWalk(0, movers_around_path(path)); }

/// Returns the next row; -1 at the end.
int next_near(Path path, inout NearWalk near) {
  if (near_count <= SF_NEAR) {
    ++near.at;
    return near.at <= near_count ? near_rows[near.at - 1] : -1;
  }
  int other = next_mover(near.walk);
  while (may_turn(2u) && other >= 0 && !is_near(path, other)) other = next_mover(near.walk);
  return other;
}
