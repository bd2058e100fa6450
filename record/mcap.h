#pragma once
// The records of an MCAP file, version 0 (https://mcap.dev/spec): a log of timestamped messages on channels.
// A record is an opcode, a 64-bit length and that many bytes; everything is little endian.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace sf::record {

inline constexpr std::array<std::uint8_t, 8> kMcapMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0A,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

/// Compression of the messages in chunks.
enum class Compression : std::uint8_t { none, zstd };
inline constexpr const char* kZstd = "zstd";  ///< in a chunk

using TextPairs = std::vector<std::pair<std::string, std::string>>;

struct McapSchema {
  std::uint16_t id = 0;  ///< never 0 in a file
  std::string name;      ///< e.g. "nav_msgs/msg/Odometry"
  std::string encoding;  ///< "ros2msg"
  std::string text;
  bool operator==(const McapSchema&) const = default;
};

struct McapChannel {
  std::uint16_t id = 0;
  std::uint16_t schema = 0;  ///< 0: none
  std::string topic;
  std::string encoding;  ///< "cdr"
  TextPairs metadata;
  bool operator==(const McapChannel&) const = default;
};

struct McapMessage {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;          ///< [ns] time of delivery
  std::uint64_t publish_time = 0;      ///< [ns] time of validity
  std::span<const std::uint8_t> data;  ///< the caller's bytes, or a view into the file
};

struct McapAttachment {
  std::uint64_t log_time = 0;     ///< [ns]
  std::uint64_t create_time = 0;  ///< [ns] 0: unknown
  std::string name;
  std::string media_type;
  std::span<const std::uint8_t> data;  ///< the caller's bytes, or a view into the file
};

struct McapMetadata {
  std::string name;
  TextPairs pairs;
};

}  // namespace sf::record
