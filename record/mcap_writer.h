#pragma once
// Writes MCAP, uncompressed, into memory. The owner of the file drains `pending` into it.
//
// Messages are collected in a chunk; `end_chunk` seals it with its CRC and its message indexes. When the caller ends a
// chunk and drains once per tick, the file is readable up to the last whole tick, wherever it is cut.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "record/mcap.h"

namespace sf::record {

/// One thread. Order: schemas, channels, attachments and metadata, then messages; `finish` last and once.
class McapWriter {
 public:
  McapWriter(std::string_view profile, std::string_view library);

  /// @returns the schema's id, from 1.
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view text);
  /// @param schema an id of `add_schema`. At most 65 535 channels. @returns the channel's id, from 1.
  std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, std::string_view encoding,
                            const TextPairs& metadata = {});
  void add_attachment(const McapAttachment& attachment);
  void add_metadata(const McapMetadata& metadata);

  /// Adds to the open chunk. The data is copied.
  void add_message(const McapMessage& message);
  /// Seals the open chunk; does nothing when it is empty.
  void end_chunk();
  /// Seals the file: DataEnd, summary, footer.
  void finish();

  /// Whole records not yet drained. Valid until the next call of another function.
  std::span<const std::uint8_t> pending() const { return pending_; }
  /// To be called when `pending` is in the file.
  void drained();

 private:
  struct IndexEntry {
    std::uint16_t channel;
    std::uint64_t time;
    std::uint64_t offset;
    auto operator<=>(const IndexEntry&) const = default;
  };

  std::uint64_t position() const { return drained_ + pending_.size(); }
  std::uint64_t write_message_indexes();
  void write_chunk_index(std::uint64_t chunk_start, std::uint64_t chunk_length, std::uint64_t index_length);
  void write_statistics(base::Bytes& out) const;
  void write_summary();

  base::Bytes pending_;
  std::uint64_t drained_ = 0;      ///< [byte] drained so far
  std::uint32_t drained_crc_ = 0;  ///< of the drained bytes

  base::Bytes chunk_;                                                   ///< the open chunk's records
  std::vector<IndexEntry> index_;                                       ///< the open chunk's messages
  std::vector<std::pair<std::uint16_t, std::uint64_t>> index_offsets_;  ///< of the sealed chunk: channel, file offset

  // Records that the summary repeats, complete.
  base::Bytes schemas_, channels_, chunk_indexes_, attachment_indexes_, metadata_indexes_;
  std::uint16_t schema_count_ = 0;
  std::uint32_t attachment_count_ = 0, metadata_count_ = 0, chunk_count_ = 0;
  std::uint64_t message_count_ = 0, first_time_ = 0, last_time_ = 0;
  std::uint64_t chunk_first_ = 0, chunk_last_ = 0;
  std::vector<std::uint64_t> channel_messages_;  ///< by channel id - 1
};

}  // namespace sf::record
