#pragma once
// Packets of lockstep, with which other processes drive simulated robots tick by tick, and the checks of their
// payloads. docs/packets.md specifies every byte. `netio/packets.h` encodes and decodes whole packets.

#include <cstdint>
#include <limits>
#include <span>

#include "base/bytes.h"
#include "base/pose.h"
#include "netio/packet_status.h"

namespace sf::netio {

inline constexpr std::size_t kMaxCommands = 38;                  ///< rows of one COMMAND
inline constexpr std::uint32_t kMaxTicks = 1000;                 ///< maximum ticks of one STEP
inline constexpr std::uint32_t kMaxFetched = 64;                 ///< datagrams that one FETCH requests
inline constexpr std::size_t kMaxValues = 148;                   ///< maximum values of one VALUES
inline constexpr std::uint32_t kMaxTotal = 1u << 24;             ///< values of a reading
inline constexpr std::size_t kCommandRowBytes = 32;              ///< size of one row
inline constexpr std::size_t kStepBytes = 16, kStateBytes = 80;  ///< payload sizes of STEP and FETCH, and of STATE
inline constexpr std::uint32_t kDriverLostBit = 1;        ///< STATE: a driving process timed out before this tick
inline constexpr std::uint32_t kMaxStepCommands = 65536;  ///< one per id

/// The command that one robot executes from tick `Command::tick` on, until its next command.
struct CommandRow {
  std::uint32_t robot = 0;  ///< id in [0, kMaxId]
  base::Twist twist;        ///< in the robot's frame; each number within kMaxSpeed
};

/// To the farm: commands for robots that are bound to the sender.
struct Command {
  std::uint64_t tick = 0;              ///< last tick whose answer the sender has received
  std::span<const std::uint8_t> rows;  ///< 1 to kMaxCommands rows of kCommandRowBytes; valid as long as the datagram
};
inline std::size_t count_rows(const Command& command) { return command.rows.size() / kCommandRowBytes; }
/// @pre i < count_rows(command)
CommandRow row_of(const Command& command, std::size_t i);

/// To the farm: simulate from `tick` to `tick + ticks`.
struct Step {
  std::uint64_t tick = 0;
  std::uint32_t ticks = 1;     ///< in [1, kMaxTicks]
  std::uint32_t commands = 0;  ///< robots for which the sender has sent a COMMAND of this tick; all COMMANDs must have
                               ///< arrived
};

/// To the farm: send datagrams of a tick's answer (again).
struct Fetch {
  std::uint64_t tick = 0;
  std::uint32_t first = 0;  ///< index of the first
  std::uint32_t count = 1;  ///< in [1, kMaxFetched]
};

/// Position of a datagram in the farm's answer to a process after a tick.
struct AnswerPart {
  std::uint64_t tick = 0;
  std::uint32_t index = 0;      ///< in [0, datagrams - 1]
  std::uint32_t datagrams = 1;  ///< number of datagrams in the whole answer
};

/// From the farm: the true state of one robot.
struct State {
  AnswerPart part;
  base::Pose X_WR;
  base::Twist velocity;       ///< in the robot's frame
  std::uint32_t contact = 0;  ///< 1 if a wall or a robot stopped it
  std::uint32_t flags = 0;    ///< kDriverLostBit
  base::Tilt tilt;            ///< of the robot, finite. A level robot's packet has the short form
};

/// From the farm: an unrounded reading, or a part of one.
struct Values {
  AnswerPart part;
  std::uint8_t type = 0;    ///< wire id of the sensor type, in [1, 63]
  std::uint32_t total = 0;  ///< values of the whole reading, in [1, kMaxTotal]
  std::uint32_t first = 0;  ///< index of the first value of this part: a multiple of kMaxValues
  base::Pose X_WS;          ///< pose of the sensor at the measurement
  double bound = std::numeric_limits<double>::infinity();  ///< error bound of all elements; infinite: not stated
  std::span<const std::uint8_t> values;                    ///< f64 each; any numbers; valid as long as the datagram
};
double value_of(const Values& values, std::size_t i);
/// Returns the number of values in the part that begins with `first`.
inline std::size_t count_values(std::uint32_t total, std::uint32_t first) {
  return total - first < kMaxValues ? total - first : kMaxValues;
}

/// Reads a payload of any bytes. The result is complete if the status is `accepted`.
PacketStatus read_payload(std::span<const std::uint8_t> payload, Command& out);
PacketStatus read_payload(std::span<const std::uint8_t> payload, Step& out);
PacketStatus read_payload(std::span<const std::uint8_t> payload, Fetch& out);
PacketStatus read_payload(std::span<const std::uint8_t> payload, State& out);
PacketStatus read_payload(std::span<const std::uint8_t> payload, Values& out);

/// Appends a payload.
void write_payload(const Command& command, base::ByteWriter& writer);
void write_payload(const Step& step, base::ByteWriter& writer);
void write_payload(const Fetch& fetch, base::ByteWriter& writer);
void write_payload(const State& state, base::ByteWriter& writer);
void write_payload(const Values& values, base::ByteWriter& writer);

}  // namespace sf::netio
