// Bytes of lasers.

#include "world/serialization.h"

namespace sf::world {

using base::ByteReader;
using base::ByteWriter;

namespace {

void put(ByteWriter& out, const Pose& pose) { RowWriter{out}.put(pose); }
void put(ByteWriter& out, const Accuracy& accuracy, RowFields fields) { RowWriter{out, fields}.put(accuracy); }

template <class Row>
Row get(ByteReader& in) {
  Row row;
  RowReader{in}.get(row);
  return row;
}
Pose get_pose(ByteReader& in) { return get<Pose>(in); }
Accuracy get_accuracy(ByteReader& in) { return get<Accuracy>(in); }

}  // namespace

void put_laser(ByteWriter& out, const Laser& laser, RowFields fields) {
  out.put_string(laser.name);
  put(out, laser.X_MS);
  for (const double value : {laser.fov, laser.range_min, laser.range_max, laser.rate, laser.phase, laser.latency,
                             laser.noise.range_sigma, laser.noise.range_proportional, laser.noise.angle_sigma}) {
    out.put(value);
  }
  out.put(laser.samples);
  out.put(laser.resolution);
  if (fields == RowFields::all) out.put(laser.color);
  put(out, laser.accuracy, fields);
}

Laser get_laser(ByteReader& in) {
  Laser laser;
  laser.name = in.get_string();
  laser.X_MS = get_pose(in);
  for (double* value : {&laser.fov, &laser.range_min, &laser.range_max, &laser.rate, &laser.phase, &laser.latency,
                        &laser.noise.range_sigma, &laser.noise.range_proportional, &laser.noise.angle_sigma}) {
    *value = in.get<double>();
  }
  laser.samples = in.get<std::uint32_t>();
  laser.resolution = in.get<std::uint32_t>();
  laser.color = in.get<std::uint32_t>();
  laser.accuracy = get_accuracy(in);
  return laser;
}

bool is_valid(const Laser& l) {
  constexpr std::uint32_t kMaxSamples = 1'000'000;  // the world of a recording is untrusted input
  const bool counted = l.samples >= 1 && l.samples <= kMaxSamples && l.resolution >= 1;
  const bool positive = kAboveZero.contains(l.rate) && kAboveZero.contains(l.range_max);
  bool finite = is_within(l.X_MS);
  for (const double value :
       {l.fov, l.range_min, l.phase, l.latency, l.noise.range_sigma, l.noise.range_proportional, l.noise.angle_sigma})
    finite = finite && std::isfinite(value);
  return counted && positive && finite;
}

}  // namespace sf::world
