#include "record/recording.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <thread>

#include "base/error.h"
#include "record/mcap_writer.h"
#include "record/reading_messages.h"
#include "record/schemas.h"
#include "tests/record/sample.h"
#include "tests/refusal.h"

namespace sf::record {
namespace {

using base::Bytes;
using test::SampleTick;

/// A finished recording, with its size after the start and after each tick.
struct Sample {
  Bytes bytes;
  std::vector<std::size_t> sizes;
};

const Sample& sample(Compression compression = Compression::zstd) {
  const auto make = [](Compression form) {
    Sample sample;
    // Tests may run in parallel, each in its own process.
    const std::string directory = test::fresh_directory("to_read_" + std::to_string(::getpid()));
    Recorder recorder(directory, test::sample_info(true), {.compression = form});
    sample.sizes.push_back(recorder.size());
    for (std::uint64_t tick = 0; tick < 3; ++tick) {
      recorder.write(SampleTick(tick).record);
      while (recorder.size() == sample.sizes.back()) std::this_thread::yield();
      sample.sizes.push_back(recorder.size());
    }
    recorder.finish();
    sample.bytes = test::bytes_of(recorder.path());
    std::filesystem::remove_all(directory);
    return sample;
  };
  static const Sample plain = make(Compression::none), compressed = make(Compression::zstd);
  return compression == Compression::none ? plain : compressed;
}

bool same(const StateSample& a, const StateSample& b) {
  return a.tick == b.tick && a.time == b.time && a.contact == b.contact &&
         std::memcmp(&a.X_WM, &b.X_WM, sizeof(a.X_WM)) == 0 &&
         std::memcmp(&a.velocity, &b.velocity, sizeof(a.velocity)) == 0 &&
         std::memcmp(&a.command, &b.command, sizeof(a.command)) == 0;
}

bool same(const ReadingSample& a, const ReadingSample& b) {
  return a.mover == b.mover && a.type == b.type && a.sensor == b.sensor && a.sequence == b.sequence &&
         a.delivered == b.delivered && a.time == b.time && a.values == b.values;
}

/// Returns whether `part` is a prefix of `whole`.
bool is_prefix(const Recording& part, const Recording& whole) {
  const auto begins = [](const auto& a, const auto& b) {
    return a.size() <= b.size() &&
           std::equal(a.begin(), a.end(), b.begin(), [](const auto& x, const auto& y) { return same(x, y); });
  };
  if (part.states.size() != whole.states.size()) return false;
  for (std::size_t mover = 0; mover < part.states.size(); ++mover) {
    if (!begins(part.states[mover], whole.states[mover])) return false;
  }
  return begins(part.readings, whole.readings) && part.info.snapshot == whole.info.snapshot;
}

TEST(Recording, RoundTripsARun) {
  const Recording recording = read_recording(sample().bytes, "run.mcap");
  EXPECT_FALSE(recording.truncated);
  EXPECT_TRUE(recording.damage.empty());
  EXPECT_EQ(recording.ticks, 3u);
  EXPECT_EQ(recording.end_time, 200'000'000);
  EXPECT_EQ(recording.info.world_hash, test::sample_info(true).world_hash);
  EXPECT_EQ(recording.info.snapshot, test::sample_info(true).snapshot);
  ASSERT_EQ(recording.states.size(), 2u);
  for (std::uint32_t mover = 0; mover < 2; ++mover) {
    ASSERT_EQ(recording.states[mover].size(), 3u);
    for (std::uint64_t tick = 0; tick < 3; ++tick) {
      const SampleTick given(tick);
      const StateSample expected = {tick,
                                    given.record.time,
                                    given.contacts[mover] != 0,
                                    given.reports[mover].X_WM,
                                    given.reports[mover].velocity,
                                    given.commands[mover]};
      EXPECT_TRUE(same(recording.states[mover][tick], expected));
    }
  }
}

TEST(Recording, RoundTripsReadingsBitwiseAndScansAsFloat32) {
  const Recording recording = read_recording(sample().bytes, "run.mcap");
  ASSERT_EQ(recording.readings.size(), 18u);
  for (std::size_t i = 0; i < 18; ++i) {
    const SampleTick given(i / 6);
    const base::ReadingBlock& reading = given.readings[i % 6];
    ReadingSample expected{reading.mover,
                           reading.type,
                           reading.sensor,
                           reading.sequence,
                           given.record.time,
                           reading.time,
                           element_width(*find_sensor_type(recording.info, reading.type)),
                           {reading.values.begin(), reading.values.end()}};
    if (reading.type == 1)
      for (double& range : expected.values) range = static_cast<float>(range);
    EXPECT_TRUE(same(recording.readings[i], expected)) << i;
  }
}

void expect_prefixes(const Sample& of) {
  const Recording whole = read_recording(of.bytes, "run.mcap");
  const std::vector<std::size_t>& sizes = of.sizes;
  for (std::size_t size = 0; size < of.bytes.size(); ++size) {
    // A buffer of exactly this size, so that the sanitizer detects reads beyond the truncation.
    const Bytes cut(of.bytes.begin(), of.bytes.begin() + static_cast<std::ptrdiff_t>(size));
    Recording part;
    try {
      part = read_recording(cut, "run.mcap");
    } catch (const base::InputError&) {
      EXPECT_LT(size, sizes[0]) << "refused, though the world is inside";
      continue;
    }
    EXPECT_TRUE(part.truncated) << size;
    EXPECT_TRUE(part.damage.empty()) << size;
    EXPECT_TRUE(is_prefix(part, whole)) << size;
    const auto whole_ticks = std::upper_bound(sizes.begin() + 1, sizes.end(), size) - (sizes.begin() + 1);
    EXPECT_GE(part.ticks, static_cast<std::uint64_t>(whole_ticks)) << size;
  }
}

TEST(Recording, TruncationAtAnyByteKeepsEveryWholeTick) {
  expect_prefixes(sample(Compression::none));
  expect_prefixes(sample(Compression::zstd));
}

void expect_flips_reported(Bytes bytes) {
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    const auto bit = static_cast<std::uint8_t>(1u << (5 * at % 8));
    bytes[at] ^= bit;
    try {
      const Recording part = read_recording(bytes, "run.mcap");
      EXPECT_FALSE(part.damage.empty()) << "byte " << at << " of " << bytes.size();
    } catch (const base::InputError&) {
    }
    bytes[at] ^= bit;
  }
}

/// Flips one bit of each byte of a finished file, a different one from byte to byte. `McapReader` has tests with all
/// bits.
TEST(Recording, ReportsAFlippedBit) {
  expect_flips_reported(sample(Compression::none).bytes);
  expect_flips_reported(sample(Compression::zstd).bytes);
}

TEST(Recording, TruncatedAndGarbledFilesNeitherCrashNorHang) {
  std::mt19937 random(2);
  for (int i = 0; i < 3000; ++i) {
    Bytes bytes = sample(i % 4 < 2 ? Compression::none : Compression::zstd).bytes;
    for (int k = 0; k < 20; ++k) bytes[8 + random() % (bytes.size() - 8)] = static_cast<std::uint8_t>(random());
    if (i % 2 == 0) bytes.resize(9 + random() % (bytes.size() - 8));
    if (i % 3 == 0) bytes.insert(bytes.begin() + 8 + random() % (bytes.size() - 8), 1 + random() % 50, 0xFF);
    try {
      const Recording recording = read_recording(bytes, "run.mcap");
      EXPECT_LE(recording.info.movers.size(), bytes.size());
    } catch (const base::InputError&) {
    }
  }
}

std::string refusal(const Bytes& bytes) {
  return refusal_of([&] { read_recording(bytes, "dir/run.mcap"); });
}

Bytes finished(McapWriter& writer) {
  writer.finish();
  return {writer.pending().begin(), writer.pending().end()};
}

void add_world(McapWriter& writer, const Bytes& world) { writer.add_attachment({.name = "world.bin", .data = world}); }

void add_run_info(McapWriter& writer, const RunInfo& info) {
  Bytes message;
  encode_run_info(info, message);
  const auto schema = writer.add_schema(kRunInfo, "ros2msg", schema_text(kRunInfo));
  writer.add_message({.channel = writer.add_channel(schema, "/run", "cdr"), .data = message});
}

TEST(Recording, RejectsOtherRecordingsWithTheReason) {
  EXPECT_NE(refusal({'P', 'K', 3, 4}).find("dir/run.mcap: not an MCAP file"), std::string::npos);
  EXPECT_NE(refusal({}).find("not an MCAP file"), std::string::npos);

  McapWriter foreign("ros2", "another program");
  EXPECT_NE(refusal(finished(foreign)).find("not a sensorfarm recording"), std::string::npos);

  McapWriter worldless("ros2", "sensorfarm");
  add_run_info(worldless, {});
  EXPECT_NE(refusal(finished(worldless)).find("no complete world inside"), std::string::npos);

  McapWriter empty_world("ros2", "sensorfarm");
  add_world(empty_world, {});
  add_run_info(empty_world, {});
  EXPECT_NE(refusal(finished(empty_world)).find("no complete world inside"), std::string::npos);
}

TEST(Recording, RejectsADamagedWorldWithTheCause) {
  McapWriter writer("ros2", "sensorfarm");
  add_world(writer, Bytes(100, 7));
  add_run_info(writer, {});
  Bytes bytes = finished(writer);
  *std::search_n(bytes.begin(), bytes.end(), 50, 7) ^= 1;
  EXPECT_NE(refusal(bytes).find("attachment world.bin; damaged at byte "), std::string::npos) << refusal(bytes);
  EXPECT_NE(refusal(bytes).find("attachment left out: its CRC does not match"), std::string::npos);
}

TEST(Recording, SkipsAndReportsStatesOfUnknownMovers) {
  McapWriter writer("ros2", "sensorfarm");
  add_world(writer, {1});
  add_run_info(writer, {.movers = {{.name = "only"}}});
  Bytes message;
  encode_fleet(SampleTick(0, 2).record, message);
  const auto schema = writer.add_schema(kFleet, "ros2msg", schema_text(kFleet));
  writer.add_message({.channel = writer.add_channel(schema, "/fleet", "cdr"), .data = message});
  const Recording recording = read_recording(finished(writer), "run.mcap");
  EXPECT_EQ(recording.ticks, 0u);
  EXPECT_EQ(recording.damage.size(), 1u);
}

TEST(Recording, SkipsAndReportsTiltsOfUnknownMovers) {
  McapWriter writer("ros2", "sensorfarm");
  add_world(writer, {1});
  add_run_info(writer, {.movers = {{.name = "only"}}});
  SampleTick one(0, 1), two(0, 2);
  one.reports[0].tilt.roll = 0.25, two.reports[1].tilt.roll = 0.5;
  one.record.reports = one.reports, two.record.reports = two.reports;
  const auto add = [&](std::string_view type, const char* topic, const Bytes& message) {
    const auto schema = writer.add_schema(type, "ros2msg", schema_text(type));
    writer.add_message({.channel = writer.add_channel(schema, topic, "cdr"), .data = message});
  };
  Bytes fleet, tilts, others;
  encode_fleet(one.record, fleet), encode_tilts(one.record, tilts), encode_tilts(two.record, others);
  add(kFleet, "/fleet", fleet), add(kTilts, "/tilts", tilts), add(kTilts, "/tilts", others);
  const Recording recording = read_recording(finished(writer), "run.mcap");
  ASSERT_EQ(recording.ticks, 1u);
  EXPECT_EQ(recording.states[0][0].tilt.roll, 0.25);
  EXPECT_EQ(recording.damage.size(), 1u);
}

/// Earlier versions named topics after sensors, without an option that states it.
TEST(Recording, ReadsTopicsOfEarlierVersions) {
  McapWriter writer("ros2", "sensorfarm");
  add_world(writer, {1});
  RunInfo info = test::sample_info(true);
  put_naming({.style = TopicStyle::sensor}, info);
  name_frames(info);
  info.options.pop_back();
  add_run_info(writer, info);
  const SensorTypeInfo edge = test::edge_type();
  Bytes message;
  encode_reading(edge, 0, "f", std::vector<double>{1, 2, 3, 4, 5}, message);
  const auto schema = writer.add_schema(type_of(edge), "ros2msg", schema_text(edge));
  writer.add_message({.channel = writer.add_channel(schema, "/roomba_1/_3rd_edge/edge", "cdr"), .data = message});
  writer.end_chunk();
  const Recording recording = read_recording(finished(writer), "run.mcap");
  EXPECT_TRUE(recording.damage.empty());
  ASSERT_EQ(recording.readings.size(), 1u);
  EXPECT_EQ(recording.readings[0].type, 2);
}

TEST(Recording, SkipsAndReportsReadingsThatContradictTheirType) {
  McapWriter writer("ros2", "sensorfarm");
  add_world(writer, {1});
  RunInfo info = test::sample_info(true);
  name_frames(info);
  add_run_info(writer, info);
  const SensorTypeInfo edge = test::edge_type();
  Bytes message;
  encode_reading(edge, 0, "f", std::vector<double>{1, 2, 3, 4, 5}, message);
  const auto schema = writer.add_schema(type_of(edge), "ros2msg", schema_text(edge));
  const auto own = writer.add_channel(schema, info.movers[0].sensors[3].topic, "cdr");
  const auto other = writer.add_channel(schema, info.movers[0].sensors[2].topic, "cdr");  // of the array type
  const auto foreign = writer.add_channel(schema, "/another/program", "cdr");
  writer.add_message({.channel = own, .data = message});
  writer.add_message({.channel = own, .data = std::span(message).first(message.size() - 1)});
  writer.add_message({.channel = other, .data = message});
  writer.add_message({.channel = foreign, .data = message});
  writer.end_chunk();
  const Recording recording = read_recording(finished(writer), "run.mcap");
  EXPECT_EQ(recording.readings.size(), 1u);
  EXPECT_EQ(recording.damage.size(), 2u);  // topics of other programs do not count as damage
}

TEST(Recording, ReportsDamageAtMostAHundredTimes) {
  McapWriter writer("ros2", "sensorfarm");
  add_world(writer, {1});
  add_run_info(writer, {.movers = {{.name = "only"}}});
  Bytes message;
  encode_fleet(SampleTick(0, 2).record, message);  // of two movers
  const auto schema = writer.add_schema(kFleet, "ros2msg", schema_text(kFleet));
  const auto channel = writer.add_channel(schema, "/fleet", "cdr");
  for (int i = 0; i < 150; ++i) writer.add_message({.channel = channel, .data = message});
  const Recording recording = read_recording(finished(writer), "run.mcap");
  EXPECT_EQ(recording.damage.size(), 100u);
  EXPECT_NE(recording.damage.back().find("/fleet at 0 ns: malformed"), std::string::npos);
}

TEST(Recording, RejectsAFolderWithoutARecordingWithAdvice) {
  const auto refused = [](const std::string& directory) { return refusal_of([&] { open_recording(directory); }); };
  EXPECT_NE(refused("/nowhere/at/all").find("/nowhere/at/all/run.mcap: no such recording"), std::string::npos);
  const std::string directory = test::fresh_directory("no_file");
  std::filesystem::create_directories(directory + "/run.mcap");
  EXPECT_NE(refused(directory).find("is not a file"), std::string::npos);
  std::filesystem::remove(directory + "/run.mcap");
  std::ofstream(directory + "/run.mcap").close();
  EXPECT_NE(refused(directory).find("not an MCAP file"), std::string::npos);  // empty
}

TEST(Recording, AcceptsThePathOfTheFile) {
  Recorder recorder(test::fresh_directory("by_name"), test::sample_info(false));
  recorder.write(SampleTick(0).record);
  recorder.finish();
  EXPECT_EQ(open_recording(recorder.path()).ticks, 1u);
}

}  // namespace
}  // namespace sf::record
