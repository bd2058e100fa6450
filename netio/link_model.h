#pragma once
// A worse network than the one there is: what becomes of each message, from a seed.

#include <cstdint>
#include <optional>

namespace sf::netio {

/// Delay, jitter and loss of one direction between a robot and the farm.
struct LinkModel {
  double delay = 0.0;   ///< [s] in [0, 3600] of every message
  double jitter = 0.0;  ///< [s] in [0, 3600] more, evenly in [0, jitter]: messages may overtake each other
  double loss = 0.0;    ///< [-] in [0, 1] part of the messages that never come
  std::uint64_t seed = 0;
  bool perfect() const { return delay == 0.0 && jitter == 0.0 && loss == 0.0; }
};

/// Names one message.
struct MessageId {
  std::uint32_t robot = 0;
  std::uint32_t stream = 0;  ///< kind << 16 | sensor, or any other number of the direction
  std::uint64_t sequence = 0;
};

/// How much later than it was sent the message comes [ns]; nothing: it is lost. A function of plan and message alone.
std::optional<std::int64_t> sample_delay(const LinkModel& model, const MessageId& message);

}  // namespace sf::netio
