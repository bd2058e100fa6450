#include "robots/khepera_protocol.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/units.h"

namespace sf::robots {
namespace {

TEST(Khepera, SaturatesWheelsAlongTheArc) {
  struct Case {
    base::Twist twist;
    int left, right;
    const char* why;
  };
  for (const Case& c : std::vector<Case>{{{0.1, 0, 0}, 12, 12, "straight: 8.3 mm/s per unit"},
                                         {{0, 0, 1}, -3, 3, "in place: half a track each"},
                                         {{-0.5, 0, 0}, -60, -60, "backwards"},
                                         {{2.0, 0, 0}, 127, 127, "too fast"},
                                         {{1.0583, 0, 20}, 43, 127, "the slower wheel slows down alike"},
                                         {{kNaN, 0, 1}, 0, 0, "not a number"},
                                         {{0.1, 0, kInf}, 0, 0, "infinite"},
                                         {{1e308, 0, 1e308}, 0, 0, "the wheels' speed overflows"}}) {
    const KheperaWheels wheels = khepera_wheels(c.twist, 0.052);
    EXPECT_EQ(wheels.left, c.left) << c.why;
    EXPECT_EQ(wheels.right, c.right) << c.why;
  }
}

TEST(Khepera, EncodesCommands) {
  const auto text = [](const base::Bytes& bytes) { return std::string(bytes.begin(), bytes.end()); };
  EXPECT_EQ(text(khepera_command('D', {5, -3})), "D,5,-3\n");
  EXPECT_EQ(text(khepera_command('N')), "N\n");
}

TEST(Khepera, ParsesAnswersStrictly) {
  EXPECT_EQ(parse_khepera("d")->letter, 'd');
  EXPECT_TRUE(parse_khepera("d")->numbers.empty());
  EXPECT_EQ(parse_khepera("h,-12,345")->numbers, (std::vector<std::int64_t>{-12, 345}));
  for (const char* wrong : {"", "H,1", "h1", "h,", "h,1,", "h,1,,2", "h,1 ", "h,+1", "h,1.5", "h,2147483648", ",1"})
    EXPECT_FALSE(parse_khepera(wrong)) << wrong;
}

TEST(KheperaLines, SplitAtAnyLineEnd) {
  KheperaLines lines;
  std::vector<std::string> all;
  for (const char c : std::string("d\r\n\r\nh,1,2\nn\r\r\n") + std::string(200, 'x') + "\ng\n")
    if (const auto line = lines.take(static_cast<std::uint8_t>(c))) all.push_back(*line);
  EXPECT_EQ(all, (std::vector<std::string>{"d", "h,1,2", "n", "g"}));
  EXPECT_EQ(lines.skipped(), 200u) << "too long";
}

TEST(KheperaLines, AcceptAnyBytes) {
  KheperaLines lines;
  std::mt19937 random(7);
  constexpr std::string_view kAlphabet = "hn,-0123456789\r\n";
  for (int k = 0; k < 100'000; ++k) {
    const auto byte = static_cast<std::uint8_t>(random() % 8 == 0 ? random() : kAlphabet[random() % kAlphabet.size()]);
    if (const auto line = lines.take(byte)) {
      EXPECT_LE(line->size(), KheperaLines::kMostBytes);
      parse_khepera(*line);
    }
  }
  lines.take('\n');
  for (const char c : std::string("h,1")) EXPECT_FALSE(lines.take(static_cast<std::uint8_t>(c)));
  EXPECT_EQ(lines.take('\n'), "h,1");
}

}  // namespace
}  // namespace sf::robots
