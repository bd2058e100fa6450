// Values from files, which have a type, and from the command line, whose type is that of the reader.

#include "control/settings.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace sf::control {
namespace {

using Numbers = std::vector<double>;
using Texts = std::vector<std::string>;

Settings given(Value value) { return {"controller 'c'", {{"key", std::move(value), "--set key: "}}}; }
Settings raw(const std::string& text) { return given(RawText{text}); }

template <class Read>
std::string refusal(Settings settings, Read&& read) {
  try {
    read(settings);
  } catch (const base::InputError& error) {
    return error.what();
  }
  return "";
}

double number_of(Settings settings) { return settings.number("key", -1.0, -10.0, 10.0); }
std::string text_of(Settings settings) { return settings.text("key", "fallback"); }
Numbers numbers_of(Settings settings) { return settings.numbers("key", {}); }
Texts texts_of(Settings settings) { return settings.texts("key", {}); }

TEST(Settings, RawValuesBecomeWhatTheyAreReadAs) {
  EXPECT_EQ(number_of(raw("1")), 1.0);
  EXPECT_EQ(numbers_of(raw("1")), Numbers{1.0});  // a list of one
  EXPECT_EQ(text_of(raw("1")), "1");
  EXPECT_EQ(texts_of(raw("1")), Texts{"1"});
  EXPECT_EQ(text_of(raw("13.10")), "13.10");  // the trailing zero of a spot's name is kept
  EXPECT_EQ(text_of(raw("true")), "true");
  EXPECT_TRUE(raw("true").flag("key", false));
  EXPECT_FALSE(raw(" false ").flag("key", true));
}

TEST(Settings, RawListsAreWrittenInAnyOfTheUsualWays) {
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

TEST(Settings, RawTextsMayHaveQuotesAroundThem) {
  EXPECT_EQ(text_of(raw(R"("13.4")")), "13.4");
  EXPECT_EQ(text_of(raw("'13.4'")), "13.4");
  EXPECT_EQ(text_of(raw(R"("13.4')")), R"("13.4')");  // not a pair
  EXPECT_EQ(text_of(raw("\"")), "\"");                // a single quote mark is no pair
  EXPECT_EQ(text_of(raw(R"("")")), "");
  EXPECT_EQ(text_of(raw("")), "");
  EXPECT_EQ(text_of(raw("a b")), "a b");
}

TEST(Settings, InvalidRawValuesAreRefusedAndQuoted) {
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
  EXPECT_NE(refusal(raw("a,,b"), texts_of).find("such as a,b; got 'a,,b'"), std::string::npos);
}

TEST(Settings, ValuesOfAFileKeepTheirTypes) {
  EXPECT_EQ(number_of(given(10.0)), 10.0);  // the largest
  EXPECT_EQ(numbers_of(given(Numbers{1, 2})), (Numbers{1, 2}));
  EXPECT_NE(refusal(given(10.5), number_of).find("from -10 to 10; got 10.5"), std::string::npos);
  EXPECT_NE(refusal(given(13.4), text_of).find("expects a text in quotes; got 13.4"), std::string::npos);
  EXPECT_NE(refusal(given(1.0), numbers_of).find("such as [1, 2]; got 1"), std::string::npos);
  EXPECT_NE(refusal(given(Texts{"a", "b"}), numbers_of).find("got ['a', 'b']"), std::string::npos);
  EXPECT_NE(refusal(given(Numbers{1, 2.5}), number_of).find("got [1, 2.5]"), std::string::npos);
  EXPECT_NE(refusal(given(std::string("1")), number_of).find("got '1'"), std::string::npos);
  EXPECT_NE(refusal(given(true), text_of).find("got true"), std::string::npos);
}

TEST(Settings, WithoutTheKeyTheFallbackCounts) {
  Settings none("controller 'c'", {});
  EXPECT_EQ(none.number("key", 3.0, 0.0, 1.0), 3.0);
  EXPECT_EQ(none.text("key", "fallback"), "fallback");
  EXPECT_EQ(none.numbers("key", {4, 5}), (Numbers{4, 5}));
  none.require_all_read();
}

}  // namespace
}  // namespace sf::control
