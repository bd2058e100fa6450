// Converts a hit to a point in the sensor frame. The kernel declares the tables directions and points.
//
// The last bits of a point's x hold the row of its pixel size. Beams that yield no point are placed at SF_NOWHERE:
// ranges near the maximum or up to the minimum, hits of movers and of the ends of dashes.

void write_point(EdgeRow row, int own, int slot, float deviate, double range, uint tag) {
  precise double spread = row.range_proportional * range;
  precise double sigma = sqrt(row.range_sigma * row.range_sigma + spread * spread);
  precise double disturbed = range + sigma * (double(row.noise_share) * double(deviate));
  const double r = min(max(disturbed, row.range_min), double(row.range_max));
  const bool packed = (row.flags & SF_EDGE_PACKED) != 0u;
  const int beam = packed ? SF_BEAMS_PER_LANE * own + slot : own;
  const bool there = beam < int(row.beams) && (packed || slot == 0);
  const bool is_edge = (tag & SF_TAG_END) == 0u || (row.flags & SF_EDGE_SINGLE) != 0u;
  const bool met = there && tag != SF_NO_HIT && (tag & SF_TAG_MOVER) == 0u && is_edge && r < row.range_limit &&
                   (r > row.range_min || row.range_min == 0.0);
  const BeamDirection bearing = load_BeamDirection(directions, SF_BEAMS_PER_LANE * (int(row.directions) + own) + slot);
  precise double x = r * bearing.cos;
  precise double y = r * bearing.sin;
  const int point = SF_BEAMS_PER_LANE * (int(row.lane) + own) + slot;
  const uvec2 grained = (unpackDouble2x32(x) & uvec2(~SF_GRAIN_MASK, ~0u)) | uvec2(tag >> SF_TAG_BITS, 0u);
  store_EdgePoint(points, point, EdgePoint(met ? packDouble2x32(grained) : double(SF_NOWHERE), met ? y : 0.0));
}
