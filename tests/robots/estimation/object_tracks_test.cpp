// Tracks of objects: identities, births and deaths, motion, walls, and the consistency of the covariance over 100 seeds
// of a robot whose pose has an error that repeats.

#include "robots/estimation/object_tracks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "base/time.h"

namespace sf::estimation {
namespace {

constexpr double kTrackStep = 0.1;  // [s]
constexpr Spread kSmallError{1e-4, 0.0, 1e-4};

std::int64_t track_time(int step) { return base::nanoseconds(kTrackStep * step); }

TEST(ObjectTracks, KeepIdentitiesOfObjectsThatCross) {
  ObjectTracks tracks({});
  std::uint32_t first = 0, second = 0;
  for (int k = 0; k <= 60; ++k) {
    const double x = -1.5 + 0.05 * k;
    const Observation seen[] = {{.p = {x, 0.3}, .own = kSmallError}, {.p = {-x, -0.3}, .own = kSmallError}};
    tracks.add(track_time(k), std::span(seen));
    tracks.end_old(track_time(k));
    const auto objects = tracks.at(track_time(k));
    if (k < 2) {
      EXPECT_TRUE(objects.empty()) << "not confirmed";
      continue;
    }
    ASSERT_EQ(objects.size(), 2u) << k;
    if (k == 2) first = objects[0].identity, second = objects[1].identity;
    EXPECT_EQ(objects[0].identity, first);
    EXPECT_EQ(objects[1].identity, second);
    EXPECT_NEAR(objects[0].p.x, x, 0.02);
    if (k > 20) {
      EXPECT_TRUE(objects[0].moving && objects[1].moving) << k;
      EXPECT_NEAR(objects[0].v.x, 0.5, 0.1);
      EXPECT_NEAR(objects[1].v.x, -0.5, 0.1);
    }
  }
}

TEST(ObjectTracks, RadialSpeedsAreKnownAtOnceAndTellObjectsApart) {
  ObjectTracks tracks({.speed = 10.0});
  const auto see = [&](int k, double x, double speed) {
    const Observation seen{.p = {x, 0.0}, .own = {0.09, 0.0, 0.09}, .radial = RadialSpeed{{1.0, 0.0}, speed, 0.01}};
    tracks.add(track_time(k), {&seen, 1});
  };
  for (int k = 0; k < 3; ++k) see(k, 1.2 * k, 12.0);
  const auto objects = tracks.at(track_time(2));
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_NEAR(objects[0].v.x, 12.0, 0.15) << "along the line of sight";
  EXPECT_NEAR(objects[0].covariance(2, 2), 0.01 / 3.0, 0.02);
  EXPECT_GT(objects[0].covariance(3, 3), 0.5) << "across it only from positions";
  for (int k = 3; k < 6; ++k) see(k, 1.2 * k, 12.0), see(k, 7.4 - 1.2 * k, -12.0);
  EXPECT_EQ(tracks.at(track_time(5)).size(), 2u) << "where they meet at first, another one drives the other way";
}

TEST(ObjectTracks, EndWithoutObservationsAndAreNumberedAnew) {
  ObjectTracks tracks({.keep = 0.5});
  const Observation seen[] = {{.p = {1.0, 2.0}, .own = kSmallError}};
  for (int k = 0; k < 5; ++k) tracks.add(track_time(k), seen);
  ASSERT_EQ(tracks.at(track_time(4)).size(), 1u);
  EXPECT_FALSE(tracks.at(track_time(4))[0].moving);
  tracks.end_old(track_time(9));
  EXPECT_EQ(tracks.at(track_time(9)).size(), 1u);
  tracks.end_old(track_time(10));
  EXPECT_TRUE(tracks.at(track_time(10)).empty());
  for (int k = 10; k < 15; ++k) tracks.add(track_time(k), seen);
  EXPECT_EQ(tracks.at(track_time(14))[0].identity, 2u);
}

TEST(ObjectTracks, FuseUnlikeObservationsAndKeepTags) {
  ObjectTracks tracks({});
  const Observation scan{.p = {1.0, 0.0}, .own = kSmallError}, sonar{.p = {1.1, 0.1}, .own = {0.04, 0.0, 0.04}},
      tag{.p = {1.02, 0.0}, .own = {4e-4, 0.0, 4e-4}, .tag = 5},
      corner{.p = {1.0, 0.0}, .own = kSmallError, .corner = true};
  for (int k = 0; k < 6; ++k)
    for (const Observation* each : {&scan, &sonar, &tag, &corner}) tracks.add(track_time(k), {each, 1});
  tracks.end_old(track_time(5));
  const auto objects = tracks.at(track_time(5));
  ASSERT_EQ(objects.size(), 2u);
  EXPECT_EQ(objects[0].tag, 5u);
  EXPECT_FALSE(objects[0].corner);
  EXPECT_TRUE(objects[1].corner) << "corners are tracked apart";
  EXPECT_NEAR(objects[0].p.x, 1.0, 0.03);
}

TEST(ObjectTracks, EchoesOnWallsAreNoObjects) {
  ObjectTracks tracks({});
  const Observation on[] = {{.p = {1.0, 0.02}, .own = {0.01, 0.0, 1e-4}}},
                    off[] = {{.p = {1.0, 3.0}, .own = kSmallError}};
  const SeenWall wall{{0.0, 0.0}, {1.0, 0.0}, 2.0, 1e-4}, other{{0.0, 9.0}, {1.0, 0.0}, 2.0, 1e-4};
  for (int k = 0; k < 5; ++k) {
    tracks.add_walls(track_time(k), {k < 3 ? &wall : &other, 1});
    tracks.add(track_time(k), on);
    tracks.add(track_time(k), off);
  }
  const auto objects = tracks.at(track_time(5));
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_NEAR(objects[0].p.y, 3.0, 0.01);
  for (int k = 40; k < 45; ++k) tracks.add(track_time(k), on);
  EXPECT_EQ(tracks.at(track_time(45)).size(), 1u) << "walls are remembered when they are out of sight";
  for (int k = 80; k < 85; ++k) tracks.add(track_time(k), on);
  EXPECT_EQ(tracks.at(track_time(85)).size(), 2u) << "the wall is no longer known";
}

TEST(ObjectTracks, ObjectsAreBehindTheirSurface) {
  ObjectTracks tracks({});
  const SeenWall wall{{0.0, 2.3}, {1.0, 0.0}, 2.0, 1e-4};
  const Observation seen[] = {{.p = {1.0, 2.0}, .to_middle = {0.0, 0.3}, .own = kSmallError}},
                    on_wall[] = {{.p = {-1.0, 2.3}, .to_middle = {0.0, 0.3}, .own = kSmallError}};
  for (int k = 0; k < 5; ++k) {
    tracks.add_walls(track_time(k), {&wall, 1});
    tracks.add(track_time(k), seen);
    tracks.add(track_time(k), on_wall);
  }
  const auto objects = tracks.at(track_time(5));
  ASSERT_EQ(objects.size(), 1u) << "the surface is compared with walls, not the middle";
  EXPECT_NEAR(objects[0].p.y, 2.3, 1e-6);
}

TEST(ObjectTracks, AreBounded) {
  ObjectTracks tracks({});
  std::vector<Observation> many;
  for (int i = 0; i < 1000; ++i) many.push_back({.p = {10.0 * i, 0.0}, .own = kSmallError});
  for (int k = 0; k < 4; ++k) tracks.add(track_time(k), many);
  EXPECT_EQ(tracks.at(track_time(4)).size(), ObjectTracks::kMostTracks);
  EXPECT_EQ(tracks.left_out(), 4u * (1000 - ObjectTracks::kMostTracks));
}

/// Mean squared errors of the position over their covariance, and the stated standard deviation [m].
struct TrackNees {
  double position = 0.0, velocity = 0.0, sigma = 0.0;
};

/// @param drift [m] standard deviation of the pose's error, which changes over about `fades` seconds  @param stated
/// whether its share of the error is stated as repeated
TrackNees track_nees(double drift, bool stated, double fades = 10.0) {
  TrackNees sum;
  int terms = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const base::RandomKey key{seed, base::RandomStream::own_sensors};
    auto normal = [&, n = std::uint32_t{0}]() mutable { return base::random_normal(key, n++)[0]; };
    ObjectTracks tracks({.agility = 0.2});
    glm::dvec2 p{1.0, 1.0}, v{0.3 * normal(), 0.3 * normal()}, bias{drift * normal(), drift * normal()};
    const double own = 0.02, fade = std::exp(-kTrackStep / fades), renew = drift * std::sqrt(1.0 - fade * fade);
    for (int k = 0; k < 150; ++k) {
      const glm::dvec2 kick{0.2 * std::sqrt(kTrackStep) * normal(), 0.2 * std::sqrt(kTrackStep) * normal()};
      p += kTrackStep * (v + 0.5 * kick), v += kick;
      bias = fade * bias + renew * glm::dvec2{normal(), normal()};
      const double repeated = drift * drift, white = own * own + (stated ? 0.0 : repeated);
      const Observation seen{.p = p + bias + own * glm::dvec2{normal(), normal()},
                             .own = {white, 0.0, white},
                             .repeated = {stated ? repeated : 0.0, 0.0, stated ? repeated : 0.0}};
      tracks.add(track_time(k), {&seen, 1});
      const auto objects = tracks.at(track_time(k));
      if (k < 20 || objects.empty()) continue;
      const auto& o = objects[0];
      const auto nees = [&](glm::dvec2 e, std::size_t i) {
        const double a = o.covariance(i, i), b = o.covariance(i, i + 1), c = o.covariance(i + 1, i + 1);
        return (c * e.x * e.x - 2.0 * b * e.x * e.y + a * e.y * e.y) / (a * c - b * b) / 2.0;
      };
      sum.position += nees(o.p - p, 0), sum.velocity += nees(o.v - v, 2);
      sum.sigma += std::sqrt(0.5 * (o.covariance(0, 0) + o.covariance(1, 1)));
      ++terms;
    }
  }
  EXPECT_EQ(terms, 100 * 130);
  return {sum.position / terms, sum.velocity / terms, sum.sigma / terms};
}

TEST(ObjectTracks, CovarianceIsConsistentOver100Seeds) {
  const TrackNees exact = track_nees(0.0, true);
  EXPECT_NEAR(exact.position, 1.0, 0.15);
  EXPECT_NEAR(exact.velocity, 1.0, 0.15);
  for (const double fades : {0.3, 1.0, 3.0, 10.0, 100.0}) {
    const TrackNees biased = track_nees(0.1, true, fades);
    EXPECT_LT(biased.position, 1.1) << fades << " s: never overconfident";
    EXPECT_LT(biased.velocity, 1.2) << fades;
    EXPECT_LT(biased.sigma, 0.2) << fades;
    EXPECT_GT(biased.position, 0.3) << fades << " s: nor useless";
  }
  EXPECT_GT(track_nees(0.1, false).position, 1.5) << "as white noise, the same error would be understated";
}

}  // namespace
}  // namespace sf::estimation
