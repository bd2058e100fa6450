#include "bench/scans.h"

#include "sensors/laser_settings.h"
#include "tests/sensors/scenes.h"

namespace sf::bench {

namespace {

constexpr int kRounds = 4;
constexpr std::uint64_t kSeed = 1;

}  // namespace

world::World load_cave() {
  world::World cave = world::load_world(SF_SOURCE_DIR "/worlds/cave.world");
  cave.movers.clear();
  return cave;
}

Scans make_scans(const std::string& scene, world::World world, std::uint32_t count,
                 const sensors::LaserSettings& laser) {
  Scans scans{scene, std::move(world), laser, {}, {}};
  scenes::add_robots(scans.world, count, laser, kSeed);
  for (world::Mover& mover : scans.world.movers) mover.body.clear();

  for (int round = 0; round < kRounds; ++round) {
    std::vector<base::Pose>& poses = scans.rounds.emplace_back();
    for (const world::Mover& mover : scans.world.movers)
      poses.push_back(base::compose(mover.X_WM, {0.002 * round, 0.001 * round, 0.0, 0.1 * round}));
  }
  for (std::uint32_t i = 0; i < laser.samples; ++i) {
    const double bearing = bearing_of(laser, i);
    scans.beams.push_back({std::cos(bearing), std::sin(bearing)});
  }
  return scans;
}

}  // namespace sf::bench
