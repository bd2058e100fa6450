#pragma once
// What an MCAP file states about its own records: message indexes behind chunks, and the summary with statistics,
// indexes and offsets behind the data. Reading needs none of it; other programs do, so a file is damaged where it does
// not fit. All comparisons ignore the order of entries.

#include <compare>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "record/mcap_scan.h"

namespace sf::record {

/// The records of a data section, as the reader found them. Places and lengths in bytes, times in ns.
struct McapLayout {
  struct Message {
    std::uint16_t channel = 0;
    std::uint64_t time = 0;
    std::uint64_t offset = 0;  ///< within the chunk's records
    auto operator<=>(const Message&) const = default;
  };
  struct Chunk {
    std::uint64_t first = 0, last = 0, at = 0, length = 0;
    std::vector<std::pair<std::uint16_t, std::uint64_t>> indexes;  ///< channel, place
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
    std::map<std::uint16_t, std::uint64_t> by_channel;  ///< without zeros
    bool operator==(const Statistics&) const = default;
  };

  std::vector<Chunk> chunks;
  std::vector<Attachment> attachments;
  std::vector<Metadata> metadata;
  std::size_t data_end = 0;  ///< [byte] behind the data end record; 0: there is none
};

/// Compares the message indexes behind a chunk with its messages.
class MessageIndexCheck {
 public:
  explicit MessageIndexCheck(McapContents& contents) : contents_(contents) {}

  /// A whole chunk, whose messages follow; its times are compared as well.
  void begin_chunk(const McapRecord& record) { begin(record, State::whole); }
  /// A chunk that was left out, which is damage enough.
  void begin_lost_chunk(const McapRecord& record) { begin(record, State::lost); }
  void add(const McapLayout::Message& message) { messages_.push_back(message); }
  void end_chunk(const McapLayout::Chunk& chunk);
  /// @param chunk the last one; null: none
  void add_index(const McapRecord& record, McapLayout::Chunk* chunk);
  /// To be called where a whole record of another kind follows: the index of the last chunk is complete.
  void finish_index();

 private:
  enum class State : std::uint8_t { none, whole, lost };
  void begin(const McapRecord& record, State state);

  McapContents& contents_;
  State state_ = State::none;
  std::size_t at_ = 0;  ///< [byte] of the chunk
  std::vector<McapLayout::Message> messages_, indexed_;
};

/// Checks the summary of a finished file: its CRC, and, where nothing else is damaged, its content.
/// @param footer whole, of the file
void check_summary(std::span<const std::uint8_t> file, const McapRecord& footer, McapLayout layout,
                   McapContents& contents);

}  // namespace sf::record
