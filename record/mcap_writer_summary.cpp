// The summary of an MCAP file, for random access.

#include <array>

#include "record/crc32.h"
#include "record/mcap_record.h"
#include "record/mcap_writer.h"

namespace sf::record {

using base::Bytes;
using base::ByteWriter;

void McapWriter::write_statistics(Bytes& bytes) const {
  const OpenRecord record(bytes, Opcode::statistics);
  ByteWriter out(bytes);
  out.put(message_count_);
  out.put(schema_count_);
  out.put(static_cast<std::uint32_t>(channel_messages_.size()));
  out.put(attachment_count_);
  out.put(metadata_count_);
  out.put(chunk_count_);
  out.put(first_time_);
  out.put(last_time_);
  out.put(static_cast<std::uint32_t>(10 * channel_messages_.size()));
  for (std::size_t i = 0; i < channel_messages_.size(); ++i) {
    out.put(static_cast<std::uint16_t>(i + 1));
    out.put(channel_messages_[i]);
  }
}

void McapWriter::write_summary() {
  const std::uint64_t summary_start = position();
  const std::size_t summary_at = pending_.size();
  Bytes statistics;
  write_statistics(statistics);

  struct Group {
    Opcode opcode;
    const Bytes& records;
  };
  const std::array groups = {
      Group{Opcode::schema, schemas_},
      Group{Opcode::channel, channels_},
      Group{Opcode::statistics, statistics},
      Group{Opcode::chunk_index, chunk_indexes_},
      Group{Opcode::attachment_index, attachment_indexes_},
      Group{Opcode::metadata_index, metadata_indexes_},
  };
  Bytes offsets;
  for (const Group& group : groups) {
    if (group.records.empty()) continue;
    const OpenRecord record(offsets, Opcode::summary_offset);
    ByteWriter out(offsets);
    out.put(static_cast<std::uint8_t>(group.opcode));
    out.put(position());
    out.put(static_cast<std::uint64_t>(group.records.size()));
    append(pending_, group.records);
  }
  const std::uint64_t offsets_start = position();
  append(pending_, offsets);

  // The footer's CRC covers its own first fields, including opcode and length (20 bytes of content).
  ByteWriter out(pending_);
  out.put(static_cast<std::uint8_t>(Opcode::footer));
  out.put(std::uint64_t{20});
  out.put(summary_start);
  out.put(offsets_start);
  out.put(crc32_of(std::span(pending_).subspan(summary_at)));
}

}  // namespace sf::record
