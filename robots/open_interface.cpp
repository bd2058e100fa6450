#include "robots/open_interface.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace sf::robots {

namespace {

// Commands.
constexpr std::uint8_t kStart = 128, kSafe = 131, kLowSideDrivers = 138, kDriveDirect = 145, kDigitalOutputs = 147,
                       kStream = 148, kPauseStream = 150;
constexpr std::uint8_t kHeader = 19;

/// Fixed bytes of a frame: positions and values of ids and lengths.
constexpr auto kFixed = [] {
  std::array<std::pair<std::size_t, std::uint8_t>, std::size(kCreatePackets) + 2> fixed{};
  fixed[0] = {0, kHeader};
  fixed[1] = {1, CreateStream::kFrameBytes - 3};
  std::size_t at = 2;
  for (std::size_t i = 0; i < std::size(kCreatePackets); at += 1 + kCreatePackets[i++].bytes)
    fixed[i + 2] = {at, kCreatePackets[i].id};
  return fixed;
}();

/// Returns the position of the data of a packet in a frame.
constexpr std::size_t data_of(std::uint8_t id) {
  std::size_t at = 2;
  for (const CreatePacket& packet : kCreatePackets) {
    if (packet.id == id) return at + 1;
    at += 1 + packet.bytes;
  }
  throw "no such packet";  // only in a constant expression
}

/// Returns the id of the packet in the place of packet `id` of `kCreatePackets`.
constexpr std::uint8_t id_in(std::uint8_t id, CreateOdometry odometry) {
  constexpr std::uint8_t kDistance = 19, kAngle = 20, kLeft = 43, kRight = 44;
  if (odometry == CreateOdometry::motion) return id;
  return id == kDistance ? kLeft : id == kAngle ? kRight : id;
}

std::int16_t rounded_speed(double speed) { return static_cast<std::int16_t>(std::lround(speed)); }

void put_speed(std::int16_t speed, base::Bytes& bytes) {
  const auto bits = static_cast<std::uint16_t>(speed);
  bytes.push_back(static_cast<std::uint8_t>(bits >> 8));
  bytes.push_back(static_cast<std::uint8_t>(bits & 0xFF));
}

}  // namespace

CreateWheels create_wheels(const base::Twist& twist, double track) {
  if (!std::isfinite(twist.forward) || !std::isfinite(twist.turn)) return {};
  const double turn = 1e3 * 0.5 * track * twist.turn, forward = 1e3 * twist.forward;
  const double fastest = std::max(std::abs(forward + turn), std::abs(forward - turn));
  if (!std::isfinite(fastest)) return {};
  const double scale = fastest > kCreateSpeed ? kCreateSpeed / fastest : 1.0;
  return {rounded_speed(scale * (forward + turn)), rounded_speed(scale * (forward - turn))};
}

base::Bytes create_start(CreateOdometry odometry) {
  base::Bytes bytes{kStart, kSafe};
  const base::Bytes rest = create_drive({});
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  bytes.insert(bytes.end(), {kStream, std::size(kCreatePackets)});
  for (const CreatePacket& packet : kCreatePackets) bytes.push_back(id_in(packet.id, odometry));
  return bytes;
}

base::Bytes create_safe() { return {kSafe}; }

base::Bytes create_drive(const CreateWheels& wheels) {
  base::Bytes bytes{kDriveDirect};
  put_speed(wheels.right, bytes);
  put_speed(wheels.left, bytes);
  return bytes;
}

base::Bytes create_outputs(std::uint8_t bits) {
  return {kDigitalOutputs, static_cast<std::uint8_t>(bits & 7u), kLowSideDrivers,
          static_cast<std::uint8_t>(bits >> 3 & 7u)};
}

base::Bytes create_stop() {
  base::Bytes bytes = create_drive({});
  bytes.insert(bytes.end(), {kPauseStream, 0, kStart});
  return bytes;
}

namespace {

CreateFrame decoded(std::span<const std::uint8_t> bytes) {
  const auto byte = [&](std::size_t at) { return bytes[at]; };
  const auto word = [&](std::size_t at) { return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]); };
  const auto number = [&](std::size_t at) { return static_cast<std::int16_t>(word(at)); };
  CreateFrame f;
  const std::uint8_t bumps = byte(data_of(7));
  f.bumped_right = (bumps & 0x01) != 0;
  f.bumped_left = (bumps & 0x02) != 0;
  f.wheel_drop = (bumps & 0x1C) != 0;
  f.wall = byte(data_of(8)) != 0;
  for (std::size_t i = 0; i < f.cliffs.size(); ++i) f.cliffs[i] = byte(data_of(9) + 2 * i) != 0 ? 1 : 0;
  f.virtual_wall = byte(data_of(13)) != 0;
  f.overcurrents = byte(data_of(14));
  f.infrared = byte(data_of(17));
  f.buttons = byte(data_of(18));
  f.distance = number(data_of(19));
  f.angle = number(data_of(20));
  f.left = word(data_of(19));
  f.right = word(data_of(20));
  f.charging = byte(data_of(21));
  f.voltage = word(data_of(22));
  f.current = number(data_of(23));
  f.temperature = static_cast<std::int8_t>(byte(data_of(24)));
  f.charge = word(data_of(25));
  f.capacity = word(data_of(26));
  f.inputs = byte(data_of(32));
  f.analog = word(data_of(33));
  f.mode = byte(data_of(35));
  return f;
}

}  // namespace

std::optional<CreateFrame> CreateStream::take(std::uint8_t byte) {
  bytes_[size_++] = byte;
  // Drops bytes that cannot begin a frame one at a time, since a frame may begin within a broken one.
  const auto may_be_one = [&] {
    return std::all_of(kFixed.begin(), kFixed.end(), [&](const auto& fixed) {
      const auto& [at, value] = fixed;
      return at >= size_ || bytes_[at] == (at < 2 ? value : id_in(value, odometry_));
    });
  };
  while (size_ > 0 && !may_be_one()) drop_first();
  return size_ == kFrameBytes ? whole() : std::nullopt;
}

std::optional<CreateFrame> CreateStream::whole() {
  if (std::accumulate(bytes_.begin(), bytes_.end(), 0u) % 256 != 0) {
    ++wrong_checksums_;
    const std::array<std::uint8_t, kFrameBytes> broken = bytes_;
    size_ = 0;
    ++skipped_;
    // Fewer bytes than a frame, so none of these calls completes one.
    for (std::size_t i = 1; i < broken.size(); ++i) take(broken[i]);
    return std::nullopt;
  }
  size_ = 0;
  ++frames_;
  return decoded(bytes_);
}

void CreateStream::drop_first() {
  std::copy(bytes_.begin() + 1, bytes_.begin() + size_, bytes_.begin());
  --size_;
  ++skipped_;
}

}  // namespace sf::robots
