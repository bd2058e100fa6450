#pragma once
// One valid packet of each type: the worked examples of docs/packets.md.

#include <cmath>
#include <limits>
#include <vector>

#include "base/bytes.h"
#include "netio/packets.h"
#include "tests/netio/command_rows.h"

namespace sf::netio {

/// A reading of type 1 in its first form. Its payload is arbitrary here: a count and three words.
inline base::Bytes reading_example() {
  const std::uint8_t payload[] = {0x03, 0x00, 0xe8, 0x03, 0xfa, 0x00, 0x40, 0x1f};
  base::Bytes out;
  encode_reading({.robot = 7, .sequence = 258, .time = 1'500'000'000, .session = 0x11223344, .token = 0x55667788}, 1,
                 payload, out);
  return out;
}

/// The second form of the same type.
inline base::Bytes extended_example() {
  const std::uint8_t payload[] = {0x38, 0x01, 0x00, 0x00, 0x36, 0x01, 0x00, 0x00, 0x01, 0x00, 0x02, 0x00,
                                  0x02, 0x00, 0x00, 0x00, 0xe7, 0x7f, 0x0c, 0x00, 0xff, 0xff, 0xff, 0xff};
  base::Bytes out;
  encode_reading({.robot = 7, .sensor = 1, .sequence = 4, .time = 2'000'000'000}, 65, payload, out);
  return out;
}

inline base::Bytes v2v_example() {
  base::Bytes out;
  const V2v state{.X_WR = {1.5, -2.25, 0.0, 0.5}, .velocity = {0.25, 0.0, -0.125}, .follows = 3, .docking = true};
  encode({.robot = 7, .sequence = 9, .time = 1'500'000'000}, state, out);
  return out;
}

inline base::Bytes tilted_v2v_example() {
  base::Bytes out;
  const V2v state{.X_WR = {1.5, -2.25, 0.75, 0.5}, .velocity = {0.25, 0.0, -0.125}, .tilt = {0.0625, 0.25}};
  encode({.robot = 7, .sequence = 10, .time = 1'600'000'000}, state, out);
  return out;
}

inline base::Bytes tag_example() {
  base::Bytes out;
  const Tag state{
      .position = {3, 4, 0.5}, .orientation = {0, 0, 0.6, 0.8}, .linear = {0.5, 0, 0}, .angular = {0, 0, 0.25}};
  encode({.robot = 12, .sequence = 1, .time = 66'000'000}, state, out);
  return out;
}

inline base::Bytes subscribe_example() {
  base::Bytes out;
  encode({.robot = 7, .session = 0x55667788, .token = 0x0BADF00D}, Subscribe{1u << 1}, out);
  return out;
}

inline base::Bytes start_example() {
  base::Bytes out;
  encode({.robot = kBroadcastId}, Start{}, out);
  return out;
}

inline base::Bytes leave_example() {
  base::Bytes out;
  encode({.robot = 7, .time = 30'000'000'000}, Leave{}, out);
  return out;
}

inline base::Bytes refusal_example() {
  base::Bytes out;
  encode({.robot = 7, .time = 1'500'000'000, .session = 0x11223344, .token = 0x55667788},
         Refusal{PacketStatus::wrong_signature}, out);
  return out;
}

inline base::Bytes drive_example() {
  base::Bytes out;
  encode({.robot = 7, .sequence = 41, .time = 4'100'000'000, .session = 0x11223344, .token = 0x55667788},
         Drive{{0.25, 0.0, -0.125}}, out);
  return out;
}

inline base::Bytes challenge_example() {
  base::Bytes out;
  encode({.robot = 7, .session = 0x11223344, .token = 0x55667788}, Challenge{0x0BADF00D}, out);
  return out;
}

/// One light and its stop line.
inline base::Bytes v2i_example() {
  base::Bytes approaches, stops, out;
  put(SignalApproach{.group = 1, .state = 3, .next = 2, .left = 6.5, .X_WL = {1.5, -2.25, 0.25, 0.5}}, approaches);
  put(SignalStop{.group = 1, .segment = 3, .lane = 1, .point = 11, .x = 1.25, .y = -3.0, .heading = 1.5, .width = 0.5},
      stops);
  encode({.robot = 2, .sequence = 17, .time = 9'500'000'000}, V2i{approaches, stops}, out);
  return out;
}

inline base::Bytes object_example() {
  base::Bytes out;
  encode({.robot = 12, .sequence = 3, .time = 30'000'000'000}, Object{false}, out);
  return out;
}

inline base::Bytes shaped_object_example() {
  base::Bytes out;
  encode({.robot = 12, .sequence = 5, .time = 32'000'000'000},
         Object{.present = true, .shape = "crate", .color = 0xFFFF0000u, .size = std::array{1.5, 0.5, 0.25}}, out);
  return out;
}

inline base::Bytes lane_example() {
  base::Bytes out;
  encode({.robot = kBroadcastId}, Lane{3, 1, 1}, out);
  return out;
}

/// An acknowledgement of robot 3, a claim of two rows of cells, and the last piece of measurements: cell 3725 is free.
inline base::Bytes team_map_example() {
  const std::uint8_t piece[] = {0x01, 0xb4, 0x74, 0x00, 0x00};
  base::Bytes acks, claim, out;
  put(MapAck{3, 0x55667788, 41, 6}, acks);
  for (const ClaimRun& run : {ClaimRun{3725, 6}, ClaimRun{114, 6}}) put(run, claim);
  const TeamMap map{-1.8, 1.8, 0.03, 30, 30, 5, true, true, false, acks, claim, piece};
  encode({.robot = 7, .sequence = 12, .time = 6'500'000'000, .session = 0x11223344}, map, out);
  return out;
}

/// Three transducers: 1.2345 m, no echo, not measured.
inline base::Bytes own_readings_example() {
  base::Bytes words, out;
  for (const double range : {1.2345, HUGE_VAL, std::numeric_limits<double>::quiet_NaN()}) put_own_range(range, words);
  encode({.robot = 7, .sequence = 21, .time = 6'600'000'000, .session = 0x11223344, .token = 0x55667788},
         OwnReadings{.type = kOwnSonar, .count = 3, .total = 3, .words = words}, out);
  return out;
}

/// Readings of laser 1 that were not measured, and not sent.
inline base::Bytes dropped_example() {
  base::Bytes out;
  encode({.robot = 7, .sensor = 1, .sequence = 2, .time = 6'700'000'000, .session = 0x11223344, .token = 0x55667788},
         Dropped{1, 12, 3}, out);
  return out;
}

/// Forwarded states of two other robots.
inline base::Bytes neighbours_example() {
  base::Bytes first = v2v_example(), second, out;
  encode({.robot = 9, .sequence = 4, .time = 1'400'000'000}, V2v{.X_WR = {3, 0, 0, 0}}, second);
  const SessionToken receiver{0x11223344, 0x55667788};
  for (base::Bytes* state : {&first, &second}) write_session_token(*state, receiver);
  first.insert(first.end(), second.begin(), second.end());
  encode({.robot = 3, .sequence = 15, .time = 1'600'000'000, .session = receiver.session, .token = receiver.token},
         Neighbours{first}, out);
  return out;
}

/// States and requests that are sent to the farm or to other robots.
inline std::vector<base::Bytes> states() {
  return {v2v_example(), tag_example(),    subscribe_example(), start_example(),       leave_example(),
          v2i_example(), object_example(), team_map_example(),  own_readings_example()};
}

/// Packets from the farm, in order of type number.
inline std::vector<base::Bytes> examples() {
  return {reading_example(),      extended_example(),   v2v_example(),       tag_example(),  subscribe_example(),
          start_example(),        leave_example(),      challenge_example(), v2i_example(),  object_example(),
          refusal_example(),      neighbours_example(), drive_example(),     lane_example(), team_map_example(),
          own_readings_example(), dropped_example()};
}

inline base::Bytes command_example() {
  base::Bytes rows, out;
  add_row({7, {0.25, 0.0, -0.125}}, rows);
  add_row({9, {0.5, 0.0, 0.0}}, rows);
  encode({.robot = 7, .sequence = 240, .session = 0x55667788, .token = 0x0BADF00D}, Command{120, rows}, out);
  return out;
}

inline base::Bytes step_example() {
  base::Bytes out;
  encode({.robot = 7, .sequence = 120, .session = 0x55667788, .token = 0x0BADF00D}, Step{120, 1, 2}, out);
  return out;
}

inline base::Bytes fetch_example() {
  base::Bytes out;
  encode({.robot = 7, .sequence = 3, .session = 0x55667788, .token = 0x0BADF00D}, Fetch{121, 64, 64}, out);
  return out;
}

inline base::Bytes state_example() {
  base::Bytes out;
  encode({.robot = 7, .sequence = 121, .time = 12'100'000'000, .session = 0x11223344, .token = 0x55667788},
         State{{121, 0, 3}, {1.5, -2.25, 0.0, 0.5}, {0.25, 0.0, -0.125}, 1, 0}, out);
  return out;
}

inline base::Bytes values_example() {
  const std::array ranges{1.0, 0.2503, HUGE_VAL};
  base::Bytes bytes, out;
  base::ByteWriter writer(bytes);
  for (const double range : ranges) writer.put(range);
  encode({.robot = 7,
          .sequence = 240,
          .time = 12'000'000'000,
          .accuracy = encode_accuracy({0, false, 1e-9}),
          .session = 0x11223344,
          .token = 0x55667788},
         Values{{121, 1, 3}, 1, 3, 0, {1.6, -2.2, 0.05, 0.5}, 1e-9, bytes}, out);
  return out;
}

/// Packets of lockstep.
inline std::vector<base::Bytes> lockstep_examples() {
  return {command_example(), step_example(), fetch_example(), state_example(), values_example()};
}

inline std::vector<base::Bytes> all_examples() {
  std::vector<base::Bytes> all = examples();
  for (const base::Bytes& each : lockstep_examples()) all.push_back(each);
  return all;
}

/// Overwrites the value at `offset`.
template <class T>
base::Bytes patched(base::Bytes bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
  return bytes;
}

}  // namespace sf::netio
