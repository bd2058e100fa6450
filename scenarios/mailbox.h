#pragma once
// What has come to one robot: the newest reading of each of its sensors, through a link that delays and loses.

#include <cstdint>
#include <span>
#include <vector>

#include "base/reading.h"
#include "netio/link_model.h"

namespace sf::scenarios {

/// One thread at a time. Allocates until it has held as many readings at once as it ever will.
class Mailbox {
 public:
  /// @param robot names the robot's messages among all that have the link's seed
  Mailbox(const netio::LinkModel& link, std::uint32_t robot) : link_(link), robot_(robot) {}

  /// A reading leaves the farm at `now` [ns]; it is copied, or lost.
  void send(const base::ReadingBlock& reading, std::int64_t now);

  /// What has come by `now` [ns], the newest of each sensor in the order in which sensors were first heard. A reading
  /// that was overtaken by a newer one is never seen. Lives until the next call of `send` or `receive`.
  std::span<const base::ReadingBlock> receive(std::int64_t now);

  /// True when the last `receive` found a reading of that kind that the one before had not.
  bool renewed(std::uint8_t kind) const;

 private:
  struct Kept {
    base::ReadingBlock block;  ///< its spans are the vectors below
    std::int64_t due = 0;      ///< [ns]
    bool used = false;
    std::vector<double> values;
    std::vector<std::uint32_t> hits;
  };
  struct Slot {
    std::uint8_t kind = 0;
    std::uint32_t sensor = 0;
    bool renewed = false;
    bool has = false;  ///< `shown` is a reading
    Kept shown;
    std::vector<Kept> coming;  ///< places are reused, with their memory
  };
  Slot& slot_of(const base::ReadingBlock& reading);
  static void show(Slot& slot, std::int64_t now);

  netio::LinkModel link_;
  std::uint32_t robot_;
  std::vector<Slot> slots_;
  std::vector<base::ReadingBlock> open_;
};

}  // namespace sf::scenarios
