// `verify` as a user runs it.

#include <gtest/gtest.h>

#include <fstream>

#include "record/recorder.h"
#include "scenarios/run_info.h"
#include "scenarios/simulation.h"
#include "sensors/sensor_type.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"

namespace sf {
namespace {

/// Records two seconds of a world with sensors of many types.
std::string record(const Folder& folder, const Words& more = {}) {
  Words words{"run", our_world("minimagic/minimagic.world"), "--duration", "2", "--record", folder.path("run")};
  words.insert(words.end(), more.begin(), more.end());
  EXPECT_EQ(run_program(words).code, 0);
  return folder.path("run");
}

/// Half a second of two robots, its checksums right, with one range of one scan at `tick` a millimetre off.
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
    values[values.size() / 2] -= 1e-3;  // nearer: what is farther than the limit is no return
    if (t == tick) readings.front().values = values;
    record.readings = readings;
    recorder.write(record);
  }
  recorder.finish();
  return folder.path("altered");
}

TEST(Verify, AnAlteredReadingEndsWithOne) {
  const Folder folder;
  EXPECT_EQ(run_program({"verify", altered(folder, 99)}).code, 0) << "nothing was altered";
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
  EXPECT_EQ(facts.number("/reference/different"), 1) << "so short a run is looked at whole";
}

/// The default is a sample whose size is said; every scan of a run that is no longer than it.
TEST(Verify, LooksAtASampleUnlessAskedForAll) {
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
  EXPECT_NE(few.out.find("a sample: 10 of 1200 scans, spread evenly over the run (--all: every one)"),
            std::string::npos)
      << few.out;
  EXPECT_EQ(run_program({"verify", run, "--sample", "10", "--all"}).code, 2);
}

TEST(Verify, ASoundRunSaysSo) {
  const Folder folder;
  const Outcome outcome = run_program({"verify", record(folder, {"--record-readings"})});
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("verdict            sound"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("plain C++ beside the recording"), std::string::npos) << outcome.out;
}

TEST(Verify, InfinityForNothingMet) {
  const Folder folder;
  const Outcome outcome = run_program({"verify", record(folder, {"--record-readings", "--no-return", "inf"})});
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
}

TEST(Verify, WithoutReadings) {
  const Folder folder;
  const Outcome outcome = run_program({"verify", record(folder), "--json", "--sample", "5"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("\"sound\": true"), std::string::npos) << outcome.out;
}

/// Where nothing can be compared, that is said.
TEST(Verify, WithoutReadingsAndLasers) {
  const Folder folder;
  const std::string world = folder.path("blind.world"), run = folder.path("run");
  std::ofstream(world) << "position(pose [1 1 0 0] drive \"diff\")\n";
  ASSERT_EQ(run_program({"run", world, "--duration", "1", "--record", run}).code, 0);
  const Outcome outcome = run_program({"verify", run});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out,
            "  ticks              10\n"
            "  skipped            all readings: the run kept none, and no robot has a laser to compare with plain C++\n"
            "  verdict            sound\n");
}

/// A flipped bit in a scan is behind a checksum: it is told as damage, and what is left is verified.
TEST(Verify, DamageIsTold) {
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
  EXPECT_GT(facts.number("/ticks"), 0) << "what is left is looked at";
  EXPECT_EQ(facts.number("/reference/different"), 0);
}

TEST(Verify, WrongUsage) {
  const Outcome nothing = run_program({"verify", "/nowhere"});
  EXPECT_EQ(nothing.code, 2);
  EXPECT_NE(nothing.err.find("/nowhere"), std::string::npos);
  EXPECT_EQ(run_program({"verify"}).code, 2);
}

}  // namespace
}  // namespace sf
