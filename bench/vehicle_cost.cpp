// Time of the motion of cars in six degrees of freedom, on the floor and on a terrain.
//
//   build/release/vehicle_cost [CARS] [THREADS]   default: 1000 cars, 2 threads

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "base/thread_pool.h"
#include "bench/cost.h"
#include "bench/usage.h"
#include "robots/fleet.h"
#include "tests/robots/scenes.h"

namespace sf::bench {

namespace {

constexpr std::int64_t kTick = 100'000'000;
constexpr int kTicks = 50;

/// Cars that drive in circles of 15 m, 50 m apart.
world::World car_park(std::uint32_t cars, bool hills) {
  const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(cars)));
  world::World world = scenes::empty_world();
  for (std::uint32_t k = 0; k < cars; ++k) {
    world::Mover& mover =
        scenes::add_mover(world, {50.0 * (k % side), 50.0 * std::floor(k / side)}, scenes::rectangle({}, 4.2, 1.7));
    for (world::Segment& s : mover.body) s.z_max = 1.4;
    mover.drive = world::Drive::car, mover.wheelbase = 2.39268, mover.track = 1.4, mover.max_forward = 30.0;
    mover.dynamics = {"car", {}, ""};
  }
  if (!hills) return world;
  const auto points = 10 * side + 20;
  world::Terrain terrain{.X_WT = {25.0 * side, 25.0 * side}, .cell = {5.0, 5.0}, .columns = points, .rows = points};
  for (std::uint32_t k = 0; k < points * points; ++k)
    terrain.heights.push_back(
        static_cast<float>(std::sin(0.5 * (k % points)) + std::cos(0.3 * std::floor(k / points))));
  world.terrain.push_back(terrain);
  for (world::Mover& mover : world.movers)
    mover.X_WM.z = world::Ground({}, world.terrain).height({mover.X_WM.x, mover.X_WM.y}, 0.0);
  return world;
}

void measure(std::uint32_t cars, unsigned threads, bool hills) {
  const world::World world = car_park(cars, hills);
  base::ThreadPool pool(threads);
  robots::Fleet fleet(world, &pool);
  const std::vector<base::Twist> commands(cars, {8.0, 0.0, 8.0 / 15.0});
  std::vector<Cost> costs;
  for (int tick = 0; tick < kTicks; ++tick) {
    const Cost start = now();
    fleet.move(commands, kTick);
    costs.push_back(since(start));
  }
  std::vector<double> numbers;
  for (const base::Report& r : fleet.reports()) {
    SF_CHECK(std::abs(r.velocity.forward - 8.0) < 1.0, fmt::format("a car at {} m/s", r.velocity.forward));
    numbers.insert(numbers.end(), {r.X_WM.x, r.X_WM.y, r.X_WM.z, r.X_WM.yaw, r.tilt.roll, r.tilt.pitch});
  }
  const Cost typical = median(costs);
  const double seconds = 1e-9 * kTick;
  fmt::print(
      "{} cars, {}: {:.1f} ms of {} threads per tick of {:g} s, {:.1f} times real time; {:.2f} us of a core per car "
      "and millisecond; {}\n",
      cars, hills ? "terrain" : "floor  ", 1e3 * typical.wall_s, pool.threads(), seconds, seconds / typical.wall_s,
      1e3 * typical.cpu_s / seconds / cars,
      base::hash_hex(base::hash_bytes(numbers.data(), numbers.size() * sizeof(double))));
}

}  // namespace

}  // namespace sf::bench

int main(int argc, char** argv) {
  return sf::bench::run_main(argc, argv, "vehicle_cost [CARS [THREADS]]; default: 1000 2", [&] {
    const auto number = [&](int k, unsigned fallback) {
      return argc > k ? static_cast<unsigned>(std::atoi(argv[k])) : fallback;
    };
    for (const bool hills : {false, true}) sf::bench::measure(number(1, 1'000), number(2, 2), hills);
    return 0;
  });
}
