#include "record/mcap_reader.h"

#include <algorithm>

#include "base/bytes.h"
#include "base/error.h"
#include "base/printable.h"
#include "record/compression.h"
#include "record/crc32.h"
#include "record/mcap_index.h"
#include "record/mcap_scan.h"

namespace sf::record {

using base::ByteReader;
using View = std::span<const std::uint8_t>;

namespace {

/// The part of a file that has been read.
struct Reading {
  View file;
  McapContents contents;
  McapLayout layout;
  MessageIndexCheck index{contents};
  ZstdDecompressor zstd;
  std::uint64_t decompressed = 0;  ///< [byte]
};

TextPairs get_pairs(ByteReader& in) {
  TextPairs pairs;
  ByteReader map(in.get_bytes(in.get<std::uint32_t>()));
  while (in.good() && map.left() > 0) {
    std::string key = map.get_string();
    std::string value = map.get_string();
    if (!map.good()) break;
    pairs.emplace_back(std::move(key), std::move(value));
  }
  return pairs;
}

void read_header(const McapRecord& record, McapContents& contents) {
  ByteReader in(record.body);
  contents.profile = in.get_string();
  contents.library = in.get_string();
}

void read_schema(const McapRecord& record, McapContents& contents) {
  ByteReader in(record.body);
  McapSchema schema;
  schema.id = in.get<std::uint16_t>();
  schema.name = in.get_string();
  schema.encoding = in.get_string();
  schema.text = in.get_string();
  if (!in.good() || schema.id == 0) return note_damage(contents, record.at, "malformed schema");
  const auto [known, is_new] = contents.schemas.try_emplace(schema.id, schema);
  if (!is_new && !(known->second == schema))
    note_damage(contents, record.at, "a schema is repeated with different content");
}

void read_channel(const McapRecord& record, McapContents& contents) {
  ByteReader in(record.body);
  McapChannel channel;
  channel.id = in.get<std::uint16_t>();
  channel.schema = in.get<std::uint16_t>();
  channel.topic = in.get_string();
  channel.encoding = in.get_string();
  channel.metadata = get_pairs(in);
  const bool known = channel.schema == 0 || contents.schemas.contains(channel.schema);
  if (!in.good() || !known) return note_damage(contents, record.at, "malformed channel");
  const auto [at, is_new] = contents.channels.try_emplace(channel.id, channel);
  if (!is_new && !(at->second == channel))
    note_damage(contents, record.at, "a channel is repeated with different content");
}

void read_message(const McapRecord& record, McapContents& contents) {
  ByteReader in(record.body);
  McapMessage message;
  message.channel = in.get<std::uint16_t>();
  message.sequence = in.get<std::uint32_t>();
  message.log_time = in.get<std::uint64_t>();
  message.publish_time = in.get<std::uint64_t>();
  message.data = in.get_bytes(in.left());
  if (!in.good() || !contents.channels.contains(message.channel)) {
    return note_damage(contents, record.at, "message without a channel");
  }
  contents.messages.push_back(message);
}

/// @param whole the chunk is not truncated
void read_chunk_records(View records, std::size_t offset, bool whole, Reading& reading) {
  McapContents& contents = reading.contents;
  McapRecord record;
  std::size_t at = 0;
  for (; next_record(records, offset, at, record) && record.whole; at += kRecordHead + record.body.size()) {
    if (record.opcode == Opcode::schema) read_schema(record, contents);
    if (record.opcode == Opcode::channel) read_channel(record, contents);
    if (record.opcode != Opcode::message) continue;
    const std::size_t before = contents.messages.size();
    read_message(record, contents);
    if (contents.messages.size() == before) continue;
    const McapMessage& message = contents.messages.back();
    reading.index.add({message.channel, message.log_time, at});
  }
  if (whole && at < records.size()) note_damage(contents, offset + at, "a record extends beyond its chunk");
}

McapLayout::Chunk read_chunk_head(ByteReader& in, const McapRecord& record, std::uint32_t& crc) {
  McapLayout::Chunk chunk{.at = record.at, .length = record.end() - record.at};
  chunk.first = in.get<std::uint64_t>();
  chunk.last = in.get<std::uint64_t>();
  chunk.size = in.get<std::uint64_t>();
  crc = in.get<std::uint32_t>();
  chunk.compression = in.get_string();
  chunk.compressed = in.get<std::uint64_t>();
  return chunk;
}

/// @param bytes of a chunk, whole if it is compressed; out: its records @return the reason why it cannot be read;
/// empty: none
std::string decompress(const McapLayout::Chunk& chunk, View& bytes, Reading& reading) {
  if (chunk.compression.empty()) return chunk.size == chunk.compressed ? "" : "malformed chunk";
  if (chunk.compression != kZstd)
    return "chunk compressed with '" + base::printable(chunk.compression) +
           "' left out: expected zstd or none; `mcap decompress FILE -o OUT` (mcap.dev) converts the file";
  const std::uint64_t most = (std::uint64_t{1} << 30) + kMaxDecompressed * reading.file.size() - reading.decompressed;
  if (chunk.size > most)
    return "chunk left out: its header states " + std::to_string(chunk.size) + " bytes of records, but at most " +
           std::to_string(most) + " more are decompressed from a file of this size";
  const auto size = static_cast<std::size_t>(chunk.size);
  // Memory that is never written costs nothing, and malformed chunks may state any size.
  auto records = std::make_unique_for_overwrite<std::uint8_t[]>(size);
  if (!reading.zstd.decompress(bytes, {records.get(), size})) return "chunk left out: its zstd frame is malformed";
  reading.decompressed += size;
  bytes = {records.get(), size};
  reading.contents.decompressed.push_back(std::move(records));
  return "";
}

/// A truncated chunk yields its whole messages, or none if it is compressed; its CRC cannot be checked then.
void read_chunk(const McapRecord& record, Reading& reading) {
  McapContents& contents = reading.contents;
  reading.index.begin_lost_chunk(record);
  ByteReader in(record.body);
  std::uint32_t crc = 0;
  const McapLayout::Chunk chunk = read_chunk_head(in, record, crc);
  if (!in.good()) {
    if (record.whole) note_damage(contents, record.at, "malformed chunk");
    return;
  }
  const std::size_t offset = record.at + kRecordHead + in.position();
  View records = in.get_bytes(static_cast<std::size_t>(std::min<std::uint64_t>(chunk.compressed, in.left())));
  const bool cut = records.size() != chunk.compressed;
  if (cut == record.whole || in.left() > 0) return note_damage(contents, record.at, "malformed chunk");
  if (!record.whole && !chunk.compression.empty()) return;
  const std::string wrong = decompress(chunk, records, reading);
  if (!wrong.empty()) return note_damage(contents, record.at, wrong);
  if (record.whole && crc != 0 && crc32_of(records) != crc) {
    return note_damage(contents, record.at, "chunk left out: its CRC does not match");
  }
  if (record.whole) reading.index.begin_chunk(record);
  read_chunk_records(records, offset, record.whole, reading);
  if (record.whole) reading.index.end_chunk(chunk);
  if (record.whole) contents.compression = chunk.compression.empty() ? Compression::none : Compression::zstd;
  reading.layout.chunks.push_back(chunk);
}

void read_attachment(const McapRecord& record, Reading& reading) {
  McapContents& contents = reading.contents;
  ByteReader in(record.body);
  McapAttachment attachment;
  attachment.log_time = in.get<std::uint64_t>();
  attachment.create_time = in.get<std::uint64_t>();
  attachment.name = in.get_string();
  attachment.media_type = in.get_string();
  attachment.data = in.get_bytes(static_cast<std::size_t>(in.get<std::uint64_t>()));
  const std::size_t covered = in.position();
  const auto crc = in.get<std::uint32_t>();
  if (!in.good()) return note_damage(contents, record.at, "malformed attachment");
  if (crc != 0 && crc != crc32_of(record.body.first(covered))) {
    return note_damage(contents, record.at, "attachment left out: its CRC does not match");
  }
  reading.layout.attachments.push_back({record.at, record.end() - record.at, attachment.log_time,
                                        attachment.create_time, attachment.data.size(), attachment.name,
                                        attachment.media_type});
  contents.attachments.push_back(std::move(attachment));
}

void read_metadata(const McapRecord& record, Reading& reading) {
  McapContents& contents = reading.contents;
  ByteReader in(record.body);
  McapMetadata metadata;
  metadata.name = in.get_string();
  metadata.pairs = get_pairs(in);
  if (!in.good()) return note_damage(contents, record.at, "malformed metadata");
  reading.layout.metadata.push_back({record.at, record.end() - record.at, metadata.name});
  contents.metadata.push_back(std::move(metadata));
}

void check_data_end(const McapRecord& record, Reading& reading) {
  reading.layout.data_end = record.end();
  ByteReader in(record.body);
  const auto crc = in.get<std::uint32_t>();
  if (!in.good() || in.left() > 0) return note_damage(reading.contents, record.at, "malformed end of the data");
  if (crc != 0 && crc != crc32_of(reading.file.first(record.at)))
    note_damage(reading.contents, record.at, "the CRC of the data does not match: bytes were changed after writing");
}

void read_record(const McapRecord& record, Reading& reading) {
  if (record.opcode == Opcode::message_index)
    return reading.index.add_index(record, reading.layout.chunks.empty() ? nullptr : &reading.layout.chunks.back());
  reading.index.finish_index();
  switch (record.opcode) {
    case Opcode::header:
      return read_header(record, reading.contents);
    case Opcode::schema:
      return read_schema(record, reading.contents);
    case Opcode::channel:
      return read_channel(record, reading.contents);
    case Opcode::message:
      return read_message(record, reading.contents);
    case Opcode::chunk:
      return read_chunk(record, reading);
    case Opcode::attachment:
      return read_attachment(record, reading);
    case Opcode::metadata:
      return read_metadata(record, reading);
    case Opcode::data_end:
      return check_data_end(record, reading);
    default:
      return;  // the summary is checked at the end; opcodes of later versions are skipped
  }
}

bool is_magic(View bytes) { return std::equal(bytes.begin(), bytes.end(), kMcapMagic.begin(), kMcapMagic.end()); }

/// The magic ends a finished file; a part of it means a truncated file.
void check_end(const McapRecord& footer, Reading& reading) {
  check_summary(reading.file, footer, reading.layout, reading.contents);
  const View end = reading.file.subspan(footer.end());
  const bool begins = end.size() <= kMcapMagic.size() && std::equal(end.begin(), end.end(), kMcapMagic.begin());
  reading.contents.truncated = begins && end.size() < kMcapMagic.size();
  if (!begins) note_damage(reading.contents, footer.end(), "the file does not end with the magic of MCAP");
}

}  // namespace

McapContents read_mcap(View file, const std::string& name) {
  if (file.size() < kMcapMagic.size() || !is_magic(file.first(kMcapMagic.size()))) {
    throw base::InputError(name, 0, "not an MCAP file: expected the bytes 89 4D 43 41 50 30 0D 0A at its start");
  }
  Reading reading{.file = file};
  McapContents& contents = reading.contents;
  contents.truncated = true;
  McapRecord record;
  std::size_t at = kMcapMagic.size();
  for (; next_record(file, 0, at, record) && record.whole; at = record.end()) {
    read_record(record, reading);
    if (record.opcode != Opcode::footer) continue;
    check_end(record, reading);
    return std::move(contents);
  }
  if (at + kRecordHead <= file.size() && record.opcode == Opcode::chunk) read_chunk(record, reading);
  if (file.size() > kMcapMagic.size() && is_magic(file.last(kMcapMagic.size()))) {
    contents.truncated = false;
    note_damage(contents, at, "no valid record here before the end of the file: a length or an opcode was changed");
  }
  return std::move(contents);
}

}  // namespace sf::record
