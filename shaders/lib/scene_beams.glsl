// Four beams of a lane against faces of a leaf, in 32 bits, with the bounds of scene/rasterizer.h. Quotients and roots may
// be off by three units in the last place, for which the bounds have room.

const float kRounding = 1.0 / 16777216.0;
const float kUnbounded = 1e30;

/// Up to sixteen faces of a leaf as seen from the sensor: scene::LeafView.
shared float edge[12][16];  // positive inside
shared float edge_square[4][16];
shared float inverse[3][16];  // n / h; 0 if seen edge-on
shared float above[16], below[16], slack[16], edge_error[16];
shared uint leaf_face[16];
shared uint leaf_kind[16];  // SF_FACE_EDGE_ON, SF_FACE_HIDDEN or 0

/// Beams of a lane. Bounds are inverse ranges [1/m].
struct Beams {
  vec4 x, y, z;            // unit vectors in the frame of the mesh that is drawn
  vec4 low, high, others;  // bounds of the nearest face so far, and the largest upper bound of all others
  uvec4 face, instance;    // that face and its row of SceneInstance
};

bvec4 both(bvec4 a, bvec4 b) { return bvec4(uvec4(a) & uvec4(b)); }

vec4 along(float nx, float ny, float nz, Beams b) { return nx * b.x + ny * b.y + nz * b.z; }

/// Takes over the beams that a surface with bounds `low` and `high` covers `surely`, or `possibly`.
void take(vec4 low, vec4 high, bvec4 surely, bvec4 possibly, uint face, uint instance, inout Beams b) {
  const bvec4 nearest = both(greaterThan(low, b.low), surely);
  b.others = max(b.others, mix(mix(vec4(0.0), high, possibly), b.high, nearest));
  b.low = mix(b.low, low, nearest);
  b.high = mix(b.high, high, nearest);
  b.face = uvec4(mix(ivec4(b.face), ivec4(int(face)), nearest));
  b.instance = uvec4(mix(ivec4(b.instance), ivec4(int(instance)), nearest));
}

vec4 edge_side(uint e, uint k, Beams b) { return along(edge[e][k], edge[e + 1u][k], edge[e + 2u][k], b); }

/// Draws face k of the leaf. @param sign -1 turns it around
void draw(uint k, float sign, uint instance, inout Beams b) {
  const vec4 w = along(inverse[0][k], inverse[1][k], inverse[2][k], b);
  const vec4 inside = min(min(sign * edge_side(0u, k, b), sign * edge_side(3u, k, b)),
                          min(sign * edge_side(6u, k, b), sign * edge_side(9u, k, b)));
  take(w * below[k] - slack[k], w * above[k] + slack[k], greaterThan(inside, vec4(edge_error[k])),
       greaterThanEqual(inside, vec4(-edge_error[k])), leaf_face[k], instance, b);
}

/// Draws the plane z = 0, which covers all beams. Errors as in scene/rasterizer.h, without a rotation.
void draw_floor(dvec3 normal, double height, inout Beams b) {
  const float size = float(1.0LF / height);
  const bool edge_on = !(abs(size) < kUnbounded);
  const vec3 n = edge_on ? vec3(0.0) : vec3(normal) * size;
  const float error = edge_on ? kUnbounded : 24.0 * kRounding * abs(size);
  const vec4 w = along(n.x, n.y, n.z, b);
  take(w - error, w + error, bvec4(true), bvec4(true), SF_SCENE_FLOOR_FACE, 0u, b);
}
