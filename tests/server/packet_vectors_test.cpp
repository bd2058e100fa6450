// The farm's encoder and decoder on the golden packets: bytes to the file's text, and the decoded values back to the
// bytes.

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "maps/map_packets.h"
#include "netio/packets.h"
#include "sensors/camera.h"
#include "sensors/gps.h"
#include "sensors/image_packets.h"
#include "sensors/imu.h"
#include "sensors/laser_packets.h"
#include "sensors/lidar.h"
#include "sensors/lidar_packets.h"
#include "sensors/occupancy.h"
#include "server/packet_fields.h"
#include "server/sensor_streams.h"
#include "tests/netio/vectors.h"

namespace sf::server {
namespace {

using netio::PacketStatus;

std::string packet_description_text(const PacketDescription& packet) {
  std::string text;
  for (const PacketField& field : packet.fields) text += field.name + " = " + packet_field_text(field) + "\n";
  return text;
}

/// Returns false for readings of a sensor type that this build lacks.
bool is_built(const base::Bytes& bytes) {
  const std::uint8_t id = bytes.size() > 5 ? netio::sensor_type_of(netio::Type{bytes[5]}) : std::uint8_t{0};
  return id == 0 || sensors::find_sensor_type(id) != nullptr;
}

/// A reading in the farm, before it is encoded.
struct Decoded {
  const sensors::SensorType* type = nullptr;
  sensors::SensorSpec spec;
  std::vector<double> values;  ///< of the whole reading
  base::ReadingBlock block;    ///< refers to `values`
  std::uint32_t part = 0;
};

/// Sets the sensor of a part of a scan or map.
void restore_spec(std::uint8_t type, std::span<const std::uint8_t> payload, Decoded& out) {
  if (out.type->is_scan) {
    sensors::LaserPart scan;
    EXPECT_EQ(sensors::read_laser(payload, type >= sensors::kExtended, scan), sensors::PayloadError::none);
    out.spec.elements = scan.total;
    out.spec.limit = scan.extended ? 1e6 : sensors::kPlainRange;
  } else if (out.type->id == sensors::kLidar || out.type->id == sensors::kCamera) {
    sensors::LidarPart scan;
    EXPECT_EQ(sensors::read_lidar(payload, type >= sensors::kExtended, scan), sensors::PayloadError::none);
    out.spec.elements = scan.total, out.spec.width = scan.width;
    out.spec.limit = type >= sensors::kExtended ? 1e6 : sensors::kPlainRange;
  } else if (type == sensors::kOccupancy) {
    maps::MapPart map;
    EXPECT_EQ(maps::read_part(payload, map), maps::PartFault::none);
    out.spec.elements = maps::words(map.geometry);
    out.spec.across = map.geometry.word_columns;
    out.spec.pitch = map.geometry.cell;
    out.block.X_WS = {map.geometry.left, map.geometry.top, 0.0, 0.0};
    out.block.flags = map.flags;
  } else if (type == sensors::kGps || type == sensors::kImu) {
    out.spec.width = static_cast<std::uint32_t>((payload.size() - 4) / 4);  // with or without their last columns
  }
}

void decode_payload(std::uint8_t type, std::span<const std::uint8_t> payload, Decoded& out) {
  out.type = sensors::find_sensor_type(type % sensors::kExtended);
  ASSERT_NE(out.type, nullptr);
  out.spec.elements = 0;
  const sensors::PayloadPart part = out.type->decode(out.spec, payload, type, sensors::WireFormat::farm);
  ASSERT_EQ(part.fault, sensors::PayloadError::none);
  out.part = part.part;
  out.spec.elements = part.elements;
  restore_spec(type, payload, out);
  out.values.resize(out.spec.elements * sensors::element_width(*out.type, out.spec));
  out.type->read(out.spec, payload, type, sensors::WireFormat::farm, out.values);
  out.block.values = out.values;
}

base::Bytes encoded(const netio::Packet& packet, const netio::Reading& reading) {
  Decoded decoded;
  const auto type = static_cast<std::uint8_t>(packet.header.type);
  base::Bytes payload, bytes;
  if (sensors::camera_form(type, reading.payload) >= sensors::kPngForm) {
    sensors::ImagePart image;
    EXPECT_EQ(sensors::read_image(reading.payload, image), sensors::PayloadError::none);
    sensors::ImageFile file{std::string(image.total, '\0'), image.form};
    std::ranges::copy(image.bytes, file.bytes.begin() + image.first);
    sensors::encode_image(file, image.part, payload);
    netio::encode_reading(packet.header, type, payload, bytes);
    return bytes;
  }
  decode_payload(type, reading.payload, decoded);
  if (decoded.values.empty()) return bytes;
  EXPECT_EQ(decoded.type->encode(decoded.spec, decoded.block, sensors::WireFormat::farm, decoded.part, payload), type);
  netio::Header header = packet.header;
  netio::Accuracy accuracy = netio::decode_accuracy(header.accuracy);
  accuracy.bound *= 0.999999;  // a word covers bounds up to its own, which is rounded
  header.accuracy = netio::encode_accuracy(accuracy);
  netio::encode_reading(header, type, payload, bytes);
  return bytes;
}

template <class Body>
base::Bytes encoded(const netio::Packet& packet, const Body& body) {
  base::Bytes bytes;
  netio::encode(packet.header, body, bytes);
  return bytes;
}

TEST(PacketVectors, MatchTheFarmsPacketsInBothDirections) {
  std::set<netio::Type> types;
  for (const std::string& file : test::vector_files()) {
    if (file.ends_with("statuses.txt")) continue;
    for (const test::PacketVector& vector : test::read_vectors(file)) {
      if (!is_built(vector.bytes)) continue;
      EXPECT_EQ(packet_description_text(describe_packet(vector.bytes)), vector.text) << file;
      netio::Packet packet;
      ASSERT_EQ(netio::decode(vector.bytes, packet), PacketStatus::accepted) << file;
      types.insert(packet.header.type);
      EXPECT_EQ(std::visit([&](const auto& body) { return encoded(packet, body); }, packet.body), vector.bytes)
          << file << "\n"
          << vector.text;
    }
  }
  EXPECT_EQ(types.size(), sensors::sensor_types().size() + 3 + std::variant_size_v<decltype(netio::Packet::body)> - 1)
      << "each sensor type, the second forms of lasers, lidars and cameras, and each state and request has a file";
}

TEST(PacketVectors, HaveTheFarmsStatuses) {
  const auto vectors = test::read_vectors(SF_SOURCE_DIR "/tests/netio/vectors/statuses.txt");
  EXPECT_GT(vectors.size(), 30u);
  for (const test::PacketVector& vector : vectors) {
    if (!is_built(vector.bytes)) continue;
    EXPECT_EQ("status = " + std::string(netio::name(describe_packet(vector.bytes).status)) + "\n", vector.text)
        << testing::PrintToString(vector.bytes);
  }
}

}  // namespace
}  // namespace sf::server
