// The public interface, as a user's program sees it.

#include "sensorfarm/simulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tests/refusal.h"

namespace sensorfarm {
namespace {

using sf::expect_in, sf::refusal_of;

const std::string kCave = SF_SOURCE_DIR "/worlds/cave.world";

Twist avoid(std::span<const double> ranges) {
  const std::size_t third = ranges.size() / 3;
  const double ahead = *std::min_element(ranges.begin() + third, ranges.end() - third);
  return ahead > 0.5 ? Twist{0.3, 0.0, 0.0} : Twist{0.0, 0.0, 1.0};
}

void drive(Simulation& simulation, int ticks) {
  std::vector<Twist> commands(simulation.size());
  for (int tick = 0; tick < ticks; ++tick) {
    const Readings scans = simulation.readings("laser");
    for (std::size_t i = 0; i < scans.sensors; ++i) commands[scans.robots[i]] = avoid(scans.row(i));
    simulation.step(commands);
  }
}

struct Avoid : Controller {
  Twist step(const Input& input) override { return avoid(input.newest("laser")->values); }
};

TEST(Library, CommandsAndControllersGiveOneHash) {
  add_controller(
      {"test-avoid", "turns away", 10.0, false, [](const Robot&, Settings&) { return std::make_unique<Avoid>(); }});
  Simulation commanded(kCave, {.robots = 30, .seed = 4});
  drive(commanded, 50);
  Simulation driven(kCave, {.robots = 30, .seed = 4, .controller = "test-avoid"});
  for (int i = 0; i < 50; ++i) driven.step();
  EXPECT_EQ(commanded.hash(), driven.hash());
  EXPECT_EQ(commanded.tick(), 50u);
  EXPECT_NEAR(commanded.time(), 5.0, 1e-12);
  Simulation other(kCave, {.robots = 30, .seed = 5});
  drive(other, 50);
  EXPECT_NE(other.hash(), commanded.hash());
}

/// A program's own controller of models, chosen by its name in `ctrl`, moves its model and another one.
TEST(Library, ModelsRunTheProgramsControllers) {
  struct Pusher : ModelController {
    double speed = 0.0;
    void tick(Model& model) override {
      model.set_velocity({speed});
      model.object("tag7").set_pose({5.0, model.pose().x, 0.0, 0.0});
    }
  };
  const ModelEntry entry{"test-pusher", "", [](const ModelSite&, Settings& settings) {
                           auto made = std::make_unique<Pusher>();
                           made->speed = settings.number("speed", 0.1, 0.0, 1.0);
                           return made;
                         }};
  add_model_controller(entry);
  expect_in("a controller 'test-pusher' already exists", refusal_of<Error>([&] { add_model_controller(entry); }));
  Simulation simulation = Simulation::from_text(
      "position( name \"a\" pose [0 3 0 0] )\nmodel( name \"cart\" size [0.1 0.1 1] ctrl \"test-pusher speed=0.5\" )\n"
      "model( name \"tag7\" pose [5 0 0 0] size [0.1 0.1 1] )",
      {});
  for (int i = 0; i < 11; ++i) simulation.step();
  EXPECT_NEAR(simulation.poses()[1].x, 0.55, 1e-9);
  EXPECT_NEAR(simulation.poses()[2].y, 0.5, 1e-9) << "one tick behind";
}

/// Without `Options::controller`, `ctrl` chooses the controller; "none" restores commands.
TEST(Library, RobotsRunTheControllersOfTheirWorldFile) {
  add_controller({"test-keep-on", "drives on", 10.0, false, [](const Robot&, Settings& settings) {
                    struct KeepOn : Controller {
                      double speed = 0.0;
                      Twist step(const Input&) override { return {speed, 0.0, 0.0}; }
                    };
                    auto made = std::make_unique<KeepOn>();
                    made->speed = settings.number("speed", 0.1, 0.0, 1.0);
                    return made;
                  }});
  const std::string text =
      "position( name \"a\" ctrl \"test-keep-on speed=0.5\" ) position( name \"b\" pose [0 5 0 0] )";
  const auto driven = [&](const Options& options) {
    Simulation simulation = Simulation::from_text(text, options);
    for (int i = 0; i < 11; ++i) simulation.step(std::vector<Twist>{{0.2, 0.0, 0.0}, {0.3, 0.0, 0.0}});
    return std::pair(simulation.poses()[0].x, simulation.poses()[1].x);
  };
  EXPECT_NEAR(driven({}).first, 0.55, 0.06);
  EXPECT_NEAR(driven({}).second, 0.33, 0.04);
  EXPECT_NEAR(driven({.controller = "none"}).first, 0.22, 0.03);
  EXPECT_NEAR(driven({.controller = "test-keep-on"}).first, 0.11, 0.02);
  expect_in("given.world:1: 'speed'",
            refusal_of<Error>([] { Simulation::from_text("position( ctrl \"test-keep-on speed=fast\" )"); }));
}

/// Rows, earlier readings and earlier views are unchanged; the new row is read from the next step on.
TEST(Library, RobotsJoinAndLeave) {
  Simulation simulation(kCave, {.robots = 5, .seed = 4}), alone(kCave, {.robots = 5, .seed = 4});
  drive(simulation, 10), drive(alone, 10);
  const Readings before = simulation.readings("laser");
  const std::shared_ptr<const void> memory = simulation.memory();
  const std::span<const Pose> poses = simulation.poses();
  const std::vector<double> ranges(before.row(0).begin(), before.row(0).end());
  const std::string like = simulation.robots()[0].name;
  EXPECT_EQ(simulation.add_robot({"late", like, {1e5, 1e5, 0.0, 0.0}, "", {}}), 5u);
  EXPECT_TRUE(std::equal(ranges.begin(), ranges.end(), before.row(0).begin()));
  EXPECT_EQ(poses.size(), 5u);
  EXPECT_TRUE(std::isfinite(poses[4].x));
  const Readings after = simulation.readings("laser");
  ASSERT_EQ(after.sensors, 6u);
  EXPECT_TRUE(std::equal(ranges.begin(), ranges.end(), after.row(0).begin()));
  EXPECT_TRUE(std::isnan(after.times[5]));
  EXPECT_EQ(simulation.size(), 6u);
  EXPECT_EQ(simulation.robots()[5].name, "late");
  EXPECT_EQ(simulation.poses()[5].x, 1e5);

  drive(simulation, 10), drive(alone, 10);
  const Readings scans = simulation.readings("laser"), expected = alone.readings("laser");
  EXPECT_FALSE(std::isnan(scans.times[5]));
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_TRUE(std::equal(expected.row(i).begin(), expected.row(i).end(), scans.row(i).begin())) << i;

  simulation.remove_robot(5);
  EXPECT_EQ(simulation.present()[5], 0);
  simulation.step(std::vector<Twist>(6));
  EXPECT_TRUE(std::isnan(simulation.poses()[5].x));
  EXPECT_EQ(simulation.readings("laser").fresh[5], 0);
  EXPECT_GT(simulation.image().rgb.size(), 0u);
  EXPECT_THROW(simulation.remove_robot(5), Error);
  EXPECT_THROW(simulation.remove_robot(6), Error);
  EXPECT_THROW(simulation.add_robot({like, like, {}, "", {}}), Error);
  EXPECT_EQ(simulation.add_robot({"late", like, {1e5, 2.0, 0.0, 0.0}, "", {}}), 5u);
  EXPECT_EQ(simulation.present()[5], 1);
  simulation.reset();
  EXPECT_EQ(simulation.size(), 5u);
}

const std::string kLanes = "road( rndf \"" SF_SOURCE_DIR
                           "/worlds/simville/simville.rndf\" )\n"
                           "position( name \"car\" pose [2.4 0.75 0 0] size [0.33 0.33 0.1] laser( samples 9 ) )\n";

TEST(Library, ChangesTheUseOfLanes) {
  Simulation car = Simulation::from_text(kLanes, {.controller = "route", .settings = {{"checkpoints", "1"}}});
  const auto drive_from_start = [&](const std::string& closed) {
    car.reset();
    if (!closed.empty()) car.set_lane(closed, "closed");
    for (int i = 0; i < 50; ++i) car.step();
    return car.poses()[0].x;
  };
  EXPECT_GT(drive_from_start(""), 3.3);
  EXPECT_LT(drive_from_start("1.1"), 2.7) << "it stops in the lane";
  EXPECT_GT(drive_from_start("3.1"), 3.3) << "a reset opened 1.1, and its way does not use 3.1";
  expect_in("did you mean 'closed'?", refusal_of<Error>([&] { car.set_lane("1.1", "close"); }));
  expect_in("has no lane '99.1'", refusal_of<Error>([&] { car.set_lane("99.1", "closed"); }));
  Simulation cave(kCave, {.robots = 1});
  expect_in("has no road network", refusal_of<Error>([&] { cave.set_lane("1.1", "closed"); }));
}

/// A robot whose wheels slip, with and without cameras that see it exactly.
TEST(Library, CamerasPositionRobotsThatLocalizeThemselves) {
  const std::string world =
      "position( name \"a\" size [0.3 0.3 0.1] track 0.25 encoder( slip 0.05 track 0.25 ) laser( samples 9 ) )\n";
  const auto drive_with = [&](const std::string& positioning, int ticks) {
    Simulation robot = Simulation::from_text(
        world, {.controller = "patrol", .settings = {{"points", "0 0 2 1"}}, .positioning = positioning});
    for (int i = 0; i < ticks; ++i) robot.step();
    return robot.poses()[0];
  };
  const Pose seen = drive_with("rate = 10\n", 100), blind = drive_with("", 100);
  EXPECT_LT(std::abs(seen.y - 0.5 * seen.x), 0.05) << "on the line to its point";
  EXPECT_GT(std::abs(blind.y - 0.5 * blind.x), 0.1);
  EXPECT_GT(drive_with("delay = 0.5\n", 5).yaw, 0.0);
  EXPECT_EQ(drive_with("start = \"unknown\"\ndelay = 0.5\n", 5).yaw, 0.0) << "it rests";
  expect_in("positioning:1: unknown key 'sigma'", refusal_of<Error>([&] { drive_with("sigma = 0.01", 1); }));
  expect_in("'start' is 'lost'; expected", refusal_of<Error>([&] { drive_with("start = \"lost\"", 1); }));
}

TEST(Library, SensorsFailAsStated) {
  const std::string world = "position( name \"a\" size [0.3 0.3 0.1] gyro( noise 1 ) )\n";
  const auto rates = [&](const std::string& faults) {
    Simulation robot = Simulation::from_text(world, {.faults = faults});
    std::vector<double> all;
    for (int i = 0; i < 20; ++i) robot.step(), all.push_back(robot.readings("gyro").values[0]);
    return all;
  };
  const auto healthy = rates(""), stuck = rates("[[fault]]\nrobot = '*'\nsensor = 'gyro'\nkind = 'stuck'\nfrom = 1");
  EXPECT_EQ(healthy[8], stuck[8]);
  EXPECT_NE(healthy[18], healthy[19]);
  EXPECT_EQ(stuck[18], stuck[19]);
  expect_in("faults:1: unknown key 'faults'", refusal_of<Error>([&] { rates("[[faults]]\nrobot = 'a'"); }));
  expect_in("faults:1: no robot is called 'b'",
            refusal_of<Error>([&] { rates("[[fault]]\nrobot = 'b'\nsensor = 'gyro'\nkind = 'stuck'"); }));
}

TEST(Library, WithoutMpirunOneRankOwnsAll) {
  Simulation alone(kCave, {.robots = 5});
  Simulation shared(kCave, {.robots = 5, .ranks = true});
  drive(alone, 5), drive(shared, 5);
  EXPECT_EQ(shared.rank(), 0u);
  EXPECT_EQ(shared.ranks(), 1u);
  EXPECT_EQ(std::count(shared.owned().begin(), shared.owned().end(), 1), 5);
  EXPECT_EQ(shared.hash(), alone.hash());
}

TEST(Library, ReadingsAreTheFarmsOwnTable) {
  Simulation simulation(kCave, {.robots = 8});
  const Readings first = simulation.readings("laser");
  EXPECT_EQ(first.sensors, 8u);
  EXPECT_EQ(first.elements, 361u);
  EXPECT_EQ(first.columns, 1u);
  EXPECT_GE(first.stride, 361u);
  EXPECT_TRUE(std::all_of(first.fresh.begin(), first.fresh.end(), [](auto f) { return f == 1; }));
  EXPECT_LT(first.bounds[0], 2e-9);
  EXPECT_EQ(first.bound_without_noise[0], first.bounds[0]);
  EXPECT_EQ(first.sigma[0], 0.0);
  const double before = first.row(7)[180];
  drive(simulation, 3);
  const Readings second = simulation.readings("laser");
  EXPECT_EQ(first.values, second.values) << "no data was copied";
  EXPECT_NE(second.row(7)[180], before);
  // Hits are indices of models.
  EXPECT_LT(second.hits_of(0)[180], simulation.models().size());
}

TEST(Library, SlowerSensorsKeepTheirNewestReading) {
  const std::string text = R"(
    name "slow"
    interval_sim 100
    model( name "wall" pose [2 0 0 0] size [0.1 4 1] )
    position( name "r0" size [0.3 0.3 0.1]
      laser( samples 3 fov 90 rate 5 ) )
  )";
  Simulation simulation = Simulation::from_text(text);
  EXPECT_EQ(simulation.readings("laser").fresh[0], 1);
  const double at_start = simulation.readings("laser").row(0)[1];
  EXPECT_NEAR(at_start, 1.95, 0.2);
  const std::vector<Twist> forward{{0.5, 0.0, 0.0}};
  simulation.step(forward);
  EXPECT_EQ(simulation.readings("laser").fresh[0], 0);
  EXPECT_EQ(simulation.readings("laser").row(0)[1], at_start);
  EXPECT_EQ(simulation.readings("laser").times[0], 0.0);
  simulation.step();
  EXPECT_EQ(simulation.readings("laser").fresh[0], 1);
  EXPECT_NEAR(simulation.readings("laser").row(0)[1], at_start - 0.1, 1e-9);
  EXPECT_NEAR(simulation.poses()[0].x, 0.1, 1e-9);
  EXPECT_NEAR(simulation.velocities()[0].forward, 0.5, 1e-9);
}

TEST(Library, ResetRestarts) {
  Simulation simulation(kCave, {.robots = 5, .seed = 3});
  drive(simulation, 10);
  const std::uint64_t hash = simulation.hash();
  const Pose pose = simulation.poses()[4];
  simulation.reset();
  EXPECT_EQ(simulation.tick(), 0u);
  drive(simulation, 10);
  EXPECT_EQ(simulation.hash(), hash);
  EXPECT_EQ(simulation.poses()[4].x, pose.x);
  simulation.reset(8);
  drive(simulation, 10);
  EXPECT_NE(simulation.hash(), hash);
}

TEST(Library, MemoryOutlivesTheSimulation) {
  std::shared_ptr<const void> memory;
  Readings scans;
  {
    Simulation simulation(kCave, {.robots = 2});
    scans = simulation.readings("laser");
    memory = simulation.memory();
  }
  EXPECT_GT(scans.row(1)[0], 0.0);  // AddressSanitizer checks this read after the end
}

TEST(Library, PlacesRobots) {
  Simulation simulation(kCave, {.robots = 2});
  const Pose pose = simulation.poses()[1];
  simulation.put(0, {pose.x, pose.y + 3.0, pose.z, 1.0});
  EXPECT_EQ(simulation.poses()[0].yaw, 1.0);
  simulation.step();
  EXPECT_NEAR(simulation.poses()[0].y, pose.y + 3.0, 1e-12);
  expect_in("there is no row 2", refusal_of<Error>([&] { simulation.put(2, {}); }));
  expect_in("is not finite", refusal_of<Error>([&] { simulation.put(0, {NAN}); }));
  expect_in("beyond 1e7: (1e+300, 0, 0, 0)", refusal_of<Error>([&] { simulation.put(0, {1e300}); }));
}

/// A tilt turns lidars, lasts while the robot drives, and ends where it is placed level.
TEST(Library, PlacesTiltedRobots) {
  Simulation simulation(SF_SOURCE_DIR "/worlds/lidar.world");
  const auto scan = [&] {
    simulation.step(std::vector<Twist>{{1.0, 0.0, 0.0}, {}});
    const auto row = simulation.readings("lidar").row(0);
    return std::vector<double>(row.begin(), row.end());
  };
  simulation.put(0, {0.5, 0.25, 0.5, 0.0});
  const std::vector<double> level = scan();
  simulation.put7(0, {0.5, 0.25, 0.5, std::cos(0.1), 0.0, std::sin(0.1), 0.0});
  EXPECT_NE(scan(), level);
  const Pose7 driven = simulation.poses7()[0];
  EXPECT_GT(driven.x, 0.55);
  EXPECT_EQ(driven.z, 0.5);
  EXPECT_NEAR(driven.w, std::cos(0.1), 1e-15);
  EXPECT_NEAR(driven.qy, std::sin(0.1), 1e-15);
  simulation.put(0, {0.5, 0.25, 0.5, 0.0});
  EXPECT_EQ(simulation.poses7()[0].qy, 0.0);
  EXPECT_EQ(scan(), level);
  expect_in("the norm 2", refusal_of<Error>([&] { simulation.put7(0, {0, 0, 0, 2}); }));
  expect_in("is not finite", refusal_of<Error>([&] { simulation.put7(0, {NAN, 0, 0, 1}); }));
  simulation.remove_robot(0);
  EXPECT_TRUE(std::isnan(simulation.poses7()[0].w));
}

TEST(Library, RejectsBadInputWithoutChanges) {
  Simulation simulation(kCave, {.robots = 2});
  std::vector<Twist> commands(2);
  simulation.step(commands);
  const std::uint64_t hash = simulation.hash();
  expect_in("1 commands for 2 robots", refusal_of<Error>([&] { simulation.step(std::span(commands).first(1)); }));
  commands[1].turn = INFINITY;
  expect_in("expected finite numbers", refusal_of<Error>([&] { simulation.step(commands); }));
  expect_in("has no sensor of type 'radar'; expected one of: laser",
            refusal_of<Error>([&] { simulation.readings("radar"); }));
  EXPECT_EQ(simulation.hash(), hash);
  EXPECT_EQ(simulation.tick(), 1u);
}

TEST(Library, ErrorsIncludeFileAndLine) {
  expect_in("nowhere.world: no such file", refusal_of<Error>([] { Simulation simulation("nowhere.world"); }));
  expect_in("mine.world:2: ",
            refusal_of<Error>([] { Simulation::from_text("\nposition( size [1\n", {}, "mine.world"); }));
  expect_in("there is no controller 'unknown'",
            refusal_of<Error>([] { Simulation simulation(kCave, {.controller = "unknown"}); }));
  expect_in("there is no caster 'gpu'", refusal_of<Error>([] { Simulation simulation(kCave, {.caster = "gpu"}); }));
  EXPECT_THROW(Simulation(kCave, {.device = "no such device"}), DeviceError);
}

/// They never name options of the command line.
TEST(Library, MessagesNameOptionsOfTheLibrary) {
  const std::vector<std::string> messages{
      refusal_of<DeviceError>([] { Simulation simulation(kCave, {.device = "hots"}); }),
      refusal_of<DeviceError>([] { Simulation simulation(kCave, {.device = "host", .require_vulkan = true}); }),
      refusal_of<Error>([] { Simulation simulation(kCave, {.accuracy = "fast"}); }),
      refusal_of<Error>([] { Simulation simulation(kCave, {.robot_from = "worlds/robots.inc:create"}); })};
  for (const std::string& message : messages) EXPECT_EQ(message.find("--"), std::string::npos) << message;
  expect_in("select another with device", messages[0]);
  expect_in("did you mean 'host'?", messages[0]);
  expect_in("(require_vulkan, SENSORFARM_REQUIRE_VULKAN or caster=\"vulkan\")", messages[1]);
  expect_in("accuracy: there is no accuracy \"fast\"", messages[2]);
  expect_in("expected robots=N, too", messages[3]);
  const std::string noisy = "position( ctrl \"fasr\" ranger( noise [0.1 0 0] sensor( ) ) )";
  const Simulation simulation = Simulation::from_text(noisy);
  ASSERT_EQ(simulation.warnings().size(), 2u);
  for (const std::string& warning : simulation.warnings()) EXPECT_EQ(warning.find("--"), std::string::npos) << warning;
}

TEST(Library, UsesAndClonesARobotOfAnotherFile) {
  const std::string own = SF_SOURCE_DIR "/worlds/simville/simville.world:car";
  const std::string bare = "model( size [9 0.1 1] pose [0 4 0 0] ) model( size [9 0.1 1] pose [0 -4 0 0] )";
  const Simulation one = Simulation::from_text(bare, {.robot_from = own});
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one.robots()[0].name, "car1");
  EXPECT_EQ(Simulation(kCave, {.robots = 3, .robot_from = "worlds/robots.inc:create"}).size(), 3u);
  expect_in("has no robot 'crate'; did you mean 'create'?", refusal_of<Error>([] {
              Simulation simulation(kCave, {.robots = 2, .robot_from = "worlds/robots.inc:crate"});
            }));
  expect_in("expected one of them", refusal_of<Error>([&] {
              Simulation simulation(kCave, {.robots = 2, .of = "roomba1", .robot_from = own});
            }));
}

TEST(Library, WarnsAboutTakenTopicNames) {
  const auto folder = std::filesystem::temp_directory_path() / "sensorfarm_library_names";
  const Simulation simulation =
      Simulation::from_text("position( name \"map\" laser( samples 3 ) )", {.record = folder.string()});
  ASSERT_EQ(simulation.warnings().size(), 1u);
  expect_in("topics: robot 'map' is /map_2", simulation.warnings()[0]);
  std::filesystem::remove_all(folder);
}

TEST(Library, CastersGiveTheSameBytes) {
  Simulation host(kCave, {.robots = 4, .caster = "host"}), vulkan(kCave, {.robots = 4, .caster = "vulkan"});
  drive(host, 5), drive(vulkan, 5);
  EXPECT_EQ(host.hash(), vulkan.hash());
  EXPECT_NE(host.description(), vulkan.description());
}

/// Options accept any name of `--caster`. Readings of the reference caster differ from those of the host.
TEST(Library, AcceptsTheReferenceCaster) {
  Simulation host(kCave, {.robots = 4, .caster = "host"}), reference(kCave, {.robots = 4, .caster = "reference"});
  drive(host, 5), drive(reference, 5);
  expect_in("rays cast by: reference, long double", reference.description());
  EXPECT_NE(host.hash(), reference.hash());
  expect_in("the caster 'reference' intersects every beam with every surface",
            refusal_of<Error>([] { Simulation simulation(kCave, {.robots = 300, .caster = "reference"}); }));
}

TEST(Library, RecordsARun) {
  const auto folder = std::filesystem::temp_directory_path() / "sensorfarm_library_record";
  std::filesystem::remove_all(folder);
  Simulation simulation(kCave, {.robots = 2, .record = folder.string(), .record_readings = true});
  drive(simulation, 3);
  simulation.finish_recording();
  EXPECT_GT(std::filesystem::file_size(folder / "run.mcap"), 10'000u);
  simulation.reset();  // begins the recording again
  drive(simulation, 3);
  simulation.finish_recording();
  EXPECT_GT(std::filesystem::file_size(folder / "run.mcap"), 10'000u);
  std::filesystem::remove_all(folder);
}

TEST(Library, RecordsWithEitherCompression) {
  const auto folder = std::filesystem::temp_directory_path() / "sensorfarm_library_form";
  const auto size = [&](const std::string& compression) {
    std::filesystem::remove_all(folder);
    Simulation simulation(kCave, {.robots = 2, .record = folder.string(), .compression = compression});
    drive(simulation, 30);
    simulation.finish_recording();
    return std::filesystem::file_size(folder / "run.mcap");
  };
  EXPECT_LT(size("zstd") + 5'000, size("none"));
  EXPECT_THROW(size("lz4"), Error);
  std::filesystem::remove_all(folder);
}

TEST(Library, ImageShowsRobotsAtTheirPoses) {
  Simulation simulation(kCave, {.robots = 1});
  const auto at = [&](double x) {
    simulation.put(0, {x, 0.0, 0.0, 0.0});
    return simulation.image({.width = 40, .height = 30, .view = {{-4.0, -3.0, 4.0, 3.0}}});
  };
  const Image there = at(1.0);
  EXPECT_EQ(there.width, 40);
  EXPECT_EQ(there.rgb.size(), 3u * 40u * 30u);
  EXPECT_NE(at(-1.0).rgb, there.rgb);
  EXPECT_EQ(at(1.0).rgb, there.rgb);
  expect_in("40 x 0 pixels; expected 1 to 4096",
            refusal_of<Error>([&] { simulation.image({.width = 40, .height = 0, .view = {}}); }));
}

TEST(Library, FailingControllerEndsTheStepAndNamesTheFirstRobot) {
  struct Fails : Controller {
    Twist step(const Input& input) override {
      if (input.time > 0.15) throw std::runtime_error("had enough");
      return {};
    }
  };
  add_controller({"test-fails", "", 10.0, false, [](const Robot&, Settings&) { return std::make_unique<Fails>(); }});
  Simulation simulation(kCave, {.robots = 40, .threads = 2, .controller = "test-fails"});
  simulation.step();
  expect_in("of robot 'roomba1' failed at 0.200 s: had enough", refusal_of<Error>([&] { simulation.step(); }));
}

/// Views of readings stay valid when an outline changes; as always, their content is that of the next step.
TEST(Library, ShapesChange) {
  const std::string world =
      "shape( name \"crate\" size [1 1 1] color \"red\" )\n"
      "position( name \"a\" size [0.2 0.2 0.2] laser( samples 31 fov 60 range_max 5 ) )\n"
      "model( name \"tag1\" pose [2 0 0 0] size [0.4 0.4 0.5] )\n";
  Simulation simulation = Simulation::from_text(world, {.controller = "none"});
  EXPECT_EQ(simulation.shapes(), std::vector<std::string>{"crate"});
  simulation.step();
  const Readings before = simulation.readings("laser");
  const auto memory = simulation.memory();
  const std::vector<double> seen(before.row(0).begin(), before.row(0).end());
  simulation.set_shape(1, {.shape = "crate"});
  for (int i = 0; i < 2; ++i) simulation.step();
  EXPECT_TRUE(std::isfinite(before.row(0)[15]));
  const auto ahead = [&] { return simulation.readings("laser").row(0)[15]; };
  EXPECT_NEAR(seen[15] - ahead(), 0.3, 1e-9);
  simulation.set_shape(1, {.color = "#00ff00", .size = std::array{2.0, 1.0, 0.5}});
  simulation.step();
  EXPECT_NEAR(seen[15] - ahead(), 0.8, 1e-9);
  const std::size_t green = [&] {
    const Image image = simulation.image({.width = 100, .height = 100});
    std::size_t count = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3)
      count += image.rgb[i] < 60 && image.rgb[i + 1] > 180 && image.rgb[i + 2] < 60;
    return count;
  }();
  EXPECT_GT(green, 20u);
  expect_in("has no shape 'crat'; did you mean 'crate'?",
            refusal_of<Error>([&] { simulation.set_shape(1, {.shape = "crat"}); }));
  EXPECT_EQ(refusal_of<Error>([&] { simulation.set_shape(2, {.shape = "crate"}); }),
            "there is no row 2; expected less than 2");
  expect_in("unknown colour", refusal_of<Error>([&] { simulation.set_shape(1, {.color = "redd"}); }));
  simulation.reset();
  simulation.step();
  EXPECT_EQ(ahead(), seen[15]);
}

}  // namespace
}  // namespace sensorfarm
