#include "record/mcap_writer.h"

#include <algorithm>

#include "base/error.h"
#include "record/crc32.h"
#include "record/mcap_record.h"

namespace sf::record {

using base::Bytes;
using base::ByteWriter;

McapWriter::McapWriter(std::string_view profile, std::string_view library, Compression compression) {
  if (compression == Compression::zstd) zstd_.emplace();
  append(pending_, kMcapMagic);
  const OpenRecord record(pending_, Opcode::header);
  ByteWriter out(pending_);
  out.put_string(profile);
  out.put_string(library);
}

std::uint16_t McapWriter::add_schema(std::string_view name, std::string_view encoding, std::string_view text) {
  const std::uint64_t start = schemas_.size();
  const auto id = ++schema_count_;
  {
    const OpenRecord record(schemas_, Opcode::schema);
    ByteWriter out(schemas_);
    out.put(id);
    out.put_string(name);
    out.put_string(encoding);
    out.put_string(text);
  }
  append(pending_, std::span(schemas_).subspan(start));
  return id;
}

std::uint16_t McapWriter::add_channel(std::uint16_t schema, std::string_view topic, std::string_view encoding,
                                      const TextPairs& metadata) {
  SF_CHECK(schema >= 1 && schema <= schema_count_, "schema " + std::to_string(schema));
  SF_CHECK(channel_messages_.size() < 0xFFFF, "more than 65535 channels");
  channel_messages_.push_back(0);
  const auto id = static_cast<std::uint16_t>(channel_messages_.size());
  const std::uint64_t start = channels_.size();
  {
    const OpenRecord record(channels_, Opcode::channel);
    ByteWriter out(channels_);
    out.put(id);
    out.put(schema);
    out.put_string(topic);
    out.put_string(encoding);
    put_pairs(out, metadata);
  }
  append(pending_, std::span(channels_).subspan(start));
  return id;
}

void McapWriter::add_attachment(const McapAttachment& attachment) {
  const std::uint64_t start = position();
  {
    const OpenRecord record(pending_, Opcode::attachment);
    const std::size_t body = pending_.size();
    ByteWriter out(pending_);
    out.put(attachment.log_time);
    out.put(attachment.create_time);
    out.put_string(attachment.name);
    out.put_string(attachment.media_type);
    out.put(static_cast<std::uint64_t>(attachment.data.size()));
    out.put_bytes(attachment.data.data(), attachment.data.size());
    out.put(crc32_of(std::span(pending_).subspan(body)));
  }
  ++attachment_count_;
  const OpenRecord record(attachment_indexes_, Opcode::attachment_index);
  ByteWriter out(attachment_indexes_);
  out.put(start);
  out.put(position() - start);
  out.put(attachment.log_time);
  out.put(attachment.create_time);
  out.put(static_cast<std::uint64_t>(attachment.data.size()));
  out.put_string(attachment.name);
  out.put_string(attachment.media_type);
}

void McapWriter::add_metadata(const McapMetadata& metadata) {
  const std::uint64_t start = position();
  {
    const OpenRecord record(pending_, Opcode::metadata);
    ByteWriter out(pending_);
    out.put_string(metadata.name);
    put_pairs(out, metadata.pairs);
  }
  ++metadata_count_;
  const OpenRecord record(metadata_indexes_, Opcode::metadata_index);
  ByteWriter out(metadata_indexes_);
  out.put(start);
  out.put(position() - start);
  out.put_string(metadata.name);
}

void McapChunk::add(const McapMessage& message) {
  index_.push_back({message.channel, message.log_time, records_.size()});
  const OpenRecord record(records_, Opcode::message);
  ByteWriter out(records_);
  out.put(message.channel);
  out.put(message.sequence);
  out.put(message.log_time);
  out.put(message.publish_time);
  out.put_bytes(message.data.data(), message.data.size());
}

/// Offset of a sealed chunk, as stated by the summary.
struct McapWriter::ChunkPlace {
  std::uint64_t first = 0, last = 0;  ///< [ns]
  std::uint64_t start = 0, length = 0, index_length = 0;
  std::uint64_t compressed = 0, size = 0;  ///< [byte]
};

void McapWriter::count(const McapChunk& chunk, ChunkPlace& place) {
  place.first = place.last = chunk.index_[0].time;
  for (const auto& message : chunk.index_) {
    SF_CHECK(message.channel >= 1 && message.channel <= channel_messages_.size(),
             "channel " + std::to_string(message.channel));
    ++channel_messages_[message.channel - 1];
    place.first = std::min(place.first, message.time);
    place.last = std::max(place.last, message.time);
  }
  first_time_ = message_count_ == 0 ? place.first : std::min(first_time_, place.first);
  last_time_ = std::max(last_time_, place.last);
  message_count_ += chunk.index_.size();
  ++chunk_count_;
}

std::span<const std::uint8_t> McapWriter::compressed(const McapChunk& chunk) {
  if (!zstd_) return chunk.records_;
  zstd_->compress(chunk.records_, compressed_);
  return compressed_;
}

void McapWriter::write(McapChunk& chunk) {
  if (chunk.index_.empty()) return;
  const std::span<const std::uint8_t> bytes = compressed(chunk);
  ChunkPlace place{.start = position(), .compressed = bytes.size(), .size = chunk.records_.size()};
  count(chunk, place);
  {
    const OpenRecord record(pending_, Opcode::chunk);
    ByteWriter out(pending_);
    out.put(place.first);
    out.put(place.last);
    out.put(place.size);
    out.put(crc32_of(chunk.records_));
    out.put_string(zstd_ ? kZstd : "");
    out.put(place.compressed);
    out.put_bytes(bytes.data(), bytes.size());
  }
  place.length = position() - place.start;
  place.index_length = write_message_indexes(chunk);
  write_chunk_index(place);
  chunk.records_.clear();
  chunk.index_.clear();
}

std::uint64_t McapWriter::write_message_indexes(McapChunk& chunk) {
  auto& index = chunk.index_;
  const std::uint64_t start = position();
  std::sort(index.begin(), index.end());
  index_offsets_.clear();
  for (std::size_t first = 0, last = 0; first < index.size(); first = last) {
    const std::uint16_t channel = index[first].channel;
    while (last < index.size() && index[last].channel == channel) ++last;
    index_offsets_.emplace_back(channel, position());

    const OpenRecord record(pending_, Opcode::message_index);
    ByteWriter out(pending_);
    out.put(channel);
    out.put(static_cast<std::uint32_t>(16 * (last - first)));
    for (std::size_t i = first; i < last; ++i) {
      out.put(index[i].time);
      out.put(index[i].offset);
    }
  }
  return position() - start;
}

void McapWriter::write_chunk_index(const ChunkPlace& place) {
  const OpenRecord record(chunk_indexes_, Opcode::chunk_index);
  ByteWriter out(chunk_indexes_);
  out.put(place.first);
  out.put(place.last);
  out.put(place.start);
  out.put(place.length);
  out.put(static_cast<std::uint32_t>(10 * index_offsets_.size()));
  for (const auto& [channel, offset] : index_offsets_) {
    out.put(channel);
    out.put(offset);
  }
  out.put(place.index_length);
  out.put_string(zstd_ ? kZstd : "");
  out.put(place.compressed);
  out.put(place.size);
}

void McapWriter::drained() {
  drained_crc_ = crc32_of(pending_, drained_crc_);
  drained_ += pending_.size();
  pending_.clear();
}

void McapWriter::finish() {
  end_chunk();
  const std::uint32_t crc = crc32_of(pending_, drained_crc_);
  {
    const OpenRecord record(pending_, Opcode::data_end);
    ByteWriter(pending_).put(crc);
  }
  write_summary();
  append(pending_, kMcapMagic);
}

}  // namespace sf::record
