// Finds the nearest echo in a cone of beams. The kernel declares the tables cones, ranges, hits and echoes, and the
// function `returns_echo`, which decides whether a hit returns an echo.

void write_echo(int at) {
  const ConeRow cone = load_ConeRow(cones, at);
  const vec2 heading = vec2(cone.heading_cos, cone.heading_sin);

  // Unused places of a lane repeat a beam.
  double nearest = cone.range_max;
  uint met = SF_NO_HIT;
  const int lanes = int(cone.lanes);
  int own = 0;
  while (own < lanes) {
    const int lane = int(cone.lane) + own;
    const dvec4 range = load_LaneRanges(ranges, lane).range;
    const uvec4 hit = load_LaneHits(hits, lane).model;
    for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
      const int beam = SF_BEAMS_PER_LANE * (int(cone.directions) + own) + i;
      const bool nearer = hit[i] != SF_NO_HIT && range[i] < nearest && returns_echo(beam, hit[i], heading, cone.min_cosine);
      nearest = nearer ? range[i] : nearest;
      met = nearer ? hit[i] : met;
    }
    ++own;
  }
  store_ConeEcho(echoes, at, ConeEcho(nearest, met, 0u));
}
