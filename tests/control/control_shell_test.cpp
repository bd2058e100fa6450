#include "control/control_shell.h"

#include <gtest/gtest.h>

#include "sensors/laser_settings.h"
#include "tests/refusal.h"
#include "tests/robots/scenes.h"

namespace sf::control {
namespace {

// Counts its steps, and is done after a given number of them.
class Counting final : public Controller {
 public:
  explicit Counting(int steps, int& count) : steps_(steps), count_(count) {}
  base::Twist step(const ControllerInput&) override { return {1.0 + ++count_, 0.0, 0.0}; }
  base::Intent intent() const override { return {.follows = 7}; }
  double v2v_range() const override { return 3.0; }
  bool done() const override { return count_ >= steps_; }
  double error() const override { return 0.5; }

 private:
  int steps_;
  int& count_;
};

struct ShellMoment {
  bool contact, started;
  ControlShellState state;
  bool moves;
  const char* why;
};

void live(const ControlShellSettings& settings, std::initializer_list<ShellMoment> moments, int steps = 100) {
  int count = 0;
  ControlShell shell(std::make_unique<Counting>(steps, count), settings);
  EXPECT_EQ(shell.state(), ControlShellState::start);
  std::int64_t time = 0;
  for (const ShellMoment& m : moments) {
    const int before = count;
    const base::Twist twist = shell.step({.time = time += 100, .contact = m.contact, .started = m.started});
    EXPECT_EQ(shell.state(), m.state) << m.why;
    EXPECT_EQ(twist.forward != 0.0, m.moves) << m.why;
    EXPECT_EQ(std::isfinite(shell.error()), count > before) << m.why;
  }
}

constexpr auto kStart = ControlShellState::start, kControl = ControlShellState::control,
               kWait = ControlShellState::wait, kStop = ControlShellState::stop;

TEST(ControlShell, StartsAtOnceOrOnTheSignal) {
  live({.on_signal = false}, {{false, false, kControl, true, "no signal is needed"}});
  live({.on_signal = true}, {{false, false, kStart, false, "no signal yet"},
                             {true, false, kStart, false, "the bumper is not the signal"},
                             {false, true, kControl, true, "the signal"},
                             {false, false, kControl, true, "once is enough"}});
}

TEST(ControlShell, WaitsWhileTheBumperIsPressed) {
  live({}, {{false, true, kControl, true, "free"},
            {true, true, kWait, false, "pressed"},
            {true, true, kWait, false, "still pressed"},
            {false, true, kControl, true, "released: back to the state before"},
            {true, true, kWait, false, "and again"}});
  live({}, {{true, true, kWait, false, "pressed when it starts"}, {false, true, kControl, true, "released"}});
  live({.wait_on_bumper = false}, {{true, true, kControl, true, "it handles contacts itself"}});
}

TEST(ControlShell, StopsPermanentlyWhenTheControllerIsDone) {
  live({},
       {{false, true, kControl, true, "first step"},
        {false, true, kStop, false, "done with the second"},
        {true, true, kStop, false, "a bumper changes nothing"},
        {false, true, kStop, false, "nor does its release"}},
       2);
}

// A controller that states a stop reason.
class Stating final : public Controller, public StatesStopReason {
 public:
  base::Twist step(const ControllerInput&) override { return {}; }
  std::string stop_reason() const override { return "it has one"; }
};

TEST(ControlShell, StatesItsStopReason) {
  ControlShell shell(std::make_unique<Stating>(), {.on_signal = true});
  shell.step({.started = false});
  EXPECT_EQ(stop_reason_of(shell), "the start signal has not arrived");
  shell.step({});
  EXPECT_EQ(stop_reason_of(shell), "it has one");
  shell.step({.contact = true});
  EXPECT_EQ(stop_reason_of(shell), "its bumper is pressed, or its last motion was blocked");
  int count = 0;
  EXPECT_EQ(stop_reason_of(Counting(1, count)), "") << "no stated reason";
}

TEST(ControlShell, ForwardsTheControllersOutputs) {
  int count = 0;
  const ControlShell shell(std::make_unique<Counting>(1, count), {});
  EXPECT_EQ(shell.intent().follows, 7u);
  EXPECT_EQ(shell.v2v_range(), 3.0);
  EXPECT_FALSE(shell.done());
}

// ---- By name.

ControllerConfig config_of(std::string name, std::vector<Setting> settings = {}) {
  return {.name = name, .rate = 0.0, .settings = Settings("controller '" + name + "'", std::move(settings))};
}

world::World shell_world() {
  world::World world = scenes::boxed_world(4, 4);
  world::Mover& robot = scenes::add_create(world, {2, 2, 0, 0});
  robot.sensors.push_back(sensors::laser_sensor({}));
  robot.sensors.push_back({.type = "laneedge"});
  robot.sensors.push_back({.type = "irreceiver"});
  robot.sensors.push_back(scenes::magnetometers(2));
  return world;
}

const ControlShell& made_shell(const ConfiguredController& made) {
  return dynamic_cast<const ControlShell&>(*made.controller);
}

TEST(MakeController, WrapsEveryTypeInAShellWithItsDefaults) {
  const world::World world = shell_world();
  ConfiguredController wander = make_controller({world}, config_of("wander"));
  ConfiguredController avoid = make_controller({world}, config_of("avoid"));
  const ControllerInput pressed{.state = {.X_WM = {2, 2, 0, 0}}, .contact = true};
  wander.controller->step(pressed);
  avoid.controller->step(pressed);
  EXPECT_EQ(made_shell(wander).state(), kControl) << "wander handles contacts itself";
  EXPECT_EQ(made_shell(avoid).state(), kWait);
}

TEST(MakeController, AcceptsTheSettingsOfTheShell) {
  const world::World world = shell_world();
  ConfiguredController made = make_controller(
      {world}, config_of("wander", {{"start", std::string("signal"), ""}, {"wait_on_bumper", true, ""}}));
  made.controller->step({.started = false});
  EXPECT_EQ(made_shell(made).state(), kStart);
  made.controller->step({.contact = true, .started = true});
  EXPECT_EQ(made_shell(made).state(), kWait);
}

std::string refusal(const world::World& world, const ControllerConfig& config) {
  return refusal_of([&] { make_controller({world}, config); });
}

struct Refused {
  const char* controller;
  std::vector<Setting> settings;
  const char* says;
};

TEST(MakeController, NamesTheControllerInErrors) {
  const world::World world = shell_world();
  const std::string at = "s.toml:3: ";
  const std::vector<Refused> cases = {
      {"wanter", {}, "docking, explore, lane-camera, lane-keeping, magnet-keeping, patrol"},
      {"wander", {{"start", std::string("later"), at}}, "s.toml:3: 'start' of controller 'wander' is 'later'"},
      {"wander", {{"wait_on_bumper", 1.0, at}}, "expects true or false"},
      {"wander",
       {{"kp", 1.0, at}},
       "has no setting 'kp'; expected one of: check_sweep, localize, monitor, speed, start, wait_on_bumper"},
      {"wander", {{"localize", true, at}}, "has no encoders; expected encoder( ... )"},
      {"wander", {{"monitor", true, at}}, "'monitor' is for robots that localize themselves"},
      {"lane-keeping", {}, "requires the lane's width"},
      {"lane-keeping", {{"half_width", 0.0, at}}, "'half_width'"},
      {"lane-keeping", {{"half_width", 0.3, at}, {"kp", -1.0, at}}, "s.toml:3: 'kp'"},
      {"lane-keeping", {{"half_width", 0.3, at}, {"speed", 9.0, at}}, "'speed'"},
      {"lane-keeping", {{"half_width", 0.3, at}, {"side", std::string("up"), at}}, "expected one of: left, right"},
      {"magnet-keeping", {{"integral_limit", 0.0, at}}, "'integral_limit'"},
      {"avoid", {{"turn", 0.3, at}, {"clear", 0.2, at}}, "'clear' of controller 'avoid' expects a number from 0.3"},
      {"patrol", {}, "'points' of controller 'patrol' expects pairs"},
      {"patrol", {{"points", std::vector<double>{1, 2, 3}, at}}, "s.toml:3: 'points'"},
      {"patrol", {{"points", std::vector<double>{1, NAN}, at}}, "'points'"},
      {"docking", {}, "the world has none"},
      {"docking", {{"dock", std::string("home"), at}}, "s.toml:3: the world has no dock 'home'"},
      {"explore", {{"map_width", 100.0, at}, {"map_height", 100.0, at}}, "too large"},
      {"explore", {{"margin", 0.01, at}, {"least_margin", 0.02, at}}, "'least_margin'"},
  };
  for (const Refused& refused : cases) {
    SCOPED_TRACE(refused.controller);
    expect_in(refused.says, refusal(world, config_of(refused.controller, refused.settings)));
  }
  world::World bare = scenes::boxed_world(4, 4);
  scenes::add_create(bare, {2, 2, 0, 0});
  const auto says = [&](const char* name, std::vector<Setting> settings = {}) {
    return refusal(bare, config_of(name, std::move(settings)));
  };
  expect_in("has no laser", says("explore"));
  expect_in("has no laser", says("avoid"));
  expect_in("has no lane edge sensor", says("lane-keeping", {{"half_width", 0.2, at}}));
  expect_in("has no magnetometers", says("magnet-keeping"));
  expect_in("has no infrared receiver", says("docking"));
  bare.movers[0].sensors.push_back(scenes::magnetometers(1));
  expect_in("an array of one magnetometer", says("magnet-keeping"));
  bare.movers[0].sensors[0] = scenes::magnetometers(2);  // the fewest that differ
  EXPECT_EQ(says("magnet-keeping"), "");
}

}  // namespace
}  // namespace sf::control
