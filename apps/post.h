#pragma once
// Readings to robots: what leaves, in which form.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "apps/send_plan.h"
#include "base/reading.h"
#include "netio/outbox.h"
#include "sensors/roster.h"
#include "world/world.h"

namespace sf::apps {

/// Beams that met nothing read infinity from here on, where the user asked for it.
class NoReturn {
 public:
  /// `roster` must outlive it.
  NoReturn(const sensors::Roster& roster, bool infinite) : roster_(roster), infinite_(infinite) {}
  /// The same readings, or copies that live until the next call.
  std::span<const base::ReadingBlock> apply(std::span<const base::ReadingBlock> readings);

 private:
  const sensors::Roster& roster_;
  bool infinite_;
  std::vector<base::ReadingBlock> blocks_;
  std::vector<double> ranges_;
};

struct PostCounts {
  netio::OutboxCounts packets;
  std::uint64_t not_numbers = 0;  ///< packets never made, for a value that is not a number where none may be missing
};

/// Readings as packets, numbered per sensor as they are sent: a reading that was due and never sent leaves no gap.
/// World and roster must outlive it.
class Post {
 public:
  Post(const world::World& world, const sensors::Roster& roster, SendPlan plan, netio::Outbox outbox);

  /// Queues one reading's packets to `address`, at its sensor's port; none where the plan has none of its sensor's.
  void queue(const base::ReadingBlock& reading, std::uint32_t address, const netio::Stamp& stamp);
  void flush() { outbox_.flush(); }
  PostCounts counts() const { return {outbox_.counts(), not_numbers_}; }

 private:
  const world::World& world_;
  const sensors::Roster& roster_;
  SendPlan plan_;
  netio::Outbox outbox_;
  std::map<std::uint8_t, std::vector<std::uint32_t>> sent_;  ///< by kind, per row of its group: readings
  std::uint64_t not_numbers_ = 0;
  base::Bytes payload_;
  base::Bytes packet_;
};

}  // namespace sf::apps
