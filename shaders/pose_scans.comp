#version 450
#extension GL_GOOGLE_include_directive : require
// Casts beams from poses on the device, each against the tree of walls and the movers of its copy, in 64 bits
// (raycast/pose_scanner.h). The operations are those of raycast/intersect.h.

#include "shaders/robots/device/records.glsl"
#include "shaders/raycast/records.glsl"
#include "shaders/raycast/pose_scanner_records.glsl"

layout(local_size_x = 64) in;
#include "shaders/lib/loop_turns.glsl"
#include "shaders/lib/planar64.glsl"
#include "shaders/lib/random64.glsl"

layout(binding = 0, rgba32ui) uniform readonly uimageBuffer counts;      // PoseScanCounts
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer poses;       // FleetPose per mover
layout(binding = 2, r32ui) uniform readonly uimageBuffer absent;         // 1: absent, per mover
layout(binding = 3, rgba32ui) uniform readonly uimageBuffer scans;       // PoseScanRow
layout(binding = 4, r32ui) uniform readonly uimageBuffer scan_rows;      // of each beam
layout(binding = 5, rgba32ui) uniform readonly uimageBuffer directions;  // BeamDirection of each beam
layout(binding = 6, rgba32ui) uniform readonly uimageBuffer walls;       // FleetWall, leaf by leaf
layout(binding = 7, rgba32ui) uniform readonly uimageBuffer nodes;       // FleetNode, depth first
layout(binding = 8, rgba32ui) uniform readonly uimageBuffer outlines;    // PoseScanOutline per mover
layout(binding = 9, rgba32ui) uniform readonly uimageBuffer edges;       // FleetEdge
layout(binding = 11, rgba32ui) uniform readonly uimageBuffer draws;      // PoseScanDraw of each scan
layout(binding = 12, r32ui) uniform readonly uimageBuffer samples;       // number of each beam in its scan
layout(binding = 10) writeonly buffer Ranges { double beam[]; } ranges;  // [m] of each beam; NaN: too many turns

#define SF_MARGIN 1e-6LF  // [m] for rounding

/// The nearest surface so far along a beam.
struct Cast {
  dvec2 origin, direction;
  double range;
};

void meet(dvec2 a, dvec2 b, inout Cast beam) {
  const dvec2 wa = minus(a, beam.origin), wb = minus(b, beam.origin), e = minus(b, a);
  const double side_a = cross64(beam.direction, wa), side_b = cross64(beam.direction, wb);
  const double denominator = cross64(e, beam.direction);
  precise double t = cross64(e, wa) / denominator;
  const bool crosses = (side_a >= 0.0LF && side_b <= 0.0LF) || (side_a <= 0.0LF && side_b >= 0.0LF);
  const bool ahead = t > SF_CONTACT_DISTANCE || (denominator > 0.0LF && t >= -SF_CONTACT_DISTANCE);
  const double range = t > 0.0LF ? t : 0.0LF;
  if (crosses && denominator != 0.0LF && ahead && range < beam.range) beam.range = range;
}

/// Returns whether the rest of a beam may meet a box or a disc. Both are conservative.
bool may_meet(FleetNode box, Cast beam) {
  precise dvec2 end = beam.origin + beam.range * beam.direction;
  precise dvec2 middle = 0.5LF * dvec2(box.x_min + box.x_max, box.y_min + box.y_max) - beam.origin;
  precise dvec2 half_size = 0.5LF * dvec2(box.x_max - box.x_min, box.y_max - box.y_min);
  precise double width = abs(beam.direction.y) * half_size.x + abs(beam.direction.x) * half_size.y + SF_MARGIN;
  precise dvec2 low = dvec2(least(beam.origin.x, end.x), least(beam.origin.y, end.y)) - SF_MARGIN;
  precise dvec2 high = dvec2(most(beam.origin.x, end.x), most(beam.origin.y, end.y)) + SF_MARGIN;
  return low.x <= box.x_max && box.x_min <= high.x && low.y <= box.y_max && box.y_min <= high.y &&
         abs(cross64(beam.direction, middle)) <= width;
}

bool may_meet(dvec2 centre, double radius, Cast beam) {
  const dvec2 d = minus(centre, beam.origin);
  precise double reach = radius * (1.0LF + 1e-9LF) + SF_MARGIN;
  precise double farthest = beam.range + reach;
  const double along = dot64(d, beam.direction);
  return abs(cross64(beam.direction, d)) <= reach && along >= -reach && along <= farthest;
}

/// Cuts the beam at the walls at height z.
void meet_walls(double z, inout Cast beam) {
  const int count = int(load_PoseScanCounts(counts, 0).nodes);
  int node = 0, at = 0, end = 0;
  while (may_turn(1u) && (at < end || node < count)) {
    if (at < end) {
      const FleetWall wall = load_FleetWall(walls, at);
      if (wall.z_min <= z && z < wall.z_max) meet(dvec2(wall.ax, wall.ay), dvec2(wall.bx, wall.by), beam);
      ++at;
    } else {
      const FleetNode box = load_FleetNode(nodes, node);
      const bool near = may_meet(box, beam);
      at = int(box.first);
      end = int(box.first + (near ? box.count : 0u));
      node = near ? node + 1 : int(box.end);
    }
  }
}

/// Cuts the beam at the other movers of the copy.
void meet_movers(int own, double z, inout Cast beam) {
  const int count = int(load_PoseScanCounts(counts, 0).copy_movers), first = own / count * count;
  for (int other = first; may_turn(2u) && other < first + count; ++other) {
    const FleetPose X_WO = load_FleetPose(poses, other);
    const PoseScanOutline outline = load_PoseScanOutline(outlines, other);
    const dvec2 p = dvec2(X_WO.x, X_WO.y);
    precise double above = z - X_WO.z;
    const bool counts_it = other != own && imageLoad(absent, other).x == 0u && may_meet(p, outline.radius, beam);
    const uint end = outline.first + (counts_it ? outline.count : 0u);
    for (uint i = outline.first; may_turn(1u) && i < end; ++i) {
      const FleetEdge e = load_FleetEdge(edges, int(i));
      const dvec2 a = plus(p, turned(dvec2(e.ax, e.ay), X_WO.sine, X_WO.cosine));
      const dvec2 b = plus(p, turned(dvec2(e.bx, e.by), X_WO.sine, X_WO.cosine));
      if (e.z_min <= above && above < e.z_max) meet(a, b, beam);
    }
  }
}

/// Adds range noise, as sensors/laser_noise.cpp.
double with_noise(double range, PoseScanRow scan, PoseScanDraw draw, uint sample_number) {
  precise double growing = scan.range_proportional * range;
  const double sigma = length64(dvec2(scan.range_sigma, growing));
  const uint sequence = load_PoseScanCounts(counts, 0).ticks - draw.first;
  const uvec4 counter = uvec4(sample_number, draw.a, draw.b, sequence);
  const double normal = random_normal(counter, uvec2(draw.seed_low, draw.seed_high), draw.sigma);
  precise double disturbed = range + sigma * normal;
  return limited(disturbed, scan.range_min, scan.range_max);
}

void main() {
  const uint lane = begin_turns();
  const int at = int(lane / kSpread);
  if (lane % kSpread != 0u || uint(at) >= load_PoseScanCounts(counts, 0).beams) return;
  const int row = int(imageLoad(scan_rows, at).x);
  const PoseScanRow scan = load_PoseScanRow(scans, row);
  const FleetPose X_WM = load_FleetPose(poses, int(scan.mover));
  const BeamDirection bearing = load_BeamDirection(directions, at);
  precise double z = X_WM.z + scan.z;
  precise double yaw = X_WM.yaw + scan.yaw;
  const dvec2 heading = sin_cos64(yaw);
  Cast beam;
  beam.origin = plus(dvec2(X_WM.x, X_WM.y), turned(dvec2(scan.x, scan.y), X_WM.sine, X_WM.cosine));
  beam.direction = turned(dvec2(bearing.cos, bearing.sin), heading.x, heading.y);
  beam.range = scan.range_max;
  meet_walls(z, beam);
  meet_movers(int(scan.mover), z, beam);
  const double nan = packDouble2x32(uvec2(0u, 0x7ff80000u));
  double range = most(beam.range, scan.range_min);
  if (beam.range < scan.range_max && (scan.range_sigma > 0.0LF || scan.range_proportional > 0.0LF))
    range = with_noise(range, scan, load_PoseScanDraw(draws, row), imageLoad(samples, at).x);
  ranges.beam[at] = has_failed ? nan : range;
}
