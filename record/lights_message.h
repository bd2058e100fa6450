#pragma once
// States of all traffic lights at one tick: `sensorfarm_msgs/msg/Lights`.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/tick_record.h"

namespace sf::record {

/// Appends one message. @pre one name per light
void encode_lights(std::int64_t time, std::span<const std::string> names, std::span<const base::LightStatus> lights,
                   base::Bytes& out);

/// @return false if the bytes are not a Lights message. Skips the names.
bool decode_lights(std::span<const std::uint8_t> message, std::int64_t& time, std::vector<base::LightStatus>& lights);

}  // namespace sf::record
