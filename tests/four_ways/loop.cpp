// In process, in a loop of one's own.

#include <sensorfarm/simulation.h>

#include <cstdio>
#include <vector>

#include "tests/four_ways/avoid.h"

int main() {
  sensorfarm::Simulation simulation("worlds/cave.world", {.robots = 5});
  std::vector<sensorfarm::Twist> commands(simulation.size());
  for (int tick = 1; tick < 100; ++tick) {
    const sensorfarm::Readings scans = simulation.readings("laser");
    for (std::size_t i = 0; i < scans.sensors; ++i) commands[scans.robots[i]] = avoid(scans.row(i));
    simulation.step(commands);
  }
  std::printf("%016llx\n", static_cast<unsigned long long>(simulation.hash()));
}
