// Untrusted text that is printed to a terminal.

#include "base/printable.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace sf::base {
namespace {

TEST(Printable, KeepsPlainText) {
  for (const char* text : {"", "plain", "two\nlines\tand a tab", "Grüße, 日本, 🤖", "~"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, EscapesControlCharacters) {
  EXPECT_EQ(printable("\x1b[2J"), "\\x1b[2J");          // clears a terminal
  EXPECT_EQ(printable("a\rb\x07"), "a\\x0db\\x07");     // carriage return and bell
  EXPECT_EQ(printable(std::string("\0", 1)), "\\x00");  // terminates a C string
  EXPECT_EQ(printable("\x7f"), "\\x7f");                // deletes
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "\\xc2\\x9b2J");                     // same as ESC [ in one character
  EXPECT_EQ(printable("\xc2\xa0"), "\xc2\xa0");  // first character after the control characters
}

TEST(Printable, EscapesInvalidUtf8) {
  EXPECT_EQ(printable("\x80"), "\\x80");  // continuation byte without a start
  EXPECT_EQ(printable("\xc3"), "\\xc3");  // truncated
  EXPECT_EQ(printable("\xe2\x82"
                      "x"),
            "\\xe2\\x82x");                        // truncated by another character
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b");  // ESC in two bytes
}

/// The first and the last sequence of each size and of each range that is invalid in UTF-8, with their neighbours.
TEST(Printable, ChecksSequenceLimits) {
  const char* const valid[] = {"\x7e",
                               "\xc2\xa0",
                               "\xdf\xbf",
                               "\xe0\xa0\x80",
                               "\xed\x9f\xbf",
                               "\xee\x80\x80",
                               "\xef\xbf\xbf",
                               "\xf0\x90\x80\x80",
                               "\xf3\x8f\xbf\xbf",
                               "\xf0\xbf\xbf\xbf",
                               "\xf4\x8f\xbf\xbf",
                               "\xf4\x80\x80\x80"};
  for (const char* text : valid) EXPECT_EQ(printable(text), text);
  const char* const others[] = {
      "\xc1\xbf",     "\xe0\x9f\xbf", "\xed\xa0\x80", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80",
      "\xe2\x82\xc0", "\xc3\x7f",     "\xff",         "\xf0\x90\x80"};
  for (const char* text : others) {
    std::string numbers;
    for (const char* at = text; *at != 0; ++at) numbers += fmt::format("\\x{:02x}", static_cast<unsigned char>(*at));
    EXPECT_EQ(printable(text), numbers);
  }
  for (const char* text : {"\x1f", "\x01", "\xc2\x9f", "\xc2\x80"})
    EXPECT_EQ(printable(text).front(), '\\') << "controls";
  EXPECT_EQ(printable(" "), " ");
}

TEST(Printable, OneLineReplacesLineBreaks) {
  EXPECT_EQ(one_line("red\x1b[0m\r\n\n sensorfarm: all is well"), "red\\x1b[0m  sensorfarm: all is well");
  EXPECT_EQ(one_line("a\tb\n"), "a b ");
}

}  // namespace
}  // namespace sf::base
