#pragma once
// Readings that faults of sensors affected: `sensorfarm_msgs/msg/Faults`.

#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/fault.h"

namespace sf::record {

/// Appends one message. @param time [ns] of the tick
void encode_faults(std::int64_t time, std::span<const base::FaultMark> marks, base::Bytes& out);

/// Appends the marks of a message. @return false if the bytes are not a Faults message; `marks` is then unchanged
bool decode_faults(std::span<const std::uint8_t> message, std::vector<base::FaultMark>& marks);

}  // namespace sf::record
