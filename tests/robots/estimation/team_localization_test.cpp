// Localization by range and bearing: consistency with its own model, independence of the order of arrival, teams,
// unknown landmarks, and agreement of the smoother with the filter.

#include "robots/estimation/team_localization.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include "robots/estimation/chi_square.h"
#include "robots/estimation/team_smoother.h"
#include "tests/instrumented.h"
#include "tests/units.h"

namespace sf::estimation {
namespace {

constexpr PoseCovariance kStartCovariance{1e-4, 0.0, 0.0, 1e-4, 0.0, 1e-4};
const std::vector<glm::dvec2> kLandmarks{{3.0, 0.0}, {0.0, 4.0}, {-3.0, -1.0}, {1.0, -4.0}};

/// White noise and no errors that never average out, so that the covariance is exact up to linearization.
TeamModel white_model() {
  TeamModel model;
  model.delay = 0.1;
  model.jitter = 0.0;
  model.repeat = 0.0;
  model.freedom = 1e9;
  model.range_noise_share = 0.0;
  model.range_noise = 0.05;
  model.turn_blur = 0.0;
  model.target_size = 0.0;
  model.bearing_noise = 0.02;
  model.place_error = model.yaw_error = 0.0;
  return model;
}

struct TeamReading {
  std::int64_t time = 0;
  bool sighting = false;
  std::uint32_t robot = 0, target = 0;
  double a = 0.0, b = 0.0;  ///< range and bearing, or speed and turn rate
};

void add_reading(const TeamReading& r, TeamLocalization& filter) {
  if (r.sighting)
    filter.add_sighting(r.robot, r.time, r.target, r.a, r.b);
  else
    filter.add_odometry(r.robot, r.time, r.a, r.b);
}

/// A simulated run with the errors that the model states, in the order of time.
struct SimulatedTeam {
  std::vector<TeamReading> readings;
  std::vector<std::array<double, 3>> starts;              ///< measured, with kStartCovariance
  std::vector<std::vector<std::array<double, 3>>> truth;  ///< by robot, at each odometry reading
};

constexpr std::int64_t kReadingApart = 50 * kMs;

SimulatedTeam simulate_team(const TeamModel& model, std::uint32_t robots, int steps, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto draw = [&](double sigma) { return sigma * normal(random); };
  struct Body {
    double x, y, yaw, speed_scale, turn_scale, offset, drift;
  };
  std::vector<Body> bodies;
  SimulatedTeam run;
  run.truth.resize(robots);
  for (std::uint32_t r = 0; r < robots; ++r) {
    bodies.push_back({0.5 * r, -0.4 * r, 0.3 * r, model.speed_scale[0] + draw(model.speed_scale[1]),
                      model.turn_scale[0] + draw(model.turn_scale[1]), draw(model.bearing_offset),
                      draw(model.turn_drift[0])});
    run.starts.push_back({bodies[r].x + draw(0.01), bodies[r].y + draw(0.01), bodies[r].yaw + draw(0.01)});
  }
  const double dt = 1e-9 * kReadingApart;
  const int late = static_cast<int>(std::lround(model.delay / dt));
  const auto speeds = [](std::uint32_t r, int k) {
    return k < 0 ? std::array{0.0, 0.0} : std::array{0.15, 0.25 * std::sin(0.02 * k + r)};
  };
  for (int k = 0; k < steps; ++k) {
    const std::int64_t time = kSecond + k * kReadingApart;
    for (std::uint32_t r = 0; r < robots; ++r) {
      Body& b = bodies[r];
      const auto reported = speeds(r, k);
      run.truth[r].push_back({b.x, b.y, b.yaw});
      run.readings.push_back({time, false, r, 0, reported[0], reported[1]});
      if (k % 10 == static_cast<int>(r)) {
        const std::uint32_t targets = robots + static_cast<std::uint32_t>(kLandmarks.size());
        std::uint32_t target = std::uniform_int_distribution(0u, targets - 1u)(random);
        if (target == r) target = robots;
        const glm::dvec2 p =
            target < robots ? glm::dvec2{bodies[target].x, bodies[target].y} : kLandmarks[target - robots];
        const double range = std::hypot(p.x - b.x, p.y - b.y);
        const double bearing = std::atan2(p.y - b.y, p.x - b.x) - b.yaw + b.offset;
        // The timestamp is later than the measurement.
        run.readings.push_back({time + std::llround(1e9 * model.exposure), true, r, target,
                                (1.0 + model.range_scale) * range + draw(model.range_noise),
                                base::wrap_angle(bearing + draw(model.bearing_noise))});
      }
    }
    for (std::uint32_t r = 0; r < robots; ++r) {
      Body& b = bodies[r];
      const auto [v, w] = speeds(r, k - late);
      const bool moves = v != 0.0 || w != 0.0;
      const double turned = (b.turn_scale * w + (moves ? b.drift : 0.0)) * dt, middle = b.yaw + 0.5 * turned;
      const double distance = std::abs(v) * dt, angle = std::abs(w) * dt;
      const double pivot = model.pivot * model.pivot * angle;
      const double along = b.speed_scale * v * dt + draw(std::sqrt(model.along * model.along * distance + pivot));
      const double across = draw(std::sqrt(model.across * model.across * distance + pivot));
      b.x += along * std::cos(middle) - across * std::sin(middle);
      b.y += along * std::sin(middle) + across * std::cos(middle);
      b.yaw += turned + draw(std::sqrt(model.yaw_per_metre * model.yaw_per_metre * distance +
                                       model.yaw_per_radian * model.yaw_per_radian * angle));
      if (!moves) continue;
      const double kept = std::exp(-dt / model.turn_drift[1]);
      b.drift = kept * b.drift + draw(model.turn_drift[0] * std::sqrt(1.0 - kept * kept));
      b.speed_scale += draw(model.scale_drift * std::sqrt(dt));
      b.turn_scale += draw(model.scale_drift * std::sqrt(dt));
    }
  }
  std::stable_sort(run.readings.begin(), run.readings.end(), [](auto& a, auto& b) { return a.time < b.time; });
  return run;
}

Team team_of(const TeamModel& model, std::uint32_t robots, bool mapped = true) {
  Team team{model, robots, {}};
  for (const glm::dvec2& p : kLandmarks) team.landmarks.push_back(mapped ? std::optional(p) : std::nullopt);
  return team;
}

void start_team(const SimulatedTeam& run, TeamLocalization& filter) {
  for (std::uint32_t r = 0; r < run.starts.size(); ++r)
    filter.add_pose(r, kSecond, {run.starts[r][0], run.starts[r][1], 0.0, run.starts[r][2]}, kStartCovariance);
}

/// Squared error of x, y, yaw in units of the covariance; three degrees of freedom.
double team_squared_error(const Estimate& e, const std::array<double, 3>& truth) {
  const double d[3]{e.X_WM.x - truth[0], e.X_WM.y - truth[1], base::wrap_angle(e.X_WM.yaw - truth[2])};
  const auto P = [&](std::size_t i, std::size_t j) { return e.covariance[i * kComponents + j]; };
  const double c00 = P(1, 1) * P(2, 2) - P(1, 2) * P(1, 2), c01 = P(0, 2) * P(1, 2) - P(0, 1) * P(2, 2),
               c02 = P(0, 1) * P(1, 2) - P(0, 2) * P(1, 1), c11 = P(0, 0) * P(2, 2) - P(0, 2) * P(0, 2),
               c12 = P(0, 1) * P(0, 2) - P(0, 0) * P(1, 2), c22 = P(0, 0) * P(1, 1) - P(0, 1) * P(0, 1);
  const double det = P(0, 0) * c00 + P(0, 1) * c01 + P(0, 2) * c02;
  return (d[0] * d[0] * c00 + d[1] * d[1] * c11 + d[2] * d[2] * c22 +
          2.0 * (d[0] * d[1] * c01 + d[0] * d[2] * c02 + d[1] * d[2] * c12)) /
         det;
}

const std::uint64_t kTeamSeeds = instrumented() ? 20 : 1000;
const std::uint64_t kSmoothedSeeds = instrumented() ? 30 : 100;
/// On each side of a band.
const double kTeamTail = instrumented() ? 1e-4 : 0.025;
constexpr int kTeamSteps = 400;

struct ConsistencySums {
  double nees = 0.0, nis = 0.0;
  int nees_degrees = 0, nis_degrees = 0;
};

ConsistencySums consistency_of(const TeamModel& model, std::uint32_t robots) {
  ConsistencySums sums;
  for (std::uint64_t seed = 1; seed <= kTeamSeeds; ++seed) {
    std::mt19937_64 random(seed);
    const SimulatedTeam run = simulate_team(model, robots, kTeamSteps, random);
    TeamLocalization filter(team_of(model, robots));
    start_team(run, filter);
    for (const TeamReading& each : run.readings) add_reading(each, filter);
    const std::int64_t last = kSecond + (kTeamSteps - 1) * kReadingApart;
    // One error per run, since those of one run are correlated.
    sums.nees += team_squared_error(filter.predict(0, last).estimate, run.truth[0].back());
    sums.nees_degrees += 3;
    sums.nis += filter.squared_innovations();
    sums.nis_degrees += 2 * static_cast<int>(filter.counts()[static_cast<std::size_t>(Verdict::used)]);
  }
  return sums;
}

void expect_in_band(double sum, int degrees, const char* what) {
  EXPECT_GE(sum, chi_square_limit(degrees, 1.0 - kTeamTail)) << what << " " << sum / degrees;
  EXPECT_LE(sum, chi_square_limit(degrees, kTeamTail)) << what << " " << sum / degrees;
}

TEST(TeamLocalization, ErrorsAndInnovationsMatchTheirCovariances) {
  for (const std::uint32_t robots : {1u, 3u}) {
    SCOPED_TRACE(robots);
    const ConsistencySums sums = consistency_of(white_model(), robots);
    expect_in_band(sums.nees, sums.nees_degrees, "NEES");
    expect_in_band(sums.nis, sums.nis_degrees, "NIS");
  }
}

/// A filter that assumes a tenth of the noise must fail the same test.
TEST(TeamLocalization, WrongNoiseIsInconsistent) {
  std::mt19937_64 random(1);
  TeamModel wrong = white_model();
  wrong.range_noise *= 0.1;
  double nis = 0.0;
  int degrees = 0;
  const SimulatedTeam run = simulate_team(white_model(), 1, kTeamSteps, random);
  TeamLocalization filter(team_of(wrong, 1));
  start_team(run, filter);
  for (const TeamReading& each : run.readings) add_reading(each, filter);
  nis = filter.squared_innovations();
  degrees = 2 * static_cast<int>(filter.counts()[static_cast<std::size_t>(Verdict::used)]);
  ASSERT_GT(degrees, 20);
  EXPECT_GT(nis, chi_square_limit(degrees, 0.025));
}

std::vector<std::uint64_t> team_bits(const TeamLocalization& filter, std::int64_t time) {
  std::vector<std::uint64_t> all;
  for (std::uint32_t r = 0; r < filter.team().robots; ++r) {
    const Estimate e = filter.predict(r, time).estimate;
    for (const double v : {e.X_WM.x, e.X_WM.y, e.X_WM.yaw}) all.push_back(std::bit_cast<std::uint64_t>(v));
    for (const double v : e.covariance) all.push_back(std::bit_cast<std::uint64_t>(v));
  }
  return all;
}

RC_GTEST_PROP(TeamLocalization, AnyOrderWithinTheWindowGivesTheSameBits, ()) {
  std::mt19937_64 random(*rc::gen::inRange<std::uint64_t>(1, 1000));
  const std::uint32_t robots = *rc::gen::inRange(1u, 4u);
  const SimulatedTeam run = simulate_team(TeamModel{}, robots, 60, random);
  TeamLocalization in_order(team_of({}, robots, *rc::gen::arbitrary<bool>()));
  TeamLocalization shuffled(in_order.team());
  start_team(run, in_order);
  start_team(run, shuffled);
  for (const TeamReading& each : run.readings) add_reading(each, in_order);
  // Readings arrive up to 0.7 s late, and predictions in between change nothing.
  std::vector<std::pair<std::int64_t, TeamReading>> arrivals;
  for (const TeamReading& each : run.readings)
    arrivals.emplace_back(each.time + *rc::gen::inRange<std::int64_t>(0, 700) * kMs, each);
  std::stable_sort(arrivals.begin(), arrivals.end(), [](auto& a, auto& b) { return a.first < b.first; });
  for (const auto& [arrival, each] : arrivals) {
    add_reading(each, shuffled);
    if (*rc::gen::inRange(0, 4) == 0) shuffled.predict(each.robot, arrival);
  }
  const std::int64_t last = kSecond + 60 * kReadingApart;
  RC_ASSERT(team_bits(in_order, last) == team_bits(shuffled, last));
}

double place_error(const Estimate& e, const std::array<double, 3>& truth) {
  return std::hypot(e.X_WM.x - truth[0], e.X_WM.y - truth[1]);
}

TEST(TeamLocalization, UnknownLandmarksAreMapped) {
  double mapped = 0.0, blind = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    const SimulatedTeam run = simulate_team(white_model(), 1, 1200, random);
    TeamLocalization slam(team_of(white_model(), 1, false)), dead_reckoning(Team{white_model(), 1, {}});
    start_team(run, slam);
    start_team(run, dead_reckoning);
    for (const TeamReading& each : run.readings) {
      add_reading(each, slam);
      add_reading(each, dead_reckoning);
    }
    const std::int64_t last = kSecond + 1199 * kReadingApart;
    mapped += place_error(slam.predict(0, last).estimate, run.truth[0].back());
    blind += place_error(dead_reckoning.predict(0, last).estimate, run.truth[0].back());
  }
  EXPECT_LT(mapped, 0.5 * blind);
}

TEST(TeamLocalization, RefusesWhatItCannotUse) {
  TeamLocalization filter(team_of({}, 1));
  EXPECT_EQ(filter.predict(0, kSecond).status, Prediction::Status::none);
  EXPECT_EQ(filter.add_sighting(0, kSecond, 1, 2.0, 0.0), Verdict::no_track) << "no pose yet";
  EXPECT_EQ(filter.add_pose(0, kSecond, {}, {}), Verdict::invalid) << "no covariance";
  EXPECT_EQ(filter.add_pose(0, kSecond, {}, kStartCovariance), Verdict::started);
  EXPECT_EQ(filter.add_sighting(0, kSecond, 9, 2.0, 0.0), Verdict::invalid) << "no such landmark";
  EXPECT_EQ(filter.add_sighting(0, kSecond, 1, -2.0, 0.0), Verdict::invalid);
  EXPECT_EQ(filter.add_sighting(0, kSecond, 1, NAN, 0.0), Verdict::invalid);
  EXPECT_EQ(filter.add_odometry(0, kSecond, NAN, 0.0), Verdict::invalid);
  EXPECT_EQ(filter.add_odometry(1, kSecond, 0.1, 0.0), Verdict::invalid) << "no such robot";
  EXPECT_EQ(filter.add_odometry(0, kSecond, 0.1, 0.0), Verdict::used);
  EXPECT_EQ(filter.add_odometry(0, kSecond, 0.1, 0.0), Verdict::replayed);
  EXPECT_EQ(filter.add_sighting(0, kSecond + 100 * kMs, 1, 3.0, 0.0), Verdict::used);
  EXPECT_EQ(filter.add_sighting(0, kSecond + 200 * kMs, 1, 3.0, M_PI), Verdict::outlier);
}

/// Without odometry the robot may be anywhere.
TEST(TeamLocalization, HeldSpeedsExpire) {
  TeamLocalization filter(team_of({}, 1));
  filter.add_pose(0, kSecond, {}, kStartCovariance);
  filter.add_odometry(0, kSecond, 0.1, 0.0);
  const auto variance = [&](std::int64_t time) { return filter.predict(0, time).estimate.covariance[0]; };
  EXPECT_LT(variance(2 * kSecond), 0.01);
  EXPECT_GT(variance(12 * kSecond), 0.5);
  EXPECT_NEAR(filter.predict(0, 60 * kSecond).estimate.X_WM.x, 0.1 * 1.5 * 0.94, 0.01);
}

TEST(TeamSmoother, EndsWhereTheFilterEndsAndIsMoreAccurateBefore) {
  double filtered = 0.0, smoothed = 0.0, nees = 0.0;
  int degrees = 0;
  const TeamModel model = white_model();
  for (std::uint64_t seed = 1; seed <= kSmoothedSeeds; ++seed) {
    std::mt19937_64 random(seed);
    const SimulatedTeam run = simulate_team(model, 2, 200, random);
    TeamLocalization filter(team_of(model, 2));
    start_team(run, filter);
    TeamReadings readings{{}, {{}, {}}};
    for (std::uint32_t r = 0; r < 2; ++r) {
      const auto& s = run.starts[r];
      readings.events.push_back(start_event(r, kSecond, {s[0], s[1], 0.0, s[2]}, kStartCovariance));
    }
    const std::int64_t middle = kSecond + 100 * kReadingApart, last = kSecond + 199 * kReadingApart;
    Estimate there;
    for (const TeamReading& each : run.readings) {
      add_reading(each, filter);
      if (each.time <= middle) there = filter.predict(0, middle).estimate;
      if (each.sighting)
        readings.events.push_back(sighting_event(model, each.robot, each.time, each.target, each.a, each.b));
      else
        readings.speeds[each.robot].push_back(effective_speeds(model, each.time, each.a, each.b));
    }
    const std::vector<std::vector<std::int64_t>> times{{middle, last}, {last}};
    const auto all = smooth(team_of(model, 2), std::move(readings), times);
    ASSERT_EQ(all[0].size(), 2u);
    ASSERT_EQ(all[1].size(), 1u);
    const Estimate end = filter.predict(1, last).estimate;
    // Equal up to linearization: both advance robots at different times.
    EXPECT_NEAR(all[1][0].X_WM.x, end.X_WM.x, 0.01);
    EXPECT_NEAR(all[1][0].covariance[0], end.covariance[0], 0.05 * end.covariance[0]);
    filtered += place_error(there, run.truth[0][100]);
    smoothed += place_error(all[0][0], run.truth[0][100]);
    nees += team_squared_error(all[0][0], run.truth[0][100]);
    degrees += 3;
  }
  EXPECT_LT(smoothed, 0.95 * filtered);
  expect_in_band(nees, degrees, "NEES of the smoother");
}

}  // namespace
}  // namespace sf::estimation
