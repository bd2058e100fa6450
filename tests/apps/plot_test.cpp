// `plot` and the plots of `sweep` as used by the author of a paper.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/apps/program.h"

namespace sf {
namespace {

namespace fs = std::filesystem;

/// Eleven robots; the first has a ring of 16 sonars, a bumper and two magnetometer elements.
std::string world_text() {
  std::string text =
      "define magnet model( size [0.025 0.025 0.1] magnetic_moment 10000 )\n"
      "model( name \"room\" size [9 9 1] boundary 1 obstacle_return 1 ) magnet( pose [-1 -2 0 0] )\n"
      "position( name \"one\" pose [-2 -2 0 10] laser( samples 181 fov 180 range_max 3 rate 2 )\n"
      "  bumper( ) sonar( scount 16 range [0.1 4] ";
  for (int i = 0; i < 16; ++i) text += "spose[" + std::to_string(i) + "] [0.1 0 " + std::to_string(90 - 12 * i) + "] ";
  text +=
      ")\n  magnetometer( pose [0.3 0 -0.1 0] size [0.02 0.3 0.1] scount 2 spose[0] [0 0.1 0] spose[1] [0 -0.1 0] ) "
      ")\n";
  for (int i = 2; i <= 11; ++i)
    text += "position( name \"other" + std::to_string(i) + "\" pose [" + std::to_string(i - 6) + " 3 0 270] )\n";
  return text;
}

class PaperFigures : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new Folder;
    run_successfully({"run", folder_->write("w.world", world_text()), "--duration", "3", "--record", folder_->path("r"),
                      "--record-readings"});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  /// Runs `plot` with these arguments and returns one of the figures.
  static std::string figure(const std::string& name, Words words = {}) {
    words.insert(words.begin(), {"plot", folder_->path("r"), "-o", folder_->path("p"), "--format", "svg"});
    run_successfully(words);
    return read_file(folder_->path("p/" + name + ".svg"));
  }
  static std::string refusal(Words words) {
    words.insert(words.begin(), {"plot", folder_->path("r"), "-o", folder_->path("p")});
    const Outcome plotted = run_program(words);
    EXPECT_EQ(plotted.code, 2) << plotted.err;
    return plotted.err;
  }
  static Folder* folder_;
};
Folder* PaperFigures::folder_ = nullptr;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST_F(PaperFigures, ManyElementsAreAHeatMapOrChosenCurves) {
  const std::string map = figure("sonar");
  EXPECT_TRUE(contains(map, "<image ") && contains(map, ">range [m]<") && contains(map, ">bearing (element)<"));
  EXPECT_TRUE(contains(map, ">90° (0)<") && contains(map, ">\u221290° (15)<")) << "bearings, with true minus signs";
  EXPECT_TRUE(contains(map, ">no return (≥ 4 m)<") || !contains(map, "no return"));
  const std::string curves = figure("sonar", {"--curves"});
  EXPECT_FALSE(contains(curves, "<image "));
  EXPECT_TRUE(contains(curves, ">one 15<") && contains(curves, ">and 9 more<")) << "of 16";
  const std::string chosen = figure("sonar", {"--elements", "0,3,7"});
  EXPECT_FALSE(contains(chosen, "<image "));
  for (const char* name : {">one 0<", ">one 3<", ">one 7<"}) EXPECT_TRUE(contains(chosen, name)) << name;
  EXPECT_FALSE(contains(chosen, ">one 1<"));
  EXPECT_TRUE(contains(chosen, "stroke-dasharray")) << "known in grey print";
  EXPECT_FALSE(contains(figure("sonar", {"--elements", "0,3,7", "--line-styles", "solid"}), "stroke-dasharray"));
  EXPECT_TRUE(contains(refusal({"--elements", "500"}),
                       "has no sensor with an element 500; elements are numbered from 0 to 180"));
  EXPECT_TRUE(contains(figure("laser"), ">bearing (element)<")) << "scans, too";
}

TEST_F(PaperFigures, CsvOfAHeatMapHasACurvePerElement) {
  figure("sonar", {"--csv"});
  const std::string csv = read_file(folder_->path("p/sonar.csv"));
  EXPECT_TRUE(contains(csv, "\nrange [m],one 0,") && contains(csv, "\nrange [m],one 15,")) << csv.substr(0, 300);
}

TEST_F(PaperFigures, ADifferenceOfMagnitudesIsSigned) {
  const std::string svg = figure("magnetometer");
  EXPECT_TRUE(contains(svg, ">|B| [G]<") && contains(svg, ">difference of |B| [G]<"));
}

TEST_F(PaperFigures, ElevenRobotsHaveTheRequestedLabels) {
  EXPECT_FALSE(contains(figure("trajectories"), ">other3<"));
  const Outcome plotted = run_program({"plot", folder_->path("r"), "-o", folder_->path("p")});
  EXPECT_TRUE(contains(plotted.err, "11 robots have no label in it; label them with --label NAME,...")) << plotted.err;
  const std::string some = figure("trajectories", {"--label", "one,other3"});
  EXPECT_TRUE(contains(some, ">one<") && contains(some, ">other3<"));
  EXPECT_FALSE(contains(some, ">other4<"));
  const std::string all = figure("trajectories", {"--label", "all"});
  EXPECT_TRUE(contains(all, ">other3<") && contains(all, ">other4<"));
  EXPECT_TRUE(contains(refusal({"--label", "missing"}), "--label: no robot 'missing' is drawn; drawn are one, other2"));
  EXPECT_TRUE(contains(figure("trajectories", {"--robots", "one,other3"}), ">other3<")) << "up to ten are named";
}

TEST_F(PaperFigures, LabelsWithoutRoomAreCounted) {
  const Outcome plotted = run_successfully({"plot", folder_->path("r"), "-o", folder_->path("p"), "--size", "50x30",
                                            "--font-size", "8.3", "--label", "all"});
  EXPECT_TRUE(contains(plotted.err, " labels are left out for lack of space")) << plotted.err;
}

/// A video is a single file, drawn without figures.
TEST_F(PaperFigures, FigureOptionsAreRejectedForVideos) {
  const Words video{"plot", folder_->path("r"), "--video"};
  const auto message = [&](const std::string& file, const Words& more) {
    Words words = video;
    words.push_back(file);
    words.insert(words.end(), more.begin(), more.end());
    const Outcome refused = run_program(words);
    EXPECT_EQ(refused.code, 2) << refused.err;
    return refused.err;
  };
  EXPECT_TRUE(contains(message("x.webm", {"-o", "d"}),
                       "--out: is the folder of figures, but --video writes none; write --video d/x.webm"));
  EXPECT_TRUE(contains(message("x.webm", {"--line-styles", "solid"}),
                       "--line-styles: changes figures, but --video writes none; leave out one of the two"));
  EXPECT_TRUE(contains(message("x", {"-o", "d"}), "videos are WebM files; write x.webm"));
  EXPECT_TRUE(contains(message(".", {}), "expected a file, but '.' is a folder; write ./run.webm"));
  EXPECT_TRUE(contains(message(folder_->path(""), {}), folder_->path("run.webm")));
}

TEST_F(PaperFigures, LegendsListDrawnItems) {
  EXPECT_FALSE(contains(figure("trajectories", {"--extent", "-0.5,-0.5,0.5,0.5"}), ">wall<")) << "none in that area";
  EXPECT_FALSE(contains(figure("occupancy", {"--robots", "one"}), "0.0 %<")) << "no state without a cell";
}

TEST_F(PaperFigures, OccupancyHasTheGreysOfRos) {
  EXPECT_TRUE(contains(figure("occupancy"), "fill=\"#cdcdcd\""));
  EXPECT_TRUE(contains(figure("occupancy", {"--map-colors", "thesis"}), "fill=\"#474b50\""));
}

TEST_F(PaperFigures, FiguresFitAColumnAndItsLetters) {
  EXPECT_TRUE(contains(figure("bumper", {"--size", "50", "--font-size", "8"}).substr(0, 300), "width=\"49."));
  EXPECT_TRUE(contains(figure("bumper", {"--size", "88x40", "--no-title"}).substr(0, 300), "height=\"39."));
  EXPECT_TRUE(contains(refusal({"--size", "50", "--font-size", "12"}), "12 points require a width of at least 72 mm"));
  EXPECT_TRUE(contains(refusal({"--font-size", "12", "--size", "50"}), "allows at most 8.33 points")) << "in any order";
  EXPECT_TRUE(contains(refusal({"--size", "49"}), "W from 50 to 1000"));
  EXPECT_TRUE(contains(refusal({"--size", "50x29"}), "H from 30 to 1000"));
  EXPECT_TRUE(contains(refusal({"--font-size", "4"}), "--font-size"));
}

TEST_F(PaperFigures, IntegersAreSteps) {
  const std::string svg = figure("bumper");
  EXPECT_TRUE(contains(svg, ">0<") && contains(svg, ">1<")) << "integer ticks";
}

/// Decades on both axes, a curve per axis of the sensor, and the stated deviation.
TEST(AllanDeviation, IsDrawnBesideTheStatedOne) {
  const Folder folder;
  const std::string world =
      folder.write("w.world", "position( name \"a\" ctrl \"none\" imu( gyro_noise 1 accel_noise 0.01 ) )");
  run_successfully({"run", world, "--duration", "8", "--record", folder.path("r"), "--record-readings"});
  run_successfully({"plot", folder.path("r"), "--allan", "--csv", "--format", "svg"});
  const std::string figure = read_file(folder.path("r/allan.svg"));
  for (const char* text : {">stated<", ">x<", ">10⁻²<", ">1<", ">time of the means [s]<"})
    EXPECT_TRUE(contains(figure, text)) << text;
  const std::string table = read_file(folder.path("r/allan.csv"));
  EXPECT_TRUE(contains(table, "x,0.01,") && contains(table, "stated,0.01,")) << table;
  EXPECT_FALSE(fs::exists(folder.path("r/trajectories.svg"))) << "alone";
}

/// The log of a device: columns of numbers, at the interval of its times.
TEST(AllanDeviation, IsDrawnOfTables) {
  const Folder folder;
  std::string rows = "device,time_s,rate_rad_s\n";
  for (int k = 0; k < 16; ++k) rows += "a," + std::to_string(5 + k) + "," + std::to_string(k % 2) + "\n";
  run_successfully(
      {"plot", folder.write("log.csv", rows), "--allan", "--csv", "--format", "svg", "-o", folder.path("o")});
  const std::string table = read_file(folder.path("o/allan.csv"));
  EXPECT_TRUE(contains(table, "measured,1,0.707106")) << "of 0 and 1 in turn: " << table;
  EXPECT_TRUE(contains(table, "measured,2,0\n")) << "means of two are equal: " << table;
  const auto refused = [&](const std::string& text) {
    return run_program({"plot", folder.write("bad.csv", text), "--allan"}).err;
  };
  expect_refused({"plot", folder.path("log.csv")}, "log.csv: is a table; expected --allan, or a recording");
  EXPECT_TRUE(contains(refused("a,b\n1,2\n"), "bad.csv:1: --allan: the columns are 'a,b'; expected one named time_s"));
  EXPECT_TRUE(contains(refused("time_s,x\n0,1\n1,one\n"), "bad.csv:3: --allan: 'one' in column x"));
  EXPECT_TRUE(contains(refused("time_s,x\n0,1\n1,1\n"), "at least four rows"));
  EXPECT_TRUE(contains(refused("time_s,x\n0,1\n1,1\n2,1\n9,1\n"), "without gaps"));
}

TEST(AllanDeviation, StatesWhichColumnsItLeavesOut) {
  const Folder folder;
  std::string rows = "time_s";
  for (int i = 0; i < 17; ++i) rows += ",c" + std::to_string(i);
  rows += ",name\n";
  for (int k = 0; k < 4; ++k) {
    rows += std::to_string(k);
    for (int i = 0; i < 17; ++i) rows += "," + std::to_string(k % 2);
    rows += ",a\n";
  }
  const std::string said =
      run_successfully({"plot", folder.write("log.csv", rows), "--allan", "-o", folder.path("o"), "--format", "svg"})
          .err;
  EXPECT_TRUE(contains(said, "--allan leaves out, beyond 16 panels: c16\n")) << said;
  EXPECT_TRUE(contains(said, "since they do not begin with a number: name\n")) << said;
}

TEST_F(PaperFigures, AllanDeviationsNeedImusOrGyros) {
  EXPECT_TRUE(contains(refusal({"--allan"}), "there are no readings of an imu or a gyro"));
}

TEST_F(PaperFigures, SweepOptionsAreRejected) {
  EXPECT_TRUE(contains(refusal({"--over", "kp"}), "--over and --x-axis apply to the folder of a sweep"));
}

/// Names may contain commas; all options with several names use the same rule.
TEST(NamesWithCommas, AreAcceptedByEveryOption) {
  const Folder folder;
  const std::string world = folder.write("w.world",
                                         "position( name \"a,b\" pose [0 0 0 0] gps( ) )\n"
                                         "position( name \"a\" pose [1 0 0 0] gps( ) )\n"
                                         "position( name \"c, d\" pose [2 0 0 0] gps( ) )\n");
  const std::string record = folder.path("r"), out = folder.path("p");
  ASSERT_EQ(run_program({"run", world, "--duration", "1", "--record", record}).code, 0);
  const auto svg = [&](const Words& more) {
    run_successfully(with({"plot", record, "-o", out, "--format", "svg"}, more));
    return read_file(out + "/trajectories.svg");
  };
  const auto shows = [&](const std::string& text, const char* name) {
    return contains(text, ">" + std::string(name) + "<");
  };
  const std::string first = svg({"--robots", "a,b"});
  EXPECT_TRUE(shows(first, "a,b") && !shows(first, "a") && !shows(first, "c, d"));
  const std::string two = svg({"--robots", "a,c, d"});
  EXPECT_TRUE(shows(two, "a") && shows(two, "c, d") && !shows(two, "a,b"));
  const std::string repeated = svg({"--robots", "a", "--robots", "a,b"});
  EXPECT_TRUE(shows(repeated, "a") && shows(repeated, "a,b") && !shows(repeated, "c, d"));
  svg({"--label", "a,b,c, d"});
  const Outcome unknown = run_program({"plot", record, "-o", out, "--label", "a,x"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_TRUE(contains(unknown.err, "no robot 'x' is drawn")) << unknown.err;
  run_successfully({"view", record, "--frames", folder.path("f"), "--video-size", "64x64", "--video-follow", "a,b,c, d",
                    "--robots", "c, d"});
  const Outcome empty = run_program({"plot", record, "-o", out, "--robots", "a,,c, d"});
  EXPECT_EQ(empty.code, 2);
  EXPECT_TRUE(contains(empty.err, "has no robot ''")) << empty.err;
}

TEST(SweepPlotsCommand, AreDrawnBySweepAndByPlot) {
  const Folder folder;
  folder.write("small.toml", "world = \"" + our_world("rooms.world") + "\"\nduration = 1\n[expect]\ncontacts = 1000\n");
  const std::string file = folder.write("sweep.toml",
                                        "scenario = \"small.toml\"\nseeds = 2\n[grid]\nrobots = [1, 2, 3]\n"
                                        "link.delay = [0, 0.5]\n");
  const Outcome ran = run_successfully({"sweep", file, "-o", folder.path("out")});
  EXPECT_TRUE(contains(ran.err, " plots in ")) << ran.err;
  for (const char* name : {"distance.png", "distance_multiples.png", "met.png", "contacts.png"})
    EXPECT_TRUE(fs::exists(folder.path("out/plots/" + std::string(name)))) << name;
  EXPECT_FALSE(fs::exists(folder.path("out/plots/mean_error.png"))) << "no job has one";
  const std::string before = read_file(folder.path("out/plots/distance.png"));
  fs::remove_all(folder.path("out/plots"));
  ASSERT_EQ(run_program({"plot", folder.path("out")}, no_device()).code, 0) << "needs no device";
  EXPECT_EQ(read_file(folder.path("out/plots/distance.png")), before);

  run_successfully({"plot", folder.path("out"), "-o", folder.path("figures"), "--format", "svg", "--size", "50",
                    "--font-size", "8", "--over", "link.delay"},
                   no_device());
  const std::string svg = read_file(folder.path("figures/distance.svg"));
  EXPECT_TRUE(contains(svg, ">link.delay [s]<") && contains(svg, ">distance [m]<") && contains(svg, ">robots = 2<"));

  ASSERT_EQ(run_program({"sweep", file, "-o", folder.path("bare"), "--no-plots"}).code, 0);
  EXPECT_FALSE(fs::exists(folder.path("bare/plots")));
  folder.write("bare/plots", "");  // a file blocks the folder
  const Outcome blocked = run_successfully({"sweep", file, "-o", folder.path("bare")});
  EXPECT_TRUE(contains(blocked.err, "no plots (`plot ")) << blocked.err;
  for (const Words& words : {Words{"--over", "kp"}, {"--robots", "one"}, {"--elements", "1"}, {"--label", "one"}}) {
    const Outcome refused = run_program(with({"plot", folder.path("out")}, words), no_device());
    EXPECT_EQ(refused.code, 2) << words[0];
    EXPECT_EQ(count_lines(refused.err), 1u) << refused.err;
  }
}

}  // namespace
}  // namespace sf
