// The nearest echo of every due cone of beams. The including shader declares the tables cones (SF_CONE_TEXELS per cone:
// ConeRow), ranges, hits and echoes, and the function `returns_echo`, which decides whether a hit returns its echo.

void main() {
  const int at = int(gl_GlobalInvocationID.x);
  const uvec4 where = imageLoad(cones, SF_CONE_TEXELS * at);
  const uvec4 rest = imageLoad(cones, SF_CONE_TEXELS * at + 1);
  const vec2 heading = uintBitsToFloat(rest.xy);
  const float min_cosine = uintBitsToFloat(where.w);

  // Unused places of a lane repeat a beam.
  double nearest = packDouble2x32(rest.zw);
  uint met = SF_NO_HIT;
  const int lanes = int(where.y);
  int own = 0;
  while (own < lanes) {
    const int lane = int(where.x) + own;
    const uvec4 two = imageLoad(ranges, 2 * lane);
    const uvec4 more = imageLoad(ranges, 2 * lane + 1);
    const uvec4 hit = imageLoad(hits, lane);
    const double range[SF_BEAMS_PER_LANE] = double[SF_BEAMS_PER_LANE](
        packDouble2x32(two.xy), packDouble2x32(two.zw), packDouble2x32(more.xy), packDouble2x32(more.zw));
    for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
      const int beam = SF_BEAMS_PER_LANE * (int(where.z) + own) + i;
      const bool nearer = hit[i] != SF_NO_HIT && range[i] < nearest && returns_echo(beam, hit[i], heading, min_cosine);
      nearest = nearer ? range[i] : nearest;
      met = nearer ? hit[i] : met;
    }
    ++own;
  }
  imageStore(echoes, at, uvec4(unpackDouble2x32(nearest), met, 0u));
}
