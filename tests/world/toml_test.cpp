#include "world/toml.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/refusal.h"

namespace sf::world {
namespace {

std::string toml_refusal(const std::string& text) {
  return sf::refusal_of([&] { parse_toml("f.toml", text); });
}

TEST(Toml, EveryKindOfValueWithItsLine) {
  const TomlNode root = parse_toml("f.toml", R"(# first
flag = true
whole = 3
number = 2.5
text = "word"
list = [1, 2]
big = inf
day = 2026-01-01
[table]
inner = -1
[[row]]
a = 1
[[row]]
a = 2
)");
  ASSERT_NE(find(root, "flag"), nullptr);
  EXPECT_EQ(find(root, "flag")->kind, TomlNode::Kind::flag);
  EXPECT_TRUE(find(root, "flag")->flag);
  EXPECT_EQ(find(root, "flag")->line, 2);
  EXPECT_EQ(find(root, "whole")->number, 3.0);
  EXPECT_EQ(find(root, "number")->number, 2.5);
  EXPECT_EQ(find(root, "text")->text, "word");
  ASSERT_EQ(find(root, "list")->items.size(), 2u);
  EXPECT_EQ(find(root, "list")->items[1].number, 2.0);
  EXPECT_TRUE(std::isinf(find(root, "big")->number));
  EXPECT_EQ(find(root, "day")->kind, TomlNode::Kind::other);
  const TomlNode* table = find(root, "table");
  ASSERT_NE(table, nullptr);
  EXPECT_EQ(table->line, 9);
  EXPECT_EQ(find(*table, "inner")->number, -1.0);
  EXPECT_EQ(find(*table, "inner")->line, 10);
  const TomlNode* rows = find(root, "row");
  ASSERT_NE(rows, nullptr);
  ASSERT_EQ(rows->items.size(), 2u);
  EXPECT_EQ(rows->items[1].line, 13);
  EXPECT_EQ(find(root, "none"), nullptr);
}

TEST(Toml, EmptyTextIsAnEmptyTable) { EXPECT_TRUE(parse_toml("f.toml", "").items.empty()); }

TEST(Toml, InvalidTomlIsRejectedAtItsLine) {
  EXPECT_EQ(toml_refusal("a = 1\nb = \n").substr(0, 18), "f.toml:2: not TOML");
  EXPECT_EQ(toml_refusal("a = 1\na = 2\n").substr(0, 18), "f.toml:2: not TOML");
  EXPECT_EQ(toml_refusal("a = \"\xC3\xA9\"\n").substr(0, 9), "f.toml:1:");
  EXPECT_EQ(toml_refusal("# \xC3\xA9\na = 1\n"), "");
}

TEST(Toml, NestingIsLimited) {
  std::string deep;
  for (int i = 0; i < 32; ++i) deep += i == 0 ? "[a" : ".a";
  EXPECT_EQ(toml_refusal(deep + "]\n"), "");
  EXPECT_NE(toml_refusal(deep + ".a.a]\n").find("nested too deeply"), std::string::npos);
}

}  // namespace
}  // namespace sf::world
