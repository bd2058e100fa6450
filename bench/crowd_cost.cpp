// CPU time of ticks with movers in crowds and with the same movers spread out, for both casters.
//
//   build/release/crowd_cost [ROBOTS|LAYOUT...], where LAYOUT is a part of a layout's name; default: all

#include <fmt/format.h>

#include <cstdlib>
#include <string_view>
#include <vector>

#include "base/hash.h"
#include "bench/cost.h"
#include "bench/usage.h"
#include "farm/farm.h"
#include "raycast/casters.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/scenes.h"

namespace sf::bench {

namespace {

using trial::Chance;

struct Layout {
  const char* name;
  base::Pose (*pose)(int i, Chance& chance);
};

constexpr Layout kLayouts[] = {
    {"5 m apart",
     [](int i, Chance&) {
       return base::Pose{5.0 * (i % 40) - 100.0, 5.0 * (i / 40) - 60.0, 0.0, 0.1 * i};
     }},
    {"1 m apart",
     [](int i, Chance&) {
       return base::Pose{1.0 * (i % 40) - 20.0, 1.0 * (i / 40) - 20.0, 0.0, 0.1 * i};
     }},
    {"at one pose",
     [](int, Chance&) {
       return base::Pose{0.5, 0.25, 0.0, 0.3};
     }},
    {"within 1 nm",
     [](int, Chance& c) {
       return base::Pose{0.5 + 1e-9 * c.between(-1, 1), 0.25, 0.0, 0.3};
     }},
    {"within 1 mm",
     [](int, Chance& c) {
       return base::Pose{0.5 + 1e-3 * c.between(-1, 1), 0.25, 0.0, 0.3};
     }},
    {"within 0.1 m",
     [](int, Chance& c) {
       return base::Pose{0.1 * c.between(-1, 1), 0.1 * c.between(-1, 1), 0.0, 0.3};
     }},
    {"turned at one place",
     [](int, Chance& c) {
       return base::Pose{0.5, 0.25, 0.0, c.between(-3, 3)};
     }},
    {"turned within 1 um",
     [](int, Chance& c) {
       return base::Pose{0.5 + 1e-6 * c.between(-1, 1), 0.25 + 1e-6 * c.between(-1, 1), 0.0, c.between(-3, 3)};
     }},
    {"turned within 1 mm",
     [](int, Chance& c) {
       return base::Pose{0.5 + 1e-3 * c.between(-1, 1), 0.25 + 1e-3 * c.between(-1, 1), 0.0, c.between(-3, 3)};
     }},
    {"turned within 0.1 m",
     [](int, Chance& c) {
       return base::Pose{0.1 * c.between(-1, 1), 0.1 * c.between(-1, 1), 0.0, c.between(-3, 3)};
     }},
    {"in a line, 1 cm apart",
     [](int i, Chance&) {
       return base::Pose{0.01 * i, 0.0, 0.0, M_PI};
     }},
};

void measure(gpu::Device& device, const Layout& layout, int robots, const raycast::CasterType* caster) {
  world::World world;
  scenes::add_room(world, {}, 400.0);
  Chance chance(5);
  for (int i = 0; i < robots; ++i) scenes::add_robot(world, layout.pose(i, chance), scenes::laser());
  farm::Farm farm(world, device, {.threads = 1, .scene = {.caster = caster}});
  farm.subscribe_all();
  std::vector<Cost> costs;
  for (int tick = 0; tick < 6; ++tick) {
    std::vector<base::Report> reports;
    for (std::uint32_t m = 0; m < world.movers.size(); ++m) reports.push_back({m, 0, world.movers[m].X_WM, {}});
    for (base::Report& report : reports) report.X_WM.x += 0.004 * tick;
    const Cost start = now();
    farm.tick(tick * 1'000'000'000ll, reports);
    if (tick > 0) costs.push_back(since(start));
  }
  fmt::print("{:6} {:24} {:7} {:9.2f} ms   {}\n", robots, layout.name, caster->name, 1e3 * median(costs).cpu_s,
             base::hash_hex(farm.hash()));
}

}  // namespace

}  // namespace sf::bench

int main(int argc, char** argv) {
  return sf::bench::run_main(
      argc, argv, "crowd_cost [ROBOTS|LAYOUT...], where LAYOUT is a part of a layout's name; default: all", [&] {
        sf::gpu::Device device;
        std::vector<int> sizes;
        std::string_view chosen;
        for (int k = 1; k < argc; ++k)
          if (const int size = std::atoi(argv[k]); size > 0)
            sizes.push_back(size);
          else
            chosen = argv[k];
        if (sizes.empty()) sizes = {50, 200, 800, 1'000};
        for (const auto caster : {&sf::raycast::host_caster, &sf::raycast::device_caster})
          for (const int robots : sizes)
            for (const sf::bench::Layout& layout : sf::bench::kLayouts)
              if (std::string_view(layout.name).find(chosen) != std::string_view::npos)
                sf::bench::measure(device, layout, robots, caster);
        return 0;
      });
}
