// `derive` as users run it.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/apps/program.h"
#include "tests/refusal.h"

namespace sf {
namespace {

constexpr const char* kWheeledWorld =
    "define bot position( size [0.3 0.3 0.1] drive \"diff\" encoder( rate 20 slip 0.01 ) gyro( rate 50 noise 1 ) )\n"
    "bot( name \"r0\" ctrl \"wander\" ) bot( name \"r1\" pose [3 0 0 0] )\n";
constexpr const char* kFile =
    "[[derived]]\nrobot = \"r0\"\ntype = \"localization\"\nname = \"pose\"\ninputs = [\"encoder\", \"gyro\"]\n"
    "rate = 5\n";

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string recorded(const Folder& folder, const Words& more) {
  const std::string run = folder.path("run");
  const Outcome outcome = run_program(
      with({"run", folder.write("two.world", kWheeledWorld), "--duration", "2", "--seed", "4", "--record", run}, more));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return run;
}

TEST(Derive, WritesARecordingAndATable) {
  const Folder folder;
  const std::string run = recorded(folder, {"--record-readings"}), file = folder.write("pose.toml", kFile);
  for (const std::string threads : {"1", "3"}) {
    const std::string out = folder.path("out" + threads);
    const Outcome outcome = run_program({"derive", run, "--with", file, "-o", out, "--threads", threads});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    expect_in("derived            10 readings", outcome.out);
    EXPECT_TRUE(text_of(out + "/pose.csv").starts_with("time_s,x_m,y_m,yaw_rad,valid,xx_m2")) << outcome.out;
  }
  EXPECT_EQ(text_of(folder.path("out1/run.mcap")), text_of(folder.path("out3/run.mcap")));
  EXPECT_EQ(text_of(folder.path("out1/pose.csv")), text_of(folder.path("out3/pose.csv")));

  const Outcome verified = run_program({"verify", folder.path("out1")});
  EXPECT_EQ(verified.code, 0) << "the run would have had the same readings\n" << verified.out << verified.err;
  const Outcome again = run_program({"derive", folder.path("out1"), "--with",
                                     folder.write("none.toml", "# none\nderived = []\n"), "-o", folder.path("again")});
  EXPECT_EQ(again.code, 0) << again.err;
  expect_in("10 readings derived before: bitwise equal", again.out);
}

TEST(Derive, RefusesWithoutLeavingFiles) {
  const Folder folder;
  const std::string run = recorded(folder, {}), file = folder.write("pose.toml", kFile), out = folder.path("out");
  const Outcome none = run_program({"derive", run, "--with", file, "-o", out});
  EXPECT_EQ(none.code, 2);
  expect_in("--record-readings", none.err);
  EXPECT_FALSE(std::filesystem::exists(out));
  const Outcome same = run_program({"derive", run, "--with", file, "-o", run});
  EXPECT_EQ(same.code, 2);
  expect_in("is the folder of the recording itself", same.err);
  EXPECT_EQ(run_program({"verify", run}).code, 0) << "it is unchanged";
}

TEST(Derive, ReadsTablesOfOtherPrograms) {
  const Folder folder;
  const std::string table = folder.write("pose.csv", "time_s,x_m,y_m,yaw_rad\n5,1,2,0.5\n5.5,1,2,0.5\n6,1,2,0.5\n");
  const std::string file = folder.write(
      "with.toml",
      "[[input]]\nrobot = \"car\"\nas = \"marker\"\ncolumns = [\"x_m\", \"y_m\", \"yaw_rad\"]\n"
      "[[derived]]\nrobot = \"car\"\nname = \"fused\"\ntype = \"localization\"\ninputs = [\"marker\"]\nrate = 2\n");
  const Outcome outcome = run_program({"derive", table, "--with", file, "-o", folder.path("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  expect_in("time 0             5000000000 ns of the recording", outcome.out);
  const std::string fused = text_of(folder.path("out/fused.csv"));
  expect_in("\n0,1,2,0.5,1,", fused);
  expect_in("\n1,1,2,0.5,1,", fused);
  EXPECT_EQ(run_program({"export", folder.path("out"), "-o", folder.path("tables")}).code, 0);
  expect_in("car,marker:0,2,0,1,2,0.5", text_of(folder.path("tables/marker.csv")));
  expect_in("readings of other sensors", run_program({"verify", folder.path("out")}).out);
  const Outcome again = run_program({"derive", folder.path("out"), "--with",
                                     folder.write("none.toml", "derived = []\n"), "-o", folder.path("again")});
  EXPECT_EQ(again.code, 2);
  expect_in("derive from that recording", again.err);
}

}  // namespace
}  // namespace sf
