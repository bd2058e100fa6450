// Models with controllers in a run: the same bytes everywhere, recorded and verified.

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "base/error.h"
#include "control/own_controllers.h"
#include "examples/door/door.cpp"
#include "raycast/casters.h"
#include "record/recorder.h"
#include "record/recording.h"
#include "scenarios/recording_verification.h"
#include "scenarios/run_info.h"
#include "scenarios/scenario.h"
#include "scenarios/simulation.h"
#include "tests/cluster/thread_ranks.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "world/stage/build_world.h"

namespace sf::scenarios {
namespace {

using sensorfarm::Model;
using sensorfarm::ModelContact;

/// What the controller of all models does in the current test.
struct Act {
  std::function<void(Model&)> tick = [](Model&) {};
  std::function<void(const ModelContact&, Model&)> contact = [](const ModelContact&, Model&) {};
};
Act act;

struct ActingModel : sensorfarm::ModelController {
  void tick(Model& model) override { act.tick(model); }
  void contact(const ModelContact& contact, Model& model) override { act.contact(contact, model); }
  double range() const override { return 3.0; }
};

/// Once per process: another test may have loaded a plug-in with model controllers before.
bool add_acts() {
  control::add_own_model_controller({"acts", "", [](const auto&, auto&) { return std::make_unique<ActingModel>(); }},
                                    "test");
  return true;
}

/// Two robots that wander, with sensors between ticks, and two objects, the first `tag3`.
world::World acting_world(const std::string& ctrl = "acts") {
  act = {};
  static const bool added = add_acts();
  static_cast<void>(added);
  const char* const kText = R"(
    interval_sim 100
    define bot position( size [0.3 0.3 0.3] laser( samples 91 fov 270 range_max 6 rate 7 noise [0.01 0 0] )
                         sonar( scount 2 spose[0] [0.1 0 0] spose[1] [-0.1 0 180] range [0 3] fov 20 arrays 1 ) bumper( ) )
    bot( name "r0" ctrl "wander" ) bot( name "r1" pose [-1 1 0 90] ctrl "wander" )
    model( name "room" size [6 6 1] boundary 1 noblocks 1 ) model( name "tag3" pose [2 0 0 0] size [0.3 0.2 1] )
    model( name "tag4" pose [0 -2 0 0] size [0.8 0.1 1] )
    shape( name "post" size [0.1 0.1 1] color "green" )
  )";
  world::World world = world::build_world("acting.world", kText, {.sensors = sensors::world_file_words()});
  for (const std::uint32_t row : control::controlled_models(world)) world.movers[row].controller.clear();
  for (world::Mover& mover : world.movers)
    if (mover.is_tag) mover.controller = ctrl;
  return world;
}

SimulationOptions acting_options(const world::World& world) {
  SimulationOptions options{.seed = 9};
  for (const world::Mover& mover : world.movers) options.actors.push_back({control::controller_of(mover, {}), {}});
  return options;
}

/// Moves, leaves, returns and jumps by random numbers, robots nearby and contacts.
void do_everything() {
  act.tick = [](Model& model) {
    const double draw = model.uniform();
    if (draw < 0.1) model.set_present(!model.present());
    if (draw > 0.95) model.set_pose({2.0 * model.normal(), 1.0, 0.0, 3.0 * draw});
    if (draw > 0.3 && draw < 0.6) {
      const bool near = !model.robots().empty() && model.robots()[0].distance < 1.0;
      model.set_velocity({near ? -0.3 : 0.4, 0.2, model.normal()});
    }
  };
  act.contact = [](const ModelContact& contact, Model& model) {
    model.set_velocity({0.1 * contact.x, 0.3});
    model.object("tag3").set_velocity({0.2, 0.1 * contact.y});
  };
}

std::uint64_t hash_of(SimulationOptions options, gpu::Device& device, const world::World& world) {
  Simulation simulation(world, device, std::move(options));
  for (int tick = 0; tick < 80; ++tick) simulation.step();
  return simulation.farm().hash();
}

TEST(ModelControllers, ThreadsCastersAndDevicesAgree) {
  const world::World world = acting_world();
  do_everything();
  SimulationOptions options = acting_options(world);
  options.threads = 1;
  const std::uint64_t expected = hash_of(options, device(), world);
  options.threads = 3;
  EXPECT_EQ(hash_of(options, device(), world), expected);
  for (const char* caster : {"host", "vulkan"}) {
    options.caster = raycast::caster_named(caster);
    EXPECT_EQ(hash_of(options, device(), world), expected) << caster;
  }
  options.caster = nullptr;
  EXPECT_EQ(hash_of(options, host_device(), world), expected);
  options.seed = 10;
  EXPECT_NE(hash_of(options, device(), world), expected);
  act = {};
  options.seed = 9;
  EXPECT_NE(hash_of(options, device(), world), expected) << "models at rest";
}

TEST(ModelControllers, RecordingsAreVerified) {
  const std::string folder = (std::filesystem::temp_directory_path() / "model_controllers").string();
  const world::World world = acting_world();
  do_everything();
  int absent = 0, moved = 0;
  {
    Simulation simulation(world, device(), acting_options(world));
    record::Recorder recorder(folder,
                              run_info(world, simulation.farm().sensor_set(), {.seed = 9, .record_readings = true}));
    for (int tick = 0; tick < 80; ++tick) {
      const base::TickRecord record = simulation.step();
      absent += base::is_absent(record.reports[2].X_WM);
      moved += record.reports[2].velocity.forward != 0.0;
      recorder.write(record);
    }
    recorder.finish();
  }
  EXPECT_GT(absent, 5);
  EXPECT_GT(moved, 5);
  const Verification v = verify(record::open_recording(folder), device(), {.sample = 0});
  EXPECT_TRUE(v.sound()) << v.reference.first << (v.damage.empty() ? "" : v.damage.front()) << v.missing;
  EXPECT_GT(v.reference.readings, 100u);
}

/// The world of examples/door with its controller, at a closed door.
world::World door_world() {
  static const bool added = [] {
    sensorfarm::Plugin plugin;
    sensorfarm_plugin(plugin);
    return control::add_own_model_controller(plugin.models.at(0), "examples/door") != nullptr;
  }();
  world::World world =
      world::load_world(SF_SOURCE_DIR "/examples/door/door.world",
                        {.controllers = control::controller_names, .sensors = sensors::world_file_words()});
  for (world::Mover& mover : world.movers)
    if (mover.is_tag && added) mover.controller = "door";
  return world;
}

TEST(ModelControllers, ADoorOpensForARobotAndClosesBehindIt) {
  const world::World world = door_world();
  Simulation simulation(world, host_device(), acting_options(world));
  bool opened = false, closed = false;
  for (int tick = 0; tick < 400; ++tick) {
    const base::TickRecord record = simulation.step();
    const double way = record.reports[0].X_WM.y, robot = record.reports[1].X_WM.x;
    EXPECT_EQ(record.contacts[0] + record.contacts[1], 0) << tick;
    EXPECT_TRUE(std::abs(robot - 0.1) > 0.2 || way > 0.9) << "open while the robot passes";
    opened = opened || way > 0.99;
    closed = closed || (robot > 2.0 && std::abs(way) < 1e-9);
  }
  EXPECT_TRUE(opened);
  EXPECT_TRUE(closed);
}

TEST(ModelControllers, ADoorDoesNotCloseOnARobot) {
  world::World world = door_world();
  world.movers[1].controller = "none";
  Simulation simulation(world, host_device(), acting_options(world));
  simulation.step();
  simulation.put(0, {0.1, 1.0, 0.0, M_PI / 2});
  simulation.put(1, {0.1, 0.0, 0.0, 0.0});
  for (int tick = 0; tick < 200; ++tick) {
    const base::TickRecord record = simulation.step();
    EXPECT_NEAR(record.reports[0].X_WM.y, 1.0, 1e-9);
    EXPECT_EQ(record.contacts[0], 0);
  }
  simulation.put(1, {-2.0, 0.0, 0.0, 0.0});
  for (int tick = 0; tick < 60; ++tick) simulation.step();
  EXPECT_NEAR(simulation.step().reports[0].X_WM.y, 0.0, 1e-9);
}

/// A model is stopped by a robot, and told once. Velocities outlast calls; a robot's controller takes precedence, as do
/// commands and removal from outside.
TEST(ModelControllers, ObstaclesStopAModelUntilOthersTakeOver) {
  world::World world = acting_world();
  for (world::Mover& mover : world.movers)
    mover.controller = !mover.is_tag ? "none" : mover.name == "tag3" ? "acts" : "";
  Simulation simulation(world, host_device(), acting_options(world));
  int ticks = 0;
  std::vector<std::string> touched;
  act.tick = [&](Model& model) {
    if (++ticks == 1) model.set_velocity({-1.0});
  };
  act.contact = [&](const ModelContact& contact, Model&) { touched.emplace_back(contact.name); };
  base::TickRecord record = simulation.step();
  EXPECT_EQ(ticks, 0) << "called at the start of the next step";
  for (int tick = 0; tick < 40; ++tick) record = simulation.step();
  EXPECT_EQ(ticks, 40);
  EXPECT_EQ(touched, std::vector<std::string>{"r0"});
  EXPECT_NEAR(record.reports[2].X_WM.x, 0.3, 1e-3) << "at the robot";
  EXPECT_EQ(record.contacts[2], 1);
  simulation.put(2, {2.0, 0.0, 0.0, 0.0});
  simulation.drive(2, {0.5, 0.0, 0.0});
  record = simulation.step();
  EXPECT_NEAR(record.reports[2].X_WM.x, 2.05, 1e-9);
  EXPECT_EQ(ticks, 40) << "the user drives it";

  SimulationOptions options = acting_options(world);
  options.actors[2].controller.name = "avoid";
  options.actors[2].controller.at = "";
  world.movers[2].sensors = world.movers[0].sensors;
  Simulation driven(world, host_device(), options);
  driven.step(), driven.step();
  EXPECT_EQ(ticks, 40) << "a robot's controller drives it";

  Simulation removed(world, host_device(), acting_options(world));
  removed.step(), removed.step();
  EXPECT_EQ(ticks, 41);
  removed.remove_robot(2);
  removed.step();
  EXPECT_EQ(ticks, 41);
}

/// A button, touched by a robot, removes a door that has no controller; `drive` and robots' controllers take
/// precedence.
TEST(ModelControllers, AButtonOpensADoor) {
  world::World world = acting_world();
  for (world::Mover& mover : world.movers)
    mover.controller = !mover.is_tag ? "none" : mover.name == "tag3" ? "acts" : "";
  bool changeable = true;
  act.contact = [](const ModelContact& contact, Model& model) {
    if (contact.robot) model.object("tag4").set_present(false);
  };
  act.tick = [&](Model& model) {
    changeable = model.object("tag4").changeable();
    if (!model.robots().empty()) model.object("tag4").set_velocity({0.5});
  };
  Simulation simulation(world, host_device(), acting_options(world));
  simulation.step();
  simulation.put(0, {1.7, 0.0, 0.0, 0.0});
  base::TickRecord record = simulation.step();
  EXPECT_TRUE(base::is_absent(record.reports[3].X_WM));
  simulation.set_absent(3, false);
  record = simulation.step();
  EXPECT_NEAR(record.reports[3].X_WM.x, 0.05, 1e-9) << "it moves";
  EXPECT_TRUE(changeable);
  simulation.drive(3, {-0.1, 0.0, 0.0});
  record = simulation.step();
  EXPECT_NEAR(record.reports[3].X_WM.x, 0.04, 1e-9) << "the user drives it";
  EXPECT_FALSE(changeable);

  SimulationOptions options = acting_options(world);
  options.actors[3].controller.name = "patrol";
  options.actors[3].controller.settings = control::Settings("patrol", {{"points", control::RawText{"0 -1.9"}, ""}});
  Simulation patrolled(world, host_device(), options);
  patrolled.step(), patrolled.step();
  EXPECT_FALSE(changeable) << "a robot's controller drives it";
}

/// Shapes set by a controller give the bytes of those that the caller sets between the same steps.
TEST(ModelControllers, ChangeShapeSizeAndColour) {
  world::World world = acting_world(), same = acting_world();
  Simulation controlled(world, host_device(), acting_options(world));
  controlled.change_shapes_in(world);
  act.tick = [](Model& model) {
    if (model.pose().x < 1.0) return;  // tag3 only
    if (model.time() > 0.95 && model.time() < 1.05) model.set_shape("post"), model.set_color("#0000ff");
    if (model.time() > 1.95 && model.time() < 2.05) model.set_size(0.5, 1.5, 1.0);
    if (model.time() > 2.95 && model.time() < 3.05) model.set_shape("original");
  };
  for (world::Mover& mover : same.movers)
    if (mover.is_tag) mover.controller.clear();
  Simulation by_hand(same, host_device(), acting_options(same));
  for (int tick = 0; tick < 40; ++tick) {
    if (tick == 11) by_hand.set_shape(same, 2, {.shape = "post", .color = 0xFF0000FFu});
    if (tick == 21) by_hand.set_shape(same, 2, {.size = glm::dvec3{0.5, 1.5, 1.0}});
    if (tick == 31) by_hand.set_shape(same, 2, {.shape = "original"});
    const base::TickRecord one = controlled.step(), other = by_hand.step();
    EXPECT_EQ(one.shapes.size(), other.shapes.size()) << tick;
    EXPECT_EQ(one.shapes.size(), tick % 10 == 1 && tick > 10 ? 1u : 0u) << tick;
    EXPECT_EQ(controlled.farm().hash(), by_hand.farm().hash()) << tick;
  }
  act.tick = [](Model& model) { model.set_shape("pots"); };
  expect_in("controller 'acts' of model 'tag3' failed at 3.900 s: acting.world: has no shape 'pots'",
            refusal_of([&] { controlled.step(); }));
  act.tick = [](Model& model) { model.set_size(0.0, 1.0, 1.0); };
  expect_in("size (0, 1, 1); expected lengths above 0", refusal_of([&] { controlled.step(); }));
  act.tick = [](Model& model) { model.set_color("blurple"); };
  expect_in("controller 'acts' of model 'tag3' failed at 3.900 s: ", refusal_of([&] { controlled.step(); }));
  Simulation fixed(world, host_device(), acting_options(world));
  fixed.step();
  act.tick = [](Model& model) { model.set_shape("post"); };
  expect_in("shape, size and colour cannot change here", refusal_of([&] { fixed.step(); }));
}

TEST(ModelControllers, NoneInAScenarioEndsCtrl) {
  const std::string text = "world = \"../examples/door/door.world\"\n";
  const auto models = [&](const std::string& more) {
    return control::controlled_models(world_of(parse_scenario(SF_SOURCE_DIR "/experiments/test.toml", text + more)));
  };
  EXPECT_EQ(models("").size(), 1u);
  EXPECT_EQ(models("[[robot]]\nname = \"door\"\npose = [0, 1, 0]\n").size(), 1u);
  EXPECT_TRUE(models("[[robot]]\nname = \"door\"\ncontroller = \"none\"\n").empty());
}

TEST(ModelControllers, FailuresEndTheStep) {
  const world::World world = acting_world();
  Simulation simulation(world, host_device(), acting_options(world));
  act.tick = [](Model& model) { model.set_velocity({NAN}); };
  simulation.step();
  expect_in("controller 'acts' of model 'tag3' failed at 0.000 s: set_velocity(nan, 0, 0)",
            refusal_of([&] { simulation.step(); }));
}

TEST(ModelControllers, RanksAreRefused) {
  const world::World world = acting_world();
  cluster::ThreadRanks(2).run([&](cluster::Ranks& rank) {
    SimulationOptions options = acting_options(world);
    options.ranks = &rank;
    gpu::Device own{std::string(gpu::kHostDevice)};
    expect_in("controllers of models cannot run in several ranks; expected a run in one process",
              refusal_of([&] { Simulation(world, own, options); }));
  });
}

}  // namespace
}  // namespace sf::scenarios
