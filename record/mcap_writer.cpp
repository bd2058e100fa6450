#include "record/mcap_writer.h"

#include <algorithm>

#include "base/error.h"
#include "record/crc32.h"
#include "record/mcap_record.h"

namespace sf::record {

using base::Bytes;
using base::ByteWriter;

McapWriter::McapWriter(std::string_view profile, std::string_view library) {
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

void McapWriter::add_message(const McapMessage& message) {
  SF_CHECK(message.channel >= 1 && message.channel <= channel_messages_.size(),
           "channel " + std::to_string(message.channel));
  const std::uint64_t time = message.log_time;
  chunk_first_ = index_.empty() ? time : std::min(chunk_first_, time);
  chunk_last_ = index_.empty() ? time : std::max(chunk_last_, time);
  first_time_ = message_count_ == 0 ? time : std::min(first_time_, time);
  last_time_ = std::max(last_time_, time);
  ++message_count_;
  ++channel_messages_[message.channel - 1];
  index_.push_back({message.channel, time, chunk_.size()});

  const OpenRecord record(chunk_, Opcode::message);
  ByteWriter out(chunk_);
  out.put(message.channel);
  out.put(message.sequence);
  out.put(message.log_time);
  out.put(message.publish_time);
  out.put_bytes(message.data.data(), message.data.size());
}

void McapWriter::end_chunk() {
  if (index_.empty()) return;
  const std::uint64_t start = position();
  {
    const OpenRecord record(pending_, Opcode::chunk);
    ByteWriter out(pending_);
    out.put(chunk_first_);
    out.put(chunk_last_);
    out.put(static_cast<std::uint64_t>(chunk_.size()));
    out.put(crc32_of(chunk_));
    out.put_string("");
    out.put(static_cast<std::uint64_t>(chunk_.size()));
    out.put_bytes(chunk_.data(), chunk_.size());
  }
  const std::uint64_t length = position() - start;
  write_chunk_index(start, length, write_message_indexes());
  ++chunk_count_;
  chunk_.clear();
  index_.clear();
}

std::uint64_t McapWriter::write_message_indexes() {
  const std::uint64_t start = position();
  std::sort(index_.begin(), index_.end());
  index_offsets_.clear();
  for (std::size_t first = 0, last = 0; first < index_.size(); first = last) {
    const std::uint16_t channel = index_[first].channel;
    while (last < index_.size() && index_[last].channel == channel) ++last;
    index_offsets_.emplace_back(channel, position());

    const OpenRecord record(pending_, Opcode::message_index);
    ByteWriter out(pending_);
    out.put(channel);
    out.put(static_cast<std::uint32_t>(16 * (last - first)));
    for (std::size_t i = first; i < last; ++i) {
      out.put(index_[i].time);
      out.put(index_[i].offset);
    }
  }
  return position() - start;
}

void McapWriter::write_chunk_index(std::uint64_t chunk_start, std::uint64_t chunk_length, std::uint64_t index_length) {
  const OpenRecord record(chunk_indexes_, Opcode::chunk_index);
  ByteWriter out(chunk_indexes_);
  out.put(chunk_first_);
  out.put(chunk_last_);
  out.put(chunk_start);
  out.put(chunk_length);
  out.put(static_cast<std::uint32_t>(10 * index_offsets_.size()));
  for (const auto& [channel, offset] : index_offsets_) {
    out.put(channel);
    out.put(offset);
  }
  out.put(index_length);
  out.put_string("");
  out.put(static_cast<std::uint64_t>(chunk_.size()));
  out.put(static_cast<std::uint64_t>(chunk_.size()));
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
