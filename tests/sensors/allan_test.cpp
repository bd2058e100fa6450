// Allan deviations of series in closed form, and of the errors of triads over an hour.

#include "sensors/allan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sensors/triad.h"

namespace sf::sensors {
namespace {

TEST(Allan, SimpleSeriesHaveTheirClosedForms) {
  EXPECT_TRUE(allan_deviation(std::vector<double>(3, 1.0), 0.1).empty()) << "too short";
  ASSERT_EQ(allan_deviation(std::vector<double>(4, 1.0), 0.1).size(), 1u) << "just long enough";
  for (const AllanPoint& point : allan_deviation(std::vector<double>(400, 1e6), 0.1)) EXPECT_EQ(point.deviation, 0.0);

  std::vector<double> ramp, alternating;
  for (int i = 0; i < 400; ++i) ramp.push_back(0.25 * i), alternating.push_back(i % 2);
  for (const AllanPoint& point : allan_deviation(ramp, 0.5))
    EXPECT_NEAR(point.deviation, 0.5 * point.time / std::sqrt(2.0), 1e-9) << "a rate of 0.5 a second";
  const auto points = allan_deviation(alternating, 1.0);
  EXPECT_NEAR(points[0].deviation, std::sqrt(0.5), 1e-12) << "successive means differ by 1";
  EXPECT_NEAR(points[1].deviation, 0.0, 1e-12) << "means of two are equal";
  EXPECT_EQ(points.back().time, 98.0) << "of at most a quarter of 400 s";
}

/// Returns the Allan deviations of one axis at rest over an hour.
std::vector<AllanPoint> hour(const TriadErrors& errors, double rate, std::uint64_t seed, int axis) {
  Triad triad(errors, 0.0, 1.0 / rate, {seed, base::RandomStream::instrument_noise},
              {seed, base::RandomStream::instrument_drift}, 0, true);
  std::vector<double> series;
  for (std::uint64_t k = 0; k < static_cast<std::uint64_t>(3600.0 * rate); ++k)
    series.push_back(triad.measure({}, {}, k).values[axis]);
  return allan_deviation(series, 1.0 / rate);
}

TEST(Allan, AnHourOfWhiteNoiseIsAsStated) {
  const TriadErrors errors{.noise = 1e-4, .bias = 1.0};  // a bias does not count
  for (int axis = 0; axis < 3; ++axis)
    for (const AllanPoint& point : hour(errors, 100.0, 1, axis))
      if (point.time <= 10.0) {
        EXPECT_NEAR(point.deviation * std::sqrt(point.time) / 1e-4, 1.0, 0.1) << axis << ": " << point.time;
      }
}

/// Readings hold the bias over their interval, so times of at least five readings are compared.
TEST(Allan, BiasesWanderAsStatedInTheMeanOfAHundredSeeds) {
  const TriadErrors all{.noise = 1e-3, .drift = {1e-3, 1e-4}};
  for (const TriadErrors& errors : {TriadErrors{.drift = {1.0, 0.0}}, TriadErrors{.drift = {0.0, 1.0}}, all}) {
    std::vector<AllanPoint> mean;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
      const auto one = hour(errors, 1.0, seed, static_cast<int>(seed % 3));
      mean.resize(one.size());
      for (std::size_t i = 0; i < one.size(); ++i)
        mean[i] = {one[i].time, mean[i].deviation + one[i].deviation * one[i].deviation / 100.0};
    }
    for (const AllanPoint& point : mean)
      if (point.time >= 5.0) {
        EXPECT_NEAR(std::sqrt(point.deviation / allan_variance(errors, point.time)), 1.0, 0.1) << point.time;
      }
  }
  for (double time = 4.0; time < 1000.0; time *= 2.0)
    EXPECT_NEAR(std::sqrt(allan_variance(DriftSettings{1.0, 0.0}, time)), 0.664, 0.054) << "the floor, " << time;
  EXPECT_DOUBLE_EQ(allan_variance(DriftSettings{0.0, 2.0}, 3.0), 4.0);
}

}  // namespace
}  // namespace sf::sensors
