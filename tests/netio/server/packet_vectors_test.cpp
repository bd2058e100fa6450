// The farm's encoder and decoder on the golden packets: bytes to the file's text, and what was decoded to the bytes.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "maps/map_packets.h"
#include "netio/packets.h"
#include "netio/server/sensor_streams.h"
#include "sensors/laser_packets.h"
#include "tests/netio/vectors.h"

namespace sf::server {
namespace {

using netio::PacketStatus;

template <class Values>
std::string list_of(const Values& values) {
  std::string text;
  for (const double value : values)
    text += (text.empty() ? "" : " ") + (std::isnan(value) ? "none" : fmt::format("{:.10g}", value));
  return text;
}

std::string id_text(std::uint32_t id) { return id == netio::kNone ? "none" : std::to_string(id); }

std::string text_of(const netio::Header& header) {
  std::string text =
      fmt::format("type = {}\nrobot = {}\nsensor = {}\nsequence = {}\ntime_ns = {}\n", static_cast<int>(header.type),
                  header.robot, header.sensor, header.sequence, header.time) +
      fmt::format("session = {}\ntoken = {}\n", header.session, header.token);
  if (netio::sensor_type_of(header.type) == 0) return text;
  const netio::Accuracy accuracy = netio::decode_accuracy(header.accuracy);
  return text +
         fmt::format("mode = {}\nunsure = {:d}\nbound = {}\n", accuracy.mode, accuracy.unsure,
                     std::isinf(accuracy.bound) ? "none" : fmt::format("{:.10g}", accuracy.bound)) +
         fmt::format("age_us = {}\nstale = {:d}\ncovariance = {}\n", header.state.age / 1000, header.state.stale,
                     list_of(header.state.covariance));
}

std::string text_of(const netio::V2v& state) {
  const base::Pose& pose = state.X_WR;
  const base::Twist& velocity = state.velocity;
  return fmt::format("follows = {}\ncheckpoint = {}\ndocking = {:d}\npose = {}\nvelocity = {}\n",
                     id_text(state.follows), id_text(state.checkpoint), state.docking,
                     list_of(std::array{pose.x, pose.y, pose.z, pose.yaw}),
                     list_of(std::array{velocity.forward, velocity.left, velocity.turn}));
}
std::string text_of(const netio::Tag& state) {
  return fmt::format("position = {}\norientation = {}\nlinear = {}\nangular = {}\n", list_of(state.position),
                     list_of(state.orientation), list_of(state.linear), list_of(state.angular));
}
std::string text_of(const netio::Subscribe& request) { return fmt::format("types = {}\n", request.types); }
std::string text_of(const netio::Start&) { return ""; }
std::string text_of(const netio::Leave&) { return ""; }
std::string text_of(const netio::Challenge& challenge) { return fmt::format("challenge = {}\n", challenge.token); }

std::string text_of(const netio::Neighbours& neighbours) {
  std::string text;
  for (std::size_t at = 0; at < neighbours.states.size(); at += netio::kV2vBytes) {
    netio::Packet state;
    EXPECT_EQ(netio::decode(neighbours.states.subspan(at, netio::kV2vBytes), state), PacketStatus::accepted);
    std::istringstream lines(text_of(state.header) + text_of(std::get<netio::V2v>(state.body)));
    for (std::string line; std::getline(lines, line);) text += fmt::format("{}.{}\n", at / netio::kV2vBytes, line);
  }
  return text;
}

/// A reading's payload in the sensor type's own terms.
struct Decoded {
  const sensors::SensorType* type = nullptr;
  sensors::SensorSpec spec;
  std::vector<double> values;  ///< of the whole reading
  base::ReadingBlock block;    ///< refers to `values`
  std::uint32_t part = 0;
  std::string text;
};

/// Fills in the sensor of a scan and the place of this part.
/// @return elements of the part, and the first of them
std::pair<std::uint32_t, std::uint32_t> place_laser(std::span<const std::uint8_t> payload, bool extended,
                                                    Decoded& out) {
  sensors::LaserPart scan;
  EXPECT_EQ(sensors::read_laser(payload, extended, scan), sensors::PayloadError::none);
  out.spec.elements = scan.total;
  out.spec.limit = extended ? 1e6 : sensors::kPlainRange;
  if (extended)
    out.text =
        fmt::format("total = {}\nfirst = {}\npart = {}\nparts = {}\n", scan.total, scan.first, scan.part, scan.parts);
  return {scan.count, scan.first};
}

std::pair<std::uint32_t, std::uint32_t> place_map(std::span<const std::uint8_t> payload, Decoded& out) {
  maps::MapPart map;
  EXPECT_EQ(maps::read_part(payload, map), maps::PartFault::none);
  out.spec.elements = maps::words(map.geometry);
  out.spec.across = map.geometry.word_columns;
  out.spec.pitch = map.geometry.cell;
  out.block.X_WS = {map.geometry.left, map.geometry.top, 0.0, 0.0};
  out.block.flags = map.flags;
  out.text = fmt::format("left_m = {:.10g}\ntop_m = {:.10g}\ncell_m = {:.10g}\n", map.geometry.left, map.geometry.top,
                         map.geometry.cell) +
             fmt::format("part = {}\nparts = {}\nword_columns = {}\nword_rows = {}\nflags = {}\n", map.part, map.parts,
                         map.geometry.word_columns, map.geometry.word_rows, map.flags);
  return {map.count, map.first};
}

void decode_payload(std::uint8_t type, std::span<const std::uint8_t> payload, Decoded& out) {
  constexpr auto kWire = sensors::WireFormat::farm;
  out.type = sensors::find_sensor_type(type % sensors::kExtended);
  ASSERT_NE(out.type, nullptr);
  out.spec.elements = 0;
  const sensors::PayloadPart part = out.type->decode(out.spec, payload, type, kWire);
  ASSERT_EQ(part.fault, sensors::PayloadError::none);
  out.part = part.part;
  out.spec.elements = part.elements;
  std::pair<std::uint32_t, std::uint32_t> place{part.elements, 0};
  if (out.type->is_scan) place = place_laser(payload, type >= sensors::kExtended, out);
  if (out.type->name == "occupancy") place = place_map(payload, out);

  const std::size_t width = sensors::element_width(*out.type);
  out.values.resize(out.spec.elements * width);
  out.type->read(out.spec, payload, type, kWire, out.values);
  out.block.values = out.values;
  std::size_t first = 0;
  for (const sensors::Column& column : out.type->columns) {
    std::vector<double> numbers;
    for (std::size_t row = place.second; row < place.second + place.first; ++row)
      for (std::size_t k = 0; k < column.width; ++k) numbers.push_back(out.values[row * width + first + k]);
    out.text += fmt::format("{} = {}\n", column.name, list_of(numbers));
    first += column.width;
  }
}

void expect_reading(const netio::Packet& packet, const test::PacketVector& vector) {
  Decoded decoded;
  const auto type = static_cast<std::uint8_t>(packet.header.type);
  decode_payload(type, std::get<netio::Reading>(packet.body).payload, decoded);
  if (testing::Test::HasFatalFailure()) return;
  EXPECT_EQ(text_of(packet.header) + decoded.text, vector.text) << vector.file;

  base::Bytes payload, bytes;
  EXPECT_EQ(decoded.type->encode(decoded.spec, decoded.block, sensors::WireFormat::farm, decoded.part, payload), type);
  netio::encode_reading(packet.header, type, payload, bytes);
  EXPECT_EQ(bytes, vector.bytes) << vector.file;
  netio::Accuracy accuracy = netio::decode_accuracy(packet.header.accuracy);
  accuracy.bound *= 0.999999;  // a word states bounds up to its own, which is rounded
  EXPECT_EQ(netio::encode_accuracy(accuracy), packet.header.accuracy) << vector.file;
}

void expect_state(const netio::Packet& packet, const test::PacketVector& vector) {
  std::visit(
      [&](const auto& body) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(body)>, netio::Reading>) {
          base::Bytes bytes;
          EXPECT_EQ(text_of(packet.header) + text_of(body), vector.text) << vector.file;
          netio::encode(packet.header, body, bytes);
          EXPECT_EQ(bytes, vector.bytes) << vector.file;
        }
      },
      packet.body);
}

/// What a receiver of any sensor says of the bytes.
PacketStatus status_of(const base::Bytes& bytes) {
  netio::Packet packet;
  const PacketStatus status = netio::decode(bytes, packet);
  const auto* reading = std::get_if<netio::Reading>(&packet.body);
  if (status != PacketStatus::accepted || reading == nullptr) return status;
  const sensors::SensorSpec any{.elements = 0};
  const SensorStream stream{sensors::find_sensor_type(netio::sensor_type_of(packet.header.type)), &any};
  return inspect_payload(stream, sensors::WireFormat::farm, packet.header, reading->payload).status;
}

TEST(PacketVectors, AreTheFarmsOwnPacketsInBothDirections) {
  std::set<netio::Type> types;
  for (const std::string& file : test::vector_files()) {
    if (file.ends_with("statuses.txt")) continue;
    for (const test::PacketVector& vector : test::read_vectors(file)) {
      netio::Packet packet;
      ASSERT_EQ(netio::decode(vector.bytes, packet), PacketStatus::accepted) << file;
      types.insert(packet.header.type);
      if (std::holds_alternative<netio::Reading>(packet.body)) {
        expect_reading(packet, vector);
      } else {
        expect_state(packet, vector);
      }
    }
  }
  EXPECT_EQ(types.size(), sensors::sensor_types().size() + 1 + std::variant_size_v<decltype(netio::Packet::body)> - 1)
      << "each sensor type, the lasers' second form, and each state and request has a file";
}

TEST(PacketVectors, HaveTheFarmsStatuses) {
  const auto vectors = test::read_vectors(SF_SOURCE_DIR "/tests/netio/vectors/statuses.txt");
  EXPECT_GT(vectors.size(), 30u);
  for (const test::PacketVector& vector : vectors)
    EXPECT_EQ(fmt::format("status = {}\n", netio::name(status_of(vector.bytes))), vector.text)
        << testing::PrintToString(vector.bytes);
}

}  // namespace
}  // namespace sf::server
