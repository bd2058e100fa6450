// A fleet in your own loop: 300 robots that avoid obstacles.
//
//   cmake -B build && cmake --build build && build/fleet

#include <sensorfarm/simulation.h>

#include <algorithm>
#include <cstdio>
#include <vector>

namespace {

/// Drives on if the middle third of the scan is free, turns if it is not.
sensorfarm::Twist avoid(std::span<const double> ranges) {
  const std::size_t third = ranges.size() / 3;
  const double ahead = *std::min_element(ranges.begin() + third, ranges.end() - third);
  return ahead > 0.5 ? sensorfarm::Twist{0.3, 0.0, 0.0} : sensorfarm::Twist{0.0, 0.0, 1.0};
}

}  // namespace

int main(int count, char** words) {
  try {
    sensorfarm::Simulation simulation(count > 1 ? words[1] : "worlds/cave.world", {.robots = 300});
    std::printf("%zu robots on %s\n", simulation.size(), simulation.description().c_str());
    std::vector<sensorfarm::Twist> commands(simulation.size());
    while (simulation.time() < 10.0) {
      const sensorfarm::Readings scans = simulation.readings("laser");
      for (std::size_t i = 0; i < scans.sensors; ++i) commands[scans.robots[i]] = avoid(scans.row(i));
      simulation.step(commands);
    }
    const auto stopped = std::count(simulation.contacts().begin(), simulation.contacts().end(), 1);
    std::printf("after %.0f s %d are stopped by an obstacle; hash of readings %016llx\n", simulation.time(),
                static_cast<int>(stopped), static_cast<unsigned long long>(simulation.hash()));
  } catch (const sensorfarm::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
