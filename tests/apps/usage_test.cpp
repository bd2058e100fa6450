// Usage errors and wrong files: exit code 2 and one line with the expected input. No device: 3.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "base/hash.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/golden.h"
#include "tests/refusal.h"

namespace sf {

namespace {

const Words kSubcommands{"devices", "check",  "draw",     "sense",     "run",  "serve",    "robot",   "start",
                         "plot",    "listen", "dump",     "field",     "map",  "selftest", "explain", "experiment",
                         "test",    "verify", "tradeoff", "export",    "view", "merge",    "sweep",   "help",
                         "light",   "object", "vps",      "calibrate", "v2x",  "lane",     "derive"};

struct Wrong {
  Words arguments;
  std::string message;  ///< text in the line
};

}  // namespace

TEST(Usage, EverySubcommandHasHelp) {
  const Outcome all = run_successfully({"--help"});
  for (const std::string& name : kSubcommands) {
    EXPECT_NE(all.out.find("\n  " + name + " "), std::string::npos) << name;
    const Outcome one = run_successfully({name, "--help"});
    EXPECT_NE(one.out.find("--help"), std::string::npos) << name;
    EXPECT_NE(one.out.find("\nExamples:\n  sensorfarm " + name), std::string::npos) << name;
    EXPECT_EQ(one.err, "") << name;
    EXPECT_EQ(run_program({"help", name}).out, one.out) << name;
  }
  EXPECT_EQ(run_program({"help"}).out, all.out);
  for (const std::string word : {"--server", "--port", "--loss", "--delay", "--jitter"})
    EXPECT_EQ(all.out.find(word), std::string::npos) << word << " belongs to subcommands";
}

TEST(Usage, ExamplesUseExistingFiles) {
  const std::filesystem::path source = SF_SOURCE_DIR;
  std::size_t found = 0;
  for (const std::string& name : kSubcommands) {
    std::istringstream words(run_program({name, "--help"}).out);
    for (std::string word; words >> word;) {
      if (word.rfind("worlds/", 0) != 0 && word.rfind("experiments/", 0) != 0) continue;
      EXPECT_TRUE(std::filesystem::exists(source / word)) << name << ": " << word;
      ++found;
    }
  }
  EXPECT_GT(found, 10u);
}

TEST(Usage, PortsAreAGroupAtTheEndOfTheHelp) {
  const std::string help = run_program({"run", "--help-all"}).out;
  const std::size_t group = help.find("\nPorts of sensor packets");
  ASSERT_NE(group, std::string::npos) << help;
  EXPECT_LT(help.find("--duration"), group);
  EXPECT_GT(help.find("--laser-port"), group);
  EXPECT_GT(help.find("--ports-per-robot"), group);
}

/// For commands with many options: ten, after the examples, and how to list the others.
TEST(Usage, HelpStartsWithExamplesAndCommonOptions) {
  for (const std::string name : {"run", "serve", "robot", "listen", "vps", "tradeoff"}) {
    const std::string help = run_program({name, "--help"}).out;
    std::size_t options = 0;
    for (std::size_t at = help.find("\n  -"); at != std::string::npos; at = help.find("\n  -", at + 1)) ++options;
    EXPECT_LE(options, 10u) << name;
    EXPECT_GE(options, 9u) << name;
    EXPECT_LT(help.find("Examples:"), help.find("\nOptions:")) << name;
    EXPECT_NE(help.find(" more options: sensorfarm " + name + " --help-all\n"), std::string::npos) << help;
  }
}

/// The most common commands come first.
TEST(Usage, HelpGroupsTheCommands) {
  const std::string help = run_program({"help"}).out;
  std::size_t before = 0;
  for (const char* text :
       {"\nCommon:\n  run ", "\nRun:\n", "\nInspect:\n", "\nTestbed:\n", "\nAnalyse:\n", "\nCheck:\n"}) {
    const std::size_t at = help.find(text);
    ASSERT_NE(at, std::string::npos) << text;
    EXPECT_GT(at, before) << text;
    before = at;
  }
}

TEST(Usage, MistakesAreReported) {
  const std::string world = our_world("rooms.world");
  for (const auto& [arguments, message] : std::vector<Wrong>{
           {{"run", "--hlep"}, "'--hlep' was not expected; did you mean '--help'?"},
           {{"run", "--durration=3"}, "'--durration' was not expected; did you mean '--duration'?"},
           {{"run", world, "--duration", "1m"}, "--duration: expected seconds from 0 to 1e+09, got '1m'"},
           {{"run", world, "--controller", "wandr"}, "did you mean 'wander'?"},
           {{"help", "rnu"}, "did you mean 'run'?"},
           {{"export", world}, "expected a recording, such as the folder that `run --record` writes, got"},
           {{"plot", "m.yaml"}, "expected a recording"},
           {{"run", world, "--set", "sped=0.2"}, "has no setting 'sped'; did you mean 'speed'?"}}) {
    expect_refused(arguments, message);
  }
}

/// The options of each command, in order, and a hash of its complete help.
TEST(Usage, HelpIsAsRecorded) {
  std::string record;
  for (const std::string& name : kSubcommands) {
    const std::string help = run_program({name, "--help-all"}).out;
    std::string options;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("  -")) options += line.substr(1, line.find_first_of(" =", 2) - 1);
    record += fmt::format("{}:{}; whole x{:016x}\n", name, options, base::hash_bytes(help.data(), help.size()));
    if (const std::string shown = golden::shown_file("help_" + name + ".txt"); !shown.empty())
      std::ofstream(shown) << help;
  }
  golden::expect(record, "apps", "help", 0.0);
}

/// An option that modifies another one has no effect without it.
TEST(Usage, OptionsThatNeedAnotherAreRejectedWithoutIt) {
  const Folder folder;
  const std::string world = our_world("rooms.world"), out = folder.path("out");
  const std::string sweep = SF_SOURCE_DIR "/experiments/sweeps/lane-edge.toml";
  for (const auto& [arguments, message] : std::vector<Wrong>{
           {{"run", world, "--of", "roomba0"}, "--of requires --robots"},
           {{"run", world, "--record-readings"}, "--record-readings requires --record"},
           {{"run", world, "--checkpoint", "1"}, "--checkpoint requires --record"},
           {{"run", world, "--resume"}, "--resume requires --record"},
           {{"run", world, "--balance", "1"}, "--balance requires --tiles"},
           {{"run", world, "--max-error", "5mm"}, "--max-error requires"},
           {{"run", world, "--min-rate", "1e6"}, "--min-rate requires"},
           {{"serve", world, "--wait-for", "1"}, "--wait-for requires --lockstep"},
           {{"serve", world, "--lockstep-timeout", "1"}, "--lockstep-timeout requires --lockstep"},
           {{"robot", world, "--name", "roomba1", "--clock", "estimated"}, "--clock requires --cameras"},
           {{"robot", world, "--name", "roomba1", "--baud", "57600"}, "--baud requires --serial"},
           {{"sweep", sweep, "-o", out, "--tasks", "3"}, "--tasks requires --slurm"},
           {{"sweep", sweep, "-o", out, "--sbatch=--time=1"}, "--sbatch requires --slurm"},
           {{"view", out, "--time", "1"}, "--time requires --3d"},
           {{"view", out, "--screenshot", "a.png"}, "--screenshot requires --3d"},
           {{"view", out, "--every", "1"}, "--every requires --3d"},
           {{"view", out, "--height", "1"}, "--height requires --3d"},
           {{"experiment", "mapping"}, "requires --out"},
           {{"run", world, "--topics", "nav2"}, "--topics requires --record, --ros2 or --view"},
           {{"run", world, "--odometry", "truth"}, "--odometry requires --record, --ros2 or --view"},
           {{"run", world, "--external", "mapper"}, "--external requires --record, --ros2 or --view"},
           {{"run", world, "--player", "0", "--topics", "nav2"}, "--topics requires"},
           {{"run", world, "--too-near", "min"}, "--too-near requires --record, --ros2 or --view"},
           {{"serve", world, "--topics", "nav2"}, "--topics requires --record, --ros2 or --view"},
           {{"serve", world, "--too-near", "min"}, "--too-near requires --record, --ros2 or --view"},
           {{"run", world, "--record", out, "--odometry", "exact"}, "--odometry: exact requires --record-readings"},
           {{"run", world, "--wire", "thesis"}, "--wire requires --send"},
           {{"run", world, "--laser-port", "5000"}, "--laser-port requires --send"},
           {{"run", world, "--ports-per-robot", "9"}, "--ports-per-robot requires --send"},
           {{"run", world, "--video", "a.webm", "--video-around", "2"}, "requires --video-follow"},
           {{"robot", world, "--name", "roomba1", "--tag", "3"}, "--tag requires --cameras or --truth"},
           {{"light", world, "--farm", "127.0.0.1:9", "--port", "9"}, "--port requires --send"},
           {{"light", world, "--farm", "127.0.0.1:9", "--latitude", "9"}, "--latitude requires --send"},
           {{"light", world, "--send", "127.0.0.1", "--peers", "p"}, "--peers requires --farm"},
           {{"map", "--listen", "52000", "--size", "88"}, "--size requires --out"},
           {{"map", "--listen", "52000", "--map-colors", "ros"}, "--map-colors requires --out or --view"},
           {{"map", "--listen", "52000", "--interval", "2"}, "--interval requires --out"},
           {{"tradeoff", world, "--dpi", "300"}, "--dpi requires --out"},
           {{"tradeoff", world, "--format", "pdf"}, "--format requires --out"},
           {{"export", out, "-o", out, "--every", "1"}, "--every requires --vtk"},
           {{"export", out, "-o", out, "--height", "1"}, "--height requires --vtk"},
           {{"vps", our_world("testbed.toml"), "--seed", "2"}, "--seed requires --rendered or --robots"},
           {{"calibrate", out, "--marker", "0.03"}, "--marker requires --charuco"},
           {{"calibrate", out, "--charuco", "aruco_4x4_50"}, "--charuco requires --marker"}})
    expect_refused(arguments, message);
}

/// Options that contradict each other, in any order.
TEST(Usage, ContradictoryOptionsAreRejected) {
  const Folder folder;
  const std::string world = our_world("rooms.world"), out = folder.path("out");
  const Words sensor{"run", world, "--record", out, "--record-readings", "--topics", "sensor"};
  for (const Words& more : std::vector<Words>{{"--odometry", "encoders"},
                                              {"--odometry", "exact"},
                                              {"--external", "localizer"},
                                              {"--external", "filter"},
                                              {"--external", "mapper,filter"}}) {
    Words words = with(sensor, more);
    expect_refused(words, "--topics: sensor has no frame odom and uses true odometry");
    words[0] = "serve";
    words.erase(words.begin() + 4);  // --record-readings
    expect_refused(words, "--topics: sensor has no frame odom and uses true odometry");
  }
  for (const Words& more : std::vector<Words>{{"--odometry", "truth"}, {"--external", "mapper"}}) {
    const Words words = with(with(sensor, more), {"--duration", "0.1"});
    EXPECT_EQ(run_program(words).code, 0) << more[1] << " says the same";
  }
  for (const auto& [arguments, message] : std::vector<Wrong>{
           {{"serve", world, "--filter", "--clock", "trusted", "--link-delay", "0.1"},
            "--link-delay: applies to estimated clocks"},
           {{"serve", world, "--clock", "arrival"}, "arrival needs --filter"},
           {{"serve", world, "--raw", "--filter"}, "excludes"},
           {{"serve", world, "--raw", "--clock", "trusted"}, "excludes"},
           {{"serve", world, "--raw", "--link-delay", "0.1"}, "excludes"},
           {{"serve", world, "--raw", "--hypotheses", "1"}, "excludes"},
           {{"serve", world, "--lockstep", "--raw"}, "--raw: cannot be used with --lockstep"},
           {{"serve", world, "--lockstep", "--stale", "hide"}, "--stale: cannot be used with --lockstep"},
           {{"serve", world, "--lockstep", "--spat", "9010"}, "--spat: cannot be used with --lockstep"},
           {{"serve", world, "--lockstep", "--stale-lights", "plan"}, "--stale-lights: cannot be used with --lockstep"},
           {{"calibrate", out, "--survey", "lab.toml", "--rows", "6"}, "--rows: describes a chessboard"},
           {{"run", world, "--robots", "2", "--of", "roomba1", "--robot-from", "a.inc:b"}, "excludes"}})
    expect_refused(arguments, message);
}

/// Taken names are also printed for recordings; those of sensors only if readings are recorded.
TEST(Usage, TakenTopicNamesArePrintedForRecordings) {
  const Folder folder;
  const std::string world =
      folder.write("w.world",
                   "position( name \"map\" size [0.3 0.3 0.1] laser( samples 3 ) )\n"
                   "position( name \"a b\" pose [2 0 0 0] size [0.3 0.3 0.1] laser( samples 3 ) )\n"
                   "position( name \"a-b\" pose [4 0 0 0] size [0.3 0.3 0.1] laser( samples 3 ) )\n");
  const std::string taken = "sensorfarm: topics: robot 'map' is /map_2, since /map is taken\n";
  const Outcome run = run_program({"run", world, "--duration", "0.2", "--record", folder.path("r")});
  EXPECT_NE(run.err.find(taken), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("topics: robot 'a-b' is /a_b_2"), std::string::npos) << run.err;
  EXPECT_EQ(run.err.find("topics"), run.err.rfind("topics: robot 'map'")) << "once: " << run.err;
  const Outcome serve = run_program({"serve", world, "--port", "0", "--duration", "0.2", "--record", folder.path("s")});
  EXPECT_NE(serve.err.find(taken), std::string::npos) << serve.err;
  const Outcome lockstep =
      run_program({"serve", world, "--lockstep", "--port", "0", "--duration", "0.2", "--record", folder.path("l")});
  EXPECT_NE(lockstep.err.find(taken), std::string::npos) << lockstep.err;
  const Outcome none = run_program({"run", world, "--duration", "0.2"});
  EXPECT_EQ(none.err.find("topics"), std::string::npos) << none.err;
}

TEST(Usage, RunsWithoutEffectPrintANotice) {
  const std::string world = our_world("rooms.world");
  for (const char* duration : {"0", "0.01"}) {
    const Outcome outcome = run_successfully({"run", world, "--duration", duration});
    expect_in(std::string("--duration ") + duration + " simulates nothing, since a tick takes 0.1 s", outcome.err);
  }
  const Outcome tick = run_program({"run", world, "--duration", "0.1", "--tiles"});
  EXPECT_EQ(tick.err.find("simulates nothing"), std::string::npos) << tick.err;
  EXPECT_NE(tick.err.find("--tiles has no effect in one process"), std::string::npos) << tick.err;
}

/// TOML files of other commands.
TEST(Usage, FilesOfOtherCommandsAreRecognized) {
  const std::string source = SF_SOURCE_DIR;
  const std::string sweep = source + "/experiments/sweeps/lane-edge.toml",
                    scenario = source + "/experiments/mapping.toml";
  const std::string testbed = our_world("testbed.toml"), plan = our_world("simville/lights.toml");
  const Folder folder;
  for (const char* command : {"run", "test"}) {
    for (const auto& [file, message] :
         {std::pair{sweep, "this file is a sweep, for `sensorfarm sweep`; expected a scenario"},
          {testbed, "this file is a testbed, for `sensorfarm vps`"},
          {plan, "this file is a plan of traffic lights, for `sensorfarm light`"},
          {our_world("simville/simville.toml"), "this file is of a road network"}}) {
      const Outcome outcome = run_program({command, file});
      EXPECT_NE(outcome.code, 0);
      EXPECT_NE((outcome.err + outcome.out).find(message), std::string::npos) << outcome.err << outcome.out;
    }
  }
  expect_refused({"sweep", scenario, "-o", folder.path("o")}, "this file is a scenario, for `sensorfarm run`");
  expect_refused({"vps", scenario}, "this file is a scenario");
  const std::string minutes =
      folder.write("m.toml", "world = \"" + our_world("rooms.world") + "\"\nduration = \"5 min\"\n");
  expect_refused({"run", minutes}, "m.toml:2: 'duration' expects a number from 0 to 1e+09, in seconds; got \"5 min\"");
}

TEST(Usage, VersionIsPrinted) {
  const Outcome outcome = run_successfully({"--version"});
  EXPECT_EQ(outcome.out.rfind("sensorfarm ", 0), 0u);
}

TEST(Usage, WrongArgumentsAreRejectedInOneLine) {
  const std::string world = our_world("rooms.world");
  const Folder folder;
  for (const auto& [arguments, message] : std::vector<Wrong>{
           {{}, "expected a subcommand: devices, check"},  // no arguments
           {{"frob"}, "'frob' is not a subcommand"},       // unknown subcommand
           {{"runn"}, "did you mean 'run'?"},              // one typo
           {{"help", "frob"}, "expected devices, check"},  // the same for help
           {{"--loss", "1", "run", world}, "'--loss'"},    // an option of `robot`
           {{"run"}, "world is required"},                 // no world
           {{"draw", world}, "--out is required"},         // no picture
           {{"plot"}, "recording is required"},            // no recording
           {{"--json", "check", world}, "options must follow the subcommand"},
           {{"check", world, "another"}, "'another' was not expected"},    // two worlds
           {{"run", world, "--duration"}, "--duration requires a value"},  // cut off
           {{"run", world, "--duration", "nan"}, "got 'nan'"},             // would never end
           {{"run", world, "--duration", "inf"}, "got 'inf'"},             // would never end
           {{"run", world, "--duration", "5s"}, "got '5s'"},               // a unit
           {{"run", world, "--robots", "2.5"}, "got '2.5'"},               // not an integer
           {{"run", world, "--send", ""}, "expected a host"},              // an unset variable in a script
           {{"run", world, "--record", ""}, "expected a folder"},          // the same
           {{"test", "x.toml", "--junit", ""}, "expected a file"},         // the same
           {{"run", world, "--wire", "telegraph"}, "expected farm or thesis"},
           {{"sense", world, "--no-return", "0"}, "expected max or inf"},
           {{"sense", world, "--pose", "1,2"}, "expected X,Y,YAW_DEG"},                     // no heading
           {{"sense", world, "--pose", "1,2,3,4"}, "expected X,Y,YAW_DEG"},                 // one value too many
           {{"sense", world, "--pose", "1,2,nan"}, "expected X,Y,YAW_DEG"},                 // not a number
           {{"sense", world, "--sensor", "1"}, "roomba1 has no sensor 1; it has laser 0"},  // beyond the last
           {{"sense", world, "--sensor", "65535"}, "roomba1 has no sensor 65535"},          // the largest valid index
           {{"sense", world, "--robot", "tag3"}, "tag3 has no sensor"},      // exists, but has no sensors
           {{"sense", world, "--type", "sonic"}, "--type: expected laser"},  // another program's word
           {{"sense", world, "--robot", "bob"}, "no robot 'bob'; robots with sensors: roomba1, roomba2"},
           {{"serve", world, "--radio", "nan"}, "from 0 to 1e+09"},  // NaN would pass comparisons
           {{"serve", world, "--radio", "inf"}, "from 0 to 1e+09"},  // its square overflows
           {{"serve", world, "--bind", "192.0.2.1"}, "192.0.2.1"},   // not an address of this machine
           {{"run", world, "--send", "no.such.host.invalid"}, "no.such.host.invalid"},
           {{"draw", world, "-o", folder.path("none/x.png")}, "none/x.png"},
           {{"draw", world, "-o", folder.path()}, "picture"},  // a folder
           {{"run", world, "--duration", "0.1", "--record", "/proc/none"}, "/proc/none"},
           {{"plot", folder.path()}, "no such recording"}})  // nothing was recorded there
    expect_refused(arguments, message);
}

/// A name with an unsupported format is refused before any work is done.
TEST(Usage, UnknownPictureFormatsAreRejected) {
  const Folder folder;
  const std::string world = our_world("six_magnets.world"), network = our_world("simville/simville.rndf");
  for (const std::string suffix : {".jpg", ".eps", ".svgz"}) {
    const std::string file = folder.path("x" + suffix);
    for (const Words& words : std::vector<Words>{{"draw", world, "-o", file},
                                                 {"draw", network, "-o", file},
                                                 {"field", world, "--height", "0.1", "-o", file},
                                                 {"map", "--listen", "52000", "-o", file}}) {
      expect_refused(words, "ends in " + suffix + "; write " + folder.path("x.png"));
      EXPECT_FALSE(std::filesystem::exists(file));
    }
  }
}

TEST(Usage, TheSuffixDeterminesThePictureFormat) {
  const Folder folder;
  const std::string world = our_world("six_magnets.world");
  std::filesystem::create_directories(folder.path("v1.2"));
  for (const auto& [name, begin] : {std::pair{"x.PNG", "\x89PNG"},
                                    {"plain", "\x89PNG"},
                                    {"v1.2/x.png", "\x89PNG"},
                                    {"x.svg", "<?xml"},
                                    {"x.PDF", "%PDF-"}}) {
    EXPECT_EQ(run_program({"draw", world, "-o", folder.path(name)}).code, 0) << name;
    EXPECT_TRUE(read_file(folder.path(name)).starts_with(begin)) << name;
  }
}

TEST(Usage, PictureSizesHaveLimits) {
  const Folder folder;
  const std::string world = our_world("six_magnets.world"), file = folder.path("x.png");
  for (const char* size : {"49.9", "1001", "85x29.9", "85x1001", "85x", "x60", "85,60", "wide", "nan", "85x60x70", ""})
    expect_refused({"draw", world, "-o", file, "--size", size}, "such as 88 or 170x120");
  for (const char* dpi : {"49", "1201", "nan"})
    expect_refused({"draw", world, "-o", file, "--dpi", dpi}, "from 50 to 1200");
  expect_refused({"draw", world, "-o", file, "--extent", "1,1,0,2"}, "expected XMIN,YMIN,XMAX,YMAX");  // reversed
  expect_refused({"draw", world, "-o", file, "--size", "1000", "--dpi", "1200"}, "fewer dots per inch");
  EXPECT_FALSE(std::filesystem::exists(file));
  for (const char* size : {"50", "1000x30"})  // the smallest, and the widest with the smallest height
    EXPECT_EQ(run_program({"draw", world, "-o", file, "--size", size, "--dpi", "50"}).code, 0) << size;
}

TEST(Usage, EveryCommandThatReadsAWorldRejectsWrongFiles) {
  const Folder folder;
  const std::string broken = folder.write("broken.world", "model\n(\n  size [1 1\n  color \"red\"\n)\n");
  for (const Words& command : std::vector<Words>{{"check"},
                                                 {"sense"},
                                                 {"run"},
                                                 {"serve"},
                                                 {"robot", "--name", "roomba1"},
                                                 {"listen"},
                                                 {"draw", "-o", folder.path("x.png")}}) {
    Words words = command;
    words.insert(words.begin() + 1, folder.path("none.world"));
    expect_refused(words, "none.world: no such file");
    words[1] = folder.path();
    expect_refused(words, "not a file");
    words[1] = broken;
    expect_refused(words, "broken.world:4: expected");
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path("x.png")));
}

TEST(Usage, UnreadablePicturesAreReportedWithTheirLine) {
  const Folder folder;
  folder.write("notes.png", "not a picture");
  const std::string world = folder.write("w.world", "model( size [1 1 1]\nbitmap \"notes.png\" )\n");
  expect_refused({"check", world}, "w.world:2: ");
  expect_refused({"check", world}, "notes.png");
}

TEST(Usage, UnwritableOutputIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "the machine has no /dev/full";
  const Outcome outcome = Program({"check", our_world("rooms.world")}, {}, "/dev/full").wait();
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("standard output"), std::string::npos);
}

/// Commands that compute readings.
std::vector<Words> sensing_commands() {
  const std::string world = our_world("rooms.world");
  return {{"sense", world},
          {"sense", world, "--json"},
          {"run", world, "--duration", "0.1"},
          {"run", world, "--duration", "0.1", "--json"},
          {"serve", world, "--port", "0", "--duration", "0.1"}};
}

Environment with(Environment environment, const Environment& more) {
  environment.insert(environment.end(), more.begin(), more.end());
  return environment;
}

TEST(NoDevice, ARequiredDeviceExitsWithThreeAndOneLine) {
  struct Ask {
    Words words;
    Environment environment;
  };
  const Ask asks[] = {{{"--require-vulkan"}, {}},
                      {{"--device", "0"}, {}},
                      {{"--device", "llvmpipe"}, {}},
                      {{"--caster", "vulkan"}, {}},
                      {{}, {{"SENSORFARM_REQUIRE_VULKAN", "1"}}},
                      {{}, {{"SENSORFARM_DEVICE", "0"}}},
                      {{}, {{"SENSORFARM_CASTER", "vulkan"}}}};
  std::vector<Words> commands = sensing_commands();
  commands.push_back({"devices"});
  for (std::size_t i = 0; i < std::size(asks); ++i)
    for (Words words : commands) {
      if (i > 0 && words[0] == "serve") continue;
      words.insert(words.end(), asks[i].words.begin(), asks[i].words.end());
      const Outcome outcome = run_program(words, with(no_device(), asks[i].environment));
      EXPECT_EQ(outcome.code, 3) << words[0] << ", way " << i;
      EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
      EXPECT_NE(outcome.err.find("no Vulkan device"), std::string::npos) << outcome.err;
      // Neither an empty scan nor an empty summary.
      if (words[0] != "devices") {
        EXPECT_EQ(outcome.out, "") << words[0];
      }
    }
}

TEST(NoDevice, OtherwiseTheHostComputesAndANoticeIsPrinted) {
  std::vector<Words> commands = sensing_commands();
  commands.push_back({"devices"});
  for (const Words& words : commands) {
    const Outcome outcome = run_successfully(words, with(no_device(), {{"SENSORFARM_CASTER", "auto"}}));
    EXPECT_NE(outcome.err.find("no Vulkan device"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("computing on the host"), std::string::npos) << outcome.err;
    if (words[0] == "sense" && words.back() == "--json") {
      EXPECT_EQ(outcome.out, run_program(words).out) << "the bytes of a device";
    }
  }
  const Outcome named = run_program({"sense", our_world("rooms.world"), "--device", "host", "--json"},
                                    with(no_device(), {{"SENSORFARM_CASTER", "auto"}}));
  EXPECT_EQ(named.err.find("Vulkan"), std::string::npos) << "the host that is named needs no line: " << named.err;
}

TEST(NoDevice, TheHostContradictsTheRequirement) {
  for (const Words& more : std::vector<Words>{{"--require-vulkan"}, {"--caster", "vulkan"}}) {
    const Outcome outcome =
        run_program(with({"run", our_world("rooms.world"), "--duration", "0.1", "--device", "host"}, more));
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_NE(outcome.err.find("but the host is selected"), std::string::npos) << outcome.err;
  }
}

/// As in script/hashes: every sensor type with a kernel, 32-bit ranges, and markings as a raster.
TEST(NoDevice, TheHostHasTheHashesOfTheKernels) {
  const Folder folder;
  const std::string raster = folder.path("raster.world");
  std::ofstream(raster) << "road_resolution 0.005\ninclude \"" << our_world("simville/simville.world") << "\"\n";
  for (Words words : std::vector<Words>{{our_world("cave.world"), "--robots", "20"},
                                        {our_world("cave.world"), "--robots", "20", "--accuracy", "single"},
                                        {our_world("simville/simville.world")},
                                        {raster},
                                        {our_world("mapping/mapping.world")},
                                        {our_world("minimagic/minimagic.world")}}) {
    words.insert(words.begin(), "run");
    words.insert(words.end(), {"--duration", "0.5", "--json"});
    const Outcome kernels = run_program(words, {{"SENSORFARM_CASTER", "vulkan"}});
    words.insert(words.end(), {"--device", "host"});
    const Outcome host = run_successfully(words, with(no_device(), {{"SENSORFARM_CASTER", "auto"}}));
    const Json facts(host.out), expected(kernels.out);
    EXPECT_EQ(facts.text("/hash"), expected.text("/hash")) << words[1];
    EXPECT_EQ(facts.text("/device"), "host");
  }
}

TEST(NoDevice, WorldsCanStillBeCheckedAndDrawn) {
  const Folder folder;
  EXPECT_EQ(run_program({"check", our_world("rooms.world")}, no_device()).code, 0);
  EXPECT_EQ(run_program({"draw", our_world("rooms.world"), "-o", folder.path("x.png")}, no_device()).code, 0);
}

TEST(Devices, TheChosenDeviceIsPrinted) {
  const Json facts = run_json({"devices", "--json"});
  ASSERT_GE(facts.size("/devices"), 1u);
  std::size_t chosen = 0;
  for (std::size_t i = 0; i < facts.size("/devices"); ++i) {
    const std::string row = "/devices/" + std::to_string(i);
    EXPECT_NE(facts.text(row + "/name"), "");
    facts.flag(row + "/software");
    const bool is_chosen = facts.flag(row + "/chosen");
    chosen += is_chosen;
    EXPECT_EQ(facts.text(row + "/reason").empty(), is_chosen) << "each rejected device has a reason";
    if (!is_chosen) continue;
    EXPECT_EQ(facts.text(row + "/self_check"), "passed");
  }
  EXPECT_EQ(facts.text("/devices/" + std::to_string(facts.size("/devices") - 1) + "/name"), "host");
  EXPECT_EQ(chosen, 1u);
  EXPECT_NE(run_program({"devices"}).out.find("self-check passed"), std::string::npos);
}

TEST(Devices, TheHostMatchesInAnyCase) {
  const std::string world = our_world("rooms.world");
  for (const char* name : {"host", "Host", "HOST"}) {
    run_successfully({"sense", world, "--device", name}, {{"SENSORFARM_CASTER", "auto"}});
  }
  run_successfully({"devices", "--device", "Host"}, {{"SENSORFARM_CASTER", "auto"}});
  for (const char* name : {"hots", "Hos"}) {
    const Outcome outcome = run_program({"sense", world, "--device", name});
    EXPECT_EQ(outcome.code, 3) << name;
    EXPECT_NE(outcome.err.find("did you mean 'host'?"), std::string::npos) << outcome.err;
  }
}

TEST(Devices, UnknownDeviceExitsWithThree) {
  for (const std::string command : {"devices", "sense", "run"}) {
    Words words{command};
    if (command != "devices") words.push_back(our_world("rooms.world"));
    words.insert(words.end(), {"--device", "no such device"});
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.code, 3) << command;
    EXPECT_NE(outcome.err.find("no such device"), std::string::npos) << outcome.err;
  }
}

TEST(Devices, TheOptionOverridesTheEnvironment) {
  const Environment wrong{{"SENSORFARM_DEVICE", "no such device"}};
  EXPECT_EQ(run_program({"devices"}, wrong).code, 3);
  EXPECT_EQ(run_program({"devices", "--device", "0"}, wrong).code, 0);
  EXPECT_EQ(run_program({"devices"}, {{"SENSORFARM_DEVICE", "0"}}).code, 0);
  const Outcome host = run_successfully({"devices", "--device", "host"}, {{"SENSORFARM_CASTER", "auto"}});
  EXPECT_NE(host.out.find("*    host"), std::string::npos) << host.out;
}

}  // namespace sf
