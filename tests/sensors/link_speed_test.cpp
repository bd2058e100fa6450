// The derived sensor `link-speed`: links, matching of vehicles, speeds and travel times, loops, validity, and refusals.

#include "sensors/link_speed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

#include "base/time.h"
#include "sensors/derived/derived_sensors.h"
#include "sensors/road_links.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/host_trial.h"
#include "world/stage/build_world.h"

namespace sf::trial {
namespace {

using base::Pose;
using sensors::kLinkSpeedNumbers;

constexpr const char* kTwoLinks = "links 2 link[0] [0 0 20 0] link[1] [20 -1 0 -1] reach 0.4 rate 1 drift 0.01";

/// A post with a link-speed sensor and two cars with receivers, and with derived poses.
world::World probed(const std::string& derived, const std::string& loops = "") {
  return world::build_world("links.world",
                            "define car position( size [0.4 0.2 0.2] velocity_bounds [-2 2 0 0 0 0 -720 720]\n"
                            "gps( rate 2 ) derived( type \"localization\" inputs [\"gps\"] rate 5 ) )\n"
                            "position( name \"post\" size [0.1 0.1 1] pose [0 5 0 0]\n" +
                                loops + "\nderived( type \"link-speed\" " + derived +
                                " )\n)\n"
                                "car( name \"c0\" pose [0 0 0 0] )\ncar( name \"c1\" pose [20 -1 0 180] )\n",
                            {.sensors = sensors::world_file_words()});
}

struct LinkRow {
  double speed, travel_time, valid, speed_variance, covariance, time_variance, age;
};

/// The readings of a drive, one per second. @param at pose of both cars at a time [s]
std::vector<std::vector<LinkRow>> drive(const world::World& world, double duration,
                                        const std::function<std::pair<Pose, Pose>(double)>& at, unsigned threads = 1,
                                        std::uint64_t* hash = nullptr) {
  farm::Farm farm(world, host_device(), {.threads = threads});
  farm.subscribe(0, base::only(sensors::kLinkSpeed));
  std::vector<base::Report> states = robots::states_at_load(world);
  std::vector<std::vector<LinkRow>> all;
  for (int tick = 0; 0.1 * tick <= duration + 1e-9; ++tick) {
    std::tie(states[1].X_WM, states[2].X_WM) = at(0.1 * tick);
    for (const base::ReadingBlock& block : farm.tick(base::nanoseconds(0.1 * tick), states)) {
      std::vector<LinkRow>& rows = all.emplace_back();
      for (std::size_t i = 0; i < block.values.size(); i += kLinkSpeedNumbers) {
        const double* v = block.values.data() + i;
        rows.push_back({v[0], v[1], v[2], v[3], v[4], v[5], v[6]});
      }
    }
  }
  if (hash != nullptr) *hash = farm.hash();
  return all;
}

std::pair<Pose, Pose> both(double t) { return {{0.5 * t, 0, 0, 0}, {20 - 0.25 * t, -1, 0, M_PI}}; }

TEST(LinkSpeedSensor, StatesSpeedsAndTravelTimes) {
  for (const char* input : {"*/gps", "*/localization"}) {
    const auto all = drive(probed(std::string("inputs [\"") + input + "\"] route [0 1] " + kTwoLinks), 20.0, both);
    ASSERT_EQ(all.size(), 21u) << input;
    EXPECT_EQ(all[0][0].valid, 0.0) << "no report yet";
    EXPECT_TRUE(std::isnan(all[0][0].speed) && std::isnan(all[0][0].travel_time) && std::isnan(all[0][0].age));
    const std::vector<LinkRow>& last = all.back();
    ASSERT_EQ(last.size(), 3u);
    EXPECT_NEAR(last[0].speed, 0.5, 0.02) << input;
    EXPECT_NEAR(last[1].speed, 0.25, 0.02) << input;
    EXPECT_NEAR(last[0].travel_time, 20.0 / last[0].speed, 1e-9);
    EXPECT_NEAR(last[2].travel_time, last[0].travel_time + last[1].travel_time, 1e-9) << "the route";
    EXPECT_NEAR(last[2].speed, 40.0 / last[2].travel_time, 1e-9);
    EXPECT_NEAR(last[2].time_variance, last[0].time_variance + last[1].time_variance, 1e-9);
    for (const LinkRow& row : last) {
      EXPECT_EQ(row.valid, 1.0);
      EXPECT_LT(row.age, 1.0);
      EXPECT_GT(row.speed_variance, 0.0);
      EXPECT_NEAR(row.covariance * row.covariance, row.speed_variance * row.time_variance, 1e-9)
          << "one is a function of the other";
    }
  }
}

/// Ways across the ends of links count: a vehicle that never reports twice from one link.
TEST(LinkSpeedSensor, WaysAcrossTheEndOfALinkCount) {
  const auto all = drive(probed("inputs [\"c0/gps\"] hold 100 rate 1 reach 0.5 spread 0.01 links 3\n"
                                "link[0] [0 0 1 0] link[1] [1 0 1.9 0] link[2] [2.1 0 3.2 0]"),
                         5.0, [](double t) {
                           return std::pair{Pose{1.6 * t - 1.6, 0, 0, 0}, Pose{50, 50, 0, 0}};
                         });
  for (const LinkRow& row : all.back()) EXPECT_NEAR(row.speed, 1.6, 1e-6);
}

TEST(LinkSpeedSensor, ALinkWithoutReportsBecomesInvalid) {
  const auto all = drive(probed(std::string("inputs [\"*/gps\"] hold 5 route [0 1] ") + kTwoLinks), 20.0, [](double t) {
    const auto [a, b] = both(t);
    return std::pair{t < 5.0 ? a : Pose{a.x, 50, 0, 0}, b};
  });
  EXPECT_EQ(all[9][0].valid, 1.0);
  EXPECT_NEAR(all[9][0].age, 4.5, 1e-9) << "since the last report on it";
  EXPECT_EQ(all[11][0].valid, 0.0);
  EXPECT_TRUE(std::isnan(all[11][0].speed));
  EXPECT_NEAR(all[11][0].age, 6.5, 1e-9);
  EXPECT_EQ(all[11][1].valid, 1.0);
  EXPECT_EQ(all[11][2].valid, 0.0) << "a route needs all its links";
}

TEST(LinkSpeedSensor, VehiclesInTheOtherDirectionDoNotCount) {
  const auto all = drive(probed(std::string("inputs [\"*/gps\"] ") + kTwoLinks), 10.0, [](double t) {
    return std::pair{Pose{19 - 0.5 * t, 0.1, 0, M_PI}, Pose{50, 50, 0, 0}};
  });
  EXPECT_EQ(all.back()[0].valid, 0.0);
  EXPECT_EQ(all.back()[1].valid, 0.0);
}

TEST(LinkSpeedSensor, StandingVehiclesAreReportsOfNoSpeed) {
  const auto all = drive(probed(std::string("inputs [\"*/gps\"] ") + kTwoLinks + " "), 40.0, [](double t) {
    return std::pair{Pose{0.5 * std::min(t, 5.0), 0, 0, 0}, Pose{50, 50, 0, 0}};
  });
  EXPECT_LT(all.back()[0].speed, 0.1);
  EXPECT_EQ(all.back()[0].valid, 1.0);
  EXPECT_LE(all.back()[0].travel_time, sensors::kLongestTravel);
}

TEST(LinkSpeedSensor, LoopsAloneStateTheirLink) {
  const auto all = drive(probed(std::string("inputs [\"loop\"] hold 100 ") + kTwoLinks,
                                "loop( pose [5 -5 0 0] size [1 0.4] rate 1 ) loop( pose [40 0 0 0] )"),
                         30.0, both);
  EXPECT_EQ(all[8][0].valid, 0.0) << "nothing has passed";
  EXPECT_NEAR(all.back()[0].speed, 0.5, 0.1) << "a spot speed, converted with the stated spread";
  EXPECT_EQ(all.back()[1].valid, 0.0);
}

TEST(LinkSpeedSensor, AVehicleThatStandsOnALoopIsAReport) {
  const auto all = drive(probed(std::string("inputs [\"loop\"] hold 100 ") + kTwoLinks + " correlation 5",
                                "loop( pose [5 -5 0 0] size [1 0.4] rate 1 )"),
                         60.0, [](double t) {
                           return std::pair{Pose{0.5 * std::min(t, 10.0), 0, 0, 0}, Pose{50, 50, 0, 0}};
                         });
  EXPECT_GT(all[12][0].speed, 0.3) << "it may be slow";
  EXPECT_LT(all.back()[0].speed, 0.05);
}

TEST(LinkSpeedSensor, RelocatedVehiclesHaveNotDrivenThere) {
  const auto all = drive(probed(std::string("inputs [\"*/gps\"] ") + kTwoLinks), 10.0, [](double t) {
    return std::pair{Pose{t < 4.95 ? 0.1 * t : 18.0 + 0.1 * (t - 5.0), 0, 0, 0}, Pose{50, 50, 0, 0}};
  });
  for (const auto& rows : all) EXPECT_TRUE(rows[0].valid == 0.0 || rows[0].speed < 0.2) << rows[0].speed;
}

TEST(LinkSpeedSensor, ReadingsAreTheSameForAnyNumberOfThreads) {
  const world::World world = probed(std::string("inputs [\"*/gps\" \"*/localization\" \"loop\"] ") + kTwoLinks,
                                    "loop( pose [5 -5 0 0] size [1 0.4] rate 1 )");
  std::uint64_t one = 0, three = 1;
  drive(world, 20.0, both, 1, &one);
  drive(world, 20.0, both, 3, &three);
  EXPECT_EQ(one, three);
}

/// Nearest places against all points of all links.
TEST(RoadLinks, FindsTheNearestPlaceInTheDirection) {
  Chance chance(4);
  std::vector<sensors::RoadLink> links;
  for (int i = 0; i < 30; ++i) {
    sensors::RoadLink link{std::to_string(i), {chance.in_square(10)}, chance.between(0.2, 2)};
    for (int k = 0; k < 4; ++k) link.points.push_back(link.points.back() + chance.in_square(3));
    links.push_back(link);
  }
  const sensors::RoadLinks all(links);
  int found = 0;
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec2 p = chance.in_square(12);
    const double yaw = chance.between(-4, 4);
    double nearest = HUGE_VAL;
    for (const sensors::RoadLink& link : all.links())
      for (std::size_t k = 0; k + 1 < link.points.size(); ++k) {
        const glm::dvec2 d = link.points[k + 1] - link.points[k];
        if (std::cos(std::atan2(d.y, d.x) - yaw) < 0.5) continue;
        const double distance = world::distance(p, link.points[k], link.points[k + 1]);
        if (distance <= link.reach) nearest = std::min(nearest, distance);
      }
    const auto place = all.find(p, yaw);
    ASSERT_EQ(place.has_value(), std::isfinite(nearest)) << i;
    if (!place) continue;
    ++found;
    const sensors::RoadLink& link = all.links()[place->link];
    const auto k = static_cast<std::size_t>(std::ranges::upper_bound(link.s, place->s) - link.s.begin());
    const std::size_t a = std::min(k, link.s.size() - 1) - 1;
    const glm::dvec2 at =
        glm::mix(link.points[a], link.points[a + 1], (place->s - link.s[a]) / (link.s[a + 1] - link.s[a]));
    EXPECT_NEAR(glm::distance(p, at), nearest, 1e-9) << i;
  }
  EXPECT_GT(found, 300);
}

TEST(RoadLinks, ARingGoesOn) {
  const sensors::RoadLinks ring({{"ring", {{0, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 0.1}}, 0.5}});
  EXPECT_NEAR(ring.driven(0, 39.0, 1.0), 1.9, 1e-9);
  EXPECT_NEAR(ring.driven(0, 1.0, 39.0), -1.9, 1e-9);
  EXPECT_EQ(ring.driven(0, 5.0, 8.0), 3.0);
  const sensors::RoadLinks line({{"line", {{0, 0}, {10, 0}}, 0.5}});
  EXPECT_EQ(line.driven(0, 9.0, 1.0), -8.0);
}

std::string link_refusal(const std::string& derived, const std::string& loops = "") {
  return refusal_of([&] {
    const world::World world = probed("inputs [\"*/gps\"] " + derived, loops);
    const sensors::SensorSet set(world);
    farm::Farm(world, host_device(), {});
  });
}

TEST(LinkSpeedSensor, InvalidSettingsAreRefused) {
  const auto refused = [](const std::string& derived, const std::string& words) {
    const std::string error = link_refusal(derived);
    EXPECT_TRUE(error.starts_with("links.world:")) << error;
    expect_in(words, error);
  };
  EXPECT_EQ(link_refusal(kTwoLinks), "");
  refused("", "expected either 'lanes'");
  refused("lanes \"all\" links 1 link[0] [0 0 1 0]", "expected either 'lanes'");
  refused("lanes \"all\"", "which it does not have");
  refused("links 2 link[0] [0 0 1 0]", "'link[1]' is missing");
  refused("links 1 link[0] [0 0 1 0] link[1] [0 0 1 0]", "beyond 'links 1'");
  refused("links 1 link[0] [0 0 1]", "[x y x y ...]");
  refused("links 1 link[0] [0 0 1 0 1]", "[x y x y ...]");
  refused("links 1 link[0] [1 1 1 1]", "at least two points that differ");
  refused("links 0", "'links' is 0");
  refused("links 1 link[0] [0 0 1 0] route [1]", "numbers of links below 1");
  refused("links 1 link[0] [0 0 1 0] route [0.5]", "numbers of links below 1");
  refused("links 1 link[0] [0 0 1 0] route \"main\"", "there is no link 'main'");
  refused("links 1 link[0] [0 0 1 0] spread 0", "'spread'");
  refused("links 1 link[0] [0 0 1 0] correlation 0", "'correlation'");
  refused("links 1 link[0] [0 0 1 0] hold -1", "'hold'");
  refused("links 1 link[0] [0 0 1 0] reach 0", "'reach'");
  refused("links 1 link[0] [0 0 1 0] rate 0", "'rate'");
}

TEST(LinkSpeedSensor, LoopsOffTheLinksAreRefused) {
  const std::string error = refusal_of([] {
    const world::World world = probed(std::string("inputs [\"loop\"] ") + kTwoLinks, "loop( pose [40 0 0 0] )");
    const sensors::SensorSet set(world);
    sensors::check_derived_sensors(world, set);
  });
  expect_in("none of these loops is on one of its links", error);
}

/// Lanes are those of SimVille's streets.
TEST(LinkSpeedSensor, LanesAreLinks) {
  const auto lanes = [](const std::string& which) {
    return world::build_world("town.world",
                              "road( rndf \"" SF_SOURCE_DIR
                              "/worlds/simville/simville.rndf\" )\nposition( gps( ) derived( type \"link-speed\" "
                              "inputs [\"gps\"] " +
                                  which + " ) )\n",
                              {.sensors = sensors::world_file_words()});
  };
  const sensors::SensorSet some(lanes("lanes [\"2.1\" \"2.2\"] route [\"2.2\" \"2.1\"]"));
  EXPECT_EQ(some.of(sensors::kLinkSpeed, 0)[0].elements, 3u);
  const sensors::SensorSet all(lanes("lanes \"all\""));
  EXPECT_EQ(all.of(sensors::kLinkSpeed, 0)[0].elements, 25u);
  expect_in("has no lane '2.7'", refusal_of([&] { sensors::SensorSet set(lanes("lanes [\"2.7\"]")); }));
  expect_in("'lanes' expects", refusal_of([&] { sensors::SensorSet set(lanes("lanes 2.1")); }));
}

}  // namespace
}  // namespace sf::trial
