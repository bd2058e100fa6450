#pragma once
// Writes single MCAP records.

#include <cstdint>
#include <cstring>
#include <span>

#include "base/bytes.h"
#include "record/mcap.h"

namespace sf::record {

/// Writes a record's opcode in the constructor, and its length in the destructor.
class OpenRecord {
 public:
  OpenRecord(base::Bytes& out, Opcode opcode) : out_(out) {
    base::ByteWriter writer(out);
    writer.put(static_cast<std::uint8_t>(opcode));
    writer.put(std::uint64_t{0});
    start_ = out.size();
  }
  ~OpenRecord() {
    const std::uint64_t length = out_.size() - start_;
    std::memcpy(out_.data() + start_ - sizeof(length), &length, sizeof(length));
  }
  OpenRecord(const OpenRecord&) = delete;
  OpenRecord& operator=(const OpenRecord&) = delete;

 private:
  base::Bytes& out_;
  std::size_t start_ = 0;
};

inline void append(base::Bytes& out, std::span<const std::uint8_t> bytes) {
  base::ByteWriter(out).put_bytes(bytes.data(), bytes.size());
}

/// Appends the u32 length of the whole map in bytes, then keys and values.
inline void put_pairs(base::ByteWriter& out, const TextPairs& pairs) {
  std::uint32_t size = 0;
  for (const auto& [key, value] : pairs) size += static_cast<std::uint32_t>(8 + key.size() + value.size());
  out.put(size);
  for (const auto& [key, value] : pairs) {
    out.put_string(key);
    out.put_string(value);
  }
}

}  // namespace sf::record
