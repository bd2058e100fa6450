#version 450
#extension GL_GOOGLE_include_directive : require
// Fleet::start: turns the commands into velocities for this tick.

#include "shaders/lib/fleet_tables.glsl"
#include "shaders/lib/fleet_motion.glsl"

/// std::rint.
double rint64(double x) { return abs(x) < 2251799813685248.0LF ? with_sign(nearest64(x), x) : x; }

/// robots/command_law.cpp
double whole_speed(double metres_per_second) {
  precise double millimetres = 1e3LF * metres_per_second;
  return limited(rint64(millimetres), -500.0LF, 500.0LF);
}

int radius_mm(double speed_mm, double turn) {
  precise double ratio = speed_mm / turn;
  const int radius = clamp(int(limited(rint64(ratio), -1e9LF, 1e9LF)) / 2, -2000, 2000);
  return radius != 0 ? radius : (speed_mm < 0.0LF) == (turn < 0.0LF) ? 1 : -1;
}

dvec3 apply_create_driver(double track, double forward, double turn) {
  const double speed_mm = whole_speed(forward);
  precise double speed = 1e-3LF * speed_mm;
  if (turn == 0.0LF) return dvec3(speed, 0.0LF, 0.0LF);
  precise double half_track = 0.5LF * track;
  precise double rim = half_track * turn;
  precise double spin = 1e-3LF * whole_speed(rim) / half_track;
  if (forward == 0.0LF) return dvec3(0.0LF, 0.0LF, spin);
  const int radius = radius_mm(speed_mm, turn);
  precise double tight = speed / (double(radius) * half_track);
  precise double wide = speed / (1e-3LF * double(radius));
  return abs(radius) == 1 ? dvec3(0.0LF, 0.0LF, tight) : dvec3(speed, 0.0LF, wide);
}

/// robots/motion_limits.cpp
dvec3 limit_kinematics(FleetDrive drive, uint kind, dvec3 command) {
  dvec3 v = command;
  v.z = limited(v.z, -drive.max_turn, drive.max_turn);
  if (kind == SF_DRIVE_OMNI) {
    const double speed = length64(v.xy);
    precise double ratio = drive.max_forward / speed;
    precise dvec2 slower = dvec2(v.x * ratio, v.y * ratio);
    return speed > drive.max_forward ? dvec3(slower, v.z) : v;
  }
  v.y = 0.0LF;
  v.x = limited(v.x, -drive.max_forward, drive.max_forward);
  precise double sharpest = abs(v.x) * drive.steer_tangent / drive.wheelbase;
  if (kind == SF_DRIVE_CAR) v.z = limited(v.z, -sharpest, sharpest);
  return v;
}

dvec3 limit_acceleration(FleetDrive drive, uint kind, dvec3 now, dvec3 wanted, double dt) {
  if (drive.max_acceleration == SF_INFINITY && drive.max_turn_acceleration == SF_INFINITY) return wanted;
  dvec3 v = wanted;
  const dvec2 change = minus(wanted.xy, now.xy);
  precise double largest = drive.max_acceleration * dt;
  const double needed = length64(change);
  precise double part = largest / needed;
  precise dvec2 slower = dvec2(now.x + part * change.x, now.y + part * change.y);
  if (needed > largest) v.xy = slower;
  precise double largest_turn = drive.max_turn_acceleration * dt;
  precise double turn_change = wanted.z - now.z;
  precise double slower_turn = now.z + with_sign(largest_turn, turn_change);
  if (abs(turn_change) > largest_turn) v.z = slower_turn;
  return limit_kinematics(drive, kind, v);
}

double finite64(double x) { return is_finite(x) ? x : 0.0LF; }

void main() {
  if (!begin_row()) return;
  const FleetTick now_tick = load_FleetTick(tick, 0);
  for (uint bucket = uint(own_row); bucket < now_tick.buckets; bucket += now_tick.movers)
    imageStore(buckets, int(bucket), uvec4(0u));
  FleetOwn own = load_FleetOwn(own_states, own_row);
  if (own.phase == SF_FLEET_FAILED) return;
  own.phase = 0u;
  own.round = SF_ROUND_OUT;
  store_FleetOwn(own_states, own_row, own);
  const FleetPose X_WM = load_FleetPose(poses, own_row);
  store_FleetPose(proposed_poses, own_row, X_WM);
  if (imageLoad(absent, own_row).x != 0u) {
    const FleetMotion rest = FleetMotion(0.0LF, 0.0LF, 0.0LF, 0.0LF, 0u, 0u, 0u, 0u);
    store_FleetMotion(motions, own_row, rest);
    store_FleetMotion(proposed_motions, own_row, rest);
    store_FleetShared(shared_states, own_row, FleetShared(0.0LF, 0u, 0u));
    return;
  }

  const double seconds = now_tick.seconds;
  const FleetDrive drive = load_FleetDrive(drives, own_row);
  const FleetBody body = load_FleetBody(bodies, own_row);
  const FleetCommand asked = load_FleetCommand(commands, own_row);
  const dvec3 command = dvec3(finite64(asked.forward), finite64(asked.left), finite64(asked.turn));
  const dvec3 driven = body.create != 0u ? apply_create_driver(drive.track, command.x, command.z) : command;
  const dvec3 wanted = limit_kinematics(drive, body.drive, driven);
  const dvec3 now = velocity_of(load_FleetMotion(motions, own_row));
  precise double per_grip = 1.0LF / drive.grip;
  precise dvec3 rolling = dvec3(per_grip * now.x, per_grip * now.y, per_grip * now.z);
  precise double accelerating = drive.acceleration * seconds;
  const dvec3 rolled = limit_acceleration(drive, body.drive, rolling, wanted, accelerating);
  precise dvec3 v = dvec3(drive.grip * rolled.x, drive.grip * rolled.y, drive.grip * rolled.z);
  const FleetMotion motion = FleetMotion(v.x, v.y, v.z, moves(v) ? seconds : 0.0LF, 0u, 0u, 0u, 0u);
  store_FleetMotion(motions, own_row, motion);
  store_FleetMotion(proposed_motions, own_row, motion);

  // A turning mover may push itself off once per substep.
  const FleetFootprint outline = footprint_at(own_row);
  precise double rim = abs(v.z) * outline.radius * seconds;
  precise double travel = length64(v.xy) * seconds;
  precise double steps = (travel + rim) / outline.step;
  precise double pushed = travel + SF_MAX_YIELD * (ceil64(steps) + double(SF_FLEET_ROUNDS));
  const double farthest = v.z != 0.0LF && outline.count > 0u ? pushed : travel;
  store_FleetShared(shared_states, own_row, FleetShared(farthest, moves(v) ? 1u : 0u, 0u));
}
