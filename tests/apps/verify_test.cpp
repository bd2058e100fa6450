// `verify` as a user runs it.

#include <gtest/gtest.h>

#include <fstream>

#include "tests/apps/json.h"
#include "tests/apps/program.h"

namespace sf {
namespace {

/// Records two seconds of a world with sensors of many kinds.
std::string record(const Folder& folder, const Words& more = {}) {
  Words words{"run", our_world("minimagic/minimagic.world"), "--duration", "2", "--record", folder.path("run")};
  words.insert(words.end(), more.begin(), more.end());
  EXPECT_EQ(run_program(words).code, 0);
  return folder.path("run");
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

/// A flipped bit in a scan is behind a checksum: it is told as damage, and what is left is verified.
TEST(Verify, DamageIsTold) {
  const Folder folder;
  const std::string file = record(folder, {"--record-readings"}) + "/run.mcap";
  std::string bytes = read_file(file);
  bytes[bytes.size() / 2] ^= 1;
  std::ofstream(file, std::ios::binary) << bytes;
  const Outcome outcome = run_program({"verify", folder.path("run")});
  EXPECT_FALSE(outcome.err.empty());
}

TEST(Verify, WrongUsage) {
  const Outcome nothing = run_program({"verify", "/nowhere"});
  EXPECT_EQ(nothing.code, 2);
  EXPECT_NE(nothing.err.find("/nowhere"), std::string::npos);
  EXPECT_EQ(run_program({"verify"}).code, 2);
}

}  // namespace
}  // namespace sf
