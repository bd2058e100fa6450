#include "base/suggest.h"

#include <gtest/gtest.h>

#include <vector>

namespace sf::base {
namespace {

TEST(Suggest, EditDistanceCountsEdits) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("pose", "pose"), 0u);
  EXPECT_EQ(edit_distance("pose", "posee"), 1u);       // insertion
  EXPECT_EQ(edit_distance("pose", "pse"), 1u);         // deletion
  EXPECT_EQ(edit_distance("pose", "pise"), 1u);        // substitution
  EXPECT_EQ(edit_distance("samples", "smaples"), 1u);  // swap
  EXPECT_EQ(edit_distance("range_max", "range_min"), 2u);
}

TEST(Suggest, ShortWordsAllowOneEdit) {
  const std::vector<std::string_view> words{"fov", "z"};
  EXPECT_EQ(suggest("fow", words), "; did you mean 'fov'?");
  EXPECT_EQ(suggest("abc", words), "");
  const std::vector<std::string_view> longer{"pose", "speed"};  // boundary: four and five letters
  EXPECT_EQ(suggest("paxe", longer), "");
  EXPECT_EQ(suggest("spaad", longer), "; did you mean 'speed'?");
  EXPECT_EQ(suggest("spaax", longer), "") << "three slips";
}

TEST(Suggest, ExpectedWordsFollowTheSuggestion) {
  const std::vector<std::string_view> words{"fov", "z"};
  EXPECT_EQ(expected_one_of("fow", words), "; did you mean 'fov'? Expected one of: fov, z");
  EXPECT_EQ(expected_one_of("abc", words), "; expected one of: fov, z");
  EXPECT_EQ(suggest("fow", words, "it has none"), "; did you mean 'fov'? It has none");
  EXPECT_EQ(suggest("fow", words, ""), "; did you mean 'fov'?");
}

}  // namespace
}  // namespace sf::base
