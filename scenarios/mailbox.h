#pragma once
// Readings in transit to one robot: the newest of each sensor, after a link with delay and loss.

#include <cstdint>
#include <span>
#include <vector>

#include "farm/stored_reading.h"
#include "netio/link_model.h"

namespace sf::scenarios {

/// One thread at a time. Allocates only when it grows.
class Mailbox {
 public:
  /// @param robot selects the robot's random numbers under the link's seed
  Mailbox(const netio::LinkModel& link, std::uint32_t robot) : link_(link), robot_(robot) {}

  /// Sends a reading at `now` [ns]: copies and delays it, or loses it.
  void send(const base::ReadingBlock& reading, std::int64_t now);

  /// Returns the newest reading of each sensor that has arrived by `now` [ns], ordered by the sensors' first arrival.
  /// Drops readings overtaken by newer ones. Valid until the next call of `send` or `receive`.
  std::span<const base::ReadingBlock> receive(std::int64_t now);

  /// Returns whether the last `receive` delivered a reading of this type that the previous call did not.
  bool renewed(std::uint8_t type) const;

 private:
  struct Kept {
    farm::StoredReading reading;
    std::int64_t due = 0;  ///< [ns]
    bool used = false;
  };
  struct Slot {
    std::uint8_t type = 0;
    std::uint32_t sensor = 0;
    bool renewed = false;
    bool has = false;  ///< `shown` holds a reading
    Kept shown;
    std::vector<Kept> coming;  ///< slots are reused with their memory
  };
  Slot& slot_of(const base::ReadingBlock& reading);
  static void show(Slot& slot, std::int64_t now);

  netio::LinkModel link_;
  std::uint32_t robot_;
  std::vector<Slot> slots_;
  std::vector<base::ReadingBlock> open_;
};

}  // namespace sf::scenarios
