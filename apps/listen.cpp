// `listen`: the other end of `run --send`.

#include <cstdio>

#include "apps/commands.h"
#include "apps/facts.h"
#include "apps/lend.h"
#include "apps/post.h"
#include "apps/stop.h"

namespace sf::apps {

int listen(const Options& options) {
  const world::World world = load_with_robots(options.world, options.load, options.robots, options.seed);
  const netio::PortRule rule = require_laser_ports(world, options);
  netio::ListenerOptions plan;
  plan.address = netio::resolve(options.bind);
  plan.wire = options.wire;
  for (const world::Mover& mover : world.movers)
    for (std::uint32_t i = 0; i < mover.lasers.size(); ++i)
      plan.streams.push_back({mover.id, i, mover.lasers[i].samples, mover.lasers[i].range_max, rule});
  netio::Listener listener(plan);
  catch_stop_signals();
  std::fprintf(stderr, "sensorfarm: listening on %zu ports of %s\n", plan.streams.size(), options.bind.c_str());
  listener.run(stop_requested(), static_cast<int>(1000.0 * options.silence));
  const netio::Summary summary = listener.summary();
  std::fputs((options.json ? json_of(summary) : text_of(summary)).c_str(), stdout);
  return summary.good > 0 ? 0 : 1;
}

}  // namespace sf::apps
