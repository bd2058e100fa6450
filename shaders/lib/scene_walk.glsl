// Walks the tree of an instance from near to far (scene/rasterizer/traverse-inl.h). All invocations of a group take the
// same way.

uint tile_word(uint at) { return imageLoad(tiles, int((tile + at) / 4u))[at % 4u]; }
float tile_float(uint at) { return uintBitsToFloat(tile_word(at)); }
vec3 tile_vector(uint at, uint stride) {
  return vec3(tile_float(at), tile_float(at + stride), tile_float(at + 2u * stride));
}

/// Depth [m] beyond which no beam of the tile can hit a nearer surface.
float depth_limit() { return 1.0001 / uintBitsToFloat(tile_farthest); }

// After a barrier between the two, `farthest` and `tile_farthest` are those of the beams.
void begin_farthest(Beams b) {
  lane_low[lane] = min(min(b.low.x, b.low.y), min(b.low.z, b.low.w));
  if (lane == 0u) tile_farthest = 0x7F800000u;
}
void end_farthest(uint used) {
  if (lane >= 32u) return;
  const float low = min(min(lane_low[4u * lane], lane_low[4u * lane + 1u]), min(lane_low[4u * lane + 2u], lane_low[4u * lane + 3u]));
  farthest[lane] = lane < used ? low : kUnbounded;
  atomicMin(tile_farthest, floatBitsToUint(farthest[lane]));
}

/// Returns whether the tile may see the sphere around a mesh.
bool may_see(SceneInstance mesh) {
  const vec3 centre = vec3(mesh.centre_x, mesh.centre_y, mesh.centre_z);
  bool inside = dot(tile_vector(SF_TILE_AXIS, 1u), centre) - mesh.reach <= depth_limit();
  for (uint k = 0u; k < 12u; k += 3u)
    inside = inside && dot(tile_vector(SF_TILE_PLANE + k, 1u), centre) >= -mesh.reach;
  return inside;
}

/// Rotates the beams and their boxes into the mesh's frame.
void aim(SceneInstance mesh, vec4 x, vec4 y, vec4 z, inout Beams b) {
  const mat3 R = mat3(dvec3(mesh.ax, mesh.ay, mesh.az), dvec3(mesh.bx, mesh.by, mesh.bz), dvec3(mesh.cx, mesh.cy, mesh.cz));
  const vec3 eye = vec3(mesh.eye_x, mesh.eye_y, mesh.eye_z);
  b.x = R[0].x * x + R[1].x * y + R[2].x * z;
  b.y = R[0].y * x + R[1].y * y + R[2].y * z;
  b.z = R[0].z * x + R[1].z * y + R[2].z * z;
  for (uint task = lane; task < 256u; task += SF_TILE_LANES) {  // triples of rows: boxes, planes, axis
    const uint triple = task / 32u, v = task % 32u;
    const vec3 rotated = R * tile_vector(SF_TILE_VECTORS + 96u * triple + v, 32u);
    for (uint axis = 0u; axis < 3u; ++axis) seen[3u * triple + axis][v] = rotated[axis];
    if (triple >= 3u) offset[triple - 3u][v] = dot(rotated, eye) + (triple == 7u ? mesh.room : -mesh.room);
  }
  if (lane < 8u) {
    const uint at = lane < 3u ? SF_TILE_BOX + 3u * lane : (lane < 7u ? SF_TILE_PLANE + 3u * (lane - 3u) : SF_TILE_AXIS);
    const vec3 rotated = R * tile_vector(at, 1u);
    for (uint axis = 0u; axis < 3u; ++axis) tile_seen[3u * lane + axis] = rotated[axis];
    if (lane >= 3u) tile_offset[lane - 3u] = dot(rotated, eye) + (lane == 7u ? mesh.room : -mesh.room);
  }
}

vec3 tile_row(uint k) { return vec3(tile_seen[k], tile_seen[k + 1u], tile_seen[k + 2u]); }
vec3 vector_row(uint k, uint v) { return vec3(seen[k][v], seen[k + 1u][v], seen[k + 2u][v]); }

/// Lists the children of a node that vectors of `wanted` may see: eight lanes per child, four vectors each.
void test_children(uint node, uint wanted, uint parity) {
  const uint child = lane / 8u, at = node * SF_NODE_WORDS + child;
  vec3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = uintBitsToFloat(imageLoad(nodes, int(at) + 16 * axis).x);
    high[axis] = uintBitsToFloat(imageLoad(nodes, int(at) + 16 * axis + 48).x);
  }
  const vec3 axis = tile_row(21u);
  const float depth = dot(axis, mix(high, low, greaterThanEqual(axis, vec3(0.0)))) - tile_offset[4];
  bool near = low.x <= high.x && depth <= depth_limit();
  for (uint k = 0u; k < 4u; ++k) {
    const vec3 n = tile_row(9u + 3u * k);
    near = near && dot(n, mix(low, high, greaterThanEqual(n, vec3(0.0)))) >= tile_offset[k];
  }
  const vec3 middle = 0.5 * (low + high), half_size = 0.5 * (high - low);
  uint see = 0u;
  for (uint v = 4u * (lane % 8u); near && v < 4u * (lane % 8u) + 4u; ++v) {
    const vec3 a = vector_row(21u, v);
    bool inside = (wanted >> v & 1u) != 0u &&
                  (dot(a, middle) - dot(abs(a), half_size) - offset[4][v]) * farthest[v] <= 1.0001;
    for (uint k = 0u; k < 4u; ++k) {
      const vec3 n = vector_row(9u + 3u * k, v);
      inside = inside && dot(n, middle) + dot(abs(n), half_size) >= offset[k][v];
    }
    see |= inside ? 1u << v : 0u;
  }
  if (see != 0u) atomicOr(child_vectors[parity][child], see);
  if (lane % 8u == 0u) child_depth[child] = max(depth, 0.0);
}

/// Pushes these children, the nearest last.
void push_children(uint node, uint first, uint parity) {
  if (lane >= 16u) return;
  const float depth = child_depth[lane];
  uint count = 0u, farther = 0u;
  for (uint k = 0u; k < 16u; ++k) {
    if (child_vectors[parity][k] == 0u) continue;
    ++count;
    farther += child_depth[k] > depth || (child_depth[k] == depth && k > lane) ? 1u : 0u;
  }
  const bool fits = first + count <= kStack;
  if (lane == 0u) {
    top = fits ? first + count : first;
    if (!fits) failed = 1u;
  }
  if (!fits || child_vectors[parity][lane] == 0u) return;
  stack_child[first + farther] = int(imageLoad(nodes, int(node * SF_NODE_WORDS + SF_NODE_CHILD + lane)).x);
  stack_depth[first + farther] = depth;
  stack_vectors[first + farther] = child_vectors[parity][lane];
}

/// Draws the faces of a leaf into the vectors of `wanted`.
void draw_leaf(uint row, SceneInstance mesh, uint instance, uint wanted, uint used, inout Beams b) {
  const uint leaf = row * SF_LEAF_WORDS;
  const uint count = imageLoad(leaves, int(leaf + SF_LEAF_COUNT)).x;
  const vec4 eye = leaf_eye(leaf, mesh);
  if (lane < 64u) view_face(leaf, lane % 16u, lane / 16u, eye.xyz, eye.w);
  barrier();
  if (lane < 16u) {
    const float square = max(max(edge_square[0][lane], edge_square[1][lane]),
                             max(edge_square[2][lane], edge_square[3][lane]));
    edge_error[lane] =
        kRounding * (eye.w * leaf_float(leaf + SF_LEAF_EXTENT + lane) + 14.01 * sqrt(square));
  }
  barrier();
  const uint v = lane / 4u;
  const float longest = tile_float(SF_TILE_LONGEST);
  uint faces = 0u;
  for (uint k = 4u * (lane % 4u); (wanted >> v & 1u) != 0u && k < min(4u * (lane % 4u) + 4u, count); ++k)
    faces |= sees_face(k, v, longest) ? 1u << k : 0u;
  lane_faces[lane] = faces;
  barrier();
  faces = lane_faces[4u * v] | lane_faces[4u * v + 1u] | lane_faces[4u * v + 2u] | lane_faces[4u * v + 3u];
  while (faces != 0u) {
    const uint k = uint(findLSB(faces));
    faces &= faces - 1u;
    draw(k, 1.0, instance, b);
    if (leaf_kind[k] == SF_FACE_EDGE_ON) draw(k, -1.0, instance, b);
  }
  begin_farthest(b);
  barrier();
  end_farthest(used);
}

/// @param entries that may be taken  @param parity of the entries so far
void walk(SceneInstance mesh, uint instance, uint used, inout uint entries, inout uint parity, inout Beams b) {
  while (true) {
    barrier();
    const uint count = top;
    if (count == 0u || failed != 0u) break;
    const int child = stack_child[count - 1u];
    const float depth = stack_depth[count - 1u];
    const uint wanted = stack_vectors[count - 1u];
    const bool near = depth <= depth_limit();
    barrier();
    if (lane == 0u) {
      top = count - 1u;
      if (entries == 0u) failed = 1u;
    }
    entries -= min(entries, 1u);
    if (!near) continue;
    if (child >= 0) {
      const uint node = mesh.first_node + uint(child);
      test_children(node, wanted, parity);
      barrier();
      push_children(node, count - 1u, parity);
      parity = 1u - parity;
      if (lane >= 16u && lane < 32u) child_vectors[parity][lane - 16u] = 0u;
    } else {
      draw_leaf(mesh.first_leaf + uint(~child), mesh, instance, wanted, used, b);
    }
  }
  barrier();
}
