// From a hit to a point in the sensor frame. The including shader declares the tables edges (SF_EDGE_TEXELS per sensor:
// EdgeRow), directions, normals and points.
//
// The last bits of a point's x hold the row of its pixel size. A beam that is no point lies at SF_NOWHERE: ranges near
// the maximum or up to the minimum, hits of movers and of the ends of dashes.

// Constants of one sensor for its points.
struct PointRow {
  uvec4 where;  // as in EdgeRow: lane, directions, beams, flags
  double limit, range_min, range_max;
  double range_sigma, range_proportional, noise_share;
  int noise;
};

PointRow point_row(int due) {
  const int at = SF_EDGE_TEXELS * due;
  const uvec4 limits = imageLoad(edges, at + 2);
  const uvec4 noises = imageLoad(edges, at + 3);
  const uvec4 last = imageLoad(edges, at + 5);
  return PointRow(imageLoad(edges, at), packDouble2x32(limits.xy), packDouble2x32(limits.zw),
                  double(uintBitsToFloat(last.w)), packDouble2x32(noises.xy), packDouble2x32(noises.zw),
                  double(uintBitsToFloat(last.z)), int(last.x));
}

void write_point(PointRow row, int own, int slot, float deviate, double range, uint tag) {
  precise double spread = row.range_proportional * range;
  precise double sigma = sqrt(row.range_sigma * row.range_sigma + spread * spread);
  precise double disturbed = range + sigma * (row.noise_share * double(deviate));
  const double r = min(max(disturbed, row.range_min), row.range_max);
  const bool packed = (row.where.w & SF_EDGE_PACKED) != 0u;
  const int beam = packed ? SF_BEAMS_PER_LANE * own + slot : own;
  const bool there = beam < int(row.where.z) && (packed || slot == 0);
  const bool is_edge = (tag & SF_TAG_END) == 0u || (row.where.w & SF_EDGE_SINGLE) != 0u;
  const bool met = there && tag != SF_NO_HIT && (tag & SF_TAG_MOVER) == 0u && is_edge && r < row.limit &&
                   (r > row.range_min || row.range_min == 0.0);
  const uvec4 words = imageLoad(directions, SF_BEAMS_PER_LANE * (int(row.where.y) + own) + slot);
  precise double x = r * packDouble2x32(words.xy);
  precise double y = r * packDouble2x32(words.zw);
  const double nowhere = double(SF_NOWHERE);
  const int point = SF_BEAMS_PER_LANE * (int(row.where.x) + own) + slot;
  const uvec2 grained = (unpackDouble2x32(x) & uvec2(~SF_GRAIN_MASK, ~0u)) | uvec2(tag >> SF_TAG_BITS, 0u);
  imageStore(points, point, met ? uvec4(grained, unpackDouble2x32(y)) : uvec4(unpackDouble2x32(nowhere), 0u, 0u));
}
