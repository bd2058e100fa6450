// Limits of world files, as a table: the value at the limit is accepted, and the next one is rejected with its message.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/world/read_world.h"

namespace sf::world::limits {
namespace {

struct Limit {
  const char* form;  ///< of the world, {} for the value
  const char* taken;
  const char* beyond;
  const char* says;
};

constexpr const char* kBlock = "model( size [1 1 1] block( points 2 point[0] [0 0] point[1] [1 0] {} ) )";
constexpr const char* kLight = "light( phases 1 {} )";
constexpr const char* kArc = "path( pieces 1 arc[0] [{}] )";
constexpr const char* kMagnets = "path( pieces 1 straight[0] [2 1] magnetic_moment 1 {} )";

constexpr Limit kLimits[] = {
    {"model( pose [{} 0 0 0] )", "-10000000", "10000001", "expected lengths up to 10000000 m"},
    {"interval_sim {}", "0.001", "0.0009", "'interval_sim' is 0.0009 milliseconds; expected 0.001 to 1000000"},
    {"interval_sim {}", "1000000", "1000001", "expected 0.001 to 1000000"},
    {"magnet_cutoff {}", "0", "-0.001", "'magnet_cutoff' is -0.001 m; expected 0 or more"},
    {"road_resolution {}", "0", "-0.001", "'road_resolution' is -0.001 m; expected 0 or more"},
    {"model( size [{}] )", "0 0", "0 -1e-9", "lengths that are not negative"},
    {"model( size [1 1 {}] )", "0", "-1e-9", "lengths that are not negative"},
    {kBlock, "z [1 1]", "z [1 0.999]", "min not above max"},
    {"model( block( points {} point[0] [0 0] point[1] [1 0] ) )", "2", "1", "a whole number from 2 to 2000"},
    {"model( name \"tag1\" tag_pose [{} 0 0 0] )", "100", "100.001", "within 100 m"},
    {"model( name \"tag1\" tag_pose [0 0 {} 0] )", "-100", "-100.001", "within 100 m"},
    {"model( magnetic_moment {} )", "1e16", "1.001e16", "expected at most 1e+16"},
    {"model( magnetic_moment {} )", "-1e16", "-1.001e16", "expected at most 1e+16"},
    {"model( magnetic_moment 1 size [1 {}] )", "0.001", "0", "a magnet requires a 'size' above zero"},
    {"model( ir_emitter \"dock\" ir_fov {} )", "360", "360.001", "more than 0, to 360"},
    {"model( ir_emitter \"dock\" ir_range {} )", "0.0001", "0", "'ir_range' is 0 m; expected more than 0"},
    {"model( ir_emitter \"dock\" ir_halo {} )", "0", "-0.0001", "'ir_halo' is -0.0001 m; expected 0 or more"},
    {kLight, "phase[0] [\"red\" 1000000]", "phase[0] [\"red\" 1000001]", "expected more than 0, to 1000000"},
    {kLight, "phase[0] [\"red\" 1] offset 1000000", "phase[0] [\"red\" 1] offset 1000001", "-1000000 to 1000000"},
    {kLight, "phase[0] [\"red\" 1] offset -1000000", "phase[0] [\"red\" 1] offset -1000001", "-1000000 to 1000000"},
    {kLight, "phase[0] [\"red\" 1] lamps 3", "phase[0] [\"red\" 1] lamps 4", "a whole number from 1 to 3"},
    {kLight, "phase[0] [\"red\" 1] lamps 1", "phase[0] [\"red\" 1] lamps 0", "a whole number from 1 to 3"},
    {kLight, "phase[0] [\"red\" 1] stop_lines \"32768.32768.32768\"", "phase[0] [\"red\" 1] stop_lines \"32769.1.1\"",
     "'32769.1.1'"},
    {"light( {} )", "phases 1 phase[0] [\"red\" 1]", "phases 101", "a whole number from 1 to 100"},
    {"path( pieces 1 straight[0] [1 {}] )", "0.001", "0", "a length and a width above zero"},
    {"path( pieces 1 straight[0] [{} 1] )", "0.001", "0", "a length and a width above zero"},
    {"path( {} straight[0] [1 1] )", "pieces 1", "pieces 10001", "a whole number from 1 to 10000"},
    {kArc, "1 360 0.5", "1 360.001 0.5", "at most one turn"},
    {kArc, "1 -360 0.5", "1 -360.001 0.5", "at most one turn"},
    {kArc, "1 90 1.999", "1 90 2", "a width below twice the radius"},
    {kArc, "0.5 90 0.1", "0 90 0.1", "a radius above zero"},
    {"path( pieces 1 straight[0] [1 1] left \"solid_white\" paint_width {} )", "0.001", "0", "a length above zero"},
    {"path( pieces 1 straight[0] [1 1] left \"broken_white\" dash [{}] )", "1 0.001", "1 0", "two lengths above zero"},
    {"path( pieces 1 straight[0] [1 1] left \"broken_white\" dash [{}] )", "0.001 1", "0 1", "two lengths above zero"},
    {"path( pieces 1 straight[0] [{} 1] left \"broken_white\" dash [1 1] )", "2000000", "2000003", "1000000 dashes"},
    {kMagnets, "magnet_spacing 2.5", "", "magnets require both"},
    {kMagnets, "magnet_spacing 1 magnet_size [0.1 0]", "magnet_spacing 1 magnet_size [0.1 -1]", "[width length]"},
    {kMagnets, "magnet_spacing 1 magnet_size [0.1 1]", "magnet_spacing 1 magnet_size [0 1]", "[width length]"},
    {"position( laser( samples {} ) )", "10000000", "10000001", "the world now has 10000001 samples of sensors"},
    {"position( velocity_bounds [0 {}] )", "0.0001", "0", "expected more than 0"},
    {"position( wheelbase {} )", "0.0001", "0", "'wheelbase' is 0 m; expected more than 0"},
};

TEST(StageLimits, ValueAtTheLimitIsAcceptedAndTheNextIsNot) {
  for (const Limit& l : kLimits) {
    EXPECT_EQ(error_of(fmt::format(fmt::runtime(l.form), l.taken)), "") << l.form << " with " << l.taken;
    const std::string error = error_of(fmt::format(fmt::runtime(l.form), l.beyond));
    EXPECT_NE(error.find(l.says), std::string::npos) << l.form << " with " << l.beyond << ": " << error;
  }
}

TEST(StageLimits, NestingIsLimitedTo64Levels) {
  const auto nested = [](int levels) {
    std::string text;
    for (int i = 0; i < levels; ++i) text += "model(";
    return text + std::string(static_cast<std::size_t>(levels), ')');
  };
  int levels = 1;
  while (levels < 100 && error_of(nested(levels)).empty()) ++levels;
  EXPECT_EQ(levels, 64) << "the world is a level, too";
  EXPECT_EQ(error_of(nested(levels)), "test.world:1: nested deeper than 64 levels");
}

TEST(StageLimits, WordsAreLimitedToTenThousandCharacters) {
  const auto named = [](std::size_t letters) { return "name \"" + std::string(letters, 'x') + "\""; };
  EXPECT_EQ(error_of(named(10'000)), "");
  EXPECT_EQ(error_of(named(10'001)), "test.world:1: a word or text of 10001 characters; expected at most 10000");
}

TEST(StageLimits, WarningsAreLimitedToTenThousand) {
  std::string text;
  for (int i = 0; i < 10'010; ++i) text += "model( sise 1 )\n";
  const World world = read_world(text);
  ASSERT_EQ(world.warnings.size(), 10'001u);
  EXPECT_EQ(world.warnings.back().message, "more than 10000 warnings; further warnings are dropped");
  EXPECT_EQ(world.warnings.back().line, 10'001);
  EXPECT_EQ(world.warnings[1000].message, "unknown property 'sise' of 'model' is ignored; did you mean 'size'?");
  EXPECT_EQ(world.warnings[1001].message, "unknown property 'sise' of 'model' is ignored") << "no search for thousands";
}

TEST(StageLimits, DefinitionsAreLimitedToTwentyThousand) {
  std::string text;
  for (int i = 0; i < 20'000; ++i) text += fmt::format("define m{} model( )\n", i);
  EXPECT_EQ(error_of(text), "");
  EXPECT_EQ(error_of(text + "define n model( )"), "test.world:20001: more than 20000 definitions in one world");
}

}  // namespace
}  // namespace sf::world::limits
