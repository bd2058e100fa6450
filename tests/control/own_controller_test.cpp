#include "control/own_controllers.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "sensors/sonar.h"
#include "tests/refusal.h"

namespace sf::control {
namespace {

const std::string kPlugin = SF_BINARY_DIR "/test_plugin.so";

world::World one_robot() {
  world::World world;
  world.movers.emplace_back();
  world.movers[0].name = "r0";
  world.movers[0].id = 7;
  world.movers[0].radius = 0.2;
  return world;
}

/// Controller that returns the result of `decide`.
struct Scripted : sensorfarm::Controller {
  explicit Scripted(std::function<sensorfarm::Twist(const sensorfarm::Input&)> d) : decide(std::move(d)) {}
  sensorfarm::Twist step(const sensorfarm::Input& input) override { return decide(input); }
  double radio_range() const override { return 3.0; }
  std::function<sensorfarm::Twist(const sensorfarm::Input&)> decide;
};

/// Adds one controller per name and test program.
std::unique_ptr<Controller> scripted(const world::World& world, const std::string& name,
                                     std::function<sensorfarm::Twist(const sensorfarm::Input&)> decide) {
  if (find_controller(name) == nullptr)
    add_own_controller(
        {name, "", 10.0, false,
         [decide](const sensorfarm::Robot&, sensorfarm::Settings&) { return std::make_unique<Scripted>(decide); }},
        "test");
  return make_controller({world}, {.name = name}).controller;
}

TEST(OwnController, LoadsFromAPluginWithItsRateAndSettings) {
  const world::World world = one_robot();
  const ConfiguredController made = make_controller(
      {world}, {.name = kPlugin + ":test-straight", .settings = {"controller", {{"speed", RawText{"0.5"}, ""}}}});
  EXPECT_EQ(made.rate, 5.0);
  EXPECT_EQ(made.controller->step({}).forward, 0.5);
  // Already loaded: returns the same type, now also by its plain name.
  EXPECT_EQ(find_controller("test-straight"), find_controller(kPlugin + ":test-straight"));
}

/// Drives by the sensor types that a test names.
struct Frugal final : sensorfarm::Controller {
  explicit Frugal(std::optional<std::vector<std::string>> types) : types_(std::move(types)) {}
  sensorfarm::Twist step(const sensorfarm::Input&) override { return {}; }
  std::optional<std::vector<std::string>> sufficient_sensors() const override { return types_; }
  std::optional<std::vector<std::string>> types_;
};

TEST(OwnController, StatesTheSensorsThatSuffice) {
  const world::World world = one_robot();
  const auto needs = [&](std::optional<std::vector<std::string>> types) {
    static int count = 0;
    const std::string name = fmt::format("frugal-{}", count++);
    add_own_controller(
        {name, "", 10.0, false,
         [types](const sensorfarm::Robot&, sensorfarm::Settings&) { return std::make_unique<Frugal>(types); }},
        "test");
    return make_controller({world}, {.name = name}).controller->needs();
  };
  EXPECT_EQ(needs(std::nullopt), Controller::kNeedsFarm);
  EXPECT_EQ(needs({{}}), 0u) << "none";
  EXPECT_EQ(needs({{"laser", "sonar"}}), 1ull << sensors::kLaser | 1ull << sensors::kSonar);
  expect_in("unknown sensor type 'sonra'; did you mean 'sonar'?", refusal_of([&] { needs({{"sonra"}}); }));
}

/// A configured rate overrides it; without a laser there are no scans.
TEST(OwnController, StepsOnScansIfConfigured) {
  world::World world = one_robot();
  const auto on_scans = [&](const char* name, double rate) {
    return make_controller({world}, {.name = name, .rate = rate}).on_scans;
  };
  scripted(world, "at-rate", [](const sensorfarm::Input&) { return sensorfarm::Twist{}; });
  sensorfarm::ControllerEntry entry = *find_controller("at-rate")->entry;
  entry.name = "by-scans";
  entry.on_scans = true;
  add_own_controller(entry, "test");
  EXPECT_FALSE(on_scans("by-scans", 0.0)) << "no laser";
  world.movers[0].sensors.push_back(sensors::laser_sensor({}));
  EXPECT_TRUE(on_scans("by-scans", 0.0));
  EXPECT_FALSE(on_scans("by-scans", 10.0)) << "a configured rate, also the default one";
  EXPECT_FALSE(on_scans("at-rate", 0.0));
  EXPECT_TRUE(on_scans("wander", 0.0));
}

TEST(OwnController, ReadsAndRejectsSettingsLikeBuiltInControllers) {
  const world::World world = one_robot();
  const auto make = [&](const char* key, const char* value) {
    make_controller({world}, {.name = kPlugin + ":test-straight",
                              .settings = {"controller 'x'", {{key, RawText{value}, "here: "}}}});
  };
  expect_in("here: ", refusal_of([&] { make("speed", "3"); }));  // above its upper limit
  expect_in("has no setting 'sped'", refusal_of([&] { make("sped", "1"); }));
}

TEST(OwnController, RejectsPluginFilesWithTheReason) {
  expect_in("cannot be opened", refusal_of([] { find_controller("./nowhere.so"); }));
  const std::string text = std::filesystem::temp_directory_path() / "sensorfarm_no_library.so";
  std::ofstream(text) << "no library";
  expect_in("cannot be loaded as a shared library", refusal_of([&] { find_controller(text); }));
  std::filesystem::remove(text);
  expect_in("is not a plug-in", refusal_of([] { find_controller(SF_BINARY_DIR "/sensorfarm_cairo.so"); }));
  expect_in("build it again", refusal_of([] { find_controller(SF_BINARY_DIR "/test_old_plugin.so"); }));
  expect_in("has several controllers; expected one of: ", refusal_of([] { find_controller(kPlugin); }));
  expect_in(":test-straight", refusal_of([] { find_controller(kPlugin + ":other"); }));
}

TEST(OwnController, PluginListMayContainFoldersAndGaps) {
  load_plugin_list(":" + kPlugin + "::");
  EXPECT_NE(find_controller("test-picky"), nullptr);
  expect_in("nowhere", refusal_of([] { load_plugin_list(kPlugin + ":/nowhere"); }));
}

TEST(OwnController, NamesMustBeNewAndUsable) {
  const auto add = [](const std::string& name, double rate = 10.0) {
    return refusal_of([&] {
      add_own_controller({name, "", rate, true, [](const auto&, auto&) { return nullptr; }}, "mine.so");
    });
  };
  expect_in("mine.so: a controller 'wander' already exists", add("wander"));
  for (const char* name : {"", "none", "a b", "a/b", "a:b", "x.so"}) expect_in("cannot be called", add(name));
  for (const double rate : {0.0, -1.0, 1e5, double{NAN}}) expect_in("a rate of", add("fine", rate));
}

TEST(OwnController, ErrorsNameTheRobot) {
  const world::World world = one_robot();
  expect_in("controller 'test-picky' refuses robot 'r0': robot r0 is not good enough",
            refusal_of([&] { make_controller({world}, {.name = kPlugin + ":test-picky"}); }));
}

TEST(OwnController, ReceivesTheInputsOfTheRobot) {
  world::World world = one_robot();
  world.lights.push_back({.name = "L"});
  sensorfarm::Input seen;
  std::vector<sensorfarm::Reading> readings;
  std::vector<sensorfarm::Neighbour> others;
  std::vector<sensorfarm::Light> lights;
  const auto controller = scripted(world, "looks", [&](const sensorfarm::Input& input) {
    seen = input;
    readings.assign(input.readings.begin(), input.readings.end());
    others.assign(input.others.begin(), input.others.end());
    lights.assign(input.lights.begin(), input.lights.end());
    return sensorfarm::Twist{0.1, 0.2, 0.3};
  });
  EXPECT_EQ(controller->v2v_range(), 3.0);
  const std::vector<double> values{1.0, 2.0};
  base::ReadingBlock block;
  block.type = 1, block.sensor = 2, block.time = 500'000'000, block.values = values, block.bound = 1e-9;
  const base::QualityFlag flags[] = {base::QualityFlag::none, base::QualityFlag::grazing};
  block.bound_without_noise = 2e-9, block.sigma = 0.5, block.quality = flags;
  const Neighbour near{9, {.X_WM = {1, 2, 0, 3}, .velocity = {4, 5, 6}}, {.follows = 7}};
  const world::Signal signal{world::LightState::flashing_yellow, 1.5};
  const base::Twist twist = controller->step({.time = 2'000'000'000,
                                              .state = {.X_WM = {5, 6, 7, 8}, .velocity = {1, 0, 2}},
                                              .readings = {&block, 1},
                                              .contact = true,
                                              .started = true,
                                              .others = {&near, 1},
                                              .signals = {&signal, 1}});
  EXPECT_EQ(twist.forward, 0.1);
  EXPECT_EQ(twist.left, 0.2);
  EXPECT_EQ(twist.turn, 0.3);
  EXPECT_EQ(seen.time, 2.0);
  EXPECT_EQ(seen.pose.z, 7.0);
  EXPECT_EQ(seen.velocity.turn, 2.0);
  EXPECT_TRUE(seen.contact);
  ASSERT_EQ(readings.size(), 1u);
  EXPECT_EQ(readings[0].type, "laser");
  EXPECT_EQ(readings[0].number, 2u);
  EXPECT_EQ(readings[0].time, 0.5);
  EXPECT_EQ(readings[0].values.data(), values.data());
  EXPECT_EQ(readings[0].bound, 1e-9);
  EXPECT_EQ(readings[0].bound_without_noise, 2e-9);
  EXPECT_EQ(readings[0].sigma, 0.5);
  EXPECT_EQ(std::vector(readings[0].flags.begin(), readings[0].flags.end()), (std::vector<std::uint8_t>{0, 2}));
  ASSERT_EQ(others.size(), 1u);
  EXPECT_EQ(others[0].id, 9u);
  EXPECT_EQ(others[0].pose.y, 2.0);
  EXPECT_EQ(others[0].velocity.turn, 6.0);
  EXPECT_EQ(others[0].follows, 7u);
  ASSERT_EQ(lights.size(), 1u);
  EXPECT_EQ(lights[0].name, "L");
  EXPECT_EQ(lights[0].state, sensorfarm::LightState::flashing_yellow);
  EXPECT_EQ(lights[0].left, 1.5);
}

TEST(OwnController, FailuresNameRobotAndTime) {
  const world::World world = one_robot();
  const auto nan = scripted(world, "nan", [](const auto&) { return sensorfarm::Twist{NAN}; });
  expect_in("controller 'nan' of robot 'r0' failed at 1.500 s: its twist is (nan, 0, 0); expected finite numbers",
            refusal_of([&] { nan->step({.time = 1'500'000'000}); }));
  const auto throws =
      scripted(world, "throws", [](const auto&) -> sensorfarm::Twist { throw std::out_of_range("off"); });
  expect_in("failed at 0.000 s: off", refusal_of([&] { throws->step({}); }));
  const auto odd = scripted(world, "odd", [](const auto&) -> sensorfarm::Twist { throw 1; });
  expect_in("not a std::exception", refusal_of([&] { odd->step({}); }));
}

}  // namespace
}  // namespace sf::control
