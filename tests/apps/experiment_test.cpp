// `experiment`, `test` and `run --controller` as users run them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>

#include "tests/apps/program.h"
#include "tests/viz/png.h"

namespace sf {
namespace {

std::string scenario(const std::string& more) {
  return "world = \"" + our_world("rooms.world") + "\"\nduration = 1\nrobots = 2\n" + more;
}

TEST(Experiment, WrongUsageIsRejected) {
  expect_refused({"experiment", "lane-edge", "-o", "x"}, "lane-edge-pi");
  const Outcome nowhere = run_program({"experiment", "mapping"});
  EXPECT_EQ(nowhere.code, 2);
  EXPECT_NE(nowhere.err.find("--out"), std::string::npos) << nowhere.err;
  expect_refused({"experiment"});
  expect_refused({"experiment", "mapping", "-o", "x", "--files", "/nowhere"}, "/nowhere/mapping.toml");
  expect_refused({"experiment", "mapping", "-o", "x", "--data", "d"}, "--data");
  expect_refused({"experiment", "mrclam", "-o", "x"}, "--data");
  expect_refused({"experiment", "lane-sensor", "-o", "x", "--trials", "2"},
                 "--trials: is not for the experiment lane-sensor");
  expect_refused({"experiment", "mrclam", "-o", "x", "--data", "d", "--trials", "2"}, "--trials");
  expect_refused({"experiment", "sideslip", "-o", "x", "--plant", "ideal"}, "--plant");
  expect_refused({"experiment", "sideslip", "-o", "x", "--data", "d"}, "--data");
  const Folder folder;
  expect_refused({"experiment", "mrclam", "-o", folder.path("out"), "--data", "/nowhere"}, "/nowhere");
}

TEST(Experiment, WritesItsFolder) {
  const Folder folder;
  run_successfully({"experiment", "lane-edge-p", "--trials", "1", "-o", folder.path("out"), "--files",
                    SF_SOURCE_DIR "/experiments"});
  const std::string csv = read_file(folder.path("out/statistics.csv"));
  EXPECT_EQ(csv.rfind("trial,mean,std,min,max,abs_mean,abs_std,abs_min,abs_max\n1,", 0), 0u) << csv;
  ASSERT_EQ(count_lines(csv), 2u);
  double mean = 0, deviation = 0, least = 0, most = 0, abs_mean = 0, abs_deviation = 0, abs_least = 0, abs_most = 0;
  ASSERT_EQ(std::sscanf(csv.c_str() + csv.find('\n'), "\n1,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &mean, &deviation, &least,
                        &most, &abs_mean, &abs_deviation, &abs_least, &abs_most),
            8)
      << csv;
  EXPECT_EQ(abs_most, std::max(-least, most));
  EXPECT_GE(abs_least, 0.0);
  EXPECT_NEAR(mean, 0.027, 0.01) << "docs/experiments.md";
  EXPECT_NEAR(abs_mean, 0.046, 0.01);
  EXPECT_NEAR(abs_most, 0.136, 0.03);

  const std::string report = read_file(folder.path("out/report.md"));
  for (const char* text : {"Plant `thesis`", "| yes |", "statistics.csv"})
    EXPECT_NE(report.find(text), std::string::npos) << text << "\n" << report;
  EXPECT_NE(report.find(std::to_string(mean).substr(0, 5)), std::string::npos) << "the mean of " << csv << report;

  // Time on the path begins with the first error, one second after the start; ten errors make one second of it.
  double seconds = 0.0, errors = 0.0;
  ASSERT_EQ(std::sscanf(report.c_str() + report.find("\n| 1 | "), "\n| 1 | %lf | %lf", &seconds, &errors), 2) << report;
  EXPECT_NEAR(seconds, 0.1 * (errors - 1.0), 0.06) << report;

  // Names are not in a track's colour; 5 m of track and a minute of errors are.
  constexpr std::uint32_t kFirst = 0xFF0072B2u;
  for (const char* name : {"trajectories.png", "errors.png"}) {
    const scenes::Picture picture = scenes::read_png(folder.path(std::string("out/") + name));
    EXPECT_GT(picture.count(kFirst), 1000) << name;
    int columns = 0;
    for (int x = 0; x < picture.width; ++x) columns += picture.count(kFirst, x, 0, x + 1, picture.height) > 0 ? 1 : 0;
    EXPECT_GT(columns, picture.width / 2) << name << ": from end to end";
  }
  EXPECT_EQ(run_program({"plot", folder.path("out/trial-1"), "-o", folder.path("pictures")}).code, 0);
}

/// Scenarios are found above the program; a user's plant replaces the experiment's.
TEST(Experiment, NeedsNoFilesAndTakesAPlant) {
  if (!std::string(SF_BINARY_DIR).starts_with(SF_SOURCE_DIR)) GTEST_SKIP() << "built outside of the sources";
  const Folder folder;
  const Outcome outcome =
      run_successfully({"experiment", "lane-edge-p", "--trials", "1", "--plant", "ideal", "-o", folder.path("out")});
  EXPECT_NE(read_file(folder.path("out/report.md")).find("Plant `ideal`, seed 1, "), std::string::npos);
  for (const char* name : {"report.md", "statistics.csv", "trajectories.png"})
    EXPECT_NE(outcome.err.find("wrote " + folder.path("out/") + name + "\n"), std::string::npos) << outcome.err;
}

/// `wrong` is a fraction of the known cells: per cent in the report, a fraction in the file.
TEST(Experiment, TheMappingReportMatchesItsFile) {
  const Folder folder;
  folder.write("small.world",
               "model( size [0.8 0.8 0.5] boundary 1 noblocks 0 )\n"
               "position( name \"a\" size [0.2 0.2 0.1] laser( samples 91 fov 180 range_max 2 ) )\n");
  folder.write("mapping.toml", "world = \"small.world\"\nduration = 2\n[default]\ncontroller = \"avoid\"\n");
  run_successfully({"experiment", "mapping", "--trials", "1", "-o", folder.path("out"), "--files", folder.path()});
  const std::string csv = read_file(folder.path("out/statistics.csv"));
  const std::string report = read_file(folder.path("out/report.md"));
  const std::size_t row = csv.find('\n', csv.find('\n') + 1), end = report.find(" % |\n");
  ASSERT_NE(row, std::string::npos) << csv;
  ASSERT_NE(end, std::string::npos) << report;
  const double wrong = std::stod(csv.substr(csv.rfind(',', row) + 1));
  EXPECT_GT(wrong, 5e-4) << csv;
  EXPECT_NEAR(std::stod(report.substr(report.rfind('|', end) + 1)), 100.0 * wrong, 0.006) << report;
}

TEST(Experiment, AStopLeavesNoPartialTrial) {
  const Folder folder;
  Program program({"experiment", "lane-edge-p", "--trials", "200", "-o", folder.path("out"), "--files",
                   SF_SOURCE_DIR "/experiments"});
  ASSERT_TRUE(until([&] { return std::filesystem::exists(folder.path("out/trial-1/run.mcap")) || !program.running(); }))
      << program.err();
  const Outcome outcome = program.stop();
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_NE(outcome.err.find("interrupted"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path("out/report.md")));
  for (const auto& trial : std::filesystem::directory_iterator(folder.path("out"))) {
    run_successfully({"verify", trial.path().string(), "--sample", "1"});
  }
}

TEST(TestCommand, ReportsPassesAndFailuresWithReasons) {
  const Folder folder;
  const std::string good = folder.write("good.toml", scenario("[expect]\ncontacts = 1000\n"));
  const std::string bad = folder.write("bad.toml", scenario("[expect]\ncontacts = 1000\ndone = true\n"));
  const Outcome pass = run_successfully({"test", good});
  EXPECT_NE(pass.out.find("pass"), std::string::npos);
  EXPECT_EQ(pass.out.find("FAIL"), std::string::npos) << pass.out;
  const Outcome fail = run_program({"test", good, bad, good, "--junit", folder.path("out.xml")});
  EXPECT_EQ(fail.code, 1) << "the second of three failed";
  EXPECT_NE(fail.out.find("FAIL done"), std::string::npos) << fail.out;
  const std::string xml = read_file(folder.path("out.xml"));
  EXPECT_NE(xml.find("<testsuite name=\"bad\" tests=\"2\" failures=\"1\""), std::string::npos) << xml;
}

TEST(TestCommand, BadFilesAreRejectedBeforeAnyRun) {
  const Folder folder;
  const std::string good = folder.write("good.toml", scenario(""));
  const std::string bad = folder.write("bad.toml", scenario("duraton = 3\n"));
  expect_refused({"test", good, bad}, "bad.toml:4: unknown key 'duraton'; did you mean 'duration'?");
  EXPECT_EQ(run_program({"test", folder.path("none.toml")}).code, 2);
}

TEST(TestCommand, ControllersAreCheckedBeforeAnyRun) {
  const Folder folder;
  const std::string good = folder.write("good.toml", scenario("[expect]\ncontacts = 1000\n"));
  const std::string bad = folder.write("bad.toml", scenario("[default]\ncontroller = \"lane-keeping\"\n"));
  expect_refused({"test", good, bad, "--junit", folder.path("out.xml")}, "bad.toml:5: controller 'lane-keeping'");
}

TEST(TestCommand, AnUnwritableFolderIsReportedBeforeAnyRun) {
  const Folder folder;
  const std::string good = folder.write("good.toml", scenario("[expect]\ncontacts = 1000\n"));
  expect_refused({"test", good, "--junit", folder.path("none/out.xml")}, "none/out.xml: cannot be written");
}

TEST(TestCommand, NoExpectationsIsASeparateResult) {
  const Folder folder;
  const Outcome outcome =
      run_successfully({"test", folder.write("idle.toml", scenario("")), "--junit", folder.path("o.xml")});
  EXPECT_EQ(outcome.out.find("pass"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("nothing expected"), std::string::npos) << outcome.out;
  EXPECT_NE(read_file(folder.path("o.xml")).find("skipped=\"1\""), std::string::npos);
}

TEST(RunController, ReceivesSettings) {
  const Words words{"run", our_world("testpath/testpath.world"), "--duration", "1", "--controller", "lane-keeping"};
  run_successfully(with(words, {"--set", "kp=0.7"}));
  expect_refused(with(words, {"--set", "kp=much"}), "--set kp: 'kp'");
  expect_refused(with(words, {"--set", "kq=1"}), "kq");
  expect_refused(with(words, {"--set", "kp"}));
  expect_refused({"run", words[1], "--controller", "unknown"});
}

}  // namespace
}  // namespace sf
