#version 450
#extension GL_GOOGLE_include_directive : require
// Casts a tile of 512 beams per workgroup: walks the trees of all instances from near to far, draws the faces of leaves
// in 32 bits, and evaluates certified beams in 64 (scene/rasterizer.h). The host casts the uncertain ones. Every beam that
// is certified has the face, and so the bytes, of the host's scan.

#include "shaders/scene/device/records.glsl"

layout(local_size_x = SF_TILE_LANES) in;

// Entries that a walk may take; a tile that needs more is left to the host. Mesa before 25.0 ends the loops of software
// devices silently after 65 535 turns.
layout(constant_id = 0) const uint kMostEntries = 2500u;

layout(binding = 0, rgba32ui) uniform readonly uimageBuffer jobs;       // SceneJob per group
layout(binding = 1, rgba32ui) uniform readonly uimageBuffer scans;      // SceneScan
layout(binding = 2, rgba32ui) uniform readonly uimageBuffer instances;  // SceneInstance, scan by scan, near to far
layout(binding = 3, r32ui) uniform readonly uimageBuffer nodes;         // words of TreeNode
layout(binding = 4, r32ui) uniform readonly uimageBuffer leaves;        // words of TreeLeaf
layout(binding = 5, rgba32ui) uniform readonly uimageBuffer planes;     // ScenePlane per face
layout(binding = 6, rgba32ui) uniform readonly uimageBuffer tiles;      // BeamTile
layout(binding = 7) writeonly buffer Beams32 { uvec4 beam[]; } results;  // CastBeam

const uint kStack = 224u;

uint lane;
uint tile;  // its first word

// Boxes of directions in the mesh's frame, as rows of BeamTile: 9 of boxes, 12 of planes, 3 of axes.
shared float seen[24][32];
shared float offset[5][32];  // of planes and axes: plane . q >= offset for points inside, relative to the tree's centre
shared float tile_seen[24], tile_offset[5];
shared float farthest[32];  // [1/m] of each vector: smallest `low`
shared uint tile_farthest;  // bits of the smallest of all
shared float lane_low[SF_TILE_LANES];
shared uint lane_faces[SF_TILE_LANES];
// Entries of the walk: child of a node, its depth [m], vectors that may see it.
shared int stack_child[kStack];
shared float stack_depth[kStack];
shared uint stack_vectors[kStack];
shared uint top;
shared uint failed;
shared uint child_vectors[2][16];
shared float child_depth[16];

#include "shaders/lib/scene_beams.glsl"
#include "shaders/lib/scene_leaf.glsl"
#include "shaders/lib/scene_walk.glsl"

double dot64(dvec3 n, dvec3 v) {
  precise double sum = n.x * v.x + n.y * v.y + n.z * v.z;
  return sum;
}

/// Writes what a certified beam met: seen_plane() and evaluate() of the host.
uvec4 evaluate(uint face, uint instance, SceneScan scan, dvec3 d) {
  dvec3 normal = dvec3(0.0LF);
  double height = scan.range_max, extra = 1.0LF, least_sine = 0.0LF;
  uint number = face;
  if (face == SF_SCENE_FLOOR_FACE) {
    normal = dvec3(scan.normal_x, scan.normal_y, scan.normal_z);
    height = scan.height, extra = 0.0LF, least_sine = scan.least_sine;
  } else if (face != SF_SCENE_NO_FACE) {
    const SceneInstance mesh = load_SceneInstance(instances, int(instance));
    const ScenePlane plane = load_ScenePlane(planes, int(mesh.first_face + face));
    const dvec3 n = dvec3(plane.normal_x, plane.normal_y, plane.normal_z);
    normal = dvec3(dot64(dvec3(mesh.ax, mesh.ay, mesh.az), n), dot64(dvec3(mesh.bx, mesh.by, mesh.bz), n),
                   dot64(dvec3(mesh.cx, mesh.cy, mesh.cz), n));
    precise dvec3 from = dvec3(plane.x, plane.y, plane.z) - dvec3(mesh.px, mesh.py, mesh.pz);
    height = dot64(n, from), extra = 0.0LF, least_sine = mesh.least_sine;
    number = mesh.face + face;
  }
  const double sine = dot64(normal, d);
  precise double range = height / (sine + extra);
  const double nearer = scan.range_max < range ? scan.range_max : range;
  return uvec4(unpackDouble2x32(nearer), number, abs(sine) < least_sine ? SF_BEAM_GRAZING : 0u);
}

void write_results(SceneJob job, SceneScan scan, Beams b) {
  dvec4 d[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int at = int((tile + SF_TILE_DX + 1024u * uint(axis)) / 4u + 2u * lane);
    const uvec4 one = imageLoad(tiles, at), two = imageLoad(tiles, at + 1);
    d[axis] = dvec4(packDouble2x32(one.xy), packDouble2x32(one.zw), packDouble2x32(two.xy), packDouble2x32(two.zw));
  }
  for (int i = 0; i < 4; ++i) {
    const bool certain = failed == 0u && b.low[i] > b.others[i];
    results.beam[job.result + 4u * lane + uint(i)] =
        certain ? evaluate(b.face[i], b.instance[i], scan, dvec3(d[0][i], d[1][i], d[2][i]))
                : uvec4(0u, 0u, SF_SCENE_NO_FACE, SF_BEAM_UNCERTAIN);
  }
}

void main() {
  lane = gl_LocalInvocationID.x;
  const SceneJob job = load_SceneJob(jobs, int(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x));
  if (job.view == SF_SCENE_NO_VIEW) return;
  tile = job.tile * SF_TILE_WORDS;
  const SceneScan scan = load_SceneScan(scans, int(job.view));
  const float least = float(1.0LF / scan.range_max);
  vec4 from[3];  // directions in the sensor's frame
  for (uint axis = 0u; axis < 3u; ++axis)
    from[axis] = uintBitsToFloat(imageLoad(tiles, int((tile + SF_TILE_X + 512u * axis) / 4u + lane)));
  Beams b = Beams(from[0], from[1], from[2], vec4(least * (1.0 - 1e-6)), vec4(least * (1.0 + 1e-6)), vec4(0.0),
                  uvec4(SF_SCENE_NO_FACE), uvec4(0u));
  if (scan.floor != 0u) draw_floor(dvec3(scan.normal_x, scan.normal_y, scan.normal_z), scan.height, b);
  const uint used = tile_word(SF_TILE_USED);
  if (lane == 0u) failed = 0u, top = 0u;
  if (lane < 32u) child_vectors[lane / 16u][lane % 16u] = 0u;
  begin_farthest(b);
  barrier();
  end_farthest(used);
  barrier();
  uint entries = kMostEntries, parity = 0u;
  for (uint i = 0u; i < scan.instances; ++i) {
    const uint row = scan.first_instance + i;
    const SceneInstance mesh = load_SceneInstance(instances, int(row));
    if (!may_see(mesh)) continue;
    aim(mesh, from[0], from[1], from[2], b);
    if (lane == 0u) stack_child[0] = mesh.root, stack_depth[0] = 0.0, stack_vectors[0] = 0xFFFFFFFFu >> (32u - used), top = 1u;
    walk(mesh, row, used, entries, parity, b);
  }
  write_results(job, scan, b);
}
