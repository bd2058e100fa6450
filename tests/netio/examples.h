#pragma once
// One valid packet of each type: the worked examples of docs/packets.md.

#include <string>
#include <vector>

#include "base/bytes.h"
#include "netio/laser_packets.h"
#include "netio/packets.h"

namespace sf::netio {

inline base::Bytes laser_example() {
  base::Bytes out;
  encode_laser(Wire::farm, {.robot = 7, .sequence = 258, .time = 1'500'000'000}, std::vector{1.0, 0.25, 8.0}, 8.0, 0,
               out);
  return out;
}

inline base::Bytes laser_extended_example() {
  std::vector<double> ranges(342, 1.0);
  ranges[340] = 81.9175;
  ranges[341] = INFINITY;
  base::Bytes out;
  encode_laser(Wire::farm, {.robot = 7, .sensor = 1, .sequence = 4, .time = 2'000'000'000}, ranges, 100.0, 1, out);
  return out;
}

inline base::Bytes v2v_example() {
  base::Bytes out;
  const V2v state{.X_WR = {1.5, -2.25, 0.0, 0.5}, .velocity = {0.25, 0.0, -0.125}, .follows = 3, .docking = true};
  encode({.robot = 7, .sequence = 9, .time = 1'500'000'000}, state, out);
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
  encode({.robot = 7}, Subscribe{1u << 1}, out);
  return out;
}

inline base::Bytes thesis_example() {
  base::Bytes out;
  encode_laser(Wire::thesis, {}, std::vector{1.0, 0.25, 8.0}, 8.0, 0, out);
  return out;
}

/// The farm's own packets, in order of type number.
inline std::vector<base::Bytes> examples() {
  return {laser_example(), laser_extended_example(), v2v_example(), tag_example(), subscribe_example()};
}

/// Overwrites the value at `offset`.
template <class T>
base::Bytes patched(base::Bytes bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
  return bytes;
}

}  // namespace sf::netio
