// CPU time per tick that the live view costs the farm's process: a fleet at 30 ticks/s, with and without a reader of
// its states and one robot's readings. The reader is a separate process that only reads bytes, since browser time is
// not measured.
//
//   build/bench/view_cost [ROBOTS] [SECONDS]

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>
#include <thread>

#include "bench/cost.h"
#include "bench/tiles.h"
#include "bench/usage.h"
#include "bridges/viewer.h"
#include "scenarios/run_info.h"
#include "scenarios/simulation.h"
#include "tests/bridges/raw_client.h"
#include "tests/sensors/scenes.h"

namespace sf::bench {

namespace {

constexpr double kRate = 30.0;  // [Hz] of ticks in real time
constexpr int kTurns = 5;       // each with and without a reader

/// Counts of the reader, for the parent's report.
struct Count {
  std::uint64_t messages = 0, bytes = 0;
};

/// Runs a process that reads until the server ends, or the parent closes its end of a pipe. It executes a separate
/// program: pages shared by a fork would be copied when the farm writes to them, at the farm's cost.
class ReaderProcess {
 public:
  ReaderProcess(std::uint16_t port, const std::vector<int>& channels) {
    if (::pipe2(report_, O_CLOEXEC) != 0) std::abort();
    std::vector<std::string> words{"view_cost", "--read", std::to_string(port)};
    for (const int channel : channels) words.push_back(std::to_string(channel));
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, report_[1], STDOUT_FILENO);
    if (::posix_spawn(&child_, "/proc/self/exe", &actions, nullptr, arguments.data(), environ) != 0) std::abort();
    posix_spawn_file_actions_destroy(&actions);
    ::close(report_[1]);
    char ready = 0;
    if (::read(report_[0], &ready, 1) != 1) std::abort();
  }
  /// Ends the process.
  /// @return the number of messages and bytes read
  Count end() {
    ::kill(child_, SIGTERM);
    Count count, next;
    while (::read(report_[0], &next, sizeof(next)) == sizeof(next)) count = next;
    ::close(report_[0]);
    ::waitpid(child_, nullptr, 0);
    return count;
  }

 private:
  int report_[2] = {};
  pid_t child_ = 0;
};

/// The reader's program: prints its counts on standard output.
void read_channels(std::uint16_t port, std::span<char*> channels) {
  bridges::RawClient client(port);
  client.upgrade("foxglove.sdk.v1");
  int id = 1;
  for (const char* channel : channels)
    client.text(fmt::format(R"({{"op":"subscribe","subscriptions":[{{"id":{},"channelId":{}}}]}})", id++, channel));
  client.settle();
  Count count;
  bool written = ::write(STDOUT_FILENO, "r", 1) == 1;
  while (const auto message = client.receive()) {
    ++count.messages;
    count.bytes += message->payload.size();
    written = written && ::write(STDOUT_FILENO, &count, sizeof(count)) == sizeof(count);
  }
}

std::vector<int> channels_of(const record::RunInfo& info) {
  const record::TickMessages messages(info);
  std::vector<int> channels;
  for (std::size_t row = 0; row < messages.topics().size(); ++row) {
    const std::string& name = messages.topics()[row].name;
    if (name == "/fleet" || name == info.movers.front().sensors.front().topic)
      channels.push_back(static_cast<int>(row));
  }
  return channels;
}

/// Runs ticks at the rate. @return CPU time per tick [s]
double drive(scenarios::Simulation& simulation, bridges::Viewer* viewer, int ticks) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kPeriod = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / kRate));
  Clock::time_point next = Clock::now();
  const Cost before = now();
  for (int i = 0; i < ticks; ++i) {
    const base::TickRecord tick = simulation.step();
    if (viewer != nullptr) viewer->publish(tick, {});
    next = std::max(next + kPeriod, Clock::now());  // delays are not made up for, since no update would be sent
    std::this_thread::sleep_until(next);
  }
  return since(before).cpu_s / ticks;
}

void measure(double interval, std::uint32_t robots, double seconds, gpu::Device& device) {
  world::World world = tiled_cave(robots, scenes::laser(361, M_PI, 8.0));
  world.interval = interval;
  const sensors::SensorSet sensor_set(world);
  record::RunInfo info = scenarios::run_info(world, sensor_set, {.seed = 1, .record_readings = true});
  record::name_frames(info);
  const std::vector<int> channels = channels_of(info);
  scenarios::Simulation simulation(world, device, {});
  bridges::Viewer viewer({world, sensor_set, info}, {.address = {"127.0.0.1", 0}});
  const int ticks = static_cast<int>(seconds * kRate);
  drive(simulation, nullptr, ticks / 2);
  std::vector<double> without, idle, with;
  Count read;
  for (int turn = 0; turn < kTurns; ++turn) {
    without.push_back(drive(simulation, nullptr, ticks));
    idle.push_back(drive(simulation, &viewer, ticks));
    ReaderProcess reader(viewer.server().port(), channels);
    with.push_back(drive(simulation, &viewer, ticks));
    read = reader.end();
  }
  const double plain = median(without), watched = median(with);
  fmt::print("{} robots, interval {:.3f} s, {} ticks/s, median of {} turns of {} ticks\n", robots, interval, kRate,
             kTurns, ticks);
  fmt::print("  no view             {:8.3f} ms of CPU per tick\n", 1e3 * plain);
  fmt::print("  view, no reader     {:8.3f} ms, {:+.1f} %\n", 1e3 * median(idle), 100.0 * (median(idle) / plain - 1.0));
  fmt::print(
      "  view, one reader    {:8.3f} ms, {:+.1f} %; it read {:.2f} messages and {:.0f} kB per tick, {} skipped\n",
      1e3 * watched, 100.0 * (watched / plain - 1.0), static_cast<double>(read.messages) / ticks,
      1e-3 * static_cast<double>(read.bytes) / ticks, viewer.server().skipped());
}

}  // namespace

}  // namespace sf::bench

int main(int argc, char** argv) {
  if (argc > 2 && std::string_view(argv[1]) == "--read") {
    sf::bench::read_channels(static_cast<std::uint16_t>(std::atoi(argv[2])), {argv + 3, argv + argc});
    return 0;
  }
  return sf::bench::run_main(argc, argv, "view_cost [ROBOTS [SECONDS]]; default: 1000 6", [&] {
    const auto robots = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 1000);
    const double seconds = argc > 2 ? std::atof(argv[2]) : 6.0;
    sf::gpu::Device device;
    sf::bench::measure(0.1, robots, seconds, device);         // every robot's laser in every tick
    sf::bench::measure(1.0 / 30.0, robots, seconds, device);  // lasers at 10 Hz: in every third tick
    return 0;
  });
}
