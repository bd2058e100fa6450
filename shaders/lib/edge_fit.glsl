// Computes the distance of a lane edge from the points of a scan. The kernel declares the tables points and grains.
//
// 1. Fits a line through all points, and a parabola to its residuals. If the points lie on it within the tolerance of
// their source, it is the edge.
// 2. Otherwise fits candidates: lines through windows of an eighth, a third and two thirds of the scan's width. All
// points vote (line_fit.h, `vote`). The best candidate's inliers give a second line, and its inliers the final one.
// All loops exit at the top, as lavapipe requires.

#include "sensors/lane_markings/line_fit.h"

#define SF_WINDOWS 16

// Points of one sensor.
struct EdgeFan {
  int first;  // index of its first point
  int lanes;
  bool packed;
};

struct Points {
  double w[SF_BEAMS_PER_LANE], x[SF_BEAMS_PER_LANE], y[SF_BEAMS_PER_LANE];
  uint grain[SF_BEAMS_PER_LANE];
};

Points points_of(EdgeFan fan, int own) {
  Points p;
  for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
    const EdgePoint point = load_EdgePoint(points, fan.first + SF_BEAMS_PER_LANE * own + i);
    p.x[i] = point.x;
    p.y[i] = point.y;
    p.w[i] = p.x[i] < double(SF_NOWHERE) ? 1.0 : 0.0;
    p.grain[i] = p.x[i] < double(SF_NOWHERE) ? unpackDouble2x32(point.x).x & SF_GRAIN_MASK : 0u;
  }
  return p;
}

Moments moments_of_all(EdgeFan fan, out uint grain) {
  Moments m = Moments(0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  grain = 0u;
  int own = 0;
  while (own < fan.lanes) {
    const Points p = points_of(fan, own);
    for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
      add_point(m, p.w[i], p.x[i], p.y[i]);
      grain = max(grain, p.grain[i]);
    }
    ++own;
  }
  return m;
}

// Returns the moments of the points of lanes [first, end) within `allowed` of `line`.
Moments moments_near(EdgeFan fan, int first, int end, Line line, double allowed) {
  Moments m = Moments(0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  int own = first;
  while (own < end) {
    const Points p = points_of(fan, own);
    for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
      const double v = across(line, p.x[i], p.y[i]);
      const double w = v <= allowed && v >= -allowed ? p.w[i] : 0.0;
      add_point(m, w, p.x[i], p.y[i]);
    }
    ++own;
  }
  return m;
}

LineMoments trend_near(EdgeFan fan, int end, Line line, double allowed) {
  LineMoments s = no_moments();
  int own = 0;
  while (own < end) {
    const Points p = points_of(fan, own);
    for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
      const double v = across(line, p.x[i], p.y[i]);
      const double w = v <= allowed && v >= -allowed ? p.w[i] : 0.0;
      add_to_moments(s, w, along(line, p.x[i], p.y[i]), v);
    }
    ++own;
  }
  return s;
}

// Returns the lanes of the k-th window: nine of an eighth of the scan, five of a third, two of two thirds.
ivec2 window(EdgeFan fan, int k) {
  const int least = min(fan.lanes, fan.packed ? 1 : 2);
  const int width = max(least, k < 9 ? fan.lanes / 8 : k < 14 ? fan.lanes / 3 : 2 * fan.lanes / 3);
  const int at = k < 9 ? k : k < 14 ? k - 9 : k - 14;
  const int last = k < 9 ? 8 : k < 14 ? 4 : 1;
  const int first = (fan.lanes - width) * at / last;
  return ivec2(first, first + width);
}

struct Candidate {
  Line line;
  double allowed;
  Hypothesis hypothesis_of;
  float votes;
};

Candidate candidate(EdgeFan fan, int k, bool wanted, double source) {
  const ivec2 lanes = window(fan, k);
  Line anywhere = Line(0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0);
  const Moments m = moments_near(fan, wanted ? lanes.x : 0, wanted ? lanes.y : 0, anywhere, 1e30);
  const Line line = line_through(m);
  // Tolerates a bend within the scan, which may move points by a fraction of the scan's width on the edge.
  precise double wide = sqrt(line.spread * 12.0) * double(fan.lanes) / double(lanes.y - lanes.x);
  precise double allowed = 0.625 * source + 0.015625 * wide;
  return Candidate(line, allowed, hypothesis_of(line, allowed), 0.0);
}

Candidate elect(EdgeFan fan, bool wanted, double source) {
  const Line none = Line(0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0);
  Candidate best = Candidate(none, 0.0, hypothesis_of(none, 0.0), -1e30);
  // In wide scans, every other lane votes.
  const int stride = fan.lanes >= 12 ? 2 : 1;
  int k = wanted ? 0 : SF_WINDOWS;
  while (k < SF_WINDOWS) {
    Candidate c[4];
    for (int i = 0; i < 4; ++i) c[i] = candidate(fan, k + i, wanted, source);
    int own = 0;
    while (own < fan.lanes) {
      const Points p = points_of(fan, own);
      for (int i = 0; i < SF_BEAMS_PER_LANE; ++i) {
        const float w = float(p.w[i]), x = float(p.x[i]), y = float(p.y[i]);
        for (int j = 0; j < 4; ++j) c[j].votes = c[j].votes + vote(c[j].hypothesis_of, w, x, y);
      }
      own += stride;
    }
    for (int i = 0; i < 4; ++i) {
      if (c[i].line.spread > 0.0 && c[i].votes > best.votes) best = c[i];
    }
    k += 4;
  }
  return best;
}

// Returns the variance of a point across the line due to range and bearing noise [m^2], at the middle of the line.
double noise_across(Line line, double range_sigma, double range_proportional, double angle_sigma) {
  precise double r2 = line.px * line.px + line.py * line.py;
  const double safe = r2 > 0.0 ? r2 : 1.0;
  precise double out_of = line.nx * line.px + line.ny * line.py;
  precise double beside = line.tx * line.px + line.ty * line.py;
  precise double radial = (range_sigma * range_sigma + range_proportional * range_proportional * r2) / safe;
  precise double variance = radial * out_of * out_of + angle_sigma * angle_sigma * beside * beside;
  return variance;
}

// The range of a single beam is the reading.
EdgeReading single_ray(EdgeRow row, Points start, double grain) {
  precise double range = sqrt(start.x[0] * start.x[0] + start.y[0] * start.y[0]);
  precise double spread = row.range_proportional * range;
  precise double sigma = sqrt(row.range_sigma * row.range_sigma + spread * spread + grain * grain / 12.0);
  return EdgeReading(range, start.w[0], 0.0, sigma, 1.0, 0.0);
}

EdgeReading fit_edge(EdgeRow row, out bool mixed) {
  const bool packed = (row.flags & SF_EDGE_PACKED) != 0u;
  const bool single = (row.flags & SF_EDGE_SINGLE) != 0u;
  const int beams = int(row.beams);
  const int lanes = packed ? (beams + SF_BEAMS_PER_LANE - 1) / SF_BEAMS_PER_LANE : beams;
  const EdgeFan fan = EdgeFan(SF_BEAMS_PER_LANE * int(row.lane), lanes, packed);

  // Fit all points.
  uint grain_row;
  const Moments all = moments_of_all(fan, grain_row);
  const double grain = load_Grain(grains, int(grain_row)).size;
  Line line = line_through(all);
  double noise = sqrt(noise_across(line, row.range_sigma, row.range_proportional, row.angle_sigma));
  const double source = tolerance(grain, noise);
  LineMoments trend = trend_near(fan, lanes, line, 1e30);
  Parabola curvature = parabola_of(trend);

  // Select the points of one edge among several.
  mixed = !single && trend.n > 2.5 && !is_one_edge(trend, curvature, source);
  const Candidate best = elect(fan, mixed, source);
  const int again = mixed ? lanes : 0;
  const Moments near = moments_near(fan, 0, again, best.line, best.allowed);
  const Line second = line_through(near);
  const Moments nearer = moments_near(fan, 0, again, second, best.allowed);
  const Line third = line_through(nearer);
  const LineMoments third_trend = trend_near(fan, again, third, best.allowed);
  if (mixed) {
    line = third;
    trend = third_trend;
    curvature = parabola_of(third_trend);
    noise = sqrt(noise_across(third, row.range_sigma, row.range_proportional, row.angle_sigma));
  }

  const double floor_of_noise = 9.313225746154785e-10;
  const PointError point_error = PointError(grain, noise > floor_of_noise ? noise : floor_of_noise);
  const LineFit fitted = fit_at(line, trend, curvature, point_error, row.perpendicular_x, row.perpendicular_y, row.distance_max);

  precise double left_over = all.n - fitted.points;
  EdgeReading reading = EdgeReading(fitted.distance, fitted.points, fitted.residual, fitted.sigma, fitted.gain, left_over);
  if (single) reading = single_ray(row, points_of(fan, 0), grain);
  if (single ? reading.points <= 0.0 : !fitted.seen) {
    const double nan = packDouble2x32(uvec2(0u, 0x7ff80000u));
    reading.distance = reading.sigma = nan;
    reading.residual = 0.0;
  }
  return reading;
}
