// Values from files, which have a type, and from the command line, whose type the reader determines.

#include "control/settings.h"

#include <gtest/gtest.h>

#include "tests/control/traffic.h"
#include "tests/refusal.h"

namespace sf::control {
namespace {

using Numbers = std::vector<double>;
using Texts = std::vector<std::string>;

Settings given(Value value) { return {"controller 'c'", {{"key", std::move(value), "--set key: "}}}; }
Settings raw(const std::string& text) { return given(RawText{text}); }

template <class Read>
std::string refusal(Settings settings, Read&& read) {
  return refusal_of([&] { read(settings); });
}

double number_of(Settings settings) { return settings.number("key", -1.0, -10.0, 10.0); }
std::string key_text(Settings settings) { return settings.text("key", "fallback"); }
Numbers numbers_of(Settings settings) { return settings.numbers("key", {}); }
Texts texts_of(Settings settings) { return settings.texts("key", {}); }

TEST(Settings, ConvertsRawValuesToTheRequestedType) {
  EXPECT_EQ(number_of(raw("1")), 1.0);
  EXPECT_EQ(numbers_of(raw("1")), Numbers{1.0});  // a list of one
  EXPECT_EQ(key_text(raw("1")), "1");
  EXPECT_EQ(texts_of(raw("1")), Texts{"1"});
  EXPECT_EQ(key_text(raw("13.10")), "13.10");  // the trailing zero of a spot's name is kept
  EXPECT_EQ(key_text(raw("true")), "true");
  EXPECT_TRUE(raw("true").flag("key", false));
  EXPECT_FALSE(raw(" false ").flag("key", true));
}

TEST(Settings, ReadsRawListsInAllForms) {
  for (const char* text : {"1,2", "1, 2", "1 2", "[1,2]", "[1, 2]", "[1 2]", " [ 1  2 ] ", "1 , 2"})
    EXPECT_EQ(numbers_of(raw(text)), (Numbers{1, 2})) << text;
  EXPECT_EQ(numbers_of(raw("[-0.5 1e3]")), (Numbers{-0.5, 1000}));
  EXPECT_EQ(numbers_of(raw("[]")), Numbers{});
  EXPECT_EQ(numbers_of(raw("[7]")), Numbers{7});
  EXPECT_EQ(texts_of(raw("a,b")), (Texts{"a", "b"}));
  EXPECT_EQ(texts_of(raw("[a b]")), (Texts{"a", "b"}));
  EXPECT_EQ(texts_of(raw("a b,c")), (Texts{"a b", "c"}));  // commas take precedence over blanks
  EXPECT_EQ(texts_of(raw(R"(["a, b" 'c d'])")), (Texts{"a, b", "c d"}));
}

TEST(Settings, RawTextsMayBeQuoted) {
  EXPECT_EQ(key_text(raw(R"("13.4")")), "13.4");
  EXPECT_EQ(key_text(raw("'13.4'")), "13.4");
  EXPECT_EQ(key_text(raw(R"("13.4')")), R"("13.4')");  // not a pair
  EXPECT_EQ(key_text(raw("\"")), "\"");                // a single quote mark is not a pair
  EXPECT_EQ(key_text(raw(R"("")")), "");
  EXPECT_EQ(key_text(raw("")), "");
  EXPECT_EQ(key_text(raw("a b")), "a b");
}

TEST(Settings, RejectsAndQuotesInvalidRawValues) {
  const char* const no_lists[] = {"",      "a",   "1,",  ",1",    "1,,2", "[1", "1]",
                                  "1 2,3", "1;2", "nan", "1,inf", "0x10", "]["};
  for (const char* text : no_lists)
    EXPECT_EQ(
        refusal(raw(text), numbers_of),
        std::string("--set key: 'key' of controller 'c' expects a list of numbers such as 1,2; got '") + text + "'");
  for (const char* text : {"", "x", "1,2", "11", "-10.001", "nan", "inf", "1 2", "1m"})
    EXPECT_EQ(refusal(raw(text), number_of),
              std::string("--set key: 'key' of controller 'c' expects a number from -10 to 10; got '") + text + "'");
  for (const char* text : {"", "1", "yes", "True"})
    EXPECT_EQ(refusal(raw(text), [](Settings& s) { s.flag("key", false); }),
              std::string("--set key: 'key' of controller 'c' expects true or false; got '") + text + "'");
  expect_in("such as a,b; got 'a,,b'", refusal(raw("a,,b"), texts_of));
}

TEST(Settings, ValuesOfAFileKeepTheirTypes) {
  EXPECT_EQ(number_of(given(10.0)), 10.0);  // the largest
  EXPECT_EQ(numbers_of(given(Numbers{1, 2})), (Numbers{1, 2}));
  expect_in("from -10 to 10; got 10.5", refusal(given(10.5), number_of));
  expect_in("expects a text in quotes; got 13.4", refusal(given(13.4), key_text));
  expect_in("such as [1, 2]; got 1", refusal(given(1.0), numbers_of));
  expect_in("got ['a', 'b']", refusal(given(Texts{"a", "b"}), numbers_of));
  expect_in("got [1, 2.5]", refusal(given(Numbers{1, 2.5}), number_of));
  expect_in("got '1'", refusal(given(std::string("1")), number_of));
  expect_in("got true", refusal(given(true), key_text));
}

TEST(Settings, MisspeltKeysAndWordsGetASuggestion) {
  const auto refusal_after = [](Setting setting) {
    Settings settings("controller 'c'", {std::move(setting)});
    return refusal_of([&] {
      settings.number("speed", 0.0, 0.0, 1.0);
      settings.choice("side", "left", {"left", "right"});
      settings.require_all_read();
    });
  };
  EXPECT_EQ(refusal_after({"sped", RawText{""}, "--set sped: "}),
            "--set sped: controller 'c' has no setting 'sped'; did you mean 'speed'? Expected one of: side, speed");
  EXPECT_EQ(refusal_after({"gap", 1.0, "f:1: "}),
            "f:1: controller 'c' has no setting 'gap'; expected one of: side, speed");
  EXPECT_EQ(refusal_after({"side", std::string("rigth"), "f:1: "}),
            "f:1: 'side' of controller 'c' is 'rigth'; did you mean 'right'? Expected one of: left, right");
}

TEST(Settings, ReturnsTheFallbackWithoutTheKey) {
  Settings none("controller 'c'", {});
  EXPECT_EQ(none.number("key", 3.0, 0.0, 1.0), 3.0);
  EXPECT_EQ(none.text("key", "fallback"), "fallback");
  EXPECT_EQ(none.numbers("key", {4, 5}), (Numbers{4, 5}));
  none.require_all_read();
}

/// Each number of a controller at its limits, and the next numbers beyond.
TEST(Settings, RejectsNumbersBeyondTheirLimits) {
  traffic::Streets streets;
  streets.add(traffic::on_lane(streets.roads, "1.1", 4.0), "wander", {});
  world::Mover& mover = streets.world.movers[0];
  mover.sensors.emplace_back().type = "laser";
  const double fastest = mover.max_forward, turning = mover.max_turn;
  struct Range {
    const char *controller, *key;
    double below, first, last, above;
  };
  for (const Range& r : std::initializer_list<Range>{{"avoid", "speed", -0.1, 0.0, fastest, 1.001 * fastest},
                                                     {"avoid", "slow", -0.1, 0.0, 1e3, 1000.1},
                                                     {"avoid", "turn", -0.1, 0.0, 1e3, 1000.1},
                                                     {"avoid", "clear", -0.1, 500.0, 1e3, 1000.1},
                                                     {"avoid", "turn_speed", 0.0009, 0.001, turning, 1.001 * turning},
                                                     {"explore", "cell", 0.0049, 0.005, 1.0, 1.001},
                                                     {"explore", "speed", 0.0009, 1e-3, fastest, 1.001 * fastest},
                                                     {"explore", "slow", -0.1, 0.0, 1.0, 1.001},
                                                     {"explore", "turn_speed", 0.009, 1e-2, turning, 1.001 * turning},
                                                     {"explore", "margin", -0.1, 0.5, 1.0, 1.001},
                                                     {"explore", "map_width", 0.02, 0.03, 1.0, 1000.1},
                                                     {"explore", "map_left", -1.001e6, -1e6, 1e6, 1.001e6},
                                                     {"explore", "map_top", -1.001e6, -1e6, 1e6, 1.001e6},
                                                     {"patrol", "speed", 0.00009, 1e-4, fastest, 1.001 * fastest},
                                                     {"patrol", "turn_speed", 0.0009, 1e-3, turning, 1.001 * turning},
                                                     {"patrol", "pause", -0.1, 0.0, 1e6, 1.001e6},
                                                     {"patrol", "keep", -0.1, 0.0, 1e3, 1000.1},
                                                     {"route", "speed", 0.009, 0.01, fastest, 1.001 * fastest},
                                                     {"route", "gap", 0.009, 0.01, 100.0, 100.1},
                                                     {"route", "headway", 0.29, 0.3, 10.0, 10.1},
                                                     {"route", "radio", 0.49, 0.5, 1e6, 1.001e6},
                                                     {"route", "merge_behind", -1.0, 0.0, 4294967294.0, 4294967295.0},
                                                     {"convoy", "leader", -1.0, 0.0, 4294967294.0, 4294967295.0}}) {
    const auto refused = [&](double value) {
      const std::string name = r.controller;
      std::vector<Setting> all{{r.key, value, "f:1: "}};
      for (const std::string size : {"map_width", "map_height"})  // small maps
        if (name == "explore" && r.key != size) all.push_back({size, 0.4, ""});
      if (name == "patrol") all.push_back({"points", Numbers{0, 0, 1, 0}, ""});
      if (name == "route") all.push_back({"checkpoints", Numbers{6, 7}, ""});
      if (name == "convoy" && std::string(r.key) != "leader") all.push_back({"leader", 2.0, ""});
      Settings settings("controller '" + name + "'", std::move(all));
      const std::string said = refusal(std::move(settings), [&](Settings& s) {
        find_controller(name)->make({streets.world, 0, 1, &streets.roads}, s);
      });
      return said.find(std::string("'") + r.key + "' of controller") != std::string::npos;
    };
    EXPECT_FALSE(refused(r.first)) << r.controller << " " << r.key;
    EXPECT_FALSE(refused(r.last)) << r.controller << " " << r.key;
    EXPECT_TRUE(refused(r.below)) << r.controller << " " << r.key;
    EXPECT_TRUE(refused(r.above)) << r.controller << " " << r.key;
  }
}

}  // namespace
}  // namespace sf::control
