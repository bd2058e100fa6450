// `verify` as users run it.

#include <gtest/gtest.h>

#include <fstream>

#include "record/recorder.h"
#include "record/recording.h"
#include "scenarios/run_info.h"
#include "scenarios/simulation.h"
#include "sensors/sensor_type.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/refusal.h"

namespace sf {
namespace {

/// Records two seconds of a world with many sensor types.
std::string record(const Folder& folder, const Words& more = {}) {
  const Words words =
      with({"run", our_world("minimagic/minimagic.world"), "--duration", "2", "--record", folder.path("run")}, more);
  EXPECT_EQ(run_program(words).code, 0);
  return folder.path("run");
}

/// Records half a second of two robots with valid checksums, but with one range of one scan at `tick` off by a
/// millimetre.
std::string altered(const Folder& folder, std::uint64_t tick) {
  const world::World world = world::load_world(our_world("rooms.world"), {.sensors = sensors::world_file_words()});
  gpu::Device device;
  scenarios::Simulation simulation(world, device, {.seed = 3});
  record::Recorder recorder(folder.path("altered"),
                            scenarios::run_info(world, simulation.farm().sensor_set(), {3, true}));
  for (std::uint64_t t = 0; t < 5; ++t) {
    base::TickRecord record = simulation.step();
    std::vector<base::ReadingBlock> readings(record.readings.begin(), record.readings.end());
    std::vector<double> values(readings.front().values.begin(), readings.front().values.end());
    values[values.size() / 2] -= 1e-3;  // nearer, since a range beyond the limit is no return
    if (t == tick) readings.front().values = values;
    record.readings = readings;
    recorder.write(record);
  }
  recorder.finish();
  return folder.path("altered");
}

TEST(Verify, AnAlteredReadingExitsWithOne) {
  const Folder folder;
  EXPECT_EQ(run_program({"verify", altered(folder, 99)}).code, 0) << "no reading was altered";
  const Outcome outcome = run_program({"verify", altered(folder, 2)});
  EXPECT_EQ(outcome.code, 1) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("1 of "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("numbers DIFFER, by up to 0.001"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("verdict            NOT SOUND"), std::string::npos) << outcome.out;
  const Outcome json = run_program({"verify", folder.path("altered"), "--json"});
  EXPECT_EQ(json.code, 1);
  const Json facts(json.out);
  EXPECT_FALSE(facts.flag("/sound"));
  EXPECT_EQ(facts.number("/again/0/different"), 1);
  EXPECT_EQ(facts.number("/reference/different"), 1) << "a short run is verified completely";
}

/// By default, verifies a sample and prints its size; every scan of a run with no more scans than that.
TEST(Verify, ChecksASampleByDefault) {
  const Folder folder;
  const std::string run = folder.path("run");
  ASSERT_EQ(run_program({"run", our_world("cave.world"), "--robots", "60", "--duration", "2", "--record", run}).code,
            0);
  const Json facts(run_program({"verify", run, "--json"}).out);
  EXPECT_EQ(facts.number("/scans"), 1200) << "60 lasers of 10 Hz, 20 ticks";
  EXPECT_EQ(facts.number("/reference/readings"), 600) << "every second: 500 at least";
  EXPECT_EQ(Json(run_program({"verify", run, "--json"}).out).number("/reference/readings"), 600);
  EXPECT_EQ(Json(run_program({"verify", run, "--json", "--all"}).out).number("/reference/readings"), 1200);
  const Outcome few = run_program({"verify", run, "--sample", "10"});
  expect_in("a sample: 10 of 1200 scans, spread evenly over the run (--all: every one)", few.out);
  EXPECT_EQ(run_program({"verify", run, "--sample", "10", "--all"}).code, 2);
}

TEST(Verify, NoReturnMayBeInfinite) {
  const Folder folder;
  run_successfully({"verify", record(folder, {"--record-readings", "--no-return", "inf"})});
}

TEST(Verify, WithoutReadings) {
  const Folder folder;
  const Outcome outcome = run_successfully({"verify", record(folder), "--json", "--sample", "5"});
  EXPECT_NE(outcome.out.find("\"sound\": true"), std::string::npos) << outcome.out;
}

/// If nothing can be compared, the output says so.
TEST(Verify, WithoutReadingsAndLasers) {
  const Folder folder;
  const std::string world = folder.path("blind.world"), run = folder.path("run");
  std::ofstream(world) << "position(pose [1 1 0 0] drive \"diff\")\n";
  ASSERT_EQ(run_program({"run", world, "--duration", "1", "--record", run}).code, 0);
  const Outcome outcome = run_successfully({"verify", run});
  EXPECT_EQ(
      outcome.out,
      "  ticks              10\n"
      "  skipped            all readings: none were recorded, and no robot has a laser to compare with plain C++\n"
      "  verdict            nothing could be compared\n");
  EXPECT_FALSE(Json(run_program({"verify", run, "--json"}).out).flag("/sound"));
}

/// If all existing readings are skipped, they are not verified.
TEST(Verify, ReadingsThatCannotBeComparedExitWithOne) {
  const Folder folder;
  const std::string world = folder.write("bumper.world", "position( bumper( ) )\n"), run = folder.path("run");
  ASSERT_EQ(run_program({"run", world, "--duration", "1", "--record", run, "--record-readings"}).code, 0);
  const Outcome outcome = run_program({"verify", run});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.out.find("verdict            nothing could be compared\n"), std::string::npos) << outcome.out;
}

/// A checksum detects a flipped bit in a scan: it is reported as damage, and the rest is verified.
TEST(Verify, DamageIsReported) {
  const Folder folder;
  const std::string file = record(folder, {"--record-readings"}) + "/run.mcap";
  std::string bytes = read_file(file);
  bytes[bytes.size() / 2] ^= 1;
  std::ofstream(file, std::ios::binary) << bytes;
  const Outcome outcome = run_program({"verify", folder.path("run"), "--json"});
  EXPECT_EQ(outcome.code, 1) << outcome.out;
  EXPECT_NE(outcome.err.find("run.mcap: byte "), std::string::npos) << outcome.err;
  const Json facts(outcome.out);
  EXPECT_FALSE(facts.flag("/sound"));
  EXPECT_GE(facts.size("/damage"), 1u);
  EXPECT_NE(outcome.err.find(facts.text("/damage/0")), std::string::npos) << outcome.err;
  EXPECT_GT(facts.number("/ticks"), 0) << "the rest is verified";
  EXPECT_EQ(facts.number("/reference/different"), 0);
}

/// Bits of the index and the summary, of lengths and of the end, throughout the file.
TEST(Verify, AnyFlippedBitIsReportedAsAnError) {
  const Folder folder;
  const std::string file = altered(folder, 99) + "/run.mcap";
  const std::string whole = read_file(file);
  for (std::size_t i = 0; i < 24; ++i) {
    std::string bytes = whole;
    const std::size_t at = i < 4 ? bytes.size() - 8 + 2 * i : bytes.size() - 1 - i * i * bytes.size() / 540;
    bytes[at] = static_cast<char>(bytes[at] ^ 1 << i % 8);
    std::ofstream(file, std::ios::binary) << bytes;
    const Outcome outcome = run_program({"verify", file});
    EXPECT_TRUE(outcome.code == 1 || outcome.code == 2)
        << "byte " << at << " of " << bytes.size() << ": " << outcome.out;
    EXPECT_NE(outcome.err.find("run.mcap"), std::string::npos) << outcome.err;
  }
}

/// The recording of a killed run is sound up to its last complete tick, and not sound without any tick.
TEST(Verify, ATruncatedRecordingIsIncomplete) {
  const Folder folder;
  const std::string file = altered(folder, 99) + "/run.mcap";
  const auto whole = std::filesystem::file_size(file);
  std::filesystem::resize_file(file, whole * 3 / 4);
  const Outcome part = run_successfully({"verify", file});
  EXPECT_NE(part.out.find("verdict            sound up to its end, but the recording was not finished"),
            std::string::npos)
      << part.out;
  EXPECT_TRUE(Json(run_program({"verify", file, "--json"}).out).flag("/truncated"));

  // Before the first tick, the only /fleet record is that of the channel.
  const record::Recording run = record::open_recording(file);
  std::uintmax_t size = whole * 3 / 4;
  while (record::open_recording(file).ticks > 0) std::filesystem::resize_file(file, size -= 64);
  const Outcome none = run_program({"verify", file});
  EXPECT_EQ(none.code, 1) << none.out;
  EXPECT_NE(none.out.find("cut off before its first tick: nothing was compared"), std::string::npos) << none.out;
  EXPECT_NE(none.out.find("verdict            NOT SOUND"), std::string::npos) << none.out;
  EXPECT_FALSE(Json(run_program({"verify", file, "--json"}).out).flag("/sound"));
}

TEST(Verify, AnotherAccuracyModeHasItsErrors) {
  const Folder folder;
  const std::string run = folder.path("run");
  ASSERT_EQ(run_program({"run", our_world("simville/simville.world"), "--duration", "1", "--record", run}).code, 0);
  const Outcome outcome = run_successfully({"verify", run, "--accuracy", "skip2 near1", "--json"});
  const Json facts(outcome.out);
  EXPECT_TRUE(facts.flag("/sound")) << "by the recorded mode";
  EXPECT_EQ(facts.text("/accuracy/mode"), "skip2 near1");
  EXPECT_EQ(facts.number("/accuracy/ticks"), facts.number("/ticks"));
  EXPECT_TRUE(facts.flag("/accuracy/within_bounds"));
  ASSERT_EQ(facts.size("/accuracy/types"), 3u) << "laser, lane edge, magnetometer";
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string at = "/accuracy/types/" + std::to_string(i);
    EXPECT_GT(facts.number(at + "/count"), 0.0) << outcome.out;
    EXPECT_LE(facts.number(at + "/median"), facts.number(at + "/p99"));
    EXPECT_LE(facts.number(at + "/p99"), facts.number(at + "/max"));
  }
  const Outcome text = run_successfully({"verify", run, "--accuracy", "exact"});
  expect_in("Errors of \"exact\" against exact at the recorded poses, both without noise, ", text.out);
  EXPECT_NE(text.out.find("100.00 %          0          0          0"), std::string::npos) << text.out;
}

TEST(Verify, UnknownModesAreRejectedWithTheKnownOnes) {
  const Folder folder;
  const std::string run = record(folder);
  expect_refused({"verify", run, "--accuracy", "skip3"},
                 "--accuracy: there is no accuracy \"skip3\"; expected one of \"exact\", \"single\", "
                 "\"skip2\", \"skip4\"");
}

TEST(Verify, WrongUsageIsRejected) {
  expect_refused({"verify", "/nowhere"}, "/nowhere");
  EXPECT_EQ(run_program({"verify"}).code, 2);
}

}  // namespace
}  // namespace sf
