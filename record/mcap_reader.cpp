#include "record/mcap_reader.h"

#include <algorithm>

#include "base/bytes.h"
#include "base/error.h"
#include "record/crc32.h"

namespace sf::record {

using base::ByteReader;
using View = std::span<const std::uint8_t>;

namespace {

constexpr std::size_t kRecordHead = 9;  // opcode and length
constexpr std::size_t kMaxDamage = 100;

/// A record's place in the file and its content.
struct Record {
  Opcode opcode = Opcode::header;
  std::size_t at = 0;  ///< [byte] of the opcode
  View body;
  bool whole = false;  ///< false: `body` is the rest before the cut
};

void note(McapContents& contents, std::size_t at, const std::string& what) {
  if (contents.damage.size() < kMaxDamage) contents.damage.push_back("byte " + std::to_string(at) + ": " + what);
}

/// @returns false at the end, and when the rest is shorter than a head.
bool next_record(View bytes, std::size_t offset, std::size_t at, Record& record) {
  if (bytes.size() - at < kRecordHead) return false;
  ByteReader in(bytes.subspan(at, kRecordHead));
  record.opcode = static_cast<Opcode>(in.get<std::uint8_t>());
  const auto length = in.get<std::uint64_t>();
  const std::size_t left = bytes.size() - at - kRecordHead;
  record.at = offset + at;
  record.whole = length <= left;
  record.body = bytes.subspan(at + kRecordHead, record.whole ? static_cast<std::size_t>(length) : left);
  return true;
}

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

void read_header(const Record& record, McapContents& contents) {
  ByteReader in(record.body);
  contents.profile = in.get_string();
  contents.library = in.get_string();
}

void read_schema(const Record& record, McapContents& contents) {
  ByteReader in(record.body);
  McapSchema schema;
  schema.id = in.get<std::uint16_t>();
  schema.name = in.get_string();
  schema.encoding = in.get_string();
  schema.text = in.get_string();
  if (!in.good() || schema.id == 0) return note(contents, record.at, "malformed schema");
  contents.schemas.emplace(schema.id, std::move(schema));
}

void read_channel(const Record& record, McapContents& contents) {
  ByteReader in(record.body);
  McapChannel channel;
  channel.id = in.get<std::uint16_t>();
  channel.schema = in.get<std::uint16_t>();
  channel.topic = in.get_string();
  channel.encoding = in.get_string();
  channel.metadata = get_pairs(in);
  const bool known = channel.schema == 0 || contents.schemas.contains(channel.schema);
  if (!in.good() || !known) return note(contents, record.at, "malformed channel");
  contents.channels.emplace(channel.id, std::move(channel));
}

void read_message(const Record& record, McapContents& contents) {
  ByteReader in(record.body);
  McapMessage message;
  message.channel = in.get<std::uint16_t>();
  message.sequence = in.get<std::uint32_t>();
  message.log_time = in.get<std::uint64_t>();
  message.publish_time = in.get<std::uint64_t>();
  message.data = in.get_bytes(in.left());
  if (!in.good() || !contents.channels.contains(message.channel)) {
    return note(contents, record.at, "message without a channel");
  }
  contents.messages.push_back(message);
}

void read_chunk_records(View records, std::size_t offset, McapContents& contents) {
  Record record;
  for (std::size_t at = 0; next_record(records, offset, at, record); at += kRecordHead + record.body.size()) {
    if (!record.whole) return;
    if (record.opcode == Opcode::schema) read_schema(record, contents);
    if (record.opcode == Opcode::channel) read_channel(record, contents);
    if (record.opcode == Opcode::message) read_message(record, contents);
    if (record.opcode == Opcode::message_index) return;
  }
}

/// A truncated chunk gives its whole messages; its CRC cannot be checked then.
void read_chunk(const Record& record, McapContents& contents) {
  ByteReader in(record.body);
  in.get<std::uint64_t>();  // first time
  in.get<std::uint64_t>();  // last time
  in.get<std::uint64_t>();  // uncompressed size
  const auto crc = in.get<std::uint32_t>();
  const std::string compression = in.get_string();
  const auto size = in.get<std::uint64_t>();
  if (!in.good()) {
    if (record.whole) note(contents, record.at, "malformed chunk");
    return;
  }
  if (!compression.empty()) return note(contents, record.at, "chunk compressed with '" + compression + "' left out");
  const std::size_t offset = record.at + kRecordHead + in.position();
  const View records = in.get_bytes(static_cast<std::size_t>(std::min<std::uint64_t>(size, in.left())));
  if (record.whole && records.size() != size) return note(contents, record.at, "malformed chunk");
  if (record.whole && crc != 0 && crc32_of(records) != crc) {
    return note(contents, record.at, "chunk left out: its CRC does not fit");
  }
  read_chunk_records(records, offset, contents);
}

void read_attachment(const Record& record, McapContents& contents) {
  ByteReader in(record.body);
  McapAttachment attachment;
  attachment.log_time = in.get<std::uint64_t>();
  attachment.create_time = in.get<std::uint64_t>();
  attachment.name = in.get_string();
  attachment.media_type = in.get_string();
  attachment.data = in.get_bytes(static_cast<std::size_t>(in.get<std::uint64_t>()));
  const std::size_t covered = in.position();
  const auto crc = in.get<std::uint32_t>();
  if (!in.good()) return note(contents, record.at, "malformed attachment");
  if (crc != 0 && crc != crc32_of(record.body.first(covered))) {
    return note(contents, record.at, "attachment left out: its CRC does not fit");
  }
  contents.attachments.push_back(std::move(attachment));
}

void read_metadata(const Record& record, McapContents& contents) {
  ByteReader in(record.body);
  McapMetadata metadata;
  metadata.name = in.get_string();
  metadata.pairs = get_pairs(in);
  if (!in.good()) return note(contents, record.at, "malformed metadata");
  contents.metadata.push_back(std::move(metadata));
}

void check_data_end(const Record& record, View file, McapContents& contents) {
  const auto crc = ByteReader(record.body).get<std::uint32_t>();
  if (crc != 0 && crc != crc32_of(file.first(record.at))) {
    note(contents, record.at, "the data does not fit its CRC: bytes were changed after writing");
  }
}

void read_record(const Record& record, View file, McapContents& contents) {
  switch (record.opcode) {
    case Opcode::header:
      return read_header(record, contents);
    case Opcode::schema:
      return read_schema(record, contents);
    case Opcode::channel:
      return read_channel(record, contents);
    case Opcode::message:
      return read_message(record, contents);
    case Opcode::chunk:
      return read_chunk(record, contents);
    case Opcode::attachment:
      return read_attachment(record, contents);
    case Opcode::metadata:
      return read_metadata(record, contents);
    case Opcode::data_end:
      return check_data_end(record, file, contents);
    default:
      return;  // indexes, and opcodes of later versions, are skipped
  }
}

}  // namespace

McapContents read_mcap(View file, const std::string& name) {
  if (file.size() < kMcapMagic.size() || !std::equal(kMcapMagic.begin(), kMcapMagic.end(), file.begin())) {
    throw base::InputError(name, 0, "not an MCAP file: expected the bytes 89 4D 43 41 50 30 0D 0A at its start");
  }
  McapContents contents;
  contents.truncated = true;
  Record record;
  for (std::size_t at = kMcapMagic.size(); next_record(file, 0, at, record); at += kRecordHead + record.body.size()) {
    if (!record.whole) {
      if (record.opcode == Opcode::chunk) read_chunk(record, contents);
      break;
    }
    if (record.opcode == Opcode::footer) {
      const View end = file.subspan(at + kRecordHead + record.body.size());
      contents.truncated = !std::equal(end.begin(), end.end(), kMcapMagic.begin(), kMcapMagic.end());
      break;
    }
    read_record(record, file, contents);
  }
  return contents;
}

}  // namespace sf::record
