#pragma once
// The redundant part of an MCAP file: message indexes after chunks, and the summary with statistics, indexes and
// offsets after the data. Reading does not need them, but other programs do, so a contradiction counts as damage. All
// comparisons ignore the order of entries.

#include <compare>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "record/mcap_scan.h"

namespace sf::record {

/// The records of a data section, as found by the reader. Offsets and lengths in bytes, times in ns.
struct McapLayout {
  struct Message {
    std::uint16_t channel = 0;
    std::uint64_t time = 0;
    std::uint64_t offset = 0;  ///< within the chunk's records
    auto operator<=>(const Message&) const = default;
  };
  struct Chunk {
    std::uint64_t first = 0, last = 0, at = 0, length = 0;
    std::vector<std::pair<std::uint16_t, std::uint64_t>> indexes;  ///< channel, offset
    std::uint64_t index_length = 0;
    std::string compression;
    std::uint64_t compressed = 0, size = 0;
    auto operator<=>(const Chunk&) const = default;
  };
  struct Attachment {
    std::uint64_t at = 0, length = 0, log_time = 0, create_time = 0, size = 0;
    std::string name, media_type;
    auto operator<=>(const Attachment&) const = default;
  };
  struct Metadata {
    std::uint64_t at = 0, length = 0;
    std::string name;
    auto operator<=>(const Metadata&) const = default;
  };
  struct Statistics {
    std::uint64_t messages = 0;
    std::uint16_t schemas = 0;
    std::uint32_t channels = 0, attachments = 0, metadata = 0, chunks = 0;
    std::uint64_t first = 0, last = 0;
    std::map<std::uint16_t, std::uint64_t> by_channel;  ///< without zero counts
    bool operator==(const Statistics&) const = default;
  };

  std::vector<Chunk> chunks;
  std::vector<Attachment> attachments;
  std::vector<Metadata> metadata;
  std::size_t data_end = 0;  ///< [byte] offset after the data end record; 0: there is none
};

/// Compares the message indexes after a chunk with its messages.
class MessageIndexCheck {
 public:
  explicit MessageIndexCheck(McapContents& contents) : contents_(contents) {}

  /// Begins a whole chunk, whose messages follow; its times are compared as well.
  void begin_chunk(const McapRecord& record) { begin(record, State::whole); }
  /// Begins a skipped chunk. Its index is not checked, since the loss already counts as damage.
  void begin_lost_chunk(const McapRecord& record) { begin(record, State::lost); }
  void add(const McapLayout::Message& message) { messages_.push_back(message); }
  void end_chunk(const McapLayout::Chunk& chunk);
  /// @param chunk the last chunk; null: none
  void add_index(const McapRecord& record, McapLayout::Chunk* chunk);
  /// Call this when a whole record of another kind follows: the index of the last chunk is complete.
  void finish_index();

 private:
  enum class State : std::uint8_t { none, whole, lost };
  void begin(const McapRecord& record, State state);

  McapContents& contents_;
  State state_ = State::none;
  std::size_t at_ = 0;  ///< [byte] offset of the chunk
  std::vector<McapLayout::Message> messages_, indexed_;
};

/// Checks the summary of a finished file: its CRC and, if nothing else is damaged, its content.
/// @param footer a whole footer of the file
void check_summary(std::span<const std::uint8_t> file, const McapRecord& footer, McapLayout layout,
                   McapContents& contents);

}  // namespace sf::record
