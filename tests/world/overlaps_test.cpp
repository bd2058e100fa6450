#include "world/overlaps.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/world/read_world.h"

namespace sf::world {
namespace {

using Rows = std::vector<std::uint32_t>;

constexpr const char* kBot = "define bot position( size [0.4 0.4 0.3] )\n";

Rows overlapping(const std::string& robots) { return find_overlaps(read_world(kBot + robots)).robots; }

TEST(Overlaps, RobotsInsideEachOther) {
  EXPECT_EQ(overlapping("bot( ) bot( )"), (Rows{0, 1})) << "the same pose";
  EXPECT_EQ(overlapping("bot( ) bot( pose [0.3 0.1 0 0] )"), (Rows{0, 1}));
  EXPECT_EQ(overlapping("bot( ) bot( pose [0.4 0 0 0] )"), (Rows{})) << "touching is fine";
  EXPECT_EQ(overlapping("bot( ) bot( pose [0.3 0.3 0 0] )"), (Rows{0, 1})) << "in their corners";
  EXPECT_EQ(overlapping("bot( ) bot( pose [0.45 0 0 0] )"), (Rows{}));
  EXPECT_EQ(overlapping("bot( ) bot( pose [0.45 0 0 45] )"), (Rows{0, 1})) << "turned, with a corner in the other";
  EXPECT_EQ(overlapping("bot( size [4 4 0.3] ) bot( pose [1 1 0 0] )"), (Rows{0, 1})) << "one inside the other";
  EXPECT_EQ(overlapping("bot( ) bot( pose [0 0 0.3 0] )"), (Rows{})) << "one on top of the other";
  EXPECT_EQ(overlapping("bot( ) bot( pose [0 0 0.29 0] )"), (Rows{0, 1}));
  EXPECT_EQ(overlapping("bot( obstacle_return 0 ) bot( )"), (Rows{})) << "it stops no robot";
  EXPECT_EQ(overlapping("bot( name \"tag1\" ) bot( )"), (Rows{})) << "tags can be anywhere";
  EXPECT_EQ(overlapping("bot( noblocks 1 ) bot( )"), (Rows{})) << "without a body";
}

/// Boxes that overlap, and outlines that do not.
TEST(Overlaps, CompareOutlinesNotBoxes) {
  const std::string wedge =
      "position( size [1 1 1] pose [0 0 0 {}] block( points 3 z [0 1] point[0] [0 0] point[1] [1 0] point[2] [0 1] ) "
      ")\n";
  EXPECT_EQ(overlapping(fmt::format(fmt::runtime(wedge), 0) + "bot( pose [0.4 0.4 0 0] size [0.2 0.2 0.3] )"),
            (Rows{}));
  EXPECT_EQ(overlapping(fmt::format(fmt::runtime(wedge), 180) + "bot( pose [0.4 0.4 0 0] size [0.2 0.2 0.3] )"),
            (Rows{0, 1}));
}

TEST(Overlaps, AreOneWarningWithACount) {
  const World world = read_world(std::string(kBot) +
                                 "bot( name \"a\" )\nbot( name \"b\" )\nbot( name \"c\" pose [5 0 0 0] )\n"
                                 "bot( name \"d\" pose [5.1 0 0 0] )\nbot( name \"e\" pose [9 0 0 0] )\n");
  EXPECT_EQ(warnings_of(world),
            "3: 4 robots overlap others at the start: 'a', 'b', 'c' and 1 more; 'b' starts at (0, 0), in 'a': expected "
            "separate poses\n");
}

/// Each robot in a crowd looks for only one partner, so a crowd takes no longer than separate robots.
TEST(Overlaps, CrowdAtOnePoseIsFoundCompletely) {
  std::string text;
  for (int i = 0; i < 2'000; ++i) text += "bot( )\n";
  const Overlaps found = find_overlaps(read_world(kBot + text));
  EXPECT_EQ(found.robots.size(), 2'000u);
  EXPECT_TRUE(found.complete);
  EXPECT_LT(found.pairs.size(), 4'000u);
}

/// Long parallel robots whose boxes overlap and whose outlines do not: the work is limited.
TEST(Overlaps, WorkIsLimited) {
  std::string text = "define rod position( size [1000 0.001 1] )\n";
  for (int i = 0; i < 3'000; ++i) text += fmt::format("rod( pose [{} {} 0 45] )\n", 0.01 * i, -0.01 * i);
  const World world = read_world(text);
  EXPECT_FALSE(find_overlaps(world).complete);
  EXPECT_NE(warnings_of(world).find("too many robots near each other"), std::string::npos);
}

}  // namespace
}  // namespace sf::world
