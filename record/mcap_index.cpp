#include "record/mcap_index.h"

#include "record/crc32.h"

namespace sf::record {

using base::ByteReader;
using View = std::span<const std::uint8_t>;

namespace {

/// The records of a summary.
struct Summary {
  std::vector<McapLayout::Statistics> statistics;
  std::vector<McapLayout::Chunk> chunks;
  std::vector<McapLayout::Attachment> attachments;
  std::vector<McapLayout::Metadata> metadata;
  using Group = std::pair<std::uint64_t, std::uint64_t>;  ///< offset and length of the records of an opcode
  std::map<Opcode, Group> groups;
  std::vector<std::pair<Opcode, Group>> offsets;  ///< as stated by the summary
  std::uint64_t offsets_start = 0;                ///< 0: none
};

std::vector<std::pair<std::uint16_t, std::uint64_t>> get_numbers(ByteReader& in) {
  std::vector<std::pair<std::uint16_t, std::uint64_t>> all;
  ByteReader map(in.get_bytes(in.get<std::uint32_t>()));
  while (map.left() > 0 && map.good()) {
    const auto key = map.get<std::uint16_t>();
    all.emplace_back(key, map.get<std::uint64_t>());
  }
  std::sort(all.begin(), all.end());
  return all;
}

McapLayout::Chunk read_chunk_index(ByteReader& in) {
  McapLayout::Chunk chunk;
  for (std::uint64_t* number : {&chunk.first, &chunk.last, &chunk.at, &chunk.length}) *number = in.get<std::uint64_t>();
  chunk.indexes = get_numbers(in);
  chunk.index_length = in.get<std::uint64_t>();
  chunk.compression = in.get_string();
  chunk.compressed = in.get<std::uint64_t>();
  chunk.size = in.get<std::uint64_t>();
  return chunk;
}

McapLayout::Attachment read_attachment_index(ByteReader& in) {
  McapLayout::Attachment a;
  for (std::uint64_t* number : {&a.at, &a.length, &a.log_time, &a.create_time, &a.size})
    *number = in.get<std::uint64_t>();
  a.name = in.get_string();
  a.media_type = in.get_string();
  return a;
}

McapLayout::Metadata read_metadata_index(ByteReader& in) {
  McapLayout::Metadata metadata;
  metadata.at = in.get<std::uint64_t>();
  metadata.length = in.get<std::uint64_t>();
  metadata.name = in.get_string();
  return metadata;
}

McapLayout::Statistics read_statistics(ByteReader& in) {
  McapLayout::Statistics s;
  s.messages = in.get<std::uint64_t>();
  s.schemas = in.get<std::uint16_t>();
  for (std::uint32_t* count : {&s.channels, &s.attachments, &s.metadata, &s.chunks}) *count = in.get<std::uint32_t>();
  s.first = in.get<std::uint64_t>();
  s.last = in.get<std::uint64_t>();
  for (const auto& [channel, count] : get_numbers(in))
    if (count > 0) s.by_channel[channel] += count;
  return s;
}

McapLayout::Statistics statistics_of(const McapContents& contents, const McapLayout& layout) {
  McapLayout::Statistics s;
  s.messages = contents.messages.size();
  s.schemas = static_cast<std::uint16_t>(contents.schemas.size());
  s.channels = static_cast<std::uint32_t>(contents.channels.size());
  s.attachments = static_cast<std::uint32_t>(layout.attachments.size());
  s.metadata = static_cast<std::uint32_t>(layout.metadata.size());
  s.chunks = static_cast<std::uint32_t>(layout.chunks.size());
  for (const McapMessage& message : contents.messages) {
    s.first = ++s.by_channel[message.channel] == 1 && s.by_channel.size() == 1 ? message.log_time
                                                                               : std::min(s.first, message.log_time);
    s.last = std::max(s.last, message.log_time);
  }
  return s;
}

void read_offset(ByteReader& in, Summary& summary) {
  const auto opcode = static_cast<Opcode>(in.get<std::uint8_t>());
  const auto at = in.get<std::uint64_t>();
  summary.offsets.push_back({opcode, {at, in.get<std::uint64_t>()}});
}

/// @return false if a record is shorter than its fields
bool read_summary_record(const McapRecord& record, Summary& summary) {
  ByteReader in(record.body);
  if (record.opcode == Opcode::statistics) summary.statistics.push_back(read_statistics(in));
  if (record.opcode == Opcode::chunk_index) summary.chunks.push_back(read_chunk_index(in));
  if (record.opcode == Opcode::attachment_index) summary.attachments.push_back(read_attachment_index(in));
  if (record.opcode == Opcode::metadata_index) summary.metadata.push_back(read_metadata_index(in));
  if (record.opcode == Opcode::summary_offset) {
    if (summary.offsets_start == 0) summary.offsets_start = record.at;
    read_offset(in, summary);
    return in.good();
  }
  auto& [at, length] = summary.groups[record.opcode];
  if (length == 0) at = record.at;
  length += record.end() - record.at;
  return in.good();
}

/// MCAP permits omitting an index, so an empty one fits.
template <class Entry>
bool fits(std::vector<Entry> stated, std::vector<Entry> found) {
  if (stated.empty()) return true;
  std::sort(stated.begin(), stated.end());
  std::sort(found.begin(), found.end());
  return stated == found;
}

/// @return the first entry of the summary that contradicts the data; empty: none does
std::string contradiction(const Summary& summary, McapLayout& layout, const McapContents& contents) {
  for (McapLayout::Chunk& chunk : layout.chunks) std::sort(chunk.indexes.begin(), chunk.indexes.end());
  for (const McapLayout::Statistics& s : summary.statistics)
    if (!(s == statistics_of(contents, layout))) return "statistics";
  if (!fits(summary.chunks, layout.chunks)) return "index of chunks";
  if (!fits(summary.attachments, layout.attachments)) return "index of attachments";
  if (!fits(summary.metadata, layout.metadata)) return "index of metadata";
  const auto is_group = [&](const auto& offset) {
    const auto group = summary.groups.find(offset.first);
    return group != summary.groups.end() && group->second == offset.second;
  };
  return std::all_of(summary.offsets.begin(), summary.offsets.end(), is_group) ? "" : "offsets of the summary";
}

}  // namespace

void MessageIndexCheck::begin(const McapRecord& record, State state) {
  state_ = state;
  at_ = record.at;
  messages_.clear();
  indexed_.clear();
}

void MessageIndexCheck::end_chunk(const McapLayout::Chunk& chunk) {
  if (messages_.empty()) return;
  const auto earlier = [](const auto& a, const auto& b) { return a.time < b.time; };
  const auto [first, last] = std::minmax_element(messages_.begin(), messages_.end(), earlier);
  if (first->time == chunk.first && last->time == chunk.last) return;
  note_damage(contents_, at_, "the times of the chunk are not those of its messages");
}

void MessageIndexCheck::add_index(const McapRecord& record, McapLayout::Chunk* chunk) {
  if (state_ == State::none) return note_damage(contents_, record.at, "message index without a chunk");
  if (state_ == State::lost) return;
  ByteReader in(record.body);
  const auto channel = in.get<std::uint16_t>();
  ByteReader entries(in.get_bytes(in.get<std::uint32_t>()));
  while (entries.left() > 0 && entries.good()) {
    const auto time = entries.get<std::uint64_t>();
    indexed_.push_back({channel, time, entries.get<std::uint64_t>()});
  }
  if (!in.good() || in.left() > 0 || !entries.good())
    return note_damage(contents_, record.at, "malformed message index");
  if (chunk == nullptr) return;
  chunk->indexes.emplace_back(channel, record.at);
  chunk->index_length += record.end() - record.at;
}

void MessageIndexCheck::finish_index() {
  if (state_ == State::whole && !indexed_.empty()) {
    std::sort(messages_.begin(), messages_.end());
    std::sort(indexed_.begin(), indexed_.end());
    if (messages_ != indexed_) note_damage(contents_, at_, "the message indexes do not match the chunk's messages");
  }
  state_ = State::none;
}

void check_summary(View file, const McapRecord& footer, McapLayout layout, McapContents& contents) {
  ByteReader in(footer.body);
  const auto start = in.get<std::uint64_t>(), offsets = in.get<std::uint64_t>();
  const std::size_t covered = footer.at + kRecordHead + in.position();
  const auto crc = in.get<std::uint32_t>();
  const std::size_t from = start == 0 ? footer.at : static_cast<std::size_t>(start);
  const auto refuse = [&](const std::string& what) { note_damage(contents, footer.at, what); };
  if (!in.good() || in.left() > 0) return refuse("malformed footer");
  if (layout.data_end == 0) return refuse("no end of the data before the footer");
  if (from != layout.data_end) return refuse("the summary is not at the position in the footer");
  if (crc != 0 && crc != crc32_of(file.subspan(from, covered - from)))
    return refuse("the CRC of the summary does not match: bytes were changed after writing");
  if (!contents.damage.empty()) return;  // the statistics do not include omitted data

  Summary summary;
  McapRecord record;
  const View records = file.subspan(from, footer.at - from);
  for (std::size_t at = 0; next_record(records, from, at, record); at = record.end() - from)
    if (!record.whole || !read_summary_record(record, summary))
      return note_damage(contents, record.at, "malformed summary");
  if (offsets != summary.offsets_start) return refuse("the summary's offsets are not at the position in the footer");
  const std::string wrong = contradiction(summary, layout, contents);
  if (!wrong.empty()) refuse("the " + wrong + " do not match the data");
}

}  // namespace sf::record
