// `explain` as users run it.

#include <gtest/gtest.h>

#include "apps/reports/report.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/refusal.h"

namespace sf {
namespace {

TEST(Explain, ListsWhichTablesAreBuilt) {
  const Outcome outcome = run_successfully({"explain", our_world("simville/simville.world")});
  for (const char* text : {"laser: 6 sensors on 6 robots", "magnets summed", "caster", "subscribed alone",
                           "none: computed on the host", "not built", "wall segments"})
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text << "\n" << outcome.out;
}

/// Lasers of 181 beams: the structures built for them and their cost, in integers where they are known.
TEST(Explain, AsJson) {
  const Outcome outcome =
      run_successfully({"explain", our_world("rooms.world"), "--robots", "3", "--caster", "vulkan", "--json"});
  const Json json(outcome.out);
  ASSERT_EQ(json.size("/types"), 1u);
  EXPECT_EQ(json.text("/types/0/type"), "laser");
  EXPECT_EQ(json.number("/types/0/sensors"), 3);
  EXPECT_EQ(json.number("/types/0/robots"), 3);
  EXPECT_EQ(json.number("/types/0/rate_hz/0"), 10);
  EXPECT_EQ(json.number("/types/0/readings_per_tick"), 3);
  EXPECT_EQ(json.number("/types/0/rays"), 3 * 181 * json.number("/ticks"));
  EXPECT_GT(json.number("/types/0/bytes"), 0);
  EXPECT_EQ(json.text("/caster"), "Vulkan kernels");
  EXPECT_EQ(json.text("/types/0/kernels/0"), "laser");
  double held = 0.0;
  for (std::size_t i = 0; i < json.size("/types/0/tables"); ++i)
    held += json.number("/types/0/tables/" + std::to_string(i) + "/bytes");
  EXPECT_EQ(held, json.number("/types/0/bytes")) << "the sum of its tables";
  EXPECT_EQ(json.size("/slices"), 1u) << "all at one height";
  EXPECT_EQ(json.number("/slices/0/sensors"), 3);
  EXPECT_GT(json.number("/slices/0/walls"), 0.0);
  EXPECT_LT(json.number("/slices/0/walls"), json.number("/walls")) << "a step of 4 cm is below the beams";
  EXPECT_EQ(json.text("/accuracy/0/mode"), "exact");
  EXPECT_GT(json.number("/tick_s"), 0.0);
  EXPECT_GT(json.number("/resident_bytes"), json.number("/types/0/bytes"));
  EXPECT_GT(json.size("/absent"), 0u);
  EXPECT_NE(outcome.out.find("magnet"), std::string::npos) << "no magnets, so no tables for them";
}

/// If the host casts, it has no kernel. An unknown caster is refused.
TEST(Explain, UsesTheRequestedCaster) {
  const Outcome host =
      run_successfully({"explain", our_world("rooms.world"), "--robots", "2", "--caster", "host", "--json"});
  const Json json(host.out);
  EXPECT_EQ(json.text("/caster").rfind("host, ", 0), 0u);
  EXPECT_EQ(json.size("/types/0/kernels"), 0u);
  expect_refused({"explain", our_world("rooms.world"), "--caster", "gpu"}, "--caster: expected auto, vulkan, host");
  const Outcome misspelt = run_program({"explain", our_world("rooms.world")}, {{"SENSORFARM_CASTER", "gpu"}});
  EXPECT_EQ(misspelt.code, 2) << "from the environment too";
  expect_in("SENSORFARM_CASTER: there is no caster 'gpu'; expected one of: auto, vulkan, host", misspelt.err);
  const Outcome reference =
      run_program({"explain", our_world("rooms.world"), "--robots", "2", "--caster", "reference", "--json"});
  EXPECT_EQ(Json(reference.out).text("/caster"), "reference, long double") << reference.err;
  expect_refused({"run", our_world("cave.world"), "--robots", "300", "--caster", "reference"},
                 "the caster 'reference' intersects every beam with every surface");
  const Outcome both =
      run_program({"explain", our_world("rooms.world"), "--robots", "2", "--caster", "vulkan", "--json"},
                  {{"SENSORFARM_CASTER", "host"}});
  EXPECT_EQ(Json(both.out).text("/caster"), "Vulkan kernels") << "the command line overrides the environment";
}

/// Uncertain beams are counted; the text shows their share of all beams.
TEST(Explain, CountsUncertainBeams) {
  const Words words{"explain", our_world("cave.world"), "--robots", "2"};
  Words as_json = words;
  as_json.push_back("--json");
  const Json json(run_program(as_json).out);
  const double share = 100.0 * json.number("/types/0/doubts") / json.number("/types/0/rays");
  ASSERT_GT(share, 0.0);
  const std::string text = run_program(words).out, message = " % of beams tested in 64 bits";
  const std::size_t end = text.find(message), begin = text.rfind(' ', end - 1);
  ASSERT_NE(end, std::string::npos) << text;
  EXPECT_NEAR(std::stod(text.substr(begin, end - begin)), share, 0.06 * share);
}

TEST(Explain, SizesUseTheLargestSuitableUnit) {
  scenarios::Explanation explanation{.ticks = 1};
  explanation.types.push_back({.type = "laser", .bytes = 1});
  explanation.types[0].tables = {
      {"", "a", 3u << 19}, {"", "b", 1u << 20}, {"", "c", (1u << 20) - 512}, {"", "d", 1024}, {"", "e", 1023}};
  const std::string text = apps::explanation_text(explanation);
  EXPECT_NE(text.find("1 B: a 1.5 MiB, b 1.0 MiB, c 1023.5 KiB, d 1.0 KiB, e 1023 B\n"), std::string::npos) << text;
}

TEST(Explain, WrongUsageIsRejected) {
  EXPECT_EQ(run_program({"explain"}).code, 2);
  EXPECT_EQ(run_program({"explain", "/nowhere.world"}).code, 2);
  EXPECT_EQ(run_program({"explain", our_world("rooms.world"), "--require-vulkan"}, no_device()).code, 3);
}

}  // namespace
}  // namespace sf
