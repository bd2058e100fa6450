#include "netio/own_readings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "netio/packets.h"

namespace sf::netio {

namespace {

constexpr std::size_t kWordBytes = 4;

std::uint32_t most_values(std::uint8_t type) {
  if (type == kOwnLaser) return kMostOwnBeams;
  if (type == kOwnSonar || type == kOwnInfrared) return kMostOwnTransducers;
  return type == kOwnBumper ? kMostOwnBumpers : 0;
}

std::size_t words_of(const OwnReadings& readings) { return readings.type == kOwnBumper ? 1 : readings.count; }

std::uint32_t own_word_at(const OwnReadings& readings, std::size_t k) {
  return base::ByteReader(readings.words.subspan(k * kWordBytes, kWordBytes)).get<std::uint32_t>();
}

}  // namespace

double value_of(const OwnReadings& readings, std::size_t k) {
  if (readings.type == kOwnBumper) return (own_word_at(readings, 0) >> k & 1u) != 0 ? 1.0 : 0.0;
  const std::uint32_t word = own_word_at(readings, k);
  if (word == kUnknownRange) return std::numeric_limits<double>::quiet_NaN();
  return word == kNoOwnEcho ? HUGE_VAL : word / 1e4;
}

void put_own_range(double range, base::Bytes& words) {
  const double units = std::round(std::max(0.0, range) / kOwnRangeUnit);
  const std::uint32_t word = std::isnan(range)    ? kUnknownRange
                             : units < kNoOwnEcho ? static_cast<std::uint32_t>(units)
                                                  : kNoOwnEcho;
  base::ByteWriter(words).put(word);
}

PacketStatus check(const OwnReadings& readings) {
  const OwnReadings& r = readings;
  const bool good = r.total >= 1 && r.total <= most_values(r.type) && r.first < r.total &&
                    r.first % kOwnReadingsPart == 0 && r.count == std::min(kOwnReadingsPart, r.total - r.first) &&
                    r.fov <= (r.type == kOwnLaser ? kMostOwnFov : 0u) &&
                    (r.type != kOwnBumper || std::uint64_t{own_word_at(r, 0)} >> r.count == 0);
  return good ? PacketStatus::accepted : PacketStatus::out_of_range;
}

PacketStatus read_own_readings(std::span<const std::uint8_t> payload, OwnReadings& readings) {
  if (payload.size() > kMaxPayload) return PacketStatus::too_long;
  if (payload.size() < kOwnReadingsHeadBytes) return PacketStatus::too_short;
  base::ByteReader reader(payload);
  const auto type = reader.get<std::uint16_t>();
  readings.type = type <= kOwnBumper ? static_cast<std::uint8_t>(type) : std::uint8_t{0};
  readings.count = reader.get<std::uint16_t>();
  readings.total = reader.get<std::uint32_t>();
  readings.first = reader.get<std::uint32_t>();
  readings.fov = reader.get<std::uint32_t>();
  readings.words = payload.subspan(kOwnReadingsHeadBytes);
  const std::size_t expected = kWordBytes * words_of(readings);
  if (readings.words.size() != expected)
    return readings.words.size() < expected ? PacketStatus::too_short : PacketStatus::too_long;
  return check(readings);
}

void put_own_readings(const OwnReadings& readings, base::Bytes& out) {
  base::ByteWriter writer(out);
  writer.put(std::uint16_t{readings.type});
  writer.put(readings.count);
  writer.put(readings.total);
  writer.put(readings.first);
  writer.put(readings.fov);
  writer.put_bytes(readings.words.data(), readings.words.size());
}

}  // namespace sf::netio
