#include "world/keys.h"

#include <gtest/gtest.h>

#include "world/stage/color_names.h"
#include "world/stage/mover_entities.h"

namespace sf::world {
namespace {

TEST(Keys, IndicesDoNotMatter) {
  EXPECT_TRUE(is_known_key(KeyScope::block, "point[17]"));
  EXPECT_TRUE(is_known_key(KeyScope::model, "block[2].point[17]"));
  EXPECT_FALSE(is_known_key(KeyScope::model, "point[17]"));
}

TEST(Keys, KeysAreKnownWhereTheyAreRead) {
  constexpr std::string_view own[] = {"samples"};
  EXPECT_TRUE(is_known_key(KeyScope::device, "samples", own));
  EXPECT_FALSE(is_known_key(KeyScope::model, "samples"));
  EXPECT_TRUE(is_known_key(KeyScope::device, "pose"));
  EXPECT_FALSE(is_known_key(KeyScope::world, "pose"));
}

TEST(Colors, AreSortedForSearch) {
  for (const char* name :
       {"aliceblue", "black", "red", "LightBlue", "steel blue", "DarkRed", "yellowgreen", "white", "grey"}) {
    EXPECT_TRUE(color_of(name)) << name;
  }
  EXPECT_EQ(color_of("red"), 0xFFFF0000u);
  EXPECT_EQ(color_of("gray0"), 0xFF000000u);
  EXPECT_EQ(color_of("grey100"), 0xFFFFFFFFu);
  EXPECT_EQ(color_of("red4"), 0xFF8C0000u);
  EXPECT_FALSE(color_of("gray101"));
  EXPECT_FALSE(color_of("red5"));
  EXPECT_EQ(color_of("gray100"), 0xFFFFFFFFu);
  EXPECT_FALSE(color_of("gray0100")) << "three digits at most";
  EXPECT_FALSE(color_of("1"));
  EXPECT_FALSE(color_of(""));
}

TEST(Links, FollowFromNames) {
  EXPECT_EQ(packet_id_of("roomba12")->number, 12u);
  EXPECT_EQ(packet_id_of("/khepera3")->number, 3u);
  EXPECT_EQ(packet_id_of("roomba0")->number, 0u);
  EXPECT_TRUE(packet_id_of("tag32")->is_tag);
  EXPECT_FALSE(packet_id_of("tag0"));
  EXPECT_FALSE(packet_id_of("roomba-1"));
  EXPECT_FALSE(packet_id_of("roomba"));
  EXPECT_FALSE(packet_id_of("pioneer2dx"));
}

}  // namespace
}  // namespace sf::world
