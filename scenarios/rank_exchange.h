#pragma once
// A fleet shared by the ranks of a job. Every rank moves all robots; it senses, decides and records for its own share,
// and tells the others once per tick what they cannot compute: commands, intents, and what a report needs.

#include <cstdint>
#include <exception>
#include <limits>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/report.h"
#include "cluster/ranks.h"
#include "farm/farm.h"

namespace sf::scenarios {

/// A robot's controller as other ranks know it.
struct ControlStatus {
  bool drives = false;   ///< the robot has a controller
  bool stepped = false;  ///< in the last tick
  bool done = false;
  double error = std::numeric_limits<double>::quiet_NaN();  ///< see control::Controller
};

/// One row per mover of the world, which all ranks agree on after `RankExchange::finish`.
struct FleetDecisions {
  std::span<base::Twist> commands;
  std::span<base::Intent> intents;
  std::span<ControlStatus> statuses;
};

/// One thread.
class RankExchange {
 public:
  /// Shares are neighbouring movers with about the same number of rays per second. `ranks` must outlive it.
  RankExchange(cluster::Ranks& ranks, const world::World& world, const sensors::SensorSet& sensor_set);

  /// This rank senses and decides for the mover.
  bool owns(std::uint32_t mover) const { return mover >= first_[ranks_.rank()] && mover < first_[ranks_.rank() + 1]; }

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
  std::vector<std::uint32_t> first_;        ///< per rank and one more: its first mover
  std::vector<base::Twist> sent_commands_;  ///< per mover, as the others know them; equal ones are not sent again
  std::vector<base::Intent> sent_intents_;  ///< likewise
  base::Bytes block_;
  std::vector<base::ByteReader> readers_;
};

}  // namespace sf::scenarios
