// One emulated real robot and two virtual ones (examples/rave), by the packets that they exchange with a service, each
// on its own clock. All clocks are the test's.

#include <array>
#include <cmath>

#include "server/emulated_drive.h"
#include "tests/refusal.h"
#include "tests/server/fixture.h"

namespace sf::server {
namespace {

constexpr std::int64_t kMove = 10'000'000;  // [ns]
constexpr double kRadius = 0.165;           // [m] of a Create
constexpr std::uint64_t kRuns = 10;

world::World load(const std::string& name) {
  return world::load_world(SF_SOURCE_DIR "/examples/rave/" + name, {.sensors = sensors::world_file_words()});
}

double distance_to(const world::Segment& wall, glm::dvec2 p) {
  const glm::dvec2 along = wall.b - wall.a;
  const double share = std::clamp(glm::dot(p - wall.a, along) / glm::dot(along, along), 0.0, 1.0);
  return glm::length(p - wall.a - share * along);
}

/// [m] from the outline of a Create to the nearest wall.
double clearance(const world::World& world, const base::Pose& X_WR) {
  double least = HUGE_VAL;
  for (const world::Segment& wall : world.walls) least = std::min(least, distance_to(wall, {X_WR.x, X_WR.y}));
  return least - kRadius;
}

/// The least distances of a run [m].
struct Least {
  double to_real = HUGE_VAL, to_virtual = HUGE_VAL;  ///< of the real robot to walls of both worlds
  double virtual_to_virtual = HUGE_VAL;              ///< of virtual robots to walls of their world
  double virtual_to_real = HUGE_VAL;                 ///< and of the real one
  double between = HUGE_VAL;                         ///< between robots

  void take(const Least& other) {
    to_real = std::min(to_real, other.to_real), to_virtual = std::min(to_virtual, other.to_virtual);
    virtual_to_virtual = std::min(virtual_to_virtual, other.virtual_to_virtual);
    virtual_to_real = std::min(virtual_to_real, other.virtual_to_real);
    between = std::min(between, other.between);
  }
};

struct Rave {
  explicit Rave(std::uint64_t seed, bool shares = true)
      : f({.world = load("virtual.world")}), real(std::make_shared<world::World>(load("real.world"))) {
    f.client.reset();
    for (std::uint32_t row = 0; row < 3; ++row) {
      RobotClientOptions options{.seed = 10 * seed + row, .log_descriptor = f.log.descriptor()};
      options.link.farm = {netio::kLoopback, f.service->port()};
      options.controller.name = "wander";
      options.controller.settings =
          control::Settings("controller 'wander'", {{"speed", 0.2, ""}, {"check_sweep", true, ""}});
      options.shares_readings = shares;
      if (row == 0) options.real = RealRobotOptions{.type = "emulated", .device = "real", .world = real};
      clients[row] = std::make_unique<RobotClient>(f.world, f.sensor_set, row, f.layout, options);
    }
    offset = static_cast<std::int64_t>(97 * seed) * 1'000'000'000;
  }
  /// The real robot's clock gains 200 us per second. Each clock starts with its process, that of the farm first.
  std::int64_t clock(std::uint32_t row) const { return row == 0 ? t + t / 5000 : t + row * 123'456'789; }
  base::Pose pose(std::uint32_t row) const {
    const auto* drive = dynamic_cast<const EmulatedDrive*>(clients[row]->real());
    return drive != nullptr ? drive->truth().X_WM : clients[row]->stats().pose;
  }
  void run(std::int64_t until) {
    for (; t < until; t += kMove) {
      for (std::uint32_t row = 0; row < 3; ++row) {
        const std::int64_t now = clock(row);
        clients[row]->receive(now);
        if (clients[row]->is_due(now))
          clients[row]->step(now);
        else
          clients[row]->move(now);
      }
      if (t % kTick == 0)
        f.service->tick(offset + t);
      else
        f.service->receive_pending(offset + t);
      measure();
    }
  }
  void measure() {
    for (std::uint32_t row = 0; row < 3; ++row) {
      const base::Pose X = pose(row);
      Least one;
      (row == 0 ? one.to_real : one.virtual_to_real) = clearance(*real, X);
      (row == 0 ? one.to_virtual : one.virtual_to_virtual) = clearance(f.world, X);
      for (std::uint32_t other = 0; other < row; ++other) {
        const base::Pose Y = pose(other);
        one.between = std::min(one.between, std::hypot(X.x - Y.x, X.y - Y.y) - 2.0 * kRadius);
      }
      least.take(one);
    }
  }
  std::uint64_t contacts() const {
    std::uint64_t all = 0;
    for (const auto& client : clients) all += client->stats().contacts;
    return all;
  }

  Fixture f;
  std::shared_ptr<world::World> real;
  std::array<std::unique_ptr<RobotClient>, 3> clients;
  std::int64_t offset = 0;  ///< [ns] of the farm's clock
  std::int64_t t = 0;       ///< [ns] since the start of the robots
  Least least;
};

/// Runs of one minute. Controller and speed were chosen on seeds 1 to 3.
TEST(Rave, RobotsOfBothWorldsAvoidEachOtherAndWalls) {
  Least least;
  double driven = 0.0;
  FusionCounts all;
  for (std::uint64_t seed = 11; seed < 11 + kRuns; ++seed) {
    Rave rave(seed);
    rave.run(60'000'000'000);
    EXPECT_EQ(rave.contacts(), 0u) << seed;
    EXPECT_EQ(rave.f.log.read_all(), "") << seed;
    const FusionCounts counts = rave.f.service->stats().fusion;
    EXPECT_EQ(counts.incomplete + counts.unfit + counts.overtaken + counts.mistimed, 0u) << seed;
    EXPECT_GT(counts.fused, 1100u) << "of 1200 readings of its laser and bumper";
    least.take(rave.least);
    all.fused += counts.fused, all.age_s += counts.age_s, all.oldest_s = std::max(all.oldest_s, counts.oldest_s);
    for (const auto& client : rave.clients) driven += client->stats().distance_m;
  }
  std::printf(
      "[ measured ] %d runs, %.1f m driven, least distances [m]: real robot to real walls %.3f, to virtual ones %.3f; "
      "virtual robots to virtual walls %.3f, to real ones %.3f; between robots %.3f; own readings %.1f ms old in the "
      "mean, %.1f at most\n",
      static_cast<int>(kRuns), driven, least.to_real, least.to_virtual, least.virtual_to_virtual, least.virtual_to_real,
      least.between, 1e3 * all.age_s / static_cast<double>(all.fused), 1e3 * all.oldest_s);
  EXPECT_GT(least.to_real, 0.0);
  EXPECT_GT(least.to_virtual, 0.0);
  EXPECT_GT(least.virtual_to_virtual, 0.0);
  EXPECT_GT(least.between, 0.0);
  EXPECT_GT(driven, 30.0 * static_cast<double>(kRuns));
}

// The robot keeps its readings: it drives by whichever reading is newest, and the virtual robots do not know the real
// wall.
TEST(Rave, WithoutFusionRobotsMeetWalls) {
  Least least;
  for (std::uint64_t seed = 11; seed < 11 + kRuns; ++seed) {
    Rave rave(seed, false);
    rave.run(60'000'000'000);
    EXPECT_EQ(rave.f.service->stats().fusion, FusionCounts{});
    least.take(rave.least);
  }
  std::printf(
      "[ measured ] without fusion: real robot to real walls %.3f, to virtual ones %.3f; virtual robots to real "
      "walls %.3f; between robots %.3f\n",
      least.to_real, least.to_virtual, least.virtual_to_real, least.between);
  EXPECT_LT(std::min({least.to_real, least.to_virtual, least.virtual_to_real}), 0.0);
}

TEST(Rave, TheSameSeedGivesTheSameRun) {
  const auto hash = [] {
    Rave rave(4);
    rave.run(20'000'000'000);
    return rave.f.service->stats().hash;
  };
  EXPECT_EQ(hash(), hash());
}

// A real robot must start where the farm's world has it, and be in both.
TEST(Rave, RefusesARealWorldThatDoesNotFit) {
  const auto world = std::make_shared<world::World>(load("real.world"));
  const auto make = [&](const std::string& name, const base::Pose& X_WM) {
    make_real_robot({.type = "emulated", .device = name, .world = world}, X_WM, 0.258);
  };
  const base::Pose start = world->movers[0].X_WM;
  make("real", start);
  EXPECT_NE(refusal_of([&] { make("anna", start); }).find("real.world: the real world has no robot 'anna'"),
            std::string::npos);
  EXPECT_NE(refusal_of([&] {
              make("real", {1.0, start.y, 0.0, start.yaw});
            }).find("starts at [-3 -2 0 20] in the real"),
            std::string::npos);
}

}  // namespace
}  // namespace sf::server
