#pragma once
// State, command and contact of all movers at one tick, bit for bit: `sensorfarm_msgs/msg/Fleet`, and, where some are
// not level, their tilts: `sensorfarm_msgs/msg/Tilts`, and the speeds of the wheels of cars:
// `sensorfarm_msgs/msg/Wheels`.

#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/pose.h"
#include "base/tick_record.h"

namespace sf::record {

class CdrWriter;

struct MoverState {
  std::uint32_t mover = 0;  ///< row in `RunInfo::movers`
  bool contact = false;     ///< a wall or a robot stopped it
  base::Pose X_WM;
  base::Twist velocity;  ///< in the mover's frame
  base::Twist command;   ///< the twist that its controller commanded; zero without a controller
};

struct FleetState {
  std::uint64_t tick = 0;
  std::int64_t time = 0;  ///< [ns] simulated
  std::vector<MoverState> states;
};

template <class Value>
struct MoverValue {
  std::uint32_t mover = 0;  ///< row in `RunInfo::movers`
  Value value;              ///< finite
};

/// Values of some of the movers at one tick.
template <class Value>
struct MoverValues {
  std::int64_t time = 0;  ///< [ns] simulated
  std::vector<MoverValue<Value>> movers;
};
using TiltsSample = MoverValues<base::Tilt>;          ///< of all movers that are not level
using WheelsSample = MoverValues<base::WheelSpeeds>;  ///< of all movers whose speeds of wheels are known

/// Returns whether a mover that is in the world is not level.
bool any_tilted(const base::TickRecord& record);
/// Appends the tilted movers that are in the world as a sequence of `sensorfarm_msgs/Tilt`.
void put_tilts(CdrWriter& cdr, const base::TickRecord& record);
/// Appends one message, of the tilted movers that are in the world.
void encode_tilts(const base::TickRecord& record, base::Bytes& out);
/// @return false if the bytes are not a Tilts message. Replaces the content of `sample`.
bool decode_tilts(std::span<const std::uint8_t> message, TiltsSample& sample);

/// Returns whether the speeds of the wheels of a mover in the world are known.
bool any_wheels(const base::TickRecord& record);
/// Appends one message, of these movers.
void encode_wheels(const base::TickRecord& record, base::Bytes& out);
/// @return false if the bytes are not a Wheels message. Replaces the content of `sample`.
bool decode_wheels(std::span<const std::uint8_t> message, WheelsSample& sample);

/// Appends one message. @pre `commands` and `contacts` are empty or contain one entry per report
void encode_fleet(const base::TickRecord& record, base::Bytes& out);

/// @return false if the bytes are not a Fleet message; `fleet` is then partly filled. Reuses its capacity.
bool decode_fleet(std::span<const std::uint8_t> message, FleetState& fleet);

}  // namespace sf::record
