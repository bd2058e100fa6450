#pragma once
// Readings to robots: which port each sensor has, and what leaves in which form.

#include <cstdint>
#include <span>
#include <vector>

#include "apps/options.h"
#include "base/reading.h"
#include "netio/outbox.h"
#include "netio/ports.h"
#include "world/world.h"

namespace sf::apps {

/// Ports that `options` give the lasers. @throws base::InputError when two sensors would share one, one is past 65535,
/// or the chosen wire cannot carry a sensor's scans.
netio::PortRule require_laser_ports(const world::World& world, const Options& options);

/// Beams that met nothing read infinity from here on, where the user asked for it.
class NoReturn {
 public:
  NoReturn(const world::World& world, bool infinite) : world_(world), infinite_(infinite) {}
  /// The same readings, or copies that live until the next call.
  std::span<const base::ReadingBlock> apply(std::span<const base::ReadingBlock> readings);

 private:
  const world::World& world_;
  bool infinite_;
  std::vector<base::ReadingBlock> blocks_;
  std::vector<double> ranges_;
};

/// Queues one reading to its robot's address, at its sensor's port.
void post(netio::Outbox& outbox, const world::World& world, const base::ReadingBlock& reading, std::uint32_t address,
          const netio::PortRule& rule, netio::Wire wire);

}  // namespace sf::apps
