// Time of the motion of fleets, on the host (one thread) and on the device, and whether the bytes agree.
//
//   build/release/fleet_cost [WORLDS ROBOTS]   default: four pairs with a thousand robots

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <vector>

#include "base/hash.h"
#include "base/random.h"
#include "bench/cost.h"
#include "bench/usage.h"
#include "robots/device/device_fleet.h"
#include "robots/fleet.h"
#include "tests/robots/scenes.h"
#include "world/copies.h"

namespace sf::bench {

namespace {

constexpr std::int64_t kTick = 100'000'000;
constexpr int kTicks = 40;

/// Discs of 0.33 m, each with 1 m^2 of a square room with walls.
world::World crowded_rooms(std::uint32_t worlds, std::uint32_t robots) {
  const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(robots)));
  world::World world = scenes::boxed_world(side, side);
  for (std::uint32_t i = 0; i < robots; ++i)
    scenes::add_create(world, {0.5 + i % side, 0.5 + i / side, 0.0, 0.7 * i});  // NOLINT(bugprone-integer-division)
  world::copy_movers(world, worlds);
  return world;
}

std::vector<base::Twist> commands_at(int tick, std::size_t movers) {
  std::vector<base::Twist> commands;
  for (std::uint32_t row = 0; row < movers; ++row) {
    const auto u = base::random_uniform({.seed = 3, .a = row, .b = static_cast<std::uint32_t>(tick / 10)}, 0);
    commands.push_back({0.2 + 0.3 * u[0], 0.0, 2.0 * u[1] - 1.0});
  }
  return commands;
}

std::uint64_t hash_of(std::span<const base::Report> reports) {
  std::vector<double> numbers;
  for (const base::Report& r : reports)
    numbers.insert(numbers.end(), {r.X_WM.x, r.X_WM.y, r.X_WM.yaw, r.velocity.forward, r.velocity.turn,
                                   static_cast<double>(r.contact_mask)});
  return base::hash_bytes(numbers.data(), numbers.size() * sizeof(double));
}

void measure(gpu::Device& device, std::uint32_t worlds, std::uint32_t robots) {
  const world::World world = crowded_rooms(worlds, robots);
  robots::Fleet host(world);
  robots::DeviceFleet fleet(world, device);
  std::vector<Cost> on_host, on_device;
  std::size_t touching = 0;
  for (int tick = 0; tick < kTicks; ++tick) {
    const std::vector<base::Twist> commands = commands_at(tick, world.movers.size());
    Cost start = now();
    host.move(commands, kTick);
    on_host.push_back(since(start));
    fleet.set_commands(commands);
    start = now();
    fleet.move(kTick);
    on_device.push_back(since(start));
    for (const std::uint8_t touches : host.contacts()) touching += touches;
  }
  const Cost h = median(on_host), d = median(on_device);
  const std::uint64_t expected = hash_of(host.reports()), found = hash_of(fleet.reports());
  fmt::print(
      "{:6} worlds of {:5}: host {:8.3f} ms, device {:8.3f} ms by the clock, {:8.3f} ms of cores; {:.0f} % touch; "
      "{} {}\n",
      worlds, robots, 1e3 * h.cpu_s, 1e3 * d.wall_s, 1e3 * d.cpu_s,
      100.0 * static_cast<double>(touching) / kTicks / static_cast<double>(world.movers.size()), base::hash_hex(found),
      expected == found ? "as the host" : "DIFFERS FROM THE HOST");
}

}  // namespace

}  // namespace sf::bench

int main(int argc, char** argv) {
  return sf::bench::run_main(argc, argv, "fleet_cost [WORLDS ROBOTS]; default: four pairs with a thousand robots", [&] {
    sf::gpu::Device device;
    fmt::print("{}\n", device.info().name);
    if (argc == 3) {
      sf::bench::measure(device, static_cast<std::uint32_t>(std::atoi(argv[1])),
                         static_cast<std::uint32_t>(std::atoi(argv[2])));
      return 0;
    }
    for (const std::uint32_t robots : {1u, 10u, 100u, 1'000u}) sf::bench::measure(device, 1'000 / robots, robots);
    return 0;
  });
}
