#include "robots/open_interface.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sf::robots {

namespace {

// Commands.
constexpr std::uint8_t kStart = 128, kSafe = 131, kDriveDirect = 145, kStream = 148, kPauseStream = 150;
// Packets of a frame: id, then number of data bytes.
constexpr std::uint8_t kBumps = 7, kDistance = 19, kAngle = 20, kMode = 35;
constexpr std::uint8_t kHeader = 19;
constexpr std::array<std::uint8_t, 4> kPackets{kBumps, kDistance, kAngle, kMode};

// Fixed bytes of a frame: positions and values of ids and lengths.
constexpr std::array<std::pair<std::size_t, std::uint8_t>, 6> kFixed{
    {{0, kHeader}, {1, CreateStream::kFrameBytes - 3}, {2, kBumps}, {4, kDistance}, {7, kAngle}, {10, kMode}}};

std::int16_t whole_speed(double speed) { return static_cast<std::int16_t>(std::lround(speed)); }

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
  return {whole_speed(scale * (forward + turn)), whole_speed(scale * (forward - turn))};
}

base::Bytes create_start() {
  base::Bytes bytes{kStart, kSafe};
  const base::Bytes rest = create_drive({});
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  bytes.insert(bytes.end(), {kStream, kPackets.size()});
  bytes.insert(bytes.end(), kPackets.begin(), kPackets.end());
  return bytes;
}

base::Bytes create_safe() { return {kSafe}; }

base::Bytes create_drive(const CreateWheels& wheels) {
  base::Bytes bytes{kDriveDirect};
  put_speed(wheels.right, bytes);
  put_speed(wheels.left, bytes);
  return bytes;
}

base::Bytes create_stop() {
  base::Bytes bytes = create_drive({});
  bytes.insert(bytes.end(), {kPauseStream, 0, kStart});
  return bytes;
}

std::optional<CreateFrame> CreateStream::take(std::uint8_t byte) {
  bytes_[size_++] = byte;
  // Drops bytes that cannot begin a frame one at a time, since a frame may begin within a broken one.
  const auto may_be_one = [&] {
    return std::all_of(kFixed.begin(), kFixed.end(),
                       [&](const auto& fixed) { return fixed.first >= size_ || bytes_[fixed.first] == fixed.second; });
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
  const auto number = [&](std::size_t at) { return static_cast<std::int16_t>(bytes_[at] << 8 | bytes_[at + 1]); };
  return CreateFrame{(bytes_[3] & 0x03) != 0, (bytes_[3] & 0x1C) != 0, number(5), number(8), bytes_[11]};
}

void CreateStream::drop_first() {
  std::copy(bytes_.begin() + 1, bytes_.begin() + size_, bytes_.begin());
  --size_;
  ++skipped_;
}

}  // namespace sf::robots
