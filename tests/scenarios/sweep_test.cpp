#include "scenarios/sweep.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "base/error.h"
#include "scenarios/sweep_sample.h"
#include "tests/refusal.h"

namespace sf::scenarios {
namespace {

constexpr const char* kSweepFile = SF_SOURCE_DIR "/experiments/sweeps/test.toml";
constexpr const char* kTown = "scenario = \"../simville.toml\"\n";

/// Returns the error from the file's name on; empty without an error.
std::string sweep_refusal(const std::string& text) {
  return refusal_from("test.toml", [&] { check_sweep(parse_sweep(kSweepFile, text)); });
}

std::vector<double> values_of(const std::string& parameter) {
  const Sweep sweep = parse_sweep(kSweepFile, kTown + ("[grid]\n" + parameter));
  std::vector<double> numbers;
  for (const world::TomlNode& value : sweep.parameters.at(0).values) numbers.push_back(value.number);
  return numbers;
}

TEST(SweepFile, EachErrorIsReportedAtItsLine) {
  const std::string town = kTown;
  const std::pair<std::string, std::string> kCorpus[] = {
      {"seeds = 2\n", "test.toml: has no scenario"},
      {"seeds = 2\nscenario = \"no.toml\"\n", "test.toml:2: there is no scenario 'no.toml'"},
      {town + "sead = 2\n", "test.toml:2: unknown key 'sead'"},
      {town + "seeds = 0\n", "test.toml:2: 'seeds' expects at least one"},
      {town + "seeds = [1, 2, 1]\n", "test.toml:2: 'seeds' contains a duplicate"},
      {town + "seeds = [1.5]\n", "test.toml:2: 'seeds' expects a whole number"},
      {town + "[grid]\nseed = [1, 2]\n", "test.toml:3: 'seed' is not a parameter"},
      {town + "[grid]\nduration = []\n", "test.toml:3: 'duration' has no values"},
      {town + "[grid]\n\"link..delay\" = [1]\n", "test.toml:3: 'link..delay' has an empty part"},
      {town + "[grid]\nlink.delay = [0]\n\"link.delay\" = [1]\n", "test.toml:4: 'link.delay' is already a parameter"},
      {town + "[grid]\nduration = { from = 1, to = 2 }\n", "test.toml:3: 'duration' has no 'count'"},
      {town + "[grid]\nduration = { from = 1, to = 2, count = 1 }\n", "test.toml:3: 'duration' expects a count of"},
      {town + "[grid]\nduration = { from = 2, to = 2, count = 2 }\n", "test.toml:3: 'duration' expects 'from' below"},
      {town + "[grid]\nduration = { from = 0, to = 2, count = 3, scale = \"log\" }\n",
       "test.toml:3: 'duration': scale \"log\" expects 'from' above 0"},
      {town + "[grid]\nduration = { from = 0.5, to = 2, count = 3, whole = true }\n",
       "test.toml:3: 'duration': whole = true expects whole numbers"},
      {town + "[sample]\npoints = 3\n", "test.toml:2: a sample has points = N and"},
      {town + "[sample]\npoints = 3\n[sample.range]\nduration = { from = 1, to = 2, count = 3 }\n",
       "test.toml:5: 'count' belongs to ranges of a grid"},
      {town + "[sample]\npoints = 3\nmethod = \"sobol\"\n[sample.range]\nduration = [1, 2]\n",
       "test.toml:4: 'method' expects"},
      // Detected only by the scenario.
      {town + "[grid]\nduratoin = [1]\n", "test.toml:3: duratoin = 1: "},
      {town + "[grid]\nlink.delay = [0.1, 0.2, -1, 0.3]\n", "test.toml:3: link.delay = -1: "},
      {town + "[grid]\nduration.long = [1]\n", "test.toml:3: duration.long = 1: 'duration' is a value"},
      {town + "[grid]\nduration = [1]\nevent.3.at = [1]\n", "test.toml:4: event.3.at = 1: "},
      // The second of three parameters is wrong, in a value that is neither first nor last.
      {town + "[grid]\nduration = [1, 2]\ndefault.controller = [\"wander\", \"unknown\", \"none\"]\nseeds = 1\n",
       "test.toml:5: seeds = 1: "},
      {town + "[grid]\nduration = [1, 2]\nplant = [\"ideal\", \"Ideal\", \"thesis\"]\nlink.delay = [0.1]\n",
       "test.toml:4: plant = Ideal: "},
  };
  for (const auto& [text, said] : kCorpus) EXPECT_EQ(sweep_refusal(text).substr(0, said.size()), said) << text;
}

/// An event's number consists only of digits and is below the number of events; a value reaches the named event.
TEST(SweepFile, EventsAreAddressedByNumber) {
  const std::string file = testing::TempDir() + "events_" + std::to_string(getpid()) + ".toml";
  std::ofstream(file) << "world = \"" SF_SOURCE_DIR "/worlds/minimagic/minimagic.world\"\n"
                      << "[[event]]\nat = 1\nobject = \"tag1\"\npresent = false\n"
                      << "[[event]]\nat = 2\nobject = \"tag1\"\npresent = true\n";
  const auto text = [&](const std::string& number) {
    return "scenario = \"" + file + "\"\n[grid]\nevent." + number + ".at = [1.5]\n";
  };
  for (const std::string number : {"0", "1"}) {
    EXPECT_EQ(sweep_refusal(text(number)), "");
    const Scenario scenario = scenario_of(parse_sweep(kSweepFile, text(number)), 0);
    ASSERT_EQ(scenario.events.size(), 2u);
    EXPECT_EQ(scenario.events[0].at, number == "0" ? 1.5 : 1.0);
    EXPECT_EQ(scenario.events[1].at, number == "1" ? 1.5 : 2.0);
  }
  for (const std::string number : {"2", "-1", "0x", "1st", "first", "18446744073709551616"})
    EXPECT_EQ(sweep_refusal(text(number)), "test.toml:3: event." + number + ".at = 1.5: 'event' has no item " + number +
                                               "; expected its number, from 0 to 1");
  std::filesystem::remove(file);
}

/// Checked one after the other: each value is combined with the first values of all other parameters.
TEST(SweepFile, IncompatibleValuesAreLeftToTheirJobs) {
  const std::string lane = "scenario = \"../lane-edge-p.toml\"\n[grid]\n";
  const std::string controllers = "default.controller = [\"lane-keeping\", \"none\"]\n";
  EXPECT_EQ(sweep_refusal(lane + controllers + "expect = [{ contacts = 9 }, { mean_error = 9 }]\n"), "");
  EXPECT_NE(sweep_refusal(lane + controllers + "expect = [{ mean_error = 9 }]\n"), "") << "the two that do not";
}

/// Lines are those of the sweep, because the scenario does not contain the value.
TEST(SweepFile, AWrongValueHasNoLineOfTheScenario) {
  const std::string said = sweep_refusal(kTown + std::string("[grid]\nlink.delay = [-1]\n"));
  EXPECT_NE(said.find("/simville.toml: 'delay'"), std::string::npos) << said;
}

/// A scenario for one test, with the seed 5, in a world with a mistake.
class OwnScenario : public testing::Test {
 protected:
  OwnScenario() {
    std::ofstream(world_) << "model( size [4 4 1] boundary 1 colour \"red\" )\nposition( name \"one\" )\n";
    std::ofstream(scenario_) << "world = \"" << world_ << "\"\nseed = 5\n";
  }
  ~OwnScenario() override {
    for (const std::string& file : {world_, scenario_}) std::filesystem::remove(file);
  }
  Sweep sweep(const std::string& more = "") const {
    return parse_sweep(kSweepFile, "scenario = \"" + scenario_ + "\"\n" + more);
  }

 private:
  const std::string stem_ = testing::TempDir() + "own_" + std::to_string(getpid());
  const std::string world_ = stem_ + ".world", scenario_ = stem_ + ".toml";
};

TEST_F(OwnScenario, ItsWarningsAreReturnedByTheCheck) {
  const std::vector<world::Warning> warnings = check_sweep(sweep());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].message.find("'colour'"), std::string::npos) << warnings[0].message;
}

TEST_F(OwnScenario, ANumberOfSeedsStartsAtItsSeed) {
  EXPECT_EQ(sweep("seeds = 3\n").seeds, (std::vector<std::uint64_t>{5, 6, 7}));
  EXPECT_EQ(sweep().seeds, (std::vector<std::uint64_t>{5}));
}

TEST_F(OwnScenario, RobotsWithoutAnEntryGetOne) {
  const Scenario scenario = scenario_of(sweep("[grid]\nrobot.one.rate = [4]\n"), 0);
  ASSERT_EQ(scenario.robot_setups.size(), 1u);
  EXPECT_EQ(scenario.robot_setups[0].name, "one");
  EXPECT_EQ(scenario.robot_setups[0].actor->controller.rate, 4.0);
}

TEST(SweepFile, TheNumberOfJobsIsCheckedBeforeTheyAreCreated) {
  const std::string grid = "[grid]\nduration = { from = 1, to = 2, count = 1000 }\n";
  const std::string delay = "link.delay = { from = 0, to = 1, count = 1000 }\n";
  EXPECT_EQ(parse_sweep(kSweepFile, kTown + grid + delay).jobs(), kMostJobs);  // the largest sweep
  const auto refused = [](const std::string& text) {
    const std::string said = sweep_refusal(text);
    return said.find("test.toml: has ") == 0 && said.find("expected 1000000 at most") != std::string::npos;
  };
  EXPECT_TRUE(refused(kTown + std::string("seeds = 2\n") + grid + delay)) << "seeds count, too";
  EXPECT_TRUE(refused(kTown + grid + delay + "start_at = { from = 0, to = 1, count = 1000000 }\n"));
  EXPECT_TRUE(refused(kTown + grid + "[sample]\npoints = 1001\n[sample.range]\nlink.delay = [0, 1]\n"));
  EXPECT_EQ(sweep_refusal(kTown + std::string("[sample]\npoints = 1000000\n[sample.range]\n"
                                              "a = [1]\nb = [1]\nc = [1]\nd = [1]\ne = [1]\n"))
                .substr(0, 33),
            "test.toml:2: too many points and ");
}

TEST(SweepFile, RangesIncludeBothEnds) {
  EXPECT_EQ(values_of("duration = { from = 1, to = 2, count = 3 }"), (std::vector<double>{1.0, 1.5, 2.0}));
  EXPECT_EQ(values_of("duration = { from = 1, to = 4, count = 4, whole = true }"), (std::vector<double>{1, 2, 3, 4}));
  const std::vector<double> decades = values_of("duration = { from = 0.1, to = 1000, count = 5, scale = \"log\" }");
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(decades[i] / std::pow(10.0, i - 1), 1.0, 1e-12);
  EXPECT_EQ(decades.back(), 1000.0);
}

/// One of four points in each quarter: two of each whole number, and one in each decade.
TEST(SweepFile, SampledRangesAreEvenOnTheirScale) {
  const auto sampled = [](const std::string& range) {
    const Sweep sweep = parse_sweep(
        kSweepFile, kTown + std::string("[sample]\npoints = 4\n[sample.range]\nduration = { ") + range + " }\n");
    std::vector<double> values;
    for (const world::TomlNode& value : sweep.parameters.at(0).values) values.push_back(value.number);
    std::sort(values.begin(), values.end());
    return values;
  };
  EXPECT_EQ(sampled("from = 3, to = 4, whole = true"), (std::vector<double>{3, 3, 4, 4}));
  const std::vector<double> linear = sampled("from = 0, to = 4"),
                            decades = sampled("from = 0.01, to = 100, scale = \"log\"");
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(std::floor(linear[i]), i);
    EXPECT_EQ(std::floor(std::log10(decades[i])), i - 2);
  }
}

TEST(SweepFile, ASampleDependsOnItsMethodAndSeed) {
  const auto expect_sample = [](const std::string& keys, SampleMethod method, std::uint64_t seed) {
    const Sweep sweep = parse_sweep(kSweepFile, kTown + ("[sample]\npoints = 20\n" + keys) +
                                                    "[sample.range]\nlink.delay = { from = 0, to = 2 }\n"
                                                    "default.controller = [\"wander\", \"none\", \"route\"]\n");
    const auto rows = sample_points(method, 20, 2, seed);
    const char* const names[] = {"wander", "none", "route"};
    for (std::size_t i = 0; i < 20; ++i) {
      EXPECT_EQ(sweep.parameters.at(0).values[i].number, 2.0 * rows[i][0]) << keys;
      EXPECT_EQ(sweep.parameters.at(1).values[i].text, names[static_cast<std::size_t>(3.0 * rows[i][1])]) << keys;
    }
  };
  expect_sample("", SampleMethod::latin_hypercube, 1);
  expect_sample("seed = 4\n", SampleMethod::latin_hypercube, 4);
  expect_sample("method = \"random\"\nseed = 4\n", SampleMethod::random, 4);
}

TEST(Sweep, ParametersAreInTheOrderOfTheirLines) {
  const Sweep sweep =
      parse_sweep(kSweepFile, kTown + std::string("[grid]\nlink.delay = [0]\nduration = [1]\nlink.loss = [0]\n"));
  std::vector<std::string> names;
  for (const SweepParameter& parameter : sweep.parameters) names.push_back(parameter.name);
  EXPECT_EQ(names, (std::vector<std::string>{"link.delay", "duration", "link.loss"}));
}

TEST(Sweep, SeedsChangeFastestAndTheFirstParameterSlowest) {
  const Sweep sweep = parse_sweep(kSweepFile, kTown + std::string("seeds = [7, 5]\n[grid]\nstart_at = [1, 2]\n"
                                                                  "duration = [10, 20, 30]\n"));
  ASSERT_EQ(sweep.jobs(), 12u);
  for (std::uint64_t job = 0; job < 12; ++job) {
    const Scenario scenario = scenario_of(sweep, job);
    EXPECT_EQ(scenario.start_at, 1.0 + static_cast<double>(job / 6)) << job;
    EXPECT_EQ(scenario.duration, 10.0 * static_cast<double>(1 + job / 2 % 3)) << job;
    EXPECT_EQ(scenario.seed, job % 2 == 0 ? 7u : 5u) << job;
  }
}

TEST(Sweep, ASampleIsRepeatedAtEachPointOfTheGrid) {
  const Sweep sweep =
      parse_sweep(kSweepFile, kTown + std::string("[grid]\nduration = [10, 20]\n[sample]\npoints = 3\n"
                                                  "[sample.range]\nlink.delay = { from = 0, to = 1 }\n"));
  ASSERT_EQ(sweep.points(), 6u);
  std::set<double> delays;
  for (std::uint64_t point = 0; point < 6; ++point) {
    EXPECT_EQ(scenario_of(sweep, point).duration, point < 3 ? 10.0 : 20.0);
    EXPECT_EQ(scenario_of(sweep, point).actor.link.delay, scenario_of(sweep, point % 3).actor.link.delay);
    delays.insert(scenario_of(sweep, point).actor.link.delay);
  }
  EXPECT_EQ(delays.size(), 3u);
}

/// A robot of the file, one that is only in the world, and a complete table.
TEST(Sweep, ParametersReachEveryKeyOfAScenario) {
  const Sweep sweep =
      parse_sweep(kSweepFile,
                  "scenario = \"../minimagic.toml\"\n[grid]\nrobot.tag1.settings.speed = [0.3]\nrobot.new.rate = [4]\n"
                  "link = [{ delay = 0.5, loss = 0.25 }]\nexpect.contacts = [3]\n");
  const Scenario scenario = scenario_of(sweep, 0);
  const auto robot = [&](const std::string& name) {
    return *std::find_if(scenario.robot_setups.begin(), scenario.robot_setups.end(),
                         [&](const RobotSetup& setup) { return setup.name == name; });
  };
  control::Settings settings = robot("tag1").actor->controller.settings;
  EXPECT_EQ(settings.number("speed", 0.0, 0.0, 1.0), 0.3);
  EXPECT_EQ(settings.numbers("points", {}).size(), 4u) << "the robot's other settings stay";
  EXPECT_EQ(robot("new").actor->controller.rate, 4.0);
  EXPECT_EQ(scenario.actor.link.loss, 0.25);
  EXPECT_TRUE(std::ranges::any_of(scenario.expect, [](const Expectation& each) {
    return each.kind == Expectation::Kind::contacts && each.limit == 3.0;
  }));
  EXPECT_EQ(parameter_value_text(sweep.parameters[2].values[0]), "{ delay = 0.5, loss = 0.25 }");
}

TEST(Sweep, ValuesAreShownAsInAFile) {
  const Sweep sweep = parse_sweep(
      kSweepFile, kTown + std::string("[grid]\nvalue = [true, false, 0.5, \"two words\", [1, 2.5], { a = [true] }]\n"));
  std::vector<std::string> texts;
  for (const world::TomlNode& value : sweep.parameters.at(0).values) texts.push_back(parameter_value_text(value));
  EXPECT_EQ(texts, (std::vector<std::string>{"true", "false", "0.5", "two words", "[1, 2.5]", "{ a = [true] }"}));
}

TEST(Sweep, ItsHashDependsOnBothFiles) {
  const auto hash = [](const std::string& text) { return parse_sweep(kSweepFile, text).hash; };
  EXPECT_EQ(hash(kTown), hash(kTown));
  EXPECT_NE(hash(kTown), hash(std::string(kTown) + "seeds = 1\n"));
  const std::string copy = testing::TempDir() + "copied.toml";
  std::filesystem::copy_file(SF_SOURCE_DIR "/experiments/simville.toml", copy,
                             std::filesystem::copy_options::overwrite_existing);
  const std::string text = "scenario = \"" + copy + "\"\nname = \"a\"\n";
  std::filesystem::copy_file(SF_SOURCE_DIR "/experiments/minimagic.toml", testing::TempDir() + "other.toml",
                             std::filesystem::copy_options::overwrite_existing);
  const std::uint64_t before = hash(text);
  std::filesystem::rename(testing::TempDir() + "other.toml", copy);
  EXPECT_NE(hash(text), before) << "the scenario changed behind the same words";
}

TEST(Sweep, TheExampleIsValid) {
  const Sweep sweep = read_sweep(SF_SOURCE_DIR "/experiments/sweeps/lane-edge.toml");
  EXPECT_TRUE(check_sweep(sweep).empty());
  EXPECT_EQ(sweep.jobs(), 27u);
}

TEST(SamplePoints, ALatinHypercubeHasOnePointInEachInterval) {
  for (const std::uint64_t points : {1u, 2u, 7u, 100u}) {
    const auto rows = sample_points(SampleMethod::latin_hypercube, points, 3, points);
    for (std::size_t d = 0; d < 3; ++d) {
      std::set<std::uint64_t> intervals;
      for (const std::vector<double>& row : rows) {
        EXPECT_GE(row[d], 0.0);
        EXPECT_LT(row[d], 1.0);
        intervals.insert(static_cast<std::uint64_t>(row[d] * static_cast<double>(points)));
      }
      EXPECT_EQ(intervals.size(), points) << d;
    }
  }
  // Each coordinate has its own order: of a hundred points, one is expected in the same interval of both.
  std::size_t same = 0;
  for (const std::vector<double>& row : sample_points(SampleMethod::latin_hypercube, 100, 2, 1))
    same += std::floor(100.0 * row[0]) == std::floor(100.0 * row[1]) ? 1 : 0;
  EXPECT_LT(same, 8u);
}

/// Computed by another program: a sweep's sample does not change between versions.
TEST(SamplePoints, AHypercubeNeverChanges) {
  const std::vector<std::vector<double>> expected{{0.2267753288025065, 0.8272814072732395},
                                                  {0.8902429807689076, 0.2042048456833454},
                                                  {0.6701796227565839, 0.7822716095822353},
                                                  {0.4941504264980464, 0.014885008014233337},
                                                  {0.11396942974041932, 0.5270462436627472}};
  EXPECT_EQ(sample_points(SampleMethod::latin_hypercube, 5, 2, 1), expected);
}

TEST(SamplePoints, SeedsAndMethodsDifferAndARandomSampleIsExtended) {
  const auto points = [](SampleMethod method, std::uint64_t count, std::uint64_t seed) {
    return sample_points(method, count, 2, seed);
  };
  constexpr auto kLatin = SampleMethod::latin_hypercube;
  EXPECT_EQ(points(kLatin, 9, 1), points(kLatin, 9, 1));
  EXPECT_NE(points(kLatin, 9, 1), points(kLatin, 9, 2));
  const auto nine = points(SampleMethod::random, 9, 1);
  EXPECT_NE(nine, points(kLatin, 9, 1));
  auto twenty = points(SampleMethod::random, 20, 1);
  twenty.resize(9);
  EXPECT_EQ(twenty, nine);
  EXPECT_NEAR(sample_points(SampleMethod::random, 1, 1, 1)[0][0], 0.13387664401253274, 1e-15) << "the engine's first";
}

}  // namespace
}  // namespace sf::scenarios
