#include "farm/shared_hash.h"

#include <algorithm>

#include "base/error.h"
#include "base/hash.h"

namespace sf::farm {

void SharedHash::add_call(std::int64_t now, std::span<const base::ReadingBlock> readings,
                          std::span<const std::uint64_t> hashes) {
  base::ByteWriter out(calls_);
  out.put(now);
  out.put(static_cast<std::uint32_t>(readings.size()));
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const std::uint32_t sensor = order_.sensor_of(readings[i].type, readings[i].mover, readings[i].sensor);
    out.put(sensor);
    out.put(hashes[i]);
    if (order_.is_late(sensor)) out.put(readings[i].time);
  }
  ++count_;
}

void SharedHash::write(base::Bytes& out) {
  base::ByteWriter writer(out);
  writer.put(count_);
  writer.put_bytes(calls_.data(), calls_.size());
  calls_.clear();
  count_ = 0;
}

std::uint64_t SharedHash::chain(std::span<base::ByteReader> parts) {
  std::uint32_t calls = 0;
  for (base::ByteReader& part : parts) calls = part.get<std::uint32_t>();
  for (std::uint32_t call = 0; call < calls; ++call) {
    entries_.clear();
    for (base::ByteReader& part : parts) read_call(part);
    std::sort(entries_.begin(), entries_.end());
    hashes_.clear();
    for (const Entry& entry : entries_) hashes_.push_back(entry.hash);
    hash_ = base::hash_bytes(hashes_.data(), hashes_.size() * sizeof hashes_[0], hash_);
  }
  return hash_;
}

void SharedHash::read_call(base::ByteReader& in) {
  const auto now = in.get<std::int64_t>();
  const auto readings = in.get<std::uint32_t>();
  for (std::uint32_t i = 0; i < readings && in.good(); ++i) {
    const auto sensor = in.get<std::uint32_t>();
    const auto hash = in.get<std::uint64_t>();
    SF_CHECK(sensor < order_.sensors(), "sensor " + std::to_string(sensor) + " of another process");
    entries_.push_back({order_.key(sensor, order_.is_late(sensor) ? in.get<std::int64_t>() : now), hash});
  }
  SF_CHECK(in.good(), "readings of another process end early");
}

}  // namespace sf::farm
