#include "netio/lockstep_packets.h"

#include <array>
#include <cmath>

#include "base/tilted_pose.h"
#include "netio/packets.h"

namespace sf::netio {

namespace {

constexpr std::size_t kCommandHead = 16, kValuesHead = 72;  ///< [byte]
static_assert(kCommandHead + kMaxCommands * kCommandRowBytes <= kMaxPayload);
static_assert(kValuesHead + kMaxValues * sizeof(double) == kMaxPayload);

PacketStatus status_if(bool fine) { return fine ? PacketStatus::accepted : PacketStatus::out_of_range; }

PacketStatus compare_size(std::size_t size, std::size_t expected) {
  if (size == expected) return PacketStatus::accepted;
  return size < expected ? PacketStatus::too_short : PacketStatus::too_long;
}

bool all_finite(std::span<const double> numbers) {
  for (const double number : numbers)
    if (!std::isfinite(number)) return false;
  return true;
}

AnswerPart get_part(base::ByteReader& reader) {
  AnswerPart part;
  part.tick = reader.get<std::uint64_t>();
  part.index = reader.get<std::uint32_t>();
  part.datagrams = reader.get<std::uint32_t>();
  return part;
}
void put_part(const AnswerPart& part, base::ByteWriter& writer) {
  writer.put(part.tick);
  writer.put(part.index);
  writer.put(part.datagrams);
}

base::Pose get_pose(base::ByteReader& reader) {
  base::Pose pose;
  for (double* each : {&pose.x, &pose.y, &pose.z, &pose.yaw}) *each = reader.get<double>();
  return pose;
}
void put_pose(const base::Pose& pose, base::ByteWriter& writer) {
  for (const double each : {pose.x, pose.y, pose.z, pose.yaw}) writer.put(each);
}

base::Twist get_twist(base::ByteReader& reader) {
  base::Twist twist;
  for (double* each : {&twist.forward, &twist.left, &twist.turn}) *each = reader.get<double>();
  return twist;
}
void put_twist(const base::Twist& twist, base::ByteWriter& writer) {
  for (const double each : {twist.forward, twist.left, twist.turn}) writer.put(each);
}

/// Returns the first fault of a row; not_finite takes precedence over out_of_range.
PacketStatus check_row(const CommandRow& row) {
  const std::array numbers{row.twist.forward, row.twist.left, row.twist.turn};
  if (!all_finite(numbers)) return PacketStatus::not_finite;
  bool within = row.robot <= kMaxId;
  for (const double number : numbers) within = within && std::abs(number) <= kMaxSpeed;
  return status_if(within);
}

}  // namespace

CommandRow row_of(const Command& command, std::size_t i) {
  base::ByteReader reader(command.rows.subspan(i * kCommandRowBytes, kCommandRowBytes));
  CommandRow row;
  row.twist = get_twist(reader);
  row.robot = reader.get<std::uint32_t>();
  return row;
}

double value_of(const Values& values, std::size_t i) {
  return base::ByteReader(values.values.subspan(i * sizeof(double))).get<double>();
}

PacketStatus read_payload(std::span<const std::uint8_t> payload, Command& out) {
  if (payload.size() < kCommandHead) return PacketStatus::too_short;
  base::ByteReader reader(payload);
  out.tick = reader.get<std::uint64_t>();
  const auto count = reader.get<std::uint32_t>();
  const PacketStatus sized = compare_size(payload.size() - kCommandHead, std::size_t{count} * kCommandRowBytes);
  if (sized != PacketStatus::accepted) return sized;
  out.rows = payload.subspan(kCommandHead);
  if (count < 1 || count > kMaxCommands) return PacketStatus::out_of_range;
  PacketStatus found = PacketStatus::accepted;
  for (std::size_t i = 0; i < count; ++i) {
    const PacketStatus status = check_row(row_of(out, i));
    if (status == PacketStatus::not_finite) return status;
    if (found == PacketStatus::accepted) found = status;
  }
  return found;
}

PacketStatus read_payload(std::span<const std::uint8_t> payload, Step& out) {
  base::ByteReader reader(payload);
  out.tick = reader.get<std::uint64_t>();
  out.ticks = reader.get<std::uint32_t>();
  out.commands = reader.get<std::uint32_t>();
  const PacketStatus sized = compare_size(payload.size(), kStepBytes);
  if (sized != PacketStatus::accepted) return sized;
  return status_if(out.ticks >= 1 && out.ticks <= kMaxTicks && out.commands <= kMaxStepCommands);
}

PacketStatus read_payload(std::span<const std::uint8_t> payload, Fetch& out) {
  base::ByteReader reader(payload);
  out.tick = reader.get<std::uint64_t>();
  out.first = reader.get<std::uint32_t>();
  out.count = reader.get<std::uint32_t>();
  const PacketStatus sized = compare_size(payload.size(), kStepBytes);
  if (sized != PacketStatus::accepted) return sized;
  return status_if(out.count >= 1 && out.count <= kMaxFetched);
}

PacketStatus read_payload(std::span<const std::uint8_t> payload, State& out) {
  base::ByteReader reader(payload);
  out.part = get_part(reader);
  out.X_WR = get_pose(reader);
  out.velocity = get_twist(reader);
  out.contact = reader.get<std::uint32_t>();
  out.flags = reader.get<std::uint32_t>();
  const bool tilted = payload.size() == kStateBytes + kTiltBytes;
  const PacketStatus sized = tilted ? PacketStatus::accepted : compare_size(payload.size(), kStateBytes);
  if (sized != PacketStatus::accepted) return sized;
  if (tilted) out.tilt.roll = reader.get<double>(), out.tilt.pitch = reader.get<double>();
  const std::array numbers{out.X_WR.x,        out.X_WR.y,        out.X_WR.z,    out.X_WR.yaw,  out.velocity.forward,
                           out.velocity.left, out.velocity.turn, out.tilt.roll, out.tilt.pitch};
  if (!all_finite(numbers)) return PacketStatus::not_finite;
  return status_if(out.part.index < out.part.datagrams && out.contact <= 1 && out.flags <= kDriverLostBit);
}

PacketStatus read_payload(std::span<const std::uint8_t> payload, Values& out) {
  if (payload.size() < kValuesHead) return PacketStatus::too_short;
  base::ByteReader reader(payload);
  out.part = get_part(reader);
  const auto type = reader.get<std::uint16_t>();
  const auto count = reader.get<std::uint16_t>();
  out.type = static_cast<std::uint8_t>(type);
  out.total = reader.get<std::uint32_t>();
  out.first = reader.get<std::uint32_t>();
  reader.get<std::uint32_t>();
  out.X_WS = get_pose(reader);
  out.bound = reader.get<double>();
  out.values = payload.subspan(kValuesHead);
  const PacketStatus sized = compare_size(out.values.size(), count * sizeof(double));
  if (sized != PacketStatus::accepted) return sized;
  if (!all_finite(std::array{out.X_WS.x, out.X_WS.y, out.X_WS.z, out.X_WS.yaw}) || std::isnan(out.bound))
    return PacketStatus::not_finite;
  const bool placed = out.total >= 1 && out.total <= kMaxTotal && out.first < out.total &&
                      out.first % kMaxValues == 0 && count == count_values(out.total, out.first);
  return status_if(placed && type >= 1 && type <= 63 && out.part.index < out.part.datagrams && out.bound >= 0.0);
}

void write_payload(const Command& command, base::ByteWriter& writer) {
  writer.put(command.tick);
  writer.put(static_cast<std::uint32_t>(count_rows(command)));
  writer.put(std::uint32_t{0});
  writer.put_bytes(command.rows.data(), command.rows.size());
}

void write_payload(const Step& step, base::ByteWriter& writer) {
  writer.put(step.tick);
  writer.put(step.ticks);
  writer.put(step.commands);
}

void write_payload(const Fetch& fetch, base::ByteWriter& writer) {
  writer.put(fetch.tick);
  writer.put(fetch.first);
  writer.put(fetch.count);
}

void write_payload(const State& state, base::ByteWriter& writer) {
  put_part(state.part, writer);
  put_pose(state.X_WR, writer);
  put_twist(state.velocity, writer);
  writer.put(state.contact);
  writer.put(state.flags);
  if (base::is_level(state.tilt)) return;
  for (const double each : {state.tilt.roll, state.tilt.pitch}) writer.put(each);
}

void write_payload(const Values& values, base::ByteWriter& writer) {
  put_part(values.part, writer);
  writer.put(std::uint16_t{values.type});
  writer.put(static_cast<std::uint16_t>(values.values.size() / sizeof(double)));
  writer.put(values.total);
  writer.put(values.first);
  writer.put(std::uint32_t{0});
  put_pose(values.X_WS, writer);
  writer.put(values.bound);
  writer.put_bytes(values.values.data(), values.values.size());
}

}  // namespace sf::netio
