#include "bench/price.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <fmt/format.h>

#include "base/error.h"
#include "bench/comparison.h"
#include "bench/cost.h"
#include "bench/scans.h"
#include "farm/farm.h"
#include "scenarios/explanation.h"
#include "tests/sensors/scenes.h"

extern char** environ;

namespace sf::bench {

namespace {

using Words = std::vector<std::string>;

constexpr double kMostMiB = 200.0;
constexpr double kMostSeconds = 1.0;
constexpr int kStarts = 7;
constexpr int kTurns = 41;

struct Process {
  double seconds = 0.0;  ///< from before exec to after exit
  double mib = 0.0;      ///< peak resident memory
};

/// Runs the program until it exits and discards its output.
Process run_program(Words words) {
  words.insert(words.begin(), SF_PROGRAM);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int stream : {1, 2}) posix_spawn_file_actions_addopen(&files, stream, "/dev/null", O_WRONLY, 0);
  const double start = now().wall_s;
  pid_t child = 0;
  SF_CHECK(posix_spawn(&child, SF_PROGRAM, &files, nullptr, arguments.data(), environ) == 0, "no program to measure");
  int status = 0;
  rusage usage{};
  SF_CHECK(wait4(child, &status, 0, &usage) == child && status == 0, words[1] + " failed");
  posix_spawn_file_actions_destroy(&files);
  return {now().wall_s - start, static_cast<double>(usage.ru_maxrss) / 1024.0};
}

double median_start(const Words& words) {
  std::vector<double> seconds;
  for (int k = 0; k < kStarts; ++k) seconds.push_back(run_program(words).seconds);
  return median(seconds);
}

std::string simville() { return std::string(SF_SOURCE_DIR) + "/worlds/simville/simville.world"; }

constexpr std::int64_t kPeriod = 100'000'000;  ///< [ns] of a sensor

/// A farm that takes turns with others.
class Turn {
 public:
  Turn(const world::World& world, gpu::Device& device, bool subscribed, std::int64_t interval, bool reuse_unchanged)
      : farm_(world, device, {.reuse_unchanged = reuse_unchanged}), interval_(interval) {
    if (subscribed) farm_.subscribe_all();
    for (int k = 0; k < 4; ++k) tick();
    costs_.clear();
  }
  void tick() {
    const double start = now().wall_s;
    farm_.tick(time_, {});
    time_ += interval_;
    costs_.push_back(now().wall_s - start);
  }
  double ms() const { return 1e3 * median(costs_); }

 private:
  farm::Farm farm_;
  std::int64_t interval_;
  std::int64_t time_ = 0;
  std::vector<double> costs_;
};

/// Measures the same hundred lasers in a cave under several conditions.
void measure_lasers(gpu::Device& device, std::vector<Measurement>& facts) {
  const world::World plain = make_scans("cave", load_cave(), 100, scenes::laser()).world;
  world::World magnets = plain;
  for (int i = 0; i < 10'000; ++i) magnets.magnets.push_back({{0.001 * i - 5.0, 0.0}, 0.0, 1.0, 0.01, 0});
  Turn measured(plain, device, true, kPeriod, false), beside(magnets, device, true, kPeriod, false);
  Turn unsubscribed(plain, device, false, kPeriod, false), standing(plain, device, true, kPeriod, true);
  Turn idle(plain, device, true, 1000, false);
  for (int k = 0; k < kTurns; ++k)
    for (Turn* repeat : {&measured, &beside, &unsubscribed, &standing, &idle}) repeat->tick();
  facts.push_back({"100 lasers of 361 beams, measured", measured.ms(), "ms"});
  facts.push_back({"the same, 10 000 magnets in the world and no magnetometer", beside.ms(), "ms"});
  facts.push_back({"the same, not subscribed", unsubscribed.ms(), "ms"});
  facts.push_back({"the same, not due", idle.ms(), "ms"});
  facts.push_back({"the same, standing without noise", standing.ms(), "ms"});
  // The margin of 0.5 ms allows for variations of short ticks on a shared machine.
  SF_CHECK(beside.ms() < 1.5 * measured.ms() + 0.5, "magnets without magnetometers cost something");
  SF_CHECK(unsubscribed.ms() < 0.1 * measured.ms(), "sensors without subscribers cost something");
  SF_CHECK(idle.ms() < 0.1 * measured.ms(), "sensors that are not due cost something");
  SF_CHECK(standing.ms() < 0.25 * measured.ms(), "sensors that stand cost something");
}

}  // namespace

std::vector<Measurement> measure_program() {
  const Process fifty = run_program({"run", simville(), "--robots", "50", "--duration", "60"});
  const Process town = run_program({"run", simville(), "--duration", "60"});
  const Process none = run_program({"devices"});
  const Words first{"sense", simville(), "--type", "laser"}, tick{"run", simville(), "--duration", "0.1"};
  setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
  const double cold = median_start(first);
  const double all = median_start(tick);
  unsetenv("MESA_SHADER_CACHE_DISABLE");
  const double warm = median_start(first);
  SF_CHECK(fifty.mib < kMostMiB, fmt::format("SimVille with 50 robots takes {:.0f} MiB", fifty.mib));
  SF_CHECK(cold < kMostSeconds, fmt::format("the first reading takes {:.2f} s", cold));
  return {{"SimVille, 50 robots, a minute: most resident", fifty.mib, "MiB"},
          {"SimVille, its own 8 robots, a minute: most resident", town.mib, "MiB"},
          {"the driver alone, listing devices: most resident", none.mib, "MiB"},
          {"from exec to the first reading in SimVille and exit, kernel compiled", cold, "s"},
          {"from exec to the first reading in SimVille and exit, kernel from the driver's cache", warm, "s"},
          {"from exec to the first tick of all of SimVille's sensors and exit, kernels compiled", all, "s"},
          {"the same, kernels from the driver's cache", median_start(tick), "s"},
          {"from exec to exit, --version", median_start({"--version"}), "s"}};
}

std::vector<Measurement> measure_features(gpu::Device& device) {
  std::vector<Measurement> facts;
  const world::World world = world::load_world(simville(), {.sensors = sensors::world_file_words()});
  const scenarios::Explanation e = scenarios::explain(world, device, 1, 0);
  facts.push_back({"SimVille, building the farm", 1e3 * e.build, "ms"});
  facts.push_back({"SimVille, the first tick", 1e3 * e.first, "ms"});
  facts.push_back({"SimVille, none subscribed", 1e3 * e.silent, "ms a tick"});
  for (const scenarios::SensorTypeCost& cost : e.types) {
    const std::string name = fmt::format("SimVille, {} x {} alone", cost.sensors, cost.type);
    facts.push_back({name, 1e3 * cost.tick, "ms a tick"});
    facts.push_back({name + ", tables", static_cast<double>(cost.bytes) / (1 << 20), "MiB"});
  }
  facts.push_back({"SimVille, all subscribed", 1e3 * e.all, "ms a tick"});
  measure_lasers(device, facts);
  return facts;
}

}  // namespace sf::bench
