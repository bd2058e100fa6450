#pragma once
// Objects that changed their shape, size or colour: `sensorfarm_msgs/msg/Shapes`.

#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/shape_state.h"

namespace sf::record {

/// Shapes from a tick on.
struct ShapesSample {
  std::int64_t time = 0;  ///< [ns] of the tick
  std::vector<base::ShapeState> shapes;
};

/// Appends one message.
void encode_shapes(std::int64_t time, std::span<const base::ShapeState> shapes, base::Bytes& out);

/// @return false if the bytes are not a Shapes message
bool decode_shapes(std::span<const std::uint8_t> message, ShapesSample& sample);

}  // namespace sf::record
