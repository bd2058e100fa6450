// Measures the seconds per step of libsensorfarm, in wall time and CPU time of all threads, for bench/python_step.py:
// library_step WORLD ROBOTS STEPS [WORLDS], without noise if WORLDS is given, even as 1. The first line of input starts
// the measurement; each further line repeats it.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <string>
#include <vector>

#include "sensorfarm/simulation.h"

int main(int argc, char** argv) {
  if (argc != 4 && argc != 5) return std::fputs("usage: library_step WORLD ROBOTS STEPS [WORLDS]\n", stderr), 2;
  const std::uint32_t worlds = argc == 5 ? static_cast<std::uint32_t>(std::atol(argv[4])) : 1;
  const long steps = std::atol(argv[3]);
  try {
    sensorfarm::Simulation simulation(
        argv[1], {.robots = static_cast<std::uint32_t>(std::atol(argv[2])), .copies = worlds, .noise = argc == 4});
    std::vector<sensorfarm::Twist> twists(simulation.size());
    const auto drive = [&] {
      const sensorfarm::Readings scans = simulation.readings("laser");
      for (std::size_t i = 0; i < scans.sensors; ++i) {
        const auto ranges = scans.row(i);
        const bool near = *std::min_element(ranges.begin(), ranges.end()) < 0.5;
        twists[scans.robots[i]] = near ? sensorfarm::Twist{0.0, 0.0, 0.8} : sensorfarm::Twist{0.3, 0.0, 0.0};
      }
    };
    for (std::string line; std::getline(std::cin, line);) {
      simulation.reset(1);
      double spent = 0.0, cpu = 0.0;
      for (long i = 0; i < steps; ++i) {
        drive();
        const std::clock_t cpu_start = std::clock();
        const auto start = std::chrono::steady_clock::now();
        simulation.step(twists);
        static_cast<void>(simulation.readings("laser"));
        spent += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        cpu += static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
      }
      std::printf("%.9f %.9f %016llx\n", spent / static_cast<double>(steps), cpu / static_cast<double>(steps),
                  static_cast<unsigned long long>(simulation.hash()));
      std::fflush(stdout);
    }
  } catch (const sensorfarm::Error& error) {
    std::fprintf(stderr, "library_step: %s\n", error.what());
    return 1;
  }
}
