#include "server/packet_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/tilted_pose.h"
#include "maps/map_packets.h"
#include "netio/packet_forms.h"
#include "sensors/camera.h"
#include "sensors/gps.h"
#include "sensors/image_packets.h"
#include "sensors/imu.h"
#include "sensors/laser_packets.h"
#include "sensors/lidar.h"
#include "sensors/lidar_packets.h"
#include "sensors/occupancy.h"
#include "server/sensor_streams.h"

namespace sf::server {

namespace {

using netio::PacketStatus;
using Fields = std::vector<PacketField>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string number_text(double value) { return std::isnan(value) ? "none" : fmt::format("{:.10g}", value); }

template <class Whole>
requires std::is_integral_v<Whole>
void add(Fields& out, std::string name, Whole value) {
  out.push_back({std::move(name), static_cast<std::int64_t>(value)});
}
void add(Fields& out, std::string name, double value) { out.push_back({std::move(name), value}); }
template <class Numbers>
requires std::ranges::range<Numbers>
void add(Fields& out, std::string name, const Numbers& numbers) {
  out.push_back({std::move(name), std::vector<double>(numbers.begin(), numbers.end())});
}
void add_id(Fields& out, std::string name, std::uint32_t id) {
  if (id == netio::kNone) return add(out, std::move(name), kNan);
  add(out, std::move(name), id);
}

void add_header(const netio::Header& header, Fields& out) {
  add(out, "type", static_cast<int>(header.type));
  add(out, "robot", header.robot);
  add(out, "sensor", header.sensor);
  add(out, "sequence", header.sequence);
  add(out, "time_ns", header.time);
  add(out, "session", header.session);
  add(out, "token", header.token);
  const bool is_reading = netio::sensor_type_of(header.type) != 0;
  if (is_reading || header.type == netio::Type::values) {
    const netio::Accuracy accuracy = netio::decode_accuracy(header.accuracy);
    add(out, "mode", accuracy.mode);
    add(out, "unsure", accuracy.unsure);
    add(out, "bound", std::isinf(accuracy.bound) ? kNan : accuracy.bound);
  }
  if (header.fused) add(out, "fused", header.fused);
  if (!is_reading && !header.state.stated) return;
  constexpr std::int64_t kMost = 0xFFFFFFFF;  // saturates: larger ages are stated as this
  add(out, "age_us", std::min(header.state.age / 1000, kMost));
  add(out, "stale", header.state.stale);
  add(out, "covariance", header.state.covariance);
}

/// Packets of level robots have no such field.
void add_tilt(const base::Tilt& tilt, Fields& out) {
  if (!base::is_level(tilt)) add(out, "tilt", std::array{tilt.roll, tilt.pitch});
}

void add_body(const netio::V2v& state, Fields& out) {
  add_id(out, "follows", state.follows);
  add_id(out, "checkpoint", state.checkpoint);
  add(out, "docking", state.docking);
  add(out, "pose", std::array{state.X_WR.x, state.X_WR.y, state.X_WR.z, state.X_WR.yaw});
  add(out, "velocity", std::array{state.velocity.forward, state.velocity.left, state.velocity.turn});
  add_tilt(state.tilt, out);
}
void add_body(const netio::Tag& state, Fields& out) {
  add(out, "position", state.position);
  add(out, "orientation", state.orientation);
  add(out, "linear", state.linear);
  add(out, "angular", state.angular);
}
void add_body(const netio::Subscribe& request, Fields& out) { add(out, "types", request.types); }
void add_body(const netio::Start&, Fields&) {}
void add_body(const netio::Drive& drive, Fields& out) {
  add(out, "velocity", std::array{drive.twist.forward, drive.twist.left, drive.twist.turn});
}
void add_body(const netio::Lane& lane, Fields& out) {
  add(out, "segment", lane.segment);
  add(out, "lane", lane.lane);
  add(out, "use", lane.rule + (lane.reversed ? 8u : 0u));
}
void add_body(const netio::Leave&, Fields&) {}
void add_body(const netio::Refusal& refusal, Fields& out) {
  const bool by_source = refusal.reason == netio::PacketStatus::wrong_source;
  add(out, "reason",
      by_source ? 4 : static_cast<int>(refusal.reason) - static_cast<int>(netio::PacketStatus::not_signed) + 1);
}
void add_body(const netio::Challenge& challenge, Fields& out) { add(out, "challenge", challenge.token); }

/// Adds one list of robots, and per robot forward, left and turn.
void add_body(const netio::Command& command, Fields& out) {
  std::vector<double> robots, twists;
  for (std::size_t i = 0; i < netio::count_rows(command); ++i) {
    const netio::CommandRow row = netio::row_of(command, i);
    robots.push_back(row.robot);
    twists.insert(twists.end(), {row.twist.forward, row.twist.left, row.twist.turn});
  }
  add(out, "tick", command.tick);
  add(out, "robots", robots);
  add(out, "twists", twists);
}
void add_body(const netio::Step& step, Fields& out) {
  add(out, "tick", step.tick);
  add(out, "ticks", step.ticks);
  add(out, "commands", step.commands);
}
void add_body(const netio::Fetch& fetch, Fields& out) {
  add(out, "tick", fetch.tick);
  add(out, "first", fetch.first);
  add(out, "count", fetch.count);
}
void add_part(const netio::AnswerPart& part, Fields& out) {
  add(out, "tick", part.tick);
  add(out, "index", part.index);
  add(out, "datagrams", part.datagrams);
}
void add_body(const netio::State& state, Fields& out) {
  add_part(state.part, out);
  add(out, "contact", state.contact);
  add(out, "flags", state.flags);
  add(out, "pose", std::array{state.X_WR.x, state.X_WR.y, state.X_WR.z, state.X_WR.yaw});
  add(out, "velocity", std::array{state.velocity.forward, state.velocity.left, state.velocity.turn});
  add_tilt(state.tilt, out);
}
void add_body(const netio::Values& values, Fields& out) {
  add_part(values.part, out);
  add(out, "values_type", values.type);
  add(out, "total", values.total);
  add(out, "first", values.first);
  add(out, "sensor_pose", std::array{values.X_WS.x, values.X_WS.y, values.X_WS.z, values.X_WS.yaw});
  add(out, "error", std::isinf(values.bound) ? kNan : values.bound);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < values.values.size() / sizeof(double); ++i) numbers.push_back(netio::value_of(values, i));
  add(out, "value", numbers);
}

/// Adds approaches, then stop lines, each column separately.
void add_body(const netio::V2i& signals, Fields& out) {
  std::vector<double> group, state, next, left, light, stop_group, stop_point, stop_line;
  for (std::size_t k = 0; k < netio::count(signals.approaches); ++k) {
    const netio::SignalApproach a = netio::approach_at(signals, k);
    group.push_back(a.group);
    state.push_back(a.state);
    next.push_back(a.next == netio::kNoSignalState ? kNan : a.next);
    left.push_back(std::isinf(a.left) ? kNan : a.left);
    light.insert(light.end(), {a.X_WL.x, a.X_WL.y, a.X_WL.z, a.X_WL.yaw});
  }
  for (std::size_t k = 0; k < netio::count(signals.stops); ++k) {
    const netio::SignalStop s = netio::stop_at(signals, k);
    stop_group.push_back(s.group);
    for (const std::uint16_t id : {s.segment, s.lane, s.point}) stop_point.push_back(id);
    stop_line.insert(stop_line.end(), {s.x, s.y, s.heading, s.width});
  }
  add(out, "group", group);
  add(out, "state", state);
  add(out, "next", next);
  add(out, "left_s", left);
  add(out, "light", light);
  add(out, "stop_group", stop_group);
  add(out, "stop_point", stop_point);
  add(out, "stop_line", stop_line);
}
/// Adds the rows as three lists: of robot, session, pieces and later ones; of skipped and claimed cells; of bytes.
void add_body(const netio::TeamMap& map, Fields& out) {
  add(out, "left_m", map.left);
  add(out, "top_m", map.top);
  add(out, "cell_m", map.cell);
  add(out, "word_columns", map.word_columns);
  add(out, "word_rows", map.word_rows);
  add(out, "piece", map.piece);
  add(out, "flags", netio::flags_of(map));
  std::vector<double> acks, claim;
  for (std::size_t k = 0; k < netio::count_acks(map); ++k) {
    const netio::MapAck ack = netio::ack_at(map, k);
    for (const std::uint32_t number : {ack.robot, ack.session, ack.pieces, ack.later}) acks.push_back(number);
  }
  for (std::size_t k = 0; k < netio::count_runs(map); ++k)
    for (const std::uint16_t number : {netio::run_at(map, k).skip, netio::run_at(map, k).take}) claim.push_back(number);
  add(out, "acks", acks);
  add(out, "claim", claim);
  add(out, "data", map.bytes);
}
void add_body(const netio::Dropped& dropped, Fields& out) {
  add(out, "readings_type", dropped.type);
  add(out, "processor", dropped.processor);
  add(out, "network", dropped.network);
}
void add_body(const netio::OwnReadings& readings, Fields& out) {
  add(out, "readings_type", readings.type);
  add(out, "total", readings.total);
  add(out, "first", readings.first);
  add(out, "fov_urad", readings.fov);
  std::vector<double> values;
  for (std::size_t k = 0; k < readings.count; ++k) values.push_back(netio::value_of(readings, k));
  add(out, "value", values);
}
/// A long OBJECT has all fields: what it leaves as it is, is none.
void add_body(const netio::Object& object, Fields& out) {
  add(out, "present", object.present);
  if (!object.changes_shape()) return;
  out.push_back({"shape", object.shape.empty() ? "none" : object.shape});
  if (object.color) add(out, "color", *object.color);
  if (!object.color) add(out, "color", kNan);
  add(out, "size_m", object.size.value_or(std::array{kNan, kNan, kNan}));
}

/// Adds the states, prefixed by their index: "0.robot", ... States that are not valid V2V are omitted.
void add_body(const netio::Neighbours& neighbours, Fields& out) {
  for (std::size_t i = 0; i < neighbours.states.size() / netio::kV2vBytes; ++i) {
    netio::Packet packet;
    const auto bytes = neighbours.states.subspan(i * netio::kV2vBytes, netio::kV2vBytes);
    if (netio::decode(bytes, packet) != PacketStatus::accepted) continue;
    const auto* state = std::get_if<netio::V2v>(&packet.body);
    if (state == nullptr) continue;
    Fields fields;
    add_header(packet.header, fields);
    add_body(*state, fields);
    for (PacketField& field : fields) out.push_back({fmt::format("{}.{}", i, field.name), std::move(field.value)});
  }
}

/// Adds which part of a reading an extended packet carries.
template <class Part>
void add_part(const Part& part, Fields& out) {
  add(out, "total", part.total);
  add(out, "first", part.first);
  add(out, "part", part.part);
  add(out, "parts", part.parts);
}

/// Adds the columns of a scan, and which part of it an extended packet carries.
/// @param values element by element, `width` numbers each
template <class Part>
void add_scan(const sensors::SensorType& type, const Part& part, bool extended, std::span<const double> values,
              std::size_t width, Fields& out) {
  if (extended) add_part(part, out);
  for (std::size_t column = 0; column < width; ++column) {
    std::vector<double> numbers;
    for (std::size_t i = column; i < values.size(); i += width) numbers.push_back(values[i]);
    add(out, std::string(type.columns[column].name), numbers);
  }
}

void add_map(std::span<const std::uint8_t> payload, Fields& out) {
  maps::MapPart map;
  maps::read_part(payload, map);
  add(out, "left_m", map.geometry.left);
  add(out, "top_m", map.geometry.top);
  add(out, "cell_m", map.geometry.cell);
  add(out, "part", map.part);
  add(out, "parts", map.parts);
  add(out, "word_columns", map.geometry.word_columns);
  add(out, "word_rows", map.geometry.word_rows);
  add(out, "flags", map.flags);
  std::vector<double> words;
  for (std::uint32_t i = 0; i < map.count; ++i) words.push_back(maps::word_of(map, i));
  add(out, "word", words);
}

/// Adds the columns of a reading that fits one datagram.
/// @param elements its rows
void add_columns(const sensors::SensorType& type, std::uint32_t elements, std::span<const std::uint8_t> payload,
                 Fields& out) {
  constexpr std::size_t kHead = 4, kNumber = 4;  // [bytes] of sensors that may have their first columns only
  const bool partial = type.id == sensors::kGps || type.id == sensors::kImu;
  const std::size_t width = partial ? (payload.size() - kHead) / (kNumber * elements) : sensors::element_width(type);
  std::vector<double> values(elements * width);
  type.read({.elements = elements}, payload, type.id, sensors::WireFormat::farm, values);
  std::size_t first = 0;
  for (const sensors::Column& column : type.columns) {
    if (first >= width) break;
    std::vector<double> numbers;
    for (std::size_t row = 0; row < elements; ++row)
      for (std::size_t k = 0; k < column.width; ++k) numbers.push_back(values[row * width + first + k]);
    add(out, std::string(column.name), numbers);
    first += column.width;
  }
}

PacketStatus add_reading(const netio::Header& header, std::span<const std::uint8_t> payload,
                         const sensors::SensorType& type, Fields& out) {
  const sensors::SensorSpec any{.elements = 0};
  const netio::PayloadInfo info = inspect_payload({&type, &any}, sensors::WireFormat::farm, header, payload);
  if (info.status != PacketStatus::accepted) return info.status;
  const bool extended = static_cast<std::uint8_t>(header.type) >= sensors::kExtended;
  if (sensors::camera_form(static_cast<std::uint8_t>(header.type), payload) >= sensors::kPngForm) {
    sensors::ImagePart image;
    sensors::read_image(payload, image);
    add_part(image, out);
    add(out, "form", image.form);
    add(out, "image", std::vector<double>(image.bytes.begin(), image.bytes.end()));
  } else if (type.id == sensors::kLidar || type.id == sensors::kCamera) {
    sensors::LidarPart scan;
    sensors::read_lidar(payload, extended, scan);
    add_scan(type, scan, extended, scan.values, scan.width, out);
  } else if (type.is_scan) {
    sensors::LaserPart scan;
    sensors::read_laser(payload, extended, scan);
    std::vector<double> ranges;
    for (std::uint32_t i = 0; i < scan.count; ++i) ranges.push_back(sensors::range_of(scan, i));
    add_scan(type, scan, extended, ranges, 1, out);
  } else if (type.id == sensors::kOccupancy) {
    add_map(payload, out);
  } else {
    add_columns(type, info.elements, payload, out);
  }
  return PacketStatus::accepted;
}

std::string_view packet_type_name(netio::Type type) {
  const netio::PacketForm* const form = netio::find_packet_form(type);
  return form != nullptr ? form->name : sensors::find_sensor_type(netio::sensor_type_of(type))->name;
}

}  // namespace

std::string packet_field_text(const PacketField& field) {
  if (const auto* whole = std::get_if<std::int64_t>(&field.value)) return std::to_string(*whole);
  if (const auto* number = std::get_if<double>(&field.value)) return number_text(*number);
  if (const auto* text = std::get_if<std::string>(&field.value)) return *text;
  std::string text;
  for (const double number : std::get<std::vector<double>>(field.value))
    text += (text.empty() ? "" : " ") + number_text(number);
  return text;
}

PacketDescription describe_packet(std::span<const std::uint8_t> bytes) {
  PacketDescription out;
  netio::Packet packet;
  out.status = netio::decode(bytes, packet);
  if (out.status != PacketStatus::accepted) return out;
  const std::uint8_t id = netio::sensor_type_of(packet.header.type);
  const sensors::SensorType* type = sensors::find_sensor_type(id);
  if (id != 0 && type == nullptr) out.status = PacketStatus::unknown_type;
  if (out.status != PacketStatus::accepted) return out;
  out.header = packet.header;
  out.name = packet_type_name(packet.header.type);
  add_header(packet.header, out.fields);
  out.header_fields = out.fields.size();
  std::visit(
      [&](const auto& body) {
        if constexpr (std::is_same_v<std::decay_t<decltype(body)>, netio::Reading>) {
          out.status = add_reading(packet.header, body.payload, *type, out.fields);
        } else {
          add_body(body, out.fields);
        }
      },
      packet.body);
  return out;
}

}  // namespace sf::server
