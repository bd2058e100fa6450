// A lane of the kernels that cast lasers: its tables, beams and results.

layout(constant_id = 0) const bool kMovers = true;   // the world has movers
layout(constant_id = 1) const bool kSinglePrecision = false;  // ranges in 32 bits if they are accurate enough
layout(constant_id = 2) const bool kTexels = false;  // results exceed the limit of storage buffers, which are faster
layout(constant_id = 3) const bool kRounds32 = true;  // device property: lib/exact32.glsl
layout(binding = 0, rgba32ui) uniform readonly uimageBuffer rows;            // RayRow of each sensor
layout(binding = 1, r32ui) uniform readonly uimageBuffer lanes;              // Lane of each lane
layout(binding = 2, r32f) uniform readonly imageBuffer bearings;             // middle bearing of each lane [sectors]
layout(binding = 3, rgba32ui) uniform readonly uimageBuffer directions;      // BeamDirection of each beam
layout(binding = 4, rgba32ui) uniform readonly uimageBuffer lists;           // ListHead, ListEntry, ListChunk
layout(binding = 5, r32ui) uniform readonly uimageBuffer segment_ids;              // exact segment of each entry
layout(binding = 6, rgba32ui) uniform readonly uimageBuffer mover_rows;          // MoverRow of each mover and height
layout(binding = 7, rgba32ui) uniform readonly uimageBuffer segments;        // ExactSegment of each segment
layout(binding = 8, r32ui) uniform readonly uimageBuffer models;             // `Segment::model` of each segment
layout(binding = 9, rgba32ui) uniform writeonly uimageBuffer range_texels;   // LaneRanges of each lane
layout(binding = 10, rgba32ui) uniform writeonly uimageBuffer hit_texels;    // LaneHits of each lane
layout(binding = 11) writeonly buffer Ranges { dvec4 lane[]; } ranges;        // same tables as storage buffers
layout(binding = 12) writeonly buffer Hits { uvec4 lane[]; } hits;
layout(binding = 13) buffer Uncertain {                                       // lanes with beams that 32 bits could not certify
  uint across, down, one;  // groups of the dispatch over these lanes
  uint count;
  uvec2 lanes[];  // lane; flags: SF_UNCERTAIN, SF_GRAZING
} uncertain;

#include "shaders/lib/intersect.glsl"

// A lane of the dispatch: its sensor, beams and lists.
struct ScanLane {
  RayRow row;
  int results;  // lane of the results
  Beam64 beams[SF_BEAMS_PER_LANE];
  ListHead walls, movers;
};

// Returns beam `i` of a lane in the world frame. The lane's beams start at `first` in the tables.
Beam64 beam_of(RayRow row, int first, int i) {
  const BeamDirection bearing = load_BeamDirection(directions, SF_BEAMS_PER_LANE * first + i);
  precise double x = row.heading_cos64 * bearing.cos - row.heading_sin64 * bearing.sin;
  precise double y = row.heading_sin64 * bearing.cos + row.heading_cos64 * bearing.sin;
  return Beam64(dvec2(row.origin_x, row.origin_y), dvec2(x, y));
}

ScanLane scan_lane(int lane) {
  const Lane due = load_Lane(lanes, lane);
  ScanLane scan;
  scan.row = load_RayRow(rows, int(due.row));
  scan.results = int(scan.row.results + due.lane);
  const int first = int(scan.row.beams + due.lane);
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) scan.beams[i] = beam_of(scan.row, first, i);
  const int sector = int(floor(scan.row.heading_sectors + imageLoad(bearings, first).x)) & (SF_SECTORS - 1);
  scan.walls = load_ListHead(lists, int(scan.row.walls) + sector);
  scan.movers = decode_ListHead(kMovers ? imageLoad(lists, int(scan.row.movers) + sector) : uvec4(0u));
  return scan;
}

// Returns the segment that the beam hits before the end of its range, or SF_NO_HIT.
uint met_before(ClosestHit hit, RayRow row) { return hit.range < row.range_max ? hit.id : SF_NO_HIT; }

// Returns the reported range, clamped to the sensor's limits.
double reported_range(ClosestHit hit, Beam64 beam, RayRow row) {
  double range = hit.range;
  if (kSinglePrecision) {
    const float t = range_single(met_before(hit, row), beam, float(row.range_max));
    range = t >= 0.0 && double(t) < row.range_max ? double(t) : range;
  }
  return max(range, row.range_min);
}

uint reported_model(ClosestHit hit, RayRow row) {
  const uint segment = met_before(hit, row);
  return segment == SF_NO_HIT ? SF_NO_HIT : imageLoad(models, int(segment)).x;
}

// Stores the lane's ranges and hits.
void store(ScanLane scan, ClosestHit closest[SF_BEAMS_PER_LANE]) {
  LaneRanges lane_ranges;
  LaneHits lane_hits;
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
    lane_ranges.range[i] = reported_range(closest[i], scan.beams[i], scan.row);
    lane_hits.model[i] = reported_model(closest[i], scan.row);
  }
  if (kTexels) {
    store_LaneRanges(range_texels, scan.results, lane_ranges);
    store_LaneHits(hit_texels, scan.results, lane_hits);
  } else {
    ranges.lane[scan.results] = lane_ranges.range;
    hits.lane[scan.results] = lane_hits.model;
  }
}

int invocation() {
  return int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
}
