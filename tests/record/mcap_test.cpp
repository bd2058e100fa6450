#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "base/error.h"
#include "record/compression.h"
#include "record/crc32.h"
#include "record/mcap_reader.h"
#include "record/mcap_writer.h"

namespace sf::record {
namespace {

using base::Bytes;

/// Computes the CRC bit by bit, as a reference.
std::uint32_t slow_crc(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (0xEDB88320u & (0u - (crc & 1u)));
  }
  return ~crc;
}

/// A file written by hand, in the order of the specification.
struct Hand {
  Bytes bytes;
  Hand& u8(std::initializer_list<int> values) {
    for (const int value : values) bytes.push_back(static_cast<std::uint8_t>(value));
    return *this;
  }
  Hand& number(std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return *this;
  }
  Hand& u16(std::uint64_t value) { return number(value, 2); }
  Hand& u32(std::uint64_t value) { return number(value, 4); }
  Hand& u64(std::uint64_t value) { return number(value, 8); }
  Hand& text(const std::string& text) {
    u32(text.size());
    bytes.insert(bytes.end(), text.begin(), text.end());
    return *this;
  }
  Hand& record(int opcode, std::uint64_t length) { return u8({opcode}).u64(length); }
  Hand& raw(const Bytes& other) {
    bytes.insert(bytes.end(), other.begin(), other.end());
    return *this;
  }
  std::uint64_t size() const { return bytes.size(); }
};

const Bytes kMagic = {0x89, 0x4D, 0x43, 0x41, 0x50, 0x30, 0x0D, 0x0A};

Bytes tiny_file(Compression compression = Compression::none) {
  McapWriter writer("p", "lib", compression);
  const auto schema = writer.add_schema("S", "ros2msg", "bool b\n");
  const auto channel = writer.add_channel(schema, "/t", "cdr", {{"k", "v"}});
  const Bytes world = {7, 8};
  writer.add_attachment({.log_time = 1, .create_time = 2, .name = "w", .media_type = "m", .data = world});
  writer.add_metadata({"M", {{"a", "b"}}});
  const Bytes data = {0, 1, 0, 0, 1};
  writer.add_message({channel, 3, 1000, 999, data});
  writer.finish();
  const auto pending = writer.pending();
  return {pending.begin(), pending.end()};
}

Bytes tiny_file_by_hand() {
  Hand file;
  file.raw(kMagic);
  file.record(0x01, 12).text("p").text("lib");
  const Bytes schema = Hand().record(0x03, 2 + 5 + 11 + 11).u16(1).text("S").text("ros2msg").text("bool b\n").bytes;
  file.raw(schema);
  const Bytes channel = Hand()
                            .record(0x04, 2 + 2 + 6 + 7 + 4 + 10)
                            .u16(1)
                            .u16(1)
                            .text("/t")
                            .text("cdr")
                            .u32(10)
                            .text("k")
                            .text("v")
                            .bytes;
  file.raw(channel);

  const std::uint64_t attachment_at = file.size();
  const Bytes attachment = Hand().u64(1).u64(2).text("w").text("m").u64(2).u8({7, 8}).bytes;
  file.record(0x09, attachment.size() + 4).raw(attachment).u32(slow_crc(attachment));
  const std::uint64_t metadata_at = file.size();
  file.record(0x0C, 5 + 4 + 10).text("M").u32(10).text("a").text("b");

  const std::uint64_t chunk_at = file.size();
  const Bytes message = Hand().record(0x05, 22 + 5).u16(1).u32(3).u64(1000).u64(999).u8({0, 1, 0, 0, 1}).bytes;
  file.record(0x06, 8 + 8 + 8 + 4 + 4 + 8 + 36).u64(1000).u64(1000).u64(36).u32(slow_crc(message)).text("").u64(36);
  file.raw(message);
  const std::uint64_t index_at = file.size();
  file.record(0x07, 2 + 4 + 16).u16(1).u32(16).u64(1000).u64(0);
  const std::uint32_t data_crc = slow_crc(file.bytes);
  const std::uint64_t index_end = file.size();
  file.record(0x0F, 4).u32(data_crc);

  const std::uint64_t summary_at = file.size();
  Hand summary;
  summary.raw(schema).raw(channel);
  summary.record(0x0B, 8 + 2 + 4 * 4 + 8 + 8 + 4 + 10).u64(1).u16(1).u32(1).u32(1).u32(1).u32(1).u64(1000).u64(1000);
  summary.u32(10).u16(1).u64(1);
  const std::uint64_t chunk_index_at = summary_at + summary.size();
  summary.record(0x08, 4 * 8 + 4 + 10 + 8 + 4 + 8 + 8).u64(1000).u64(1000).u64(chunk_at).u64(index_at - chunk_at);
  summary.u32(10).u16(1).u64(index_at).u64(index_end - index_at).text("").u64(36).u64(36);
  const std::uint64_t attachment_index_at = summary_at + summary.size();
  summary.record(0x0A, 5 * 8 + 5 + 5).u64(attachment_at).u64(metadata_at - attachment_at).u64(1).u64(2).u64(2);
  summary.text("w").text("m");
  const std::uint64_t metadata_index_at = summary_at + summary.size();
  summary.record(0x0D, 8 + 8 + 5).u64(metadata_at).u64(chunk_at - metadata_at).text("M");
  const std::uint64_t offsets_at = summary_at + summary.size();

  const std::uint64_t channels_at = summary_at + schema.size();
  const std::uint64_t statistics_at = channels_at + channel.size();
  summary.record(0x0E, 17).u8({0x03}).u64(summary_at).u64(channels_at - summary_at);
  summary.record(0x0E, 17).u8({0x04}).u64(channels_at).u64(statistics_at - channels_at);
  summary.record(0x0E, 17).u8({0x0B}).u64(statistics_at).u64(chunk_index_at - statistics_at);
  summary.record(0x0E, 17).u8({0x08}).u64(chunk_index_at).u64(attachment_index_at - chunk_index_at);
  summary.record(0x0E, 17).u8({0x0A}).u64(attachment_index_at).u64(metadata_index_at - attachment_index_at);
  summary.record(0x0E, 17).u8({0x0D}).u64(metadata_index_at).u64(offsets_at - metadata_index_at);
  summary.record(0x02, 20).u64(summary_at).u64(offsets_at);
  const std::uint32_t summary_crc = slow_crc(summary.bytes);
  return file.raw(summary.bytes).u32(summary_crc).raw(kMagic).bytes;
}

McapContents read(const Bytes& bytes) { return read_mcap(bytes, "f.mcap"); }

/// Magic, header, a schema and channel 1, which precede the records of a case.
Hand opening() {
  Hand file;
  file.raw(kMagic).record(0x01, 8).text("").text("");
  file.record(0x03, 2 + 4 + 4 + 4).u16(1).text("").text("").text("");
  file.record(0x04, 4 + 4 + 4 + 4).u16(1).u16(1).text("").text("").u32(0);
  return file;
}

TEST(Crc, MatchesTheDefinition) {
  const std::string digits = "123456789";
  const Bytes bytes(digits.begin(), digits.end());
  EXPECT_EQ(crc32_of(bytes), 0xCBF43926u);  // the check value of CRC-32/ISO-HDLC
  EXPECT_EQ(slow_crc(bytes), 0xCBF43926u);
  const std::span all(bytes);
  EXPECT_EQ(crc32_of(all.subspan(4), crc32_of(all.first(4))), 0xCBF43926u);
  EXPECT_EQ(crc32_of({}, 5u), 5u);
  EXPECT_EQ(crc32_of({}), 0u);
}

TEST(McapWriter, TinyFileMatchesTheSpecificationByteByByte) { EXPECT_EQ(tiny_file(), tiny_file_by_hand()); }

TEST(McapWriter, DrainingAtAnyTimeMakesNoDifference) {
  const Bytes data = {1, 2, 3};
  const auto write = [&](bool drain) {
    McapWriter writer("p", "lib");
    Bytes file;
    const auto take = [&] {
      file.insert(file.end(), writer.pending().begin(), writer.pending().end());
      writer.drained();
    };
    const auto channel = writer.add_channel(writer.add_schema("S", "", ""), "/t", "cdr");
    for (std::uint32_t i = 0; i < 5; ++i) {
      if (drain) take();
      writer.add_message({channel, i, i, i, data});
      if (drain) take();
      writer.end_chunk();
    }
    if (drain) take();
    writer.finish();
    take();
    return file;
  };
  EXPECT_EQ(write(true), write(false));
}

TEST(McapWriter, DoesNotWriteEmptyChunks) {
  McapWriter writer("", "");
  const std::size_t before = writer.pending().size();
  writer.end_chunk();
  EXPECT_EQ(writer.pending().size(), before);
}

TEST(McapWriter, IndexesUnorderedMessagesByTheirExtremes) {
  McapWriter writer("", "");
  const auto channel = writer.add_channel(writer.add_schema("S", "", ""), "/t", "cdr");
  for (const std::uint64_t time : {50u, 20u, 70u}) writer.add_message({channel, 0, time, time, {}});
  const std::size_t before = writer.pending().size();
  writer.end_chunk();
  std::uint64_t first = 0, last = 0;
  std::memcpy(&first, writer.pending().data() + before + 9, 8);
  std::memcpy(&last, writer.pending().data() + before + 17, 8);
  EXPECT_EQ(first, 20u);
  EXPECT_EQ(last, 70u);
}

TEST(McapReader, ReadsTheTinyFile) {
  const Bytes file = tiny_file_by_hand();
  const McapContents contents = read(file);
  EXPECT_FALSE(contents.truncated);
  EXPECT_TRUE(contents.damage.empty());
  EXPECT_EQ(contents.profile, "p");
  EXPECT_EQ(contents.library, "lib");
  EXPECT_EQ(contents.schemas.at(1).text, "bool b\n");
  EXPECT_EQ(contents.channels.at(1).topic, "/t");
  EXPECT_EQ(contents.channels.at(1).metadata, (TextPairs{{"k", "v"}}));
  ASSERT_EQ(contents.messages.size(), 1u);
  EXPECT_EQ(contents.messages[0].sequence, 3u);
  EXPECT_EQ(contents.messages[0].log_time, 1000u);
  EXPECT_EQ(contents.messages[0].publish_time, 999u);
  EXPECT_EQ(contents.messages[0].data.size(), 5u);
  ASSERT_EQ(contents.attachments.size(), 1u);
  EXPECT_EQ(contents.attachments[0].data[1], 8);
  EXPECT_EQ(contents.metadata.at(0).pairs, (TextPairs{{"a", "b"}}));
}

TEST(McapReader, ReadsMessagesOutsideChunks) {
  Hand file = opening();
  file.record(0x05, 22 + 1).u16(1).u32(9).u64(1).u64(1).u8({5});
  const McapContents contents = read(file.bytes);
  ASSERT_EQ(contents.messages.size(), 1u);
  EXPECT_EQ(contents.messages[0].data[0], 5);
  EXPECT_TRUE(contents.truncated);  // no footer
}

TEST(McapReader, SkipsOpcodesOfLaterVersions) {
  Hand file = opening();
  file.record(0x10, 3).u8({1, 2, 3}).record(0x80, 0);
  file.record(0x05, 22).u16(1).u32(9).u64(1).u64(1);
  EXPECT_EQ(read(file.bytes).messages.size(), 1u);
}

TEST(McapReader, RejectsOtherFiles) {
  const std::vector<Bytes> corpus = {
      {}, {0x89}, Bytes(8, 0), {'#', 'R', 'O', 'S', 'B', 'A', 'G', ' ', 'V', '2', '.', '0'}};
  for (const Bytes& bytes : corpus) EXPECT_THROW(read(bytes), base::InputError);
  EXPECT_TRUE(read(kMagic).truncated);  // the magic alone is a truncated file
}

/// Bad records with the reason of each. All must be skipped, and all except truncations reported.
TEST(McapReader, SkipsAndReportsBadRecords) {
  const std::vector<std::pair<const char*, Bytes>> corpus = {
      {"schema shorter than its fields", Hand().record(0x03, 1).u8({1}).bytes},
      {"schema with the reserved id 0", Hand().record(0x03, 14).u16(0).text("").text("").text("").bytes},
      {"schema with text beyond the record", Hand().record(0x03, 14).u16(2).text("").text("").u32(0xFFFFFFFF).bytes},
      {"channel of an unknown schema", Hand().record(0x04, 16).u16(2).u16(9).text("").text("").u32(0).bytes},
      {"channel whose map is longer than the record",
       Hand().record(0x04, 16).u16(2).u16(1).text("").text("").u32(99).bytes},
      {"message of an unknown channel", Hand().record(0x05, 22).u16(2).u32(0).u64(0).u64(0).bytes},
      {"message shorter than its head", Hand().record(0x05, 21).u16(1).u32(0).u64(0).u32(0).u8({0, 0, 0}).bytes},
      {"chunk shorter than its head", Hand().record(0x06, 3).u8({1, 2, 3}).bytes},
      {"chunk in an unknown compression", Hand().record(0x06, 43).u64(0).u64(0).u64(0).u32(0).text("lz4").u64(0).bytes},
      {"chunk with more records than bytes", Hand().record(0x06, 40).u64(0).u64(0).u64(9).u32(0).text("").u64(9).bytes},
      {"chunk with a wrong CRC", Hand()
                                     .record(0x06, 71)
                                     .u64(0)
                                     .u64(0)
                                     .u64(31)
                                     .u32(1)
                                     .text("")
                                     .u64(31)
                                     .record(5, 22)
                                     .u16(1)
                                     .u32(0)
                                     .u64(0)
                                     .u64(0)
                                     .bytes},
      {"attachment larger than the record",
       Hand().record(0x09, 36).u64(0).u64(0).text("").text("").u64(~0ull).u32(0).bytes},
      {"attachment with a wrong CRC", Hand().record(0x09, 36).u64(0).u64(0).text("").text("").u64(0).u32(1).bytes},
      {"metadata without its map", Hand().record(0x0C, 4).text("").bytes},
      {"message index without a chunk", Hand().record(0x07, 6).u16(1).u32(0).bytes},
      {"data end with a wrong CRC", Hand().record(0x0F, 4).u32(1).bytes},
  };
  for (const auto& [reason, bytes] : corpus) {
    const Bytes file = opening().raw(bytes).record(0x05, 22).u16(1).u32(77).u64(0).u64(0).bytes;
    const McapContents contents = read(file);
    EXPECT_EQ(contents.damage.size(), 1u) << reason;
    ASSERT_EQ(contents.messages.size(), 1u) << reason;  // and the next records are still read
    EXPECT_EQ(contents.messages[0].sequence, 77u) << reason;
    EXPECT_TRUE(contents.attachments.empty()) << reason;
  }
}

TEST(McapReader, LengthBeyondTheFileEndsReading) {
  for (const std::uint64_t length : {std::uint64_t{1}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    const McapContents contents = read(opening().record(0x05, length).bytes);
    EXPECT_TRUE(contents.truncated);
    EXPECT_TRUE(contents.messages.empty());
  }
}

TEST(McapReader, KeepsWholeMessagesOfATruncatedChunk) {
  Hand file = opening();
  file.record(0x06, 40 + 2 * 31).u64(0).u64(0).u64(62).u32(1).text("").u64(62);
  file.record(0x05, 22).u16(1).u32(7).u64(0).u64(0);
  file.record(0x05, 22).u16(1).u32(8);  // truncated here, so the CRC covers more than the rest
  const McapContents contents = read(file.bytes);
  EXPECT_TRUE(contents.truncated);
  EXPECT_TRUE(contents.damage.empty());
  ASSERT_EQ(contents.messages.size(), 1u);
  EXPECT_EQ(contents.messages[0].sequence, 7u);
}

TEST(McapReader, ReportsDamageAtMostAHundredTimes) {
  Hand file = opening();
  for (int i = 0; i < 1000; ++i) file.record(0x05, 0);
  EXPECT_EQ(read(file.bytes).damage.size(), 100u);
}

void expect_cuts_read(const Bytes& file) {
  for (std::size_t size = kMagic.size(); size < file.size(); ++size) {
    const McapContents contents = read(Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)));
    EXPECT_TRUE(contents.truncated) << size;
    EXPECT_TRUE(contents.damage.empty()) << size << ": " << contents.damage.front();
  }
  EXPECT_FALSE(read(file).truncated);
}

TEST(McapReader, ReadsWholeRecordsBeforeAnyTruncation) {
  for (const Compression compression : {Compression::none, Compression::zstd}) expect_cuts_read(tiny_file(compression));
}

/// Returns a chunk of 100 messages, compressed by `writer`.
Bytes compressed_records(Bytes& records) {
  Hand all;
  for (std::uint64_t i = 0; i < 100; ++i) all.record(0x05, 22).u16(1).u32(i).u64(5).u64(5);
  records = all.bytes;
  Bytes frame;
  ZstdCompressor().compress(records, frame);
  return frame;
}

TEST(McapReader, ReadsCompressedChunks) {
  Bytes records;
  const Bytes frame = compressed_records(records);
  ASSERT_LT(frame.size(), records.size() / 4);
  const auto with = [&](std::uint64_t size, std::uint32_t crc, const std::string& form, const Bytes& bytes) {
    Hand file = opening();
    file.record(0x06, 40 + form.size() + bytes.size()).u64(5).u64(5).u64(size).u32(crc).text(form).u64(bytes.size());
    file.raw(bytes).record(0x05, 22).u16(1).u32(1000).u64(6).u64(6);
    return read(file.bytes);
  };
  const std::uint32_t crc = slow_crc(records);
  const auto good = with(records.size(), crc, "zstd", frame);
  EXPECT_TRUE(good.damage.empty()) << good.damage[0];
  ASSERT_EQ(good.messages.size(), 101u);
  EXPECT_EQ(good.messages[99].sequence, 99u);
  EXPECT_TRUE(with(records.size(), 0, "zstd", frame).damage.empty()) << "a CRC of 0 means none";

  Bytes cut = frame, longer = frame, twice = frame, other = frame;
  cut.pop_back();
  longer.push_back(0);
  twice.insert(twice.end(), frame.begin(), frame.end());
  other.back() ^= 1;
  const struct {
    const char* reason;
    std::uint64_t size;
    std::uint32_t crc;
    std::string form;
    Bytes bytes;
    const char* message;
  } bad[] = {{"one byte less than there is", records.size() - 1, crc, "zstd", frame, "malformed"},
             {"one byte more than there is", records.size() + 1, crc, "zstd", frame, "malformed"},
             {"more than memory", ~0ull, crc, "zstd", frame, "at most"},
             {"more than a file of this size may have", (1ull << 30) + 300 * 2000, crc, "zstd", frame, "at most"},
             {"as much as it may have", 1ull << 30, crc, "zstd", frame, "malformed"},
             {"another CRC", records.size(), crc ^ 1, "zstd", frame, "CRC"},
             {"a cut frame", records.size(), crc, "zstd", cut, "malformed"},
             {"a byte behind the frame", records.size(), crc, "zstd", longer, "malformed"},
             {"two frames", records.size(), crc, "zstd", twice, "malformed"},
             {"no frame", records.size(), crc, "zstd", {}, "malformed"},
             {"another form", records.size(), crc, "lz4", frame, "mcap decompress"},
             {"a form with control characters", records.size(), crc, "\x1b[2J", frame, "\\x1b[2J"}};
  for (const auto& [reason, size, sum, form, bytes, message] : bad) {
    const McapContents contents = with(size, sum, form, bytes);
    ASSERT_EQ(contents.damage.size(), 1u) << reason;
    EXPECT_NE(contents.damage[0].find(message), std::string::npos) << reason << ": " << contents.damage[0];
    ASSERT_EQ(contents.messages.size(), 1u) << reason;
    EXPECT_EQ(contents.messages[0].sequence, 1000u) << "the next records are read";
  }
}

/// Frames of any origin, with one byte changed or truncated: no read beyond their ends, and no message that does not
/// exist.
TEST(McapReader, HandlesAnyCompressedBytes) {
  Bytes records;
  const Bytes frame = compressed_records(records);
  ZstdDecompressor zstd;
  Bytes out(records.size());
  for (std::size_t at = 0; at < frame.size(); ++at)
    for (unsigned bit = 0; bit < 8; ++bit) {
      Bytes changed = frame;
      changed[at] ^= static_cast<std::uint8_t>(1u << bit);
      zstd.decompress(changed, out);
      zstd.decompress(std::span(frame).first(at), out);
    }
  EXPECT_TRUE(zstd.decompress(frame, out));
  EXPECT_EQ(out, records);
}

/// Two channels in two chunks, and all records that precede chunks; not finished.
Bytes unfinished_file() {
  McapWriter writer("p", "lib");
  const auto schema = writer.add_schema("S", "ros2msg", "bool b\n");
  const auto first = writer.add_channel(schema, "/t", "cdr", {{"k", "v"}}),
             second = writer.add_channel(schema, "/u", "cdr");
  const Bytes world = {7, 8}, data = {0, 1, 0, 0, 1};
  writer.add_attachment({.log_time = 1, .create_time = 2, .name = "w", .media_type = "m", .data = world});
  for (const std::uint64_t time : {1000u, 2000u}) {
    writer.add_message({first, 3, time, 999, data});
    writer.add_message({second, 4, time + 1, 999, data});
    writer.end_chunk();
  }
  return {writer.pending().begin(), writer.pending().end()};
}

/// A record's opcode and the offset of its content.
struct Place {
  Opcode opcode;
  std::size_t begin, end;
};

std::vector<Place> places_in(const Bytes& file, std::size_t at, std::size_t end) {
  std::vector<Place> places;
  while (at < end) {
    std::uint64_t length = 0;
    std::memcpy(&length, file.data() + at + 1, sizeof length);
    places.push_back({static_cast<Opcode>(file[at]), at + 9, at + 9 + static_cast<std::size_t>(length)});
    at = places.back().end;
  }
  return places;
}

/// Flips each bit of the bytes in turn. @param mend updates the file's checksum to its new bytes
template <class Mend>
void expect_each_flip_reported(Bytes file, std::size_t begin, std::size_t end, Mend mend) {
  for (std::size_t at = begin; at < end; ++at)
    for (unsigned bit = 0; bit < 8; ++bit) {
      file[at] ^= static_cast<std::uint8_t>(1u << bit);
      mend(file);
      try {
        EXPECT_FALSE(read(file).damage.empty()) << "bit " << bit << " of byte " << at << " of " << file.size();
      } catch (const base::InputError&) {
        EXPECT_LT(at, kMagic.size()) << "only without the magic at its start it is another file";
      }
      file[at] ^= static_cast<std::uint8_t>(1u << bit);
    }
}

TEST(McapReader, ReportsEachFlippedBitOfAFinishedFile) {
  for (const Bytes& file : {tiny_file(), tiny_file(Compression::zstd), [] {
                              McapWriter writer("", "");  // without content
                              writer.finish();
                              return Bytes(writer.pending().begin(), writer.pending().end());
                            }()})
    expect_each_flip_reported(file, 0, file.size(), [](Bytes&) {});
}

/// Before its end, a file has CRCs and redundant numbers in attachments, chunks and their indexes. The rest (header,
/// schemas, channels, metadata, heads of records) is stated once, and the index of the last chunk may be truncated.
TEST(McapReader, ReportsFlippedBitsInRedundantFieldsOfAnUnfinishedFile) {
  Bytes file = unfinished_file();
  const std::vector<Place> places = places_in(file, kMagic.size(), file.size());
  ASSERT_EQ(places.back().opcode, Opcode::message_index);
  std::size_t flips = 0;
  for (std::size_t i = 0; i + 2 < places.size(); ++i) {
    const Opcode opcode = places[i].opcode;
    if (opcode != Opcode::attachment && opcode != Opcode::chunk && opcode != Opcode::message_index) continue;
    for (std::size_t at = places[i].begin; at < places[i].end; ++at)
      for (unsigned bit = 0; bit < 8; ++bit, ++flips) {
        file[at] ^= static_cast<std::uint8_t>(1u << bit);
        EXPECT_FALSE(read(file).damage.empty()) << "bit " << bit << " of byte " << at << ", opcode " << int(opcode);
        file[at] ^= static_cast<std::uint8_t>(1u << bit);
      }
  }
  EXPECT_GT(flips, 8u * 250u);
  EXPECT_TRUE(read(file).damage.empty());
}

/// A summary whose CRC is correct, but whose content contradicts the data.
TEST(McapReader, ReportsASummaryThatContradictsTheData) {
  const Bytes file = tiny_file();
  std::uint64_t start = 0;
  const std::size_t footer = file.size() - kMagic.size() - 20;
  std::memcpy(&start, file.data() + footer, sizeof start);
  const auto mend = [&](Bytes& changed) {
    const std::uint32_t crc = slow_crc(std::span(changed).subspan(start, footer + 16 - start));
    std::memcpy(changed.data() + footer + 16, &crc, sizeof crc);
  };
  for (const Place& place : places_in(file, start, footer + 20)) {
    // Only the footer's own CRC is updated.
    const std::size_t end = place.opcode == Opcode::footer ? place.end - 4 : place.end;
    expect_each_flip_reported(file, place.begin, end, mend);
  }
}

/// A chunk of one message, and its index as written by `rest`: a count of bytes, and further content.
TEST(McapReader, MessageIndexesEndWithTheirEntries) {
  const auto damage = [](const Bytes& rest) {
    Hand file = opening();
    const Bytes message = Hand().record(0x05, 22).u16(1).u32(9).u64(5).u64(5).bytes;
    file.record(0x06, 40 + 31).u64(5).u64(5).u64(31).u32(slow_crc(message)).text("").u64(31).raw(message);
    file.record(0x07, 2 + rest.size()).u16(1).raw(rest);
    return read(file.record(0x05, 22).u16(1).u32(10).u64(6).u64(6).bytes).damage;  // ends the chunk's indexes
  };
  const struct {
    const char* reason;
    Bytes rest;
  } malformed[] = {{"a byte behind the entries", Hand().u32(16).u64(5).u64(0).u8({0}).bytes},
                   {"a byte behind none", Hand().u32(0).u8({0}).bytes},
                   {"less than an entry", Hand().u32(15).u64(5).u32(0).u8({0, 0, 0}).bytes},
                   {"more than an entry", Hand().u32(17).u64(5).u64(0).u8({0}).bytes},
                   {"more than there is", Hand().u32(32).u64(5).u64(0).bytes},
                   {"no count", Hand().u8({0, 0}).bytes}};
  for (const auto& [reason, rest] : malformed) {
    const auto found = damage(rest);
    ASSERT_FALSE(found.empty()) << reason;
    EXPECT_NE(found[0].find("malformed message index"), std::string::npos) << reason << ": " << found[0];
  }
  EXPECT_TRUE(damage(Hand().u32(16).u64(5).u64(0).bytes).empty()) << "unchanged";
  EXPECT_TRUE(damage(Hand().u32(0).bytes).empty()) << "it may list nothing";
  for (const Bytes& other : {Hand().u32(16).u64(6).u64(0).bytes, Hand().u32(16).u64(5).u64(1).bytes,
                             Hand().u32(32).u64(5).u64(0).u64(5).u64(0).bytes})
    EXPECT_EQ(damage(other).size(), 1u) << "another time or place, or an entry twice";
}

/// A chunk states the times of its first and its last message.
TEST(McapReader, ChecksTheTimesOfAChunk) {
  const auto damaged = [](std::uint64_t first, std::uint64_t last) {
    Hand file = opening();
    Hand messages;
    for (const std::uint64_t time : {7u, 5u, 6u}) messages.record(0x05, 22).u16(1).u32(0).u64(time).u64(time);
    file.record(0x06, 40 + 93).u64(first).u64(last).u64(93).u32(slow_crc(messages.bytes)).text("").u64(93);
    return !read(file.raw(messages.bytes).bytes).damage.empty();
  };
  EXPECT_FALSE(damaged(5, 7));
  for (const auto& [first, last] : {std::pair{4, 7}, {6, 7}, {5, 6}, {5, 8}, {7, 5}})
    EXPECT_TRUE(damaged(static_cast<std::uint64_t>(first), static_cast<std::uint64_t>(last)))
        << first << " to " << last;
}

TEST(McapReader, ReportsBytesAfterTheEnd) {
  Bytes file = tiny_file();
  file.push_back(0);
  EXPECT_EQ(read(file).damage.size(), 1u);
  EXPECT_FALSE(read(file).truncated);
}

/// A CRC of 0 means none: MCAP permits files without CRCs.
TEST(McapReader, ReadsAFileWithoutChecksums) {
  Bytes file = tiny_file();
  const std::size_t footer_crc = file.size() - kMagic.size() - 4;
  std::memset(file.data() + footer_crc, 0, 4);
  const auto data_end = places_in(file, kMagic.size(), footer_crc - 25);
  for (const Place& place : data_end)
    if (place.opcode == Opcode::data_end) std::memset(file.data() + place.begin, 0, 4);
  EXPECT_TRUE(read(file).damage.empty());
}

}  // namespace
}  // namespace sf::record
