#pragma once
// Network model: delay, jitter and loss per message, derived from a seed.

#include <cstdint>
#include <optional>

namespace sf::netio {

/// Model of one direction between a robot and the farm.
struct LinkModel {
  double delay = 0.0;   ///< [s] in [0, 3600]
  double jitter = 0.0;  ///< [s] in [0, 3600] additional delay, uniform in [0, jitter]; messages may be reordered
  double loss = 0.0;    ///< [-] in [0, 1] probability of loss
  std::uint64_t seed = 0;
  double duplicate = 0.0;  ///< [-] in [0, 1] probability that a message that is not lost arrives twice
  double corrupt = 0.0;    ///< [-] in [0, 1] probability that one bit of a message that is not lost is flipped
  bool perfect() const { return delay == 0.0 && jitter == 0.0 && loss == 0.0 && duplicate == 0.0 && corrupt == 0.0; }
};

/// Identity of one message.
struct MessageId {
  std::uint32_t robot = 0;
  std::uint32_t stream = 0;  ///< type << 16 | sensor, or any other number of the stream
  std::uint64_t sequence = 0;
};

/// Returns the delay of the message [ns]; nullopt if it is lost. Depends only on model and message.
std::optional<std::int64_t> sample_delay(const LinkModel& model, const MessageId& message);

/// Further faults of a message that is not lost. They depend only on model and message.
struct MessageFaults {
  std::optional<std::int64_t> again;  ///< [ns] delay of its second copy
  std::optional<double> flipped_bit;  ///< in [0, 1): position of the flipped bit among the bits of the message
};
MessageFaults sample_faults(const LinkModel& model, const MessageId& message);

}  // namespace sf::netio
