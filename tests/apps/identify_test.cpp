// `identify` as users run it, and its model as a derived sensor.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/apps/program.h"
#include "tests/refusal.h"

namespace sf {
namespace {

// The second gyro has noise only; the first is wrong by 20 %.
constexpr const char* kTwoGyros =
    "define bot position( size [0.3 0.3 0.1] drive \"diff\" gyro( rate 20 scale_error 0.2 )\n"
    "gyro( name \"better\" rate 20 noise 0.3 ) )\nbot( name \"r0\" ctrl \"wander\" )\n"
    "model( pose [1.5 0 0 0] size [0.2 3 1] ) model( pose [-1.5 0 0 0] size [0.2 3 1] )\n";

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

struct Identify : testing::Test {
  Folder folder;
  std::string run = folder.path("run");

  void record(const Words& more = {"--record-readings"}) const {
    const Outcome outcome = run_program(with(
        {"run", folder.write("gyros.world", kTwoGyros), "--duration", "20", "--seed", "4", "--record", run}, more));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  Outcome identify(const Words& more, const std::string& out = "model.toml", const std::string& rate = "20",
                   const std::string& robot = "r0") const {
    return run_program(with({"identify", run, "--robot", robot, "--rate", rate, "-o", folder.path(out)}, more));
  }
};

TEST_F(Identify, ItsModelIsADerivedSensor) {
  record();
  const Words signals{"--inputs", "gyro", "--output", "gyro:1", "--lags", "1,2", "--hidden", "2"};
  const Outcome outcome = identify(with(signals, {"--threads", "1"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  expect_in("free run   RMS error [rate_rad_s], in cross-validation", outcome.out);
  expect_in("chosen", outcome.out);
  ASSERT_EQ(identify(with(signals, {"--threads", "3"}), "again.toml").code, 0);
  EXPECT_EQ(bytes_of(folder.path("model.toml")), bytes_of(folder.path("again.toml")));

  const std::string file =
      folder.write("with.toml",
                   "[[derived]]\nrobot = \"r0\"\ntype = \"model\"\nname = \"learnt\"\nfile = \"model.toml\"\n"
                   "inputs = [\"gyro\"]\nrate = 20\n");
  const Outcome derived = run_program({"derive", run, "--with", file, "-o", folder.path("out")});
  ASSERT_EQ(derived.code, 0) << derived.err;
  std::istringstream table(bytes_of(folder.path("out/learnt.csv")));
  std::string line;
  std::getline(table, line);
  EXPECT_TRUE(line.starts_with("time_s,value,valid,variance")) << line;
  int valid = 0;
  while (std::getline(table, line)) valid += line.find(",1,") != std::string::npos ? 1 : 0;
  EXPECT_GT(valid, 380) << "of 400 steps";
}

TEST_F(Identify, RefusesWithoutAModel) {
  record();
  const Words gyros{"--inputs", "gyro", "--output", "gyro:1"};
  const auto error = [&](const Words& more) {
    const Outcome outcome = identify(more);
    EXPECT_NE(outcome.code, 0) << outcome.out;
    return outcome.err;
  };
  expect_in("no sensor 'laser'; expected TYPE or TYPE:NUMBER, of: gyro",
            error({"--inputs", "laser", "--output", "gyro:1"}));
  expect_in("no sensor 'gyro:2'", error({"--inputs", "gyro:2", "--output", "gyro"}));
  expect_in("no sensor 'gyro:'", error({"--inputs", "gyro:", "--output", "gyro"}));
  expect_in("has no robot 'r1'", identify(gyros, "model.toml", "20", "r1").err);
  expect_in("--lags", error(with(gyros, {"--lags", "0"})));
  expect_in("expected NAME=LEAST,MOST", error(with(gyros, {"--where", "gyro.rate_rad_s=1"})));
  expect_in("have no 'rate'; expected one of: gyro.rate_rad_s", error(with(gyros, {"--where", "rate=0,1"})));
  expect_in("too few", error(with(gyros, {"--where", "gyro.rate_rad_s=1000,1001"})));
  expect_in("smaller number first", error(with(gyros, {"--between", "1,0"})));
  expect_in("is one of the inputs", error({"--inputs", "gyro", "--output", "gyro"}));
  expect_in("--kinds", error(with(gyros, {"--kinds", "svm"})));
  expect_in("too few", identify(with(gyros, {"--lags", "30", "--kinds", "arx"}), "model.toml", "0.1").err);
  EXPECT_FALSE(std::filesystem::exists(folder.path("model.toml")));
}

TEST_F(Identify, NeedsRecordedReadings) {
  record({});
  expect_in("record the run with --record-readings", identify({"--inputs", "gyro", "--output", "gyro:1"}).err);
}

}  // namespace
}  // namespace sf
