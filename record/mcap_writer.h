#pragma once
// Writes MCAP into memory. The owner of the file drains `pending` into it.
//
// Messages are collected in a chunk; `end_chunk` compresses it and seals it with its CRC and its message indexes. When
// the caller ends a chunk and drains once per tick, the file is readable up to the last whole tick, wherever it is cut.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "record/compression.h"
#include "record/mcap.h"

namespace sf::record {

/// Messages of one chunk. Single-threaded.
class McapChunk {
 public:
  /// Copies the data. @pre the channel belongs to the writer that receives the chunk
  void add(const McapMessage& message);

 private:
  friend class McapWriter;
  struct IndexEntry {
    std::uint16_t channel;
    std::uint64_t time;
    std::uint64_t offset;
    auto operator<=>(const IndexEntry&) const = default;
  };
  base::Bytes records_;
  std::vector<IndexEntry> index_;
};

/// Single-threaded. Order of calls: schemas, channels, attachments and metadata, then messages; `finish` last and once.
class McapWriter {
 public:
  McapWriter(std::string_view profile, std::string_view library, Compression compression = Compression::none);

  /// @return the schema's id, from 1
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view text);
  /// @param schema an id of `add_schema`. At most 65 535 channels. @return the channel's id, from 1
  std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, std::string_view encoding,
                            const TextPairs& metadata = {});
  void add_attachment(const McapAttachment& attachment);
  void add_metadata(const McapMetadata& metadata);

  /// Adds to the open chunk. Copies the data.
  void add_message(const McapMessage& message) { chunk_.add(message); }
  /// Seals the open chunk; does nothing if it is empty.
  void end_chunk() { write(chunk_); }
  /// Seals and clears a chunk of the caller; does nothing if it is empty.
  void write(McapChunk& chunk);
  /// Seals the file: DataEnd, summary, footer.
  void finish();

  /// Returns whole records that are not yet drained. Valid until the next call of another function.
  std::span<const std::uint8_t> pending() const { return pending_; }
  /// Call this when `pending` is in the file.
  void drained();

 private:
  std::uint64_t position() const { return drained_ + pending_.size(); }
  struct ChunkPlace;
  void count(const McapChunk& chunk, ChunkPlace& place);
  std::span<const std::uint8_t> compressed(const McapChunk& chunk);
  std::uint64_t write_message_indexes(McapChunk& chunk);
  void write_chunk_index(const ChunkPlace& place);
  void write_statistics(base::Bytes& out) const;
  void write_summary();

  base::Bytes pending_;
  std::uint64_t drained_ = 0;      ///< [byte] drained so far
  std::uint32_t drained_crc_ = 0;  ///< CRC of the drained bytes

  std::optional<ZstdCompressor> zstd_;                                  ///< nullopt: chunks are not compressed
  base::Bytes compressed_;                                              ///< compressed records of the sealed chunk
  McapChunk chunk_;                                                     ///< the open chunk
  std::vector<std::pair<std::uint16_t, std::uint64_t>> index_offsets_;  ///< channel and file offset of each index of
                                                                        ///< the sealed chunk

  // Complete records that the summary repeats.
  base::Bytes schemas_, channels_, chunk_indexes_, attachment_indexes_, metadata_indexes_;
  std::uint16_t schema_count_ = 0;
  std::uint32_t attachment_count_ = 0, metadata_count_ = 0, chunk_count_ = 0;
  std::uint64_t message_count_ = 0, first_time_ = 0, last_time_ = 0;
  std::vector<std::uint64_t> channel_messages_;  ///< number of messages, indexed by channel id - 1
};

}  // namespace sf::record
