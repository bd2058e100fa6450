// Messages of ROS 2 by fastcdr.

#include <fastcdr/Cdr.h>
#include <fastcdr/exceptions/Exception.h>

#include <cmath>

#include "tests/ros2/fast_peer.h"

namespace sf::ros2 {

using base::Bytes;
using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

namespace {

/// Returns nullopt unless `read` consumes all bytes, up to padding to a multiple of 4.
/// @param whole false: more may follow
template <class T, class Read>
std::optional<T> decode(const Bytes& message, Read&& read, bool whole = true) {
  Bytes copy = message;
  FastBuffer buffer(reinterpret_cast<char*>(copy.data()), copy.size());
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  T value{};
  try {
    cdr.read_encapsulation();
    read(cdr, value);
  } catch (const eprosima::fastcdr::exception::Exception&) {
    return std::nullopt;
  }
  if (whole && copy.size() - cdr.getSerializedDataLength() > 3) return std::nullopt;
  return value;
}

template <class Write>
Bytes encode(Write&& write) {
  FastBuffer buffer;
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  write(cdr);
  const auto* const begin = reinterpret_cast<const std::uint8_t*>(buffer.getBuffer());
  return {begin, begin + cdr.getSerializedDataLength()};
}

std::int64_t read_time(Cdr& cdr) {
  std::int32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  cdr >> seconds >> nanoseconds;
  return seconds * std::int64_t{1'000'000'000} + nanoseconds;
}

void read_transform(Cdr& cdr, Transform& transform) {
  transform.time = read_time(cdr);
  cdr >> transform.frame >> transform.child;
  for (double& value : transform.position) cdr >> value;
  for (double& value : transform.rotation) cdr >> value;
}

void write_twist(Cdr& cdr, double forward, double left, double turn) {
  for (const double value : {forward, left, 0.0, 0.0, 0.0, turn}) cdr << value;
}

}  // namespace

std::optional<LaserScan> decode_scan(const Bytes& message) {
  return decode<LaserScan>(message, [](Cdr& cdr, LaserScan& scan) {
    scan.time = read_time(cdr);
    cdr >> scan.frame >> scan.angle_min >> scan.angle_max >> scan.angle_increment >> scan.time_increment >>
        scan.scan_time >> scan.range_min >> scan.range_max >> scan.ranges >> scan.intensities;
  });
}

std::optional<Odometry> decode_odometry(const Bytes& message) {
  return decode<Odometry>(message, [](Cdr& cdr, Odometry& odometry) {
    read_transform(cdr, odometry.pose);
    for (double& value : odometry.pose_covariance) cdr >> value;
    for (double& value : odometry.velocity) cdr >> value;
    for (double& value : odometry.velocity_covariance) cdr >> value;
  });
}

std::optional<std::vector<Transform>> decode_transforms(const Bytes& message) {
  return decode<std::vector<Transform>>(message, [](Cdr& cdr, std::vector<Transform>& transforms) {
    std::uint32_t count = 0;
    cdr >> count;
    for (; count > 0; --count) read_transform(cdr, transforms.emplace_back());
  });
}

std::optional<Header> decode_header(const Bytes& message) {
  return decode<Header>(
      message,
      [](Cdr& cdr, Header& header) {
        header.time = read_time(cdr);
        cdr >> header.frame;
      },
      false);
}

std::optional<std::int64_t> decode_clock(const Bytes& message) {
  return decode<std::int64_t>(message, [](Cdr& cdr, std::int64_t& time) { time = read_time(cdr); });
}

std::optional<std::vector<Node>> decode_nodes(const Bytes& message) {
  return decode<std::vector<Node>>(message, [](Cdr& cdr, std::vector<Node>& nodes) {
    std::uint8_t byte = 0;
    std::uint32_t count = 0, guids = 0;
    for (int i = 0; i < 16; ++i) cdr >> byte;
    cdr >> count;
    for (; count > 0; --count) {
      Node& node = nodes.emplace_back();
      cdr >> node.space >> node.name;
      for (std::size_t* number : {&node.readers, &node.writers}) {
        cdr >> guids;
        *number = guids;
        for (std::uint32_t i = 0; i < 16 * guids; ++i) cdr >> byte;
      }
    }
  });
}

Bytes encode_twist(double forward, double left, double turn) {
  return encode([&](Cdr& cdr) { write_twist(cdr, forward, left, turn); });
}

Bytes encode_twist_stamped(double forward, double left, double turn) {
  return encode([&](Cdr& cdr) {
    cdr << std::int32_t{7} << std::uint32_t{5} << std::string("base_link");
    write_twist(cdr, forward, left, turn);
  });
}

Bytes encode_fields(const std::vector<std::uint8_t>& fields) {
  return encode([&](Cdr& cdr) {
    for (const std::uint8_t byte : fields) cdr << byte;
  });
}

Bytes encode_request(std::uint64_t client, std::int64_t sequence, const std::vector<std::uint8_t>& fields) {
  return encode([&](Cdr& cdr) {
    cdr << client << sequence;
    for (const std::uint8_t byte : fields) cdr << byte;
  });
}

Bytes encode_set_pose(std::uint64_t client, std::int64_t sequence, const std::string& entity, double x, double y,
                      double yaw) {
  return encode([&](Cdr& cdr) {
    cdr << client << sequence << entity << std::int32_t{0} << std::uint32_t{0} << std::string("world");
    for (const double value : {x, y, 0.0, 0.0, 0.0, std::sin(0.5 * yaw), std::cos(0.5 * yaw)}) cdr << value;
    for (int i = 0; i < 12; ++i) cdr << 0.0;
    cdr << true << false << false;
  });
}

std::optional<Reply> decode_reply(const Bytes& message) {
  return decode<Reply>(
      message, [](Cdr& cdr, Reply& reply) { cdr >> reply.client >> reply.sequence >> reply.code >> reply.message; },
      false);
}

std::optional<Reply> decode_fields_of_reply(const Bytes& message) {
  return decode<Reply>(message, [](Cdr& cdr, Reply& reply) { cdr >> reply.code >> reply.message; });
}

}  // namespace sf::ros2
