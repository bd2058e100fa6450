// The fit on the device: compared with the same steps on the host, bit by bit, and on hand-made points.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "base/random.h"
#include "sensors/lane_markings/edge_fit.h"
#include "sensors/lane_markings/host_fit.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/laneedge_trial.h"

namespace sf::trial {
namespace {

using sensors::EdgeReading;

/// The hits of one scan.
struct Shot {
  std::vector<double> ranges;
  std::vector<std::uint32_t> tags;
};

const std::vector<double> kGrains{0.0, 0.005, 0.02};

/// Scans with hand-made results: no world, no rays.
class FitRig {
 public:
  explicit FitRig(const std::vector<Settings>& settings)
      : context_{world_, device(), thread_pool_, {}},
        edges_(edges_of(settings)),
        fit_(context_, edges_, kGrains, false) {}

  std::vector<EdgeReading> read(const std::vector<Shot>& shots) {
    std::vector<sensors::DueSample> due;
    std::vector<std::uint32_t> lanes;
    std::uint32_t next = 0;
    for (std::uint32_t i = 0; i < edges_.size(); ++i) {
      due.push_back({i, 3});
      lanes.push_back(next);
      next += raycast::plan_beams(edges_[i].fan, true).lanes();
    }
    gpu::Buffer ranges(device(), "ranges", gpu::Role::upload, gpu::Texel::u32x4, 2 * std::size_t{next});
    gpu::Buffer hits(device(), "hits", gpu::Role::upload, gpu::Texel::u32x4, next);
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const raycast::BeamPlan plan = raycast::plan_beams(edges_[i].fan, true);
      for (std::size_t k = 0; k < shots[i].ranges.size(); ++k) {
        ranges.host<double>()[SF_BEAMS_PER_LANE * lanes[i] + plan.place(k)] = shots[i].ranges[k];
        hits.host<std::uint32_t>()[SF_BEAMS_PER_LANE * lanes[i] + plan.place(k)] = shots[i].tags[k];
      }
    }
    const std::size_t groups = (next + 63) / 64;
    gpu::Buffer owners(device(), "owners", gpu::Role::upload, gpu::Texel::u32, 2 * 64 * groups);
    std::size_t at = 0;
    const auto owner = owners.host<raycast::Lane>();
    for (std::uint32_t i = 0; i < edges_.size(); ++i)
      for (std::uint32_t own = 0; own < raycast::plan_beams(edges_[i].fan, true).lanes(); ++own) owner[at++] = {i, own};
    for (; at < owner.size(); ++at) owner[at] = owner[next - 1];
    fit_.prepare(due, lanes);
    fit_.bind(owners, ranges, hits);
    gpu::Buffer counts(device(), "counts", gpu::Role::upload, gpu::Texel::u32, 4);
    counts.host<std::uint32_t>()[0] = static_cast<std::uint32_t>(groups);
    counts.host<std::uint32_t>()[1] = counts.host<std::uint32_t>()[2] = 1;
    gpu::Batch batch(device());
    batch.begin();
    fit_.record_points(batch, counts);
    batch.barrier();
    fit_.record(batch);
    batch.end();
    fit_.add_copies(batch);
    batch.upload(owners, 0, owners.bytes());
    batch.upload(counts, 0, counts.bytes());
    batch.upload(ranges, 0, ranges.bytes());
    batch.upload(hits, 0, hits.bytes());
    batch.run();
    std::vector<EdgeReading> readings;
    for (std::size_t i = 0; i < edges_.size(); ++i) readings.push_back(fit_.reading(i));
    return readings;
  }

  EdgeReading on_the_host(std::uint32_t i, const Shot& shot) {
    const raycast::BeamPlan plan = raycast::plan_beams(edges_[i].fan, true);
    std::vector<double> directions;
    std::vector<float> normals;
    const base::RandomKey draw{0, base::RandomStream::range_noise, i, sensors::edge_noise_id(0), 3};
    for (std::uint32_t k = 0; k < shot.ranges.size(); ++k) {
      directions.push_back(fit_.directions(i)[2 * plan.place(k)]);
      directions.push_back(fit_.directions(i)[2 * plan.place(k) + 1]);
      normals.push_back(static_cast<float>(base::random_normal(draw, k)[0]));
    }
    sensors::fit::Points points;
    sensors::fit::make_points(
        fit_.rows()[i],
        {shot.ranges.data(), shot.tags.data(), directions.data(), normals.empty() ? nullptr : normals.data()}, points);
    return sensors::fit::read_edge(fit_.rows()[i], points, kGrains);
  }

  const std::vector<sensors::LaneEdge>& edges() const { return edges_; }

 private:
  static std::vector<sensors::LaneEdge> edges_of(const std::vector<Settings>& settings) {
    std::vector<sensors::LaneEdge> edges;
    for (const Settings& s : settings)
      edges.push_back(sensors::lane_edge_of(edge_sensor(s), static_cast<std::uint32_t>(edges.size()), 0));
    return edges;
  }

  world::World world_;
  base::ThreadPool thread_pool_;
  sensors::SensorContext context_;
  std::vector<sensors::LaneEdge> edges_;
  sensors::EdgeFit fit_;
};

/// Every beam hits the line x = `x` of the sensor frame.
Shot wall_ahead(const raycast::ScanSettings& fan, double x) {
  Shot shot;
  for (std::uint32_t k = 0; k < fan.samples; ++k) {
    shot.ranges.push_back(x / std::cos(bearing_of(fan, k)));
    shot.tags.push_back(0);
  }
  return shot;
}

/// No hits.
Shot nothing(const raycast::ScanSettings& fan) {
  return {std::vector<double>(fan.samples, fan.range_max), std::vector<std::uint32_t>(fan.samples, SF_NO_HIT)};
}

EdgeReading read_one(const Settings& settings, const Shot& shot) {
  FitRig rig({settings});
  return rig.read({shot})[0];
}

const Settings kAhead{{"perpendicular", {0}}};

raycast::ScanSettings fan_of(const Settings& settings) {
  return sensors::lane_edge_of(edge_sensor(settings), 0, 0).fan;
}

/// No edge, with defined values in all columns.
void expect_none(const EdgeReading& r, double points) {
  EXPECT_TRUE(std::isnan(r.distance)) << r.distance;
  EXPECT_TRUE(std::isnan(r.sigma));
  EXPECT_EQ(r.points, points);
  EXPECT_EQ(r.residual, 0.0);
}

TEST(LaneEdgeFit, FewerThanTwoPointsAreNotALine) {
  Shot shot = nothing(fan_of(kAhead));
  expect_none(read_one(kAhead, shot), 0);
  shot.ranges[30] = 0.5;
  shot.tags[30] = 0;
  expect_none(read_one(kAhead, shot), 1);
}

TEST(LaneEdgeFit, TwoPointsAreALine) {
  const Shot all = wall_ahead(fan_of(kAhead), 0.5);
  Shot shot = nothing(fan_of(kAhead));
  for (const std::size_t k : {std::size_t{10}, std::size_t{11}}) {
    shot.ranges[k] = all.ranges[k];
    shot.tags[k] = 0;
  }
  const EdgeReading r = read_one(kAhead, shot);
  EXPECT_NEAR(r.distance, 0.5, 1e-12);
  EXPECT_EQ(r.points, 2);
  EXPECT_LT(r.residual, 1e-15);
}

/// Equal points define no line. At the sensor itself, every line through them is at distance 0.
TEST(LaneEdgeFit, EqualPoints) {
  Shot shot = nothing(fan_of(kAhead));
  shot.ranges.assign(shot.ranges.size(), 0.0);
  shot.tags.assign(shot.tags.size(), 0);
  const EdgeReading r = read_one(kAhead, shot);
  EXPECT_EQ(r.distance, 0.0);
  EXPECT_EQ(r.points, 61);
  EXPECT_LT(r.sigma, 1e-8);
}

/// Beams a millionth of a degree apart: points within 1e-8 of their range count as one point.
TEST(LaneEdgeFit, PointsTooCloseForALine) {
  const Settings narrow{{"perpendicular", {0}}, {"fov", {1e-7}}};
  expect_none(read_one(narrow, wall_ahead(fan_of(narrow), 0.5)), 61);
}

/// A line along one ray passes through the sensor, so the distance is 0 for any bearing of the ray.
TEST(LaneEdgeFit, PointsOnOneRay) {
  const Settings narrow{{"perpendicular", {90}}, {"fov", {1e-9}}};
  Shot shot = nothing(fan_of(narrow));
  for (std::size_t k = 0; k < shot.ranges.size(); ++k) {
    shot.ranges[k] = 0.3 + 0.005 * static_cast<double>(k);
    shot.tags[k] = 0;
  }
  const EdgeReading r = read_one(narrow, shot);
  EXPECT_NEAR(r.distance, 0.0, 1e-9);
  // Along that ray it is parallel: no distance.
  const Settings along{{"perpendicular", {0}}, {"fov", {1e-9}}};
  expect_none(read_one(along, shot), 61);
}

TEST(LaneEdgeFit, IgnoresRangesNearTheMaximum) {
  Shot shot = nothing(fan_of(kAhead));
  shot.tags.assign(shot.tags.size(), 0);
  shot.ranges.assign(shot.ranges.size(), 0.99);  // the limit itself
  expect_none(read_one(kAhead, shot), 0);
  shot.ranges.assign(shot.ranges.size(), std::nextafter(0.99, 0.0));
  EXPECT_GT(read_one(kAhead, shot).points, 10);
}

TEST(LaneEdgeFit, IgnoresRangesUpToTheMinimum) {
  const Settings settings{{"perpendicular", {0}}, {"range_min", {0.3}}};
  Shot shot = wall_ahead(fan_of(settings), 0.5);
  for (std::size_t k = 0; k < 20; ++k) shot.ranges[k] = 0.3;
  EXPECT_EQ(read_one(settings, shot).points, 41);
}

TEST(LaneEdgeFit, IgnoresEndFacesAndMovers) {
  Shot shot = wall_ahead(fan_of(kAhead), 0.5);
  for (std::size_t k = 0; k < 20; ++k) {
    shot.ranges[k] = 0.2;
    shot.tags[k] = k % 2 == 0 ? SF_TAG_END : SF_TAG_MOVER;
  }
  const EdgeReading r = read_one(kAhead, shot);
  EXPECT_EQ(r.points, 41);
  EXPECT_NEAR(r.distance, 0.5, 1e-12);
}

/// A line behind the sensor along the perpendicular is on the wrong side.
TEST(LaneEdgeFit, EdgeOnTheOtherSideIsOutOfSight) {
  const Settings back{{"perpendicular", {180}}};
  expect_none(read_one(back, wall_ahead(fan_of(back), 0.5)), 61);
}

/// Extrapolation reaches up to ten times the largest range.
TEST(LaneEdgeFit, EdgeBeyondTenTimesTheRangeIsOutOfSight) {
  for (const double degrees : {86.0, 88.0}) {
    const Settings askew{{"perpendicular", {degrees}}};
    const EdgeReading r = read_one(askew, wall_ahead(fan_of(askew), 0.5));
    const double expected = 0.5 / std::cos(degrees * M_PI / 180.0);
    if (expected <= 10.0)
      EXPECT_NEAR(r.distance, expected, 1e-9);
    else
      expect_none(r, 61);
  }
}

/// A few points in front of a line of many do not change it.
TEST(LaneEdgeFit, IgnoresFewOutliers) {
  for (const std::size_t outliers : {1u, 5u, 8u}) {
    Shot shot = wall_ahead(fan_of(kAhead), 0.5);
    for (std::size_t k = 0; k < outliers; ++k)
      shot.ranges[(7 * k + 3) % 61] = 0.2 + 0.03 * static_cast<double>((k * k) % 5);
    const EdgeReading r = read_one(kAhead, shot);
    EXPECT_NEAR(r.distance, 0.5, 1e-9) << outliers;
    EXPECT_EQ(r.points, 61 - static_cast<double>(outliers));
  }
}

TEST(LaneEdgeFit, NearerEdgeWinsWithMoreThanAQuarterOfThePoints) {
  for (const std::size_t near : {8u, 14u, 30u, 50u}) {
    const Shot at_03 = wall_ahead(fan_of(kAhead), 0.3);
    Shot shot = wall_ahead(fan_of(kAhead), 0.5);
    std::copy_n(at_03.ranges.begin(), near, shot.ranges.begin());
    const EdgeReading r = read_one(kAhead, shot);
    EXPECT_NEAR(r.distance, near == 8 ? 0.5 : 0.3, 1e-9) << near;
    EXPECT_EQ(r.points, near == 8 ? 53.0 : static_cast<double>(near));
  }
}

TEST(LaneEdgeFit, SingleRayRangeIsTheReading) {
  for (const double samples : {1.0, 2.0}) {
    const Settings single{{"samples", {samples}}, {"fov", {1}}};
    Shot shot = nothing(fan_of(single));
    expect_none(read_one(single, shot), 0);
    shot.ranges[0] = 0.25;
    shot.tags[0] = SF_TAG_END;  // ends of markings count for a single ray
    EdgeReading r = read_one(single, shot);
    EXPECT_NEAR(r.distance, 0.25, 1e-13);
    EXPECT_EQ(r.points, 1);
    EXPECT_EQ(r.residual, 0.0);
    EXPECT_EQ(r.sigma, 0.0);
    shot.tags[0] = SF_TAG_MOVER;
    expect_none(read_one(single, shot), 0);
    if (samples < 2.0) continue;
    // The second ray is ignored.
    shot = nothing(fan_of(single));
    shot.ranges[1] = 0.25;
    shot.tags[1] = 0;
    expect_none(read_one(single, shot), 0);
  }
}

/// Random input: edges, corners, arcs, noise, no hits, in scans of any size.
Shot anything(const raycast::ScanSettings& fan, Chance& chance) {
  Shot shot = nothing(fan);
  const std::uint32_t what = chance.below(5);
  const double d = chance.between(0.01, 0.8) * fan.range_max;
  const double tilt = chance.between(-1.4, 1.4);
  const double share = chance.between(0.0, 1.0);
  for (std::uint32_t k = 0; k < fan.samples; ++k) {
    const double bearing = bearing_of(fan, k);
    double r = d * std::cos(tilt) / std::cos(bearing - tilt);
    if (what == 1 && chance.between(0.0, 1.0) < share) r *= 1.3;
    if (what == 2) r = chance.between(0.0, 1.0) * fan.range_max;
    if (what == 3) r = d * (1.0 + 0.5 * bearing * bearing);
    if (what == 4 && bearing > 0.0) r = d;
    r += chance.below(2) == 0 ? 0.0 : chance.between(-0.004, 0.004);
    if (!(r > 0.0 && r < fan.range_max) || chance.below(12) == 0) continue;
    shot.ranges[k] = r;
    const std::uint32_t flags = chance.below(10) == 0 ? SF_TAG_END : chance.below(15) == 0 ? SF_TAG_MOVER : 0u;
    shot.tags[k] = (chance.below(3) << SF_TAG_BITS) | flags;
  }
  return shot;
}

TEST(LaneEdgeFit, HostIsBitIdentical) {
  Chance chance(17);
  std::vector<Settings> settings;
  for (int i = 0; i < 3000; ++i) {
    const double samples = i % 7 == 0 ? 1.0 + chance.below(5) : i % 11 == 0 ? chance.below(300) + 3.0 : 61.0;
    Settings s{{"samples", {samples}}, {"fov", {i % 13 == 0 ? 300.0 : chance.between(5.0, 90.0)}}};
    if (i % 3 == 0) s.push_back({"perpendicular", {chance.between(-180.0, 180.0)}});
    if (i % 5 == 0) s.push_back({"noise", {0.003, 0.01, 0.1}});
    if (i % 17 == 0) s.push_back({"range_min", {0.05}});
    settings.push_back(s);
  }
  FitRig rig(settings);
  std::vector<Shot> shots;
  for (const sensors::LaneEdge& edge : rig.edges()) shots.push_back(anything(edge.fan, chance));
  const std::vector<EdgeReading> readings = rig.read(shots);
  std::size_t seen = 0;
  for (std::uint32_t i = 0; i < readings.size(); ++i) {
    const EdgeReading host = rig.on_the_host(i, shots[i]);
    const double device_says[] = {readings[i].distance, readings[i].points, readings[i].residual,
                                  readings[i].sigma,    readings[i].gain,   readings[i].others};
    const double host_says[] = {host.distance, host.points, host.residual, host.sigma, host.gain, host.others};
    for (int c = 0; c < 6; ++c)
      EXPECT_EQ(std::bit_cast<std::uint64_t>(device_says[c]), std::bit_cast<std::uint64_t>(host_says[c]))
          << i << " column " << c << ": " << device_says[c] << " " << host_says[c];
    seen += std::isnan(host.distance) ? 0 : 1;
  }
  EXPECT_GT(seen, readings.size() / 2);
  EXPECT_LT(seen, readings.size());
}

}  // namespace
}  // namespace sf::trial
