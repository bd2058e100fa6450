#pragma once
// Complete ticks of a large fleet: motion, contacts, decisions, three sensor types, packets to a socket.

#include <cstdint>
#include <string>
#include <vector>

#include "bench/cost.h"
#include "farm/farm.h"

namespace sf::bench {

struct LargeFleetResult {
  std::size_t robots = 0;
  std::vector<Cost> ticks;  ///< from motion until all packets are encoded; sending overlaps with the next tick
  double p50_s = 0.0;
  double p99_s = 0.0;
  double move_s = 0.0;  ///< [s] mean per tick of decisions, motion and contacts; the times below are means, too
  double encode_s = 0.0;
  double send_s = 0.0;          ///< time of the sending thread
  farm::FarmStats stages;       ///< sums over the measured ticks
  std::uint64_t datagrams = 0;  ///< during the measured ticks, like the counts below
  std::uint64_t bytes = 0;
  std::uint64_t received = 0;
  std::uint64_t dropped = 0;  ///< not sent
  std::uint64_t hash = 0;     ///< of all readings since the start
};

/// Runs `robots` wandering robots that see each other, each with a laser of 361 beams to 8 m, a lane edge sensor of 61
/// rays and five magnetometers, all at 10 Hz, for `ticks` ticks.
LargeFleetResult drive_large_fleet(gpu::Device& device, std::uint32_t robots, std::size_t ticks);

std::string large_fleet_table(const std::vector<LargeFleetResult>& results);
/// Writes large_fleet.csv; does nothing without results.
void write_large_fleet(const std::vector<LargeFleetResult>& results, const std::string& folder);

}  // namespace sf::bench
