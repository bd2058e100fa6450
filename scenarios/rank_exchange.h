#pragma once
// A fleet shared by the ranks of a job. A rank decides and records for its own robots, and tells the others once per
// tick what they cannot compute: commands, intents, and what a report needs.

#include <cstdint>
#include <exception>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/report.h"
#include "cluster/ranks.h"
#include "farm/farm.h"
#include "scenarios/fleet_share.h"

namespace sf::scenarios {

/// One row per mover of the world, which all ranks agree on after `RankExchange::finish`.
struct FleetDecisions {
  std::span<base::Twist> commands;
  std::span<base::Intent> intents;
  std::span<ControlStatus> statuses;
};

/// Rays per second of each mover, or as many as take the time of its motion, controller and readings.
std::vector<double> costs_of(const world::World& world, const sensors::SensorSet& sensor_set);

/// The rank of each mover: neighbouring ones of the world's list have one, and all ranks have about the same cost.
std::vector<unsigned> equal_homes(std::span<const double> costs, unsigned ranks);

/// One thread.
class RankExchange {
 public:
  /// `ranks` must outlive it. @param homes per mover: the rank that decides for it
  RankExchange(cluster::Ranks& ranks, std::span<const unsigned> homes);

  /// This rank decides for the mover, and delivers its readings.
  bool owns(std::uint32_t mover) const { return owned_[mover] != 0; }

  /// One more mover, in the last row, decided for by the rank with the fewest.
  void add_mover();
  void remove_last();  ///< takes that back

  /// Sends the decisions for the own share, and its readings' hashes. @param failed mover whose controller threw
  /// `failure`; null: none did @param stop a user asks for the end of the run
  void begin(const FleetDecisions& own, farm::Farm& farm, std::uint32_t failed, const std::exception_ptr& failure,
             bool stop);
  /// Completes `all` by the others' decisions. @return a rank was asked to stop
  /// @throws cluster::Failure on all ranks: the first mover's error
  bool finish(const FleetDecisions& all, farm::Farm& farm);

 private:
  void put_mover(std::uint32_t mover, const FleetDecisions& own, base::ByteWriter& out);
  void get_mover(std::uint32_t mover, const FleetDecisions& all, base::ByteReader& in);

  cluster::Ranks& ranks_;
  std::vector<std::uint8_t> owned_;                 ///< per mover
  std::vector<std::vector<std::uint32_t>> movers_;  ///< per rank: those it decides for
  std::vector<base::Twist> sent_commands_;  ///< per mover, as the others know them; equal ones are not sent again
  std::vector<base::Intent> sent_intents_;  ///< likewise
  base::Bytes block_;
  std::vector<base::ByteReader> readers_;
};

}  // namespace sf::scenarios
