#pragma once
// The lane edge sensor's fit on the host. It performs the same operations in the same order as
// shaders/lib/edge_fit.glsl, so results are bit-identical. It is a header because a benchmark also compiles it for
// other processors.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "raycast/records.h"
#include "sensors/lane_markings/line_fit.h"
#include "sensors/laneedge_settings.h"

namespace sf::sensors::fit {

/// Points of one scan, beam by beam, without the unused places of the device's lanes.
struct Points {
  double w[kMostEdgeSamples], x[kMostEdgeSamples], y[kMostEdgeSamples];
  std::uint32_t count = 0;                 ///< beams
  std::uint32_t lane = SF_BEAMS_PER_LANE;  ///< beams per lane
  std::uint32_t grain = 0;
};

/// The hits of a scan, as arrays over beams.
struct EdgeHits {
  const double* ranges;       ///< [m]
  const std::uint32_t* tags;  ///< of the surfaces that were hit, or SF_NO_HIT
  const double* directions;   ///< cosine and sine of each beam
  const float* normals;       ///< null without noise
  std::uint32_t stride = 1;   ///< from one beam to the next, in all arrays
};

static inline void make_points(const EdgeRow& row, const EdgeHits& hits, Points& p) {
  p.count = row.beams;
  p.lane = (row.flags & SF_EDGE_PACKED) != 0 ? SF_BEAMS_PER_LANE : 1;
  p.grain = 0;
  for (std::uint32_t k = 0, at = 0; k < row.beams; ++k, at += hits.stride) {
    const double range = hits.ranges[at];
    const double share =
        static_cast<double>(row.noise_share) * (hits.normals == nullptr ? 0.0 : double{hits.normals[at]});
    const double spread = row.range_proportional * range;
    const double sigma = std::sqrt(row.range_sigma * row.range_sigma + spread * spread);
    const double disturbed = range + sigma * share;
    const double r = std::min(std::max(disturbed, row.range_min), double{row.range_max});
    const std::uint32_t tag = hits.tags[at];
    const bool is_edge = (tag & SF_TAG_END) == 0 || (row.flags & SF_EDGE_SINGLE) != 0;
    const bool counts = tag != SF_NO_HIT && (tag & SF_TAG_MOVER) == 0 && is_edge && r < row.range_limit &&
                        (r > row.range_min || row.range_min == 0.0);
    p.w[k] = counts ? 1.0 : 0.0;
    const auto bits = std::bit_cast<std::uint64_t>(r * hits.directions[2 * at]) & ~std::uint64_t{SF_GRAIN_MASK};
    p.x[k] = counts ? std::bit_cast<double>(bits | tag >> SF_TAG_BITS) : 0.0;
    p.y[k] = r * hits.directions[2 * at + 1];
    if (counts) p.grain = std::max(p.grain, tag >> SF_TAG_BITS);
  }
}

static inline bool near(const Line& line, const Points& p, std::uint32_t k, double allowed, double& v) {
  v = across(line, p.x[k], p.y[k]);
  return v <= allowed && v >= -allowed;
}

static inline Moments moments_near(const Points& p, std::uint32_t first, std::uint32_t end, const Line& line,
                                   double allowed) {
  Moments m = Moments{0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  double v = 0.0;
  for (std::uint32_t k = first; k < end; ++k) add_point(m, near(line, p, k, allowed, v) ? p.w[k] : 0.0, p.x[k], p.y[k]);
  return m;
}

static inline LineMoments trend_near(const Points& p, const Line& line, double allowed) {
  LineMoments s = no_moments();
  double v = 0.0;
  for (std::uint32_t k = 0; k < p.count; ++k) {
    const double w = near(line, p, k, allowed, v) ? p.w[k] : 0.0;
    add_to_moments(s, w, along(line, p.x[k], p.y[k]), v);
  }
  return s;
}

struct Candidate {
  Line line = Line{0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0};
  double allowed = 0.0;
  float votes = -1e30F;
};

/// First and last lane of the k-th window.
struct Window {
  int first, end;
};

static inline Window window(int lanes, bool packed, int k) {
  const int least = std::min(lanes, packed ? 1 : 2);
  const int width = std::max(least, k < 9 ? lanes / 8 : k < 14 ? lanes / 3 : 2 * lanes / 3);
  const int at = k < 9 ? k : k < 14 ? k - 9 : k - 14;
  const int last = k < 9 ? 8 : k < 14 ? 4 : 1;
  const int first = (lanes - width) * at / last;
  return {first, first + width};
}

static inline Candidate elect(const Points& p, double source) {
  const int lanes = static_cast<int>((p.count + p.lane - 1) / p.lane);
  const Line anywhere = Line{0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0};
  Candidate best;
  for (int k = 0; k < 16; ++k) {
    const Window w = window(lanes, p.lane > 1, k);
    const auto first = static_cast<std::uint32_t>(w.first) * p.lane;
    const auto end = std::min(static_cast<std::uint32_t>(w.end) * p.lane, p.count);
    Candidate c;
    c.line = line_through(moments_near(p, first, end, anywhere, std::numeric_limits<double>::infinity()));
    const double wide = std::sqrt(c.line.spread * 12.0) * double(lanes) / double(w.end - w.first);
    c.allowed = 0.625 * source + 0.015625 * wide;
    c.votes = 0.0F;
    const Hypothesis paper = hypothesis_of(c.line, c.allowed);
    // In wide scans, every other lane votes.
    for (std::uint32_t i = 0; i < p.count; ++i) {
      if (lanes >= 12 && i / p.lane % 2 == 1) continue;
      c.votes =
          c.votes + vote(paper, static_cast<float>(p.w[i]), static_cast<float>(p.x[i]), static_cast<float>(p.y[i]));
    }
    if (c.line.spread > 0.0 && c.votes > best.votes) best = c;
  }
  return best;
}

static inline double noise_across(const Line& line, const EdgeRow& row) {
  const double r2 = line.px * line.px + line.py * line.py;
  const double safe = r2 > 0.0 ? r2 : 1.0;
  const double out_of = line.nx * line.px + line.ny * line.py;
  const double beside = line.tx * line.px + line.ty * line.py;
  const double radial =
      (row.range_sigma * row.range_sigma + row.range_proportional * row.range_proportional * r2) / safe;
  return radial * out_of * out_of + row.angle_sigma * row.angle_sigma * beside * beside;
}

inline constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

static inline EdgeReading single_ray(const EdgeRow& row, const Points& p, double grain) {
  if (p.w[0] == 0.0) return {kNoNumber, 0.0, 0.0, kNoNumber, 1.0, 0.0};
  const double first = std::sqrt(p.x[0] * p.x[0] + p.y[0] * p.y[0]);
  const double spread = row.range_proportional * first;
  return {first, 1.0, 0.0, std::sqrt(row.range_sigma * row.range_sigma + spread * spread + grain * grain / 12.0),
          1.0,   0.0};
}

static inline EdgeReading read_edge(const EdgeRow& row, const Points& p, std::span<const double> grains) {
  const double grain = grains[p.grain];
  if ((row.flags & SF_EDGE_SINGLE) != 0) return single_ray(row, p, grain);
  constexpr double kAll = std::numeric_limits<double>::infinity();
  const Moments all = moments_near(p, 0, p.count, Line{0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0}, kAll);
  Line line = line_through(all);
  double noise = std::sqrt(noise_across(line, row));
  const double source = tolerance(grain, noise);
  LineMoments trend = trend_near(p, line, kAll);
  Parabola curvature = parabola_of(trend);
  if (trend.n > 2.5 && !is_one_edge(trend, curvature, source)) {
    const Candidate best = elect(p, source);
    line = line_through(moments_near(p, 0, p.count, best.line, best.allowed));
    line = line_through(moments_near(p, 0, p.count, line, best.allowed));
    trend = trend_near(p, line, best.allowed);
    curvature = parabola_of(trend);
    noise = std::sqrt(noise_across(line, row));
  }
  constexpr double kFloor = 9.313225746154785e-10;
  const PointError point_error = PointError{grain, noise > kFloor ? noise : kFloor};
  const LineFit f =
      fit_at(line, trend, curvature, point_error, row.perpendicular_x, row.perpendicular_y, row.distance_max);
  const double others = all.n - f.points;
  return {f.seen ? f.distance : kNoNumber, f.points, f.seen ? f.residual : 0.0,
          f.seen ? f.sigma : kNoNumber,    f.gain,   others};
}

}  // namespace sf::sensors::fit
