// Plan files of lights: their meaning and their errors.

#include "world/light_plan.h"

#include <gtest/gtest.h>

#include "tests/refusal.h"
#include "world/fixed_programs.h"
#include "world/lights.h"

namespace sf::world {
namespace {

/// Lights a to d, 3 m apart on a street, always green.
World plan_street() {
  World world;
  world.file = "street.world";
  for (const char* name : {"a", "b", "c", "d"}) {
    Light& light = world.lights.emplace_back();
    light.name = name;
    light.X_WL.x = 3.0 * static_cast<double>(world.lights.size() - 1);
    light.phases = {{LightState::green, 1.0}};
  }
  return world;
}

const std::string kTwoStages = R"(
[[program]]
lights = ["a", "b"]
offset = 5
[[program.stage]]
states = { a = "green" }
duration = 8
[[program.stage]]
states = { b = "green" }
duration = 10
yellow = 3
clear = 0
)";

/// Times at the limit are accepted, and times beyond it are rejected.
TEST(LightPlan, TimesAreLimited) {
  struct Limit {
    std::string from, to;  ///< `from` in the plan is replaced by `to` and a value
    std::string least, below, most, beyond;
  };
  const Limit limits[] = {
      {"duration = 8", "duration = ", "0.001", "0.0009", "1e6", "1000001"},
      {"yellow = 3", "yellow = ", "0", "-0.001", "1e6", "1000001"},
      {"clear = 0", "clear = ", "0", "-0.001", "1e6", "1000001"},
  };
  const auto is_refused = [](const Limit& l, const std::string& value) {
    std::string plan = kTwoStages;
    plan.replace(plan.find(l.from), l.from.size(), l.to + value);
    World world = plan_street();
    return !sf::refusal_of([&] { parse_light_plan("p.toml", plan, world); }).empty();
  };
  for (const Limit& l : limits) {
    for (const std::string& fine : {l.least, l.most}) EXPECT_FALSE(is_refused(l, fine)) << l.to << fine;
    for (const std::string& wrong : {l.below, l.beyond}) EXPECT_TRUE(is_refused(l, wrong)) << l.to << wrong;
  }
}

/// A light that is green in the last stage and in the first turns green with the last.
TEST(LightPlan, GreenAcrossTheEndOfTheCycleBeginsOnce) {
  World world = plan_street();
  const LightPlan plan = parse_light_plan("p.toml",
                                          "[[program]]\nlights = [\"a\", \"b\"]\n"
                                          "[[program.stage]]\nstates = { a = \"green\" }\nduration = 8\n"
                                          "[[program.stage]]\nstates = { b = \"green\" }\nduration = 10\n"
                                          "[[program.stage]]\nstates = { a = \"green\" }\nduration = 4\n",
                                          world);
  EXPECT_EQ(first_green(plan.programs.at(0), 0), 8.0 + 3.0 + 10.0 + 3.0);
  EXPECT_EQ(first_green(plan.programs.at(0), 1), 8.0 + 3.0);
}

TEST(LightPlan, FixedProgramBecomesThePlansOfItsLights) {
  World world = plan_street();
  const LightPlan plan = parse_light_plan("p.toml", kTwoStages, world);
  EXPECT_FALSE(is_actuated(plan.programs.at(0)));
  // 8 s, 2 s yellow, 1 s clear; 10 s, 3 s yellow: 24 s in total.
  const auto at = [&](std::size_t light, double time) { return signal_at(world.lights[light], time).state; };
  for (const double cycle : {0.0, 24.0, -24.0}) {
    EXPECT_EQ(at(0, cycle + 5.0), LightState::green);
    EXPECT_EQ(at(0, cycle + 12.9), LightState::green);
    EXPECT_EQ(at(0, cycle + 13.1), LightState::yellow);
    EXPECT_EQ(at(0, cycle + 15.1), LightState::red);
    EXPECT_EQ(at(1, cycle + 15.9), LightState::red) << "until the clear time is over";
    EXPECT_EQ(at(1, cycle + 16.1), LightState::green);
    EXPECT_EQ(at(1, cycle + 26.1), LightState::yellow);
    EXPECT_EQ(at(1, cycle + 28.9), LightState::yellow);
  }
  EXPECT_NEAR(signal_at(world.lights[0], 16.0).left, 13.0, 1e-9) << "red lasts over both stages: one phase";
  EXPECT_NEAR(signal_at(world.lights[1], 6.0).left, 10.0, 1e-9) << "red over the end of the cycle";
  EXPECT_EQ(world.lights[2].phases.size(), 1u) << "a light without a program keeps its plan";
}

TEST(LightPlan, EveryStateCanBeShownByEachSide) {
  World world = plan_street();
  parse_light_plan("p.toml", R"(
[[program]]
lights = ["a", "b", "c", "d"]
[[program.stage]]
states = { a = "flashing red", b = "flashing yellow", c = "dark", d = "yellow" }
duration = 1
)",
                   world);
  const std::vector<SignalForecast> all = forecasts_at(world, 3.0);
  EXPECT_EQ(all[0].now.state, LightState::flashing_red);
  EXPECT_EQ(all[1].now.state, LightState::flashing_yellow);
  EXPECT_EQ(all[2].now.state, LightState::dark);
  EXPECT_EQ(all[3].now.state, LightState::yellow);
  EXPECT_FALSE(all[0].next) << "one stage never ends";
}

std::string wave(const std::string& wave_text, const std::string& last_green = "8") {
  std::string text;
  for (const char* light : {"a", "b", "c"}) {
    const std::string green = light[0] == 'c' ? last_green : "8";
    text += "[[program]]\nlights = [\"" + std::string(light) + "\"]\n[[program.stage]]\nduration = 4\n" +
            "[[program.stage]]\nstates = { " + light + " = \"green\" }\nduration = " + green + "\n";
  }
  return text + "[[wave]]\nlights = [\"a\", \"b\", \"c\"]\nspeed = 0.5\nstart = 2\n" + wave_text;
}

TEST(LightPlan, GreenWaveMovesAtItsSpeed) {
  World world = plan_street();
  parse_light_plan("p.toml", wave(""), world);
  for (std::size_t k = 0; k < 3; ++k) {  // 6 s between lights
    const double green = 2.0 + 6.0 * static_cast<double>(k);
    EXPECT_EQ(signal_at(world.lights[k], green - 0.01).state, LightState::red) << k;
    EXPECT_EQ(signal_at(world.lights[k], green + 0.01).state, LightState::green) << k;
  }
  parse_light_plan("p.toml", wave("distances = [1, 4]\n"), world);
  EXPECT_EQ(signal_at(world.lights[1], 3.99).state, LightState::red) << "as given: 2 s, then 8 s";
  EXPECT_EQ(signal_at(world.lights[1], 4.01).state, LightState::green);
  EXPECT_EQ(signal_at(world.lights[2], 12.01).state, LightState::green);
}

TEST(LightPlan, GreenWaveMovesStraightFromLightToLight) {
  World world = plan_street();
  world.lights[0].X_WL = {1.0, 3.0, 0.0, 0.0};
  world.lights[1].X_WL = {4.0, 7.0, 0.0, 0.0};  // 5 m
  parse_light_plan("p.toml", wave(""), world);
  EXPECT_EQ(signal_at(world.lights[1], 11.99).state, LightState::red) << "2 s, then 10 s";
  EXPECT_EQ(signal_at(world.lights[1], 12.01).state, LightState::green);
}

TEST(LightPlan, WorldIsRelativeToThePlan) {
  EXPECT_EQ(world_of_plan("towns/p.toml", "world = \"../x.world\""), "x.world");
  EXPECT_THROW(world_of_plan("p.toml", "[[program]]"), base::InputError);
}

TEST(LightPlan, ErrorsNameLineAndRemedy) {
  struct Case {
    std::string text;
    const char* said;
  };
  const std::string head = "[[program]]\nlights = [\"a\"]\n[[program.stage]]\n";
  const std::string detector = "[[detector]]\nname = \"n\"\nat = [0, 0]\nradius = 1\n";
  for (const Case& c : std::vector<Case>{
           {"", "no program; expected a [[program]] section"},
           {"[[programm]]\n", "p.toml:1: unknown key 'programm'; did you mean 'program'?"},
           {"[[program]]\nlights = [\"a\"]\n", "p.toml:1: a program requires 1 to"},
           {"[[program]]\n[[program.stage]]\nduration = 1\n", "p.toml:1: 'lights' is missing"},
           {"[[program]]\nlights = [\"aa\"]\n", "p.toml:2: no light of the world is called 'aa'"},
           {"[[program]]\nlights = [\"a\", \"a\"]\n", "p.toml:2: 'a' is listed twice"},
           {head + "states = { b = \"green\" }\nduration = 1\n", "p.toml:4: no light of this program is called 'b'"},
           {head + "states = { a = \"gren\" }\nduration = 1\n",
            "p.toml:4: 'a' expects a state in quotes; did you mean 'green'?"},
           {head, "p.toml:3: a stage requires 'duration', or 'min'"},
           {head + "duration = 0\n", "p.toml:4: 'duration' expects a number from 0.001"},
           {head + "duration = nan\n", "p.toml:4: 'duration' expects a number"},
           {head + "duration = 1\nmax = 2\n", "p.toml:5: a stage with a 'duration' cannot have 'max'"},
           {head + "min = 1\n", "p.toml:3: 'max' is missing"},
           {head + "min = 3\nmax = 2\n", "p.toml:5: 'max' expects a number from 3"},
           {head + "min = 1\nmax = 2\ngap = 1\n", "p.toml:4: a stage with 'min' and 'max' requires 'detectors'"},
           {head + "duration = 1\non_call = true\n", "p.toml:3: a stage that is 'on_call' requires 'detectors'"},
           {detector + head + "duration = 1\ndetectors = [\"m\"]\n", "p.toml:9: no detector is called 'm'"},
           {detector + head + "duration = 1\ndetectors = [\"n\"]\non_call = true\n",
            "p.toml:5: every stage is 'on_call'"},
           {detector + "[[program]]\nlights = [\"a\"]\noffset = 2\n[[program.stage]]\nmin = 1\nmax = 2\ngap = 1\n"
                       "detectors = [\"n\"]\n",
            "p.toml:7: an actuated program cannot have an 'offset'"},
           {"[[detector]]\nname = \"n\"\n" + head, "p.toml:1: a detector requires a position"},
           {"[[detector]]\nname = \"n\"\nat = [0]\nradius = 1\n" + head, "p.toml:3: 'at' expects"},
           {"[[detector]]\nname = \"n\"\ncalls = [[2, 1]]\n" + head, "p.toml:3: 'calls' expects a number from 2"},
           {detector + detector + head, "p.toml:5: 'n' is listed twice"},
           {wave("", "9"), "the cycle of 'c' is 16 s, that of the lights before it 15 s"},
           {wave("distances = [1]\n"), "'distances' expects 2 numbers"},
           {wave("speeed = 1\n"), "unknown key 'speeed'"},
           {kTwoStages + "[[wave]]\nspeed = 1\nlights = [\"c\"]\n", "'c' is in no program of fixed stages"}}) {
    World world = plan_street();
    expect_in(c.said, sf::refusal_of([&] { parse_light_plan("p.toml", c.text, world); }));
  }
}

}  // namespace
}  // namespace sf::world
