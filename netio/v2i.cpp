#include "netio/v2i.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "netio/packets.h"

namespace sf::netio {

namespace {

constexpr std::uint32_t kNoChange = 0xFFFFFFFFu;  ///< [ms]
constexpr std::size_t kMaxRows = (kMaxPayload - kV2iHeadBytes) / kV2iRowBytes;

/// Rounds up, as SPaT does, so that no change is announced before it happens.
std::uint32_t milliseconds(double seconds) {
  constexpr double kMost = kNoChange - 1.0;
  constexpr double kRounding = 1e-4;  // [ms] rounding error of sums of durations
  if (!std::isfinite(seconds)) return kNoChange;
  return static_cast<std::uint32_t>(std::clamp(std::ceil(1e3 * seconds - kRounding), 0.0, kMost));
}

bool is_finite(const SignalApproach& a) {
  return std::isfinite(a.X_WL.x) && std::isfinite(a.X_WL.y) && std::isfinite(a.X_WL.z) && std::isfinite(a.X_WL.yaw);
}
bool is_finite(const SignalStop& s) {
  return std::isfinite(s.x) && std::isfinite(s.y) && std::isfinite(s.heading) && std::isfinite(s.width);
}
bool is_group(std::uint8_t group) { return group >= 1 && group <= kMaxSignalGroup; }
bool within(double value, double limit) { return std::abs(value) <= limit; }

bool in_range(const SignalApproach& a) {
  return is_group(a.group) && a.state < kSignalStates && (a.next < kSignalStates || a.next == kNoSignalState) &&
         within(a.X_WL.x, kMaxPosition) && within(a.X_WL.y, kMaxPosition) && within(a.X_WL.z, kMaxPosition) &&
         within(a.X_WL.yaw, kMaxYaw);
}
bool in_range(const SignalStop& s) {
  return is_group(s.group) && within(s.x, kMaxPosition) && within(s.y, kMaxPosition) && within(s.heading, kMaxYaw) &&
         s.width >= 0.0 && s.width <= kMaxPosition;
}

std::span<const std::uint8_t> row_at(std::span<const std::uint8_t> rows, std::size_t k) {
  return rows.subspan(k * kV2iRowBytes, kV2iRowBytes);
}

}  // namespace

SignalApproach approach_at(const V2i& v2i, std::size_t k) {
  base::ByteReader reader(row_at(v2i.approaches, k));
  SignalApproach a;
  a.group = reader.get<std::uint8_t>();
  a.state = reader.get<std::uint8_t>();
  a.next = reader.get<std::uint8_t>();
  reader.get<std::uint8_t>();
  const auto left = reader.get<std::uint32_t>();
  if (left != kNoChange) a.left = 1e-3 * left;
  a.X_WL.x = reader.get<double>();
  a.X_WL.y = reader.get<double>();
  a.X_WL.z = reader.get<float>();
  a.X_WL.yaw = reader.get<float>();
  return a;
}

std::optional<SignalApproach> find_approach(const V2i& v2i, std::uint8_t group) {
  for (std::size_t k = 0; k < count(v2i.approaches); ++k)
    if (const SignalApproach approach = approach_at(v2i, k); approach.group == group) return approach;
  return std::nullopt;
}

SignalStop stop_at(const V2i& v2i, std::size_t k) {
  base::ByteReader reader(row_at(v2i.stops, k));
  SignalStop s;
  s.group = reader.get<std::uint8_t>();
  reader.get<std::uint8_t>();
  s.segment = reader.get<std::uint16_t>();
  s.lane = reader.get<std::uint16_t>();
  s.point = reader.get<std::uint16_t>();
  s.x = reader.get<double>();
  s.y = reader.get<double>();
  s.heading = reader.get<float>();
  s.width = reader.get<float>();
  return s;
}

void put(const SignalApproach& a, base::Bytes& rows) {
  SF_CHECK(is_finite(a) && in_range(a) && a.left >= 0.0, "approach of group " + std::to_string(a.group));
  base::ByteWriter writer(rows);
  writer.put(a.group);
  writer.put(a.state);
  writer.put(a.next);
  writer.put(std::uint8_t{0});
  writer.put(milliseconds(a.left));
  writer.put(a.X_WL.x);
  writer.put(a.X_WL.y);
  writer.put(static_cast<float>(a.X_WL.z));
  writer.put(static_cast<float>(a.X_WL.yaw));
}

void put(const SignalStop& s, base::Bytes& rows) {
  SF_CHECK(is_finite(s) && in_range(s), "stop line of group " + std::to_string(s.group));
  base::ByteWriter writer(rows);
  writer.put(s.group);
  writer.put(std::uint8_t{0});
  writer.put(s.segment);
  writer.put(s.lane);
  writer.put(s.point);
  writer.put(s.x);
  writer.put(s.y);
  writer.put(static_cast<float>(s.heading));
  writer.put(static_cast<float>(s.width));
}

PacketStatus read_v2i(std::span<const std::uint8_t> payload, V2i& v2i) {
  if (payload.size() < kV2iHeadBytes) return PacketStatus::too_short;
  base::ByteReader reader(payload);
  const std::size_t approaches = reader.get<std::uint16_t>(), stops = reader.get<std::uint16_t>();
  const std::size_t size = kV2iHeadBytes + (approaches + stops) * kV2iRowBytes;
  if (payload.size() != size) return payload.size() < size ? PacketStatus::too_short : PacketStatus::too_long;
  v2i.approaches = payload.subspan(kV2iHeadBytes, approaches * kV2iRowBytes);
  v2i.stops = payload.subspan(kV2iHeadBytes + approaches * kV2iRowBytes);
  return check(v2i);
}

PacketStatus check(const V2i& v2i) {
  const std::size_t approaches = count(v2i.approaches), stops = count(v2i.stops);
  if (approaches + stops > kMaxRows) return PacketStatus::too_long;
  bool fine = approaches > 0;
  for (std::size_t k = 0; k < approaches; ++k) {
    const SignalApproach a = approach_at(v2i, k);
    if (!is_finite(a)) return PacketStatus::not_finite;
    fine = fine && in_range(a);
  }
  for (std::size_t k = 0; k < stops; ++k) {
    const SignalStop s = stop_at(v2i, k);
    if (!is_finite(s)) return PacketStatus::not_finite;
    fine = fine && in_range(s);
  }
  return fine ? PacketStatus::accepted : PacketStatus::out_of_range;
}

void put_v2i(const V2i& v2i, base::Bytes& out) {
  base::ByteWriter writer(out);
  writer.put(static_cast<std::uint16_t>(count(v2i.approaches)));
  writer.put(static_cast<std::uint16_t>(count(v2i.stops)));
  writer.put(std::uint32_t{0});
  writer.put_bytes(v2i.approaches.data(), v2i.approaches.size());
  writer.put_bytes(v2i.stops.data(), v2i.stops.size());
}

}  // namespace sf::netio
