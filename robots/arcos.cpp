#include "robots/arcos.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace sf::robots {

namespace {

constexpr std::uint8_t kFirst = 0xFA, kSecond = 0xFB;
constexpr std::uint8_t kPositive = 0x3B, kNegative = 0x1B;  // types of arguments
constexpr std::size_t kFixedBytes = 20;                     // of a SIP before its sonar ranges

/// Sums pairs of bytes, high byte first. An odd last byte is combined by exclusive or.
std::uint16_t checksum_of(std::span<const std::uint8_t> payload) {
  unsigned sum = 0;
  std::size_t i = 0;
  for (; i + 1 < payload.size(); i += 2) sum += static_cast<unsigned>(payload[i] << 8 | payload[i + 1]);
  if (i < payload.size()) sum = (sum & 0xFFFF) ^ payload[i];
  return static_cast<std::uint16_t>(sum & 0xFFFF);
}

/// Returns the text up to a zero, and removes both.
std::string take_text(std::span<const std::uint8_t>& bytes) {
  const auto end = std::find(bytes.begin(), bytes.end(), 0);
  std::string text(bytes.begin(), end);
  bytes = bytes.subspan(std::min(text.size() + 1, bytes.size()));
  return text;
}

}  // namespace

base::Bytes arcos_packet(std::span<const std::uint8_t> payload) {
  base::Bytes bytes{kFirst, kSecond, static_cast<std::uint8_t>(payload.size() + 2)};
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  const std::uint16_t sum = checksum_of(payload);
  bytes.push_back(static_cast<std::uint8_t>(sum >> 8));
  bytes.push_back(static_cast<std::uint8_t>(sum & 0xFF));
  return bytes;
}

base::Bytes arcos_sync(std::uint8_t number) { return arcos_packet({{number}}); }

base::Bytes arcos_command(ArcosCommand command) { return arcos_sync(static_cast<std::uint8_t>(command)); }

base::Bytes arcos_command(ArcosCommand command, int value) {
  const auto size = static_cast<unsigned>(std::abs(value));
  const std::uint8_t payload[] = {static_cast<std::uint8_t>(command), value < 0 ? kNegative : kPositive,
                                  static_cast<std::uint8_t>(size & 0xFF), static_cast<std::uint8_t>(size >> 8)};
  return arcos_packet(payload);
}

std::optional<ArcosName> parse_arcos_name(std::span<const std::uint8_t> payload) {
  if (payload.size() < 2 || payload[0] != 2) return std::nullopt;
  std::span<const std::uint8_t> rest = payload.subspan(1);
  ArcosName name;
  for (std::string* text : {&name.name, &name.type, &name.subtype}) *text = take_text(rest);
  for (char& c : name.subtype) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (name.subtype == "p3at") name.distance = 0.465e-3;
  return name;
}

std::optional<ArcosSip> parse_arcos_sip(std::span<const std::uint8_t> payload) {
  if (payload.size() < kFixedBytes || (payload[0] != 0x32 && payload[0] != 0x33)) return std::nullopt;
  const auto word = [&](std::size_t at) { return static_cast<std::uint16_t>(payload[at] | payload[at + 1] << 8); };
  const auto number = [&](std::size_t at) { return static_cast<std::int16_t>(word(at)); };
  ArcosSip sip;
  sip.x = word(1);
  sip.y = word(3);
  sip.heading = number(5);
  sip.left = number(7);
  sip.right = number(9);
  sip.volts = 0.1 * payload[11];
  sip.left_stall = (payload[12] & 1) != 0;
  sip.right_stall = (payload[13] & 1) != 0;
  // Bits 1 to 5 run clockwise, as seen from above.
  for (unsigned i = 0; i < 5; ++i) {
    sip.bumpers[i] = payload[13] >> (1 + i) & 1;
    sip.bumpers[5 + i] = payload[12] >> (5 - i) & 1;
  }
  const std::uint16_t flags = word(16);
  sip.motors = (flags & 0x01) != 0;
  sip.stop_button = (flags & 0x20) != 0;
  sip.sonar_count = payload[19];
  if (payload.size() < kFixedBytes + 3u * sip.sonar_count) return std::nullopt;
  for (std::size_t at = kFixedBytes; at < kFixedBytes + 3u * sip.sonar_count; at += 3)
    if (payload[at] < kArcosSonars) sip.ranges[payload[at]] = 1e-3 * word(at + 1);
  return sip;
}

std::optional<base::Bytes> ArcosStream::next() {
  for (;;) {
    const auto first = std::find(bytes_.begin(), bytes_.end(), kFirst);
    skip(static_cast<std::size_t>(first - bytes_.begin()));
    if (bytes_.size() < 3) return std::nullopt;
    const std::size_t count = bytes_[2];
    if (bytes_[1] != kSecond || count < 3 || count > kMostBytes + 2) {
      skip(1);
      continue;
    }
    if (bytes_.size() < 3 + count) return std::nullopt;
    const std::span<const std::uint8_t> payload = std::span(bytes_).subspan(3, count - 2);
    const std::uint16_t sum = checksum_of(payload);
    // A packet may begin within a broken one.
    if (bytes_[1 + count] != sum >> 8 || bytes_[2 + count] != (sum & 0xFF)) {
      ++wrong_checksums_;
      skip(1);
      continue;
    }
    base::Bytes packet(payload.begin(), payload.end());
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(3 + count));
    ++packets_;
    return packet;
  }
}

void ArcosStream::skip(std::size_t count) {
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(count));
  skipped_ += count;
}

}  // namespace sf::robots
