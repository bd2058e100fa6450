// A leaf as seen from the sensor (scene/rasterizer/leaf-inl.h), and which of its faces a vector of beams may see.

float leaf_float(uint at) { return uintBitsToFloat(imageLoad(leaves, int(at)).x); }
vec3 leaf_vector(uint at) { return vec3(leaf_float(at), leaf_float(at + 16u), leaf_float(at + 32u)); }
double leaf_double(uint at) {
  return packDouble2x32(uvec2(imageLoad(leaves, int(at)).x, imageLoad(leaves, int(at) + 1).x));
}

/// The sensor relative to a leaf's centre, and the distance of the leaf's farthest point, rounded up [m].
/// @param leaf its first word
vec4 leaf_eye(uint leaf, SceneInstance mesh) {
  const uint at = leaf + SF_LEAF_CENTRE;
  precise dvec3 eye64 = dvec3(mesh.px, mesh.py, mesh.pz) -
                        dvec3(leaf_double(at), leaf_double(at + 2u), leaf_double(at + 4u));
  const vec3 eye = vec3(eye64);
  return vec4(eye, (length(eye) + leaf_float(leaf + SF_LEAF_RADIUS)) * 1.00002);
}

/// Returns whether a face is certainly a back face of a closed body, seen from outside.
bool is_hidden(uint leaf, uint k, vec3 eye, float h, float reach) {
  bool inside = true;
  for (uint axis = 0u; axis < 3u; ++axis)
    inside = inside && leaf_float(leaf + SF_LEAF_BODY + axis) <= eye[axis] &&
             eye[axis] <= leaf_float(leaf + SF_LEAF_BODY + 3u + axis);
  const uint bit = imageLoad(leaves, int(leaf + SF_LEAF_OUTWARD)).x >> (h > 0.0 ? k : k + 16u) & 1u;
  return !inside && bit != 0u && abs(h) > 25.0 * kRounding * reach;
}

/// Prepares one edge of one face; the first edge's lane also the face's plane. @param reach as `leaf_eye`
void view_face(uint leaf, uint k, uint e, vec3 eye, float reach) {
  const vec3 corner = leaf_vector(leaf + 48u * e + k), next = leaf_vector(leaf + 48u * ((e + 1u) & 3u) + k);
  const vec3 n = leaf_vector(leaf + SF_LEAF_NORMAL + k);
  const float h = dot(n, leaf_vector(leaf + k) - eye);
  const vec3 side = cross(corner - eye, next - corner) * (h < 0.0 ? -1.0 : 1.0);
  edge[3u * e][k] = side.x, edge[3u * e + 1u][k] = side.y, edge[3u * e + 2u][k] = side.z;
  edge_square[e][k] = dot(side, side);
  if (e != 0u) return;
  const float size = abs(1.0 / h), relative = 6.0 * kRounding * reach * size;
  const bool open = relative < 0.25;
  inverse[0][k] = open ? n.x / h : 0.0, inverse[1][k] = open ? n.y / h : 0.0, inverse[2][k] = open ? n.z / h : 0.0;
  slack[k] = open ? size * (24.0 * kRounding) : kUnbounded;
  above[k] = open ? 1.0 + 1.4 * relative : 1.0;
  below[k] = open ? 1.0 - 1.4 * relative : 1.0;
  leaf_face[k] = imageLoad(leaves, int(leaf + SF_LEAF_FACE + k)).x;
  leaf_kind[k] = is_hidden(leaf, k, eye, h, reach) ? SF_FACE_HIDDEN : (open ? 0u : SF_FACE_EDGE_ON);
}

/// Largest n . d over the box of vector v.
float largest(vec3 n, uint v) {
  const vec3 c = vec3(seen[0][v], seen[1][v], seen[2][v]);
  const vec3 a = vec3(seen[3][v], seen[4][v], seen[5][v]), b = vec3(seen[6][v], seen[7][v], seen[8][v]);
  return dot(n, c) + abs(dot(n, a)) + abs(dot(n, b));
}

float largest_side(uint e, uint k, uint v) { return largest(vec3(edge[e][k], edge[e + 1u][k], edge[e + 2u][k]), v); }

/// Returns whether a beam of vector v may meet face k. @param longest BeamTile::longest
bool sees_face(uint k, uint v, float longest) {
  if (leaf_kind[k] != 0u) return leaf_kind[k] == SF_FACE_EDGE_ON;
  const float inside = min(min(largest_side(0u, k, v), largest_side(3u, k, v)),
                           min(largest_side(6u, k, v), largest_side(9u, k, v)));
  const float nearest = largest(vec3(inverse[0][k], inverse[1][k], inverse[2][k]), v);
  const float high = max(nearest, 0.0) * (above[k] + 1e-5) + slack[k] * longest;
  return inside + 2.0 * longest * edge_error[k] >= 0.0 && high >= farthest[v];
}
