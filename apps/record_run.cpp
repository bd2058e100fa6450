#include "apps/record_run.h"

namespace sf::apps {

record::RunInfo run_info(const world::World& world, const Options& options) {
  record::RunInfo info;
  info.world = world.name.empty() ? world.file : world.name;
  info.world_hash = world.hash;
  info.seed = options.seed;
  info.interval = world.interval;
  info.record_readings = options.record_readings;
  info.options = {{"no_return", options.no_return_inf ? "inf" : "max"}};
  info.snapshot = world::snapshot(world);
  for (const world::Mover& mover : world.movers) {
    record::MoverInfo row{mover.name, "", mover.id, {}};
    for (const world::Laser& laser : mover.lasers)
      row.lasers.push_back(
          {laser.name, "", laser.X_MS, laser.fov, laser.samples, laser.range_min, laser.range_max, laser.rate});
    info.movers.push_back(std::move(row));
  }
  return info;
}

}  // namespace sf::apps
