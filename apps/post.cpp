#include "apps/post.h"

#include <limits>

#include "base/error.h"

namespace sf::apps {

netio::PortRule require_laser_ports(const world::World& world, const Options& options) {
  const netio::PortRule rule{options.laser_port, options.ports_per_robot};
  std::vector<netio::PortUse> uses;
  for (const world::Mover& mover : world.movers) {
    if (mover.lasers.empty()) continue;
    uses.push_back({mover.id, static_cast<std::uint32_t>(mover.lasers.size()), rule, mover.name, 0});
    for (const world::Laser& laser : mover.lasers)
      netio::require_wire(options.wire, laser.samples, laser.range_max, mover.name + "." + laser.name);
  }
  try {
    netio::require_ports(uses);
  } catch (const base::InputError& error) {
    throw base::InputError(std::string(error.what()) + " (--laser-port is the base, --ports-per-robot the stride)");
  }
  return rule;
}

std::span<const base::ReadingBlock> NoReturn::apply(std::span<const base::ReadingBlock> readings) {
  if (!infinite_) return readings;
  std::size_t count = 0;
  for (const base::ReadingBlock& r : readings) count += r.values.size();
  ranges_.resize(count);
  blocks_.assign(readings.begin(), readings.end());
  double* at = ranges_.data();
  for (base::ReadingBlock& r : blocks_) {
    const double range_max = world_.movers[r.mover].lasers[r.sensor].range_max;
    for (std::size_t i = 0; i < r.values.size(); ++i)
      at[i] =
          r.hits[i] == base::kNoHit && r.values[i] >= range_max ? std::numeric_limits<double>::infinity() : r.values[i];
    r.values = {at, r.values.size()};
    at += r.values.size();
  }
  return blocks_;
}

void post(netio::Outbox& outbox, const world::World& world, const base::ReadingBlock& reading, std::uint32_t address,
          const netio::PortRule& rule, netio::Wire wire) {
  const world::Mover& mover = world.movers[reading.mover];
  netio::Header header;
  header.robot = static_cast<std::uint16_t>(mover.id);
  header.sensor = static_cast<std::uint16_t>(reading.sensor);
  header.sequence = reading.sequence;
  header.time = reading.time;
  const auto port = static_cast<std::uint16_t>(netio::port(rule, mover.id, reading.sensor));
  outbox.queue_laser({address, port}, wire, header, reading.values, mover.lasers[reading.sensor].range_max);
}

}  // namespace sf::apps
