#pragma once
// A fleet shared by the ranks of a job. A rank decides and records for its own robots. Once per tick it sends the
// others what they cannot compute: commands, intents, estimates of own states, and data for reports.

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

/// One row per mover of the world. All ranks agree on it after `RankExchange::finish`.
struct FleetDecisions {
  std::span<base::Twist> commands;
  std::span<base::Intent> intents;
  std::span<OwnEstimate> estimates;
  std::span<ControlStatus> statuses;
};

/// Returns the cost of each mover: its rays per second, plus the number of rays that take as long as its motion,
/// controller and readings.
std::vector<double> costs_of(const world::World& world, const sensors::SensorSet& sensor_set);

/// Returns the rank of each mover: consecutive movers of the world's list share a rank, and all ranks have about the
/// same cost.
std::vector<unsigned> equal_homes(std::span<const double> costs, unsigned ranks);

/// Not thread-safe.
class RankExchange {
 public:
  /// `ranks` must outlive it.
  /// @param homes per mover: the rank that decides for it
  RankExchange(cluster::Ranks& ranks, std::span<const unsigned> homes);

  /// Returns whether this rank decides for the mover and delivers its readings.
  bool owns(std::uint32_t mover) const { return owned_[mover] != 0; }

  /// Adds a mover in the last row. The rank with the fewest movers decides for it.
  void add_mover();
  void remove_last();  ///< undoes `add_mover`

  /// Sends the decisions for this rank's movers and the hashes of their readings.
  /// @param failed mover whose controller threw `failure`; null: none @param stop whether a user requests the end of
  /// the run
  void begin(const FleetDecisions& own, farm::Farm& farm, std::uint32_t failed, const std::exception_ptr& failure,
             bool stop);
  /// Adds the others' decisions to `all`.
  /// @return whether a rank was asked to stop
  /// @throws cluster::Failure on all ranks, with the first mover's error
  bool finish(const FleetDecisions& all, farm::Farm& farm);

 private:
  void put_mover(std::uint32_t mover, const FleetDecisions& own, base::ByteWriter& out);
  void get_mover(std::uint32_t mover, const FleetDecisions& all, base::ByteReader& in);

  cluster::Ranks& ranks_;
  std::vector<std::uint8_t> owned_;                 ///< per mover
  std::vector<std::vector<std::uint32_t>> movers_;  ///< movers of each rank
  std::vector<base::Twist> sent_commands_;          ///< per mover, as last sent; equal commands are not sent again
  std::vector<base::Intent> sent_intents_;          ///< per mover, as last sent
  base::Bytes block_;
  std::vector<base::ByteReader> readers_;
};

}  // namespace sf::scenarios
