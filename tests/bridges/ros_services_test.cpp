// Every answer of every ROS 2 service.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

#include "tests/bridges/ros_services_fixture.h"

namespace sf::bridges {
namespace {

TEST_F(RosServicesTest, FeaturesAndStates) {
  const std::vector<int> watched{2, 3, 5, 10, 12, 24, 44},
      driven{2, 3, 5, 10, 12, 24, 44, 0, 1, 11, 14, 20, 21, 22, 23, 25, 26, 31, 32, 33, 40, 43, 45, 50};
  for (const bool simulated : {false, true}) {
    std::destroy_at(&services);
    std::construct_at(&services, Scene{world, sensor_set, info, simulated});
    EXPECT_EQ(services.types().size(), simulated ? 27u : 10u);
    Reply features(ask("/get_simulator_features"));
    std::vector<int> all(features.cdr.get_count(2));
    for (int& feature : all) feature = features.cdr.get<std::uint16_t>();
    EXPECT_EQ(all, simulated ? driven : watched);
    EXPECT_EQ(features.cdr.get_count(1), 0u);
    EXPECT_EQ(features.cdr.get_string(), "");
  }
  const auto expect_state = [&](int expected) {
    Reply reply(ask("/get_simulation_state"));
    EXPECT_EQ(reply.cdr.get<std::uint8_t>(), expected);
    EXPECT_EQ(reply.result(), "1 ");
  };
  expect_state(1);
  look(true)();
  expect_state(2);
  EXPECT_EQ(result("/set_simulation_state", state(0), look(true, 1)), "1 ");
  expect_state(0);
  step(true, 1)();
  expect_state(2);
}

TEST_F(RosServicesTest, Entities) {
  step(false)();
  for (const auto& [name, row] : {std::pair{"scout", 0}, {"robot_2", 1}, {"tag", 2}, {"missing", -1}, {"", -1}}) {
    Reply one(ask("/get_entity_state", number(std::string_view(name))));
    const bool present = row == 0 || row == 2;
    EXPECT_EQ(one.result(), present ? "1 " : "2 no entity of that name is present") << name;
    one.expect_state(tick.time, present ? reports[static_cast<std::size_t>(row)] : base::Report{});
  }
  /// Returns result and names of the entities that match a filter, whose states follow.
  const auto filtered = [&](const std::string& pattern, std::uint8_t categories, std::uint8_t tags,
                            std::uint8_t bounds) {
    const Fields filter = [&](record::CdrWriter& cdr) {
      cdr.put(pattern);
      cdr.put_count(categories);
      for (int i = 0; i < categories; ++i) cdr.put(std::uint8_t{1});
      cdr.put_count(tags);
      for (int i = 0; i < tags; ++i) cdr.put("tag");
      cdr.put(std::uint8_t{0});
      cdr.put(bounds);
      cdr.put_count(0);
    };
    Reply plain(ask("/get_entities", filter)), whole(ask("/get_entities_states", filter));
    const std::string text = plain.result(), names = plain.names();
    EXPECT_EQ(whole.result(), text);
    EXPECT_EQ(whole.names(), names);
    const std::uint32_t count = whole.cdr.get_count(8);
    EXPECT_EQ(count, std::count(names.begin(), names.end(), ' ')) << pattern;
    for (std::uint32_t i = 0; i < count; ++i)
      whole.expect_state(tick.time, reports[names.starts_with("tag") ? 2 : 2 * i]);
    return text + names;
  };
  for (const auto& [categories, tags, bounds] : {std::array{1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
    EXPECT_EQ(filtered("", static_cast<std::uint8_t>(categories), static_cast<std::uint8_t>(tags),
                       static_cast<std::uint8_t>(bounds)),
              "0 entities have no categories, tags or bounds");
  for (const std::string& pattern : {std::string(257, '.'), std::string("*a"), std::string("a*"), std::string("a^")})
    EXPECT_EQ(filtered(pattern, 0, 0, 0), "0 a filter consists of up to 256 characters, '.' and \".*\"") << pattern;
  for (const auto& [pattern, names] : {std::pair{"", "scout tag "},
                                       {"^", "scout tag "},
                                       {"$", "scout tag "},
                                       {"^...$", "tag "},
                                       {"^..$", ""},
                                       {"t$", "scout "},
                                       {"s.*t", "scout "},
                                       {"scout.*", "scout "},
                                       {"scout.", ""}})
    EXPECT_EQ(filtered(pattern, 0, 0, 0), std::string("1 ") + names) << pattern;
  EXPECT_EQ(filtered(std::string(256, '.'), 0, 0, 0), "1 ");
}

/// Each request that changes a run, while it is running, paused, or changed by others meanwhile.
TEST_F(RosServicesTest, Changes) {
  EXPECT_EQ(result("/set_simulation_state", state(1)), "101 ") << "plays already";
  EXPECT_FALSE(asked.paused || asked.reset);
  for (const int wanted : {3, 4, 255})
    EXPECT_EQ(result("/set_simulation_state", state(wanted)), "0 expected stopped (0), playing (1) or paused (2)");
  EXPECT_EQ(result("/step_simulation", number(std::uint64_t{1})), "4 the run is not paused");
  EXPECT_EQ(result("/sensorfarm/step"), "0 the run is not paused");
  EXPECT_EQ(result("/set_simulation_state", state(2), look(false)), "4 another user changed the setting");
  EXPECT_EQ(result("/sensorfarm/pause", number(true), look(false)), "0 another user changed the setting");
  EXPECT_EQ(result("/set_simulation_state", state(2), look(true)), "1 ");
  EXPECT_TRUE(asked.paused && *asked.paused && !asked.reset);
  EXPECT_EQ(result("/set_simulation_state", state(2)), "101 ") << "is paused already";
  for (const std::uint64_t steps : {0ull, 1'000'001ull, 1ull << 32, (1ull << 32) + 1}) {
    EXPECT_EQ(result("/step_simulation", number(steps)), "4 expected 1 to 1000000 steps") << steps;
    EXPECT_EQ(asked.steps, 0u);
  }
  EXPECT_EQ(result("/step_simulation", number(std::uint64_t{1'000'000}), look(false)),
            "4 the run continued or restarted");
  EXPECT_EQ(asked.steps, 1'000'000u);
  look(true)();
  EXPECT_EQ(result(
                "/sensorfarm/step", [](auto&) {}, look(true, 1)),
            "0 the run continued or restarted");
  EXPECT_EQ(asked.steps, 1u);
  EXPECT_EQ(result(
                "/sensorfarm/step", [](auto&) {}, step(true, 1)),
            "1 ");
  EXPECT_EQ(result(
                "/sensorfarm/reset", [](auto&) {}, step(true, 2)),
            "1 ");
  EXPECT_TRUE(asked.reset && !asked.paused);
  for (const int scope : {1, 2, 4, 6, 8, 254})
    EXPECT_EQ(result("/reset_simulation", state(scope)),
              "0 time and state can only be reset together: scope 0, 3, 7 or 255");
  EXPECT_EQ(result("/reset_simulation", state(255), step(true, 3)), "1 ");
  EXPECT_EQ(result("/set_simulation_state", state(1), look(false, 3)), "1 ");
  EXPECT_TRUE(asked.paused && !*asked.paused);
}

/// SetEntityState accepts positions and rotations up to their limits and rejects those beyond.
TEST_F(RosServicesTest, PosesUpToTheirLimits) {
  const auto code = [&](double x, double y, double tilt, double length) {
    return result("/set_entity_state",
                  [&](record::CdrWriter& cdr) {
                    cdr.put("scout");
                    record::put_header(cdr, 0, "");
                    for (const double value : {x, y, 0.0, tilt, 0.0, 0.0, std::sqrt(length * length - tilt * tilt)})
                      cdr.put(value);
                    for (int i = 0; i < 12; ++i) cdr.put(0.0);
                  })
        .substr(0, 2);
  };
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(code(sign * 1e7, 0.0, 0.0, 1.0) + code(0.0, sign * 1e7, 0.0, 1.0), "1 1 ");
    EXPECT_EQ(code(sign * 1.0001e7, 0.0, 0.0, 1.0) + code(0.0, sign * 1.0001e7, 0.0, 1.0), "1010");
    EXPECT_EQ(code(0.0, 0.0, sign * 0.99e-3, 1.0) + code(0.0, 0.0, 0.0, 1.0 + sign * 0.99e-3), "1 1 ") << "rounding";
    EXPECT_EQ(code(0.0, 0.0, sign * 1.01e-3, 1.0) + code(0.0, 0.0, 0.0, 1.0 + sign * 1.01e-3), "1 10");
    EXPECT_EQ(code(0.0, 0.0, sign * 0.5, 1.0), "1 ");
    EXPECT_NEAR(asked.placements.back().tilt.roll, sign * M_PI / 3.0, 1e-12);
    EXPECT_EQ(code(0.0, 0.0, sign * 0.99e-6, 1.0), "1 ");
    EXPECT_EQ(asked.placements.back().tilt.roll, 0.0) << "rounding, too";
  }
}

}  // namespace
}  // namespace sf::bridges
