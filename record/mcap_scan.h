#pragma once
// Iterates over the records of an MCAP file, and notes their damage.

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>

#include "base/bytes.h"
#include "record/mcap_reader.h"

namespace sf::record {

inline constexpr std::size_t kRecordHead = 9;  ///< [byte] opcode and length

/// A record's offset in the file and its content.
struct McapRecord {
  Opcode opcode = Opcode::header;
  std::size_t at = 0;  ///< [byte] offset of the opcode
  std::span<const std::uint8_t> body;
  bool whole = false;  ///< false: `body` is the part before the truncation

  std::size_t end() const { return at + kRecordHead + body.size(); }
};

/// Drops lines after the hundredth.
inline void note_damage(McapContents& contents, std::size_t at, const std::string& what) {
  constexpr std::size_t kMost = 100;
  if (contents.damage.size() < kMost) contents.damage.push_back("byte " + std::to_string(at) + ": " + what);
}

/// @param offset of `bytes` in the file @param at in `bytes`
/// @return false at the end, and if the rest is shorter than a head
inline bool next_record(std::span<const std::uint8_t> bytes, std::size_t offset, std::size_t at, McapRecord& record) {
  if (bytes.size() - at < kRecordHead) return false;
  base::ByteReader in(bytes.subspan(at, kRecordHead));
  record.opcode = static_cast<Opcode>(in.get<std::uint8_t>());
  const auto length = in.get<std::uint64_t>();
  const std::size_t left = bytes.size() - at - kRecordHead;
  record.at = offset + at;
  record.whole = length <= left;
  record.body = bytes.subspan(at + kRecordHead, record.whole ? static_cast<std::size_t>(length) : left);
  return true;
}

}  // namespace sf::record
