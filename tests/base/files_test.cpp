#include "base/files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "tests/refusal.h"

namespace sf::base {

namespace {

std::string file_with(const std::string& text) {
  const std::string file = (std::filesystem::temp_directory_path() / "lines.txt").string();
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

std::vector<std::string> lines_of(const std::string& text) {
  LineFile lines(file_with(text));
  std::vector<std::string> all;
  for (std::string_view line; lines.next(line);) {
    all.emplace_back(line);
    EXPECT_EQ(lines.number(), static_cast<int>(all.size()));
  }
  return all;
}

TEST(LineFile, LinesExcludeTheirEnds) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(lines_of(""), Lines());
  EXPECT_EQ(lines_of("\n"), Lines({""}));
  EXPECT_EQ(lines_of("a\nb"), Lines({"a", "b"}));
  EXPECT_EQ(lines_of("a\r\n\nb\n"), Lines({"a", "", "b"}));
  EXPECT_EQ(lines_of("a\rb\n"), Lines({"a\rb"}));
}

TEST(LineFile, LinesMaySpanBlocks) {  // a block is 1 MiB
  for (const std::size_t first : {(1u << 20) - 2, (1u << 20) - 1, 1u << 20, (1u << 20) + 1, 3u << 20}) {
    const auto lines = lines_of(std::string(first, 'a') + "\nb\n" + std::string(first, 'c'));
    ASSERT_EQ(lines.size(), 3u) << first;
    EXPECT_EQ(lines[0].size(), first);
    EXPECT_EQ(lines[1], "b");
    EXPECT_EQ(lines[2], std::string(first, 'c'));
  }
}

TEST(LineFile, RejectsEndlessLine) {
  const std::string file = file_with("a\n");
  std::filesystem::resize_file(file, 64u << 20);  // zeros
  LineFile lines(file);
  std::string_view line;
  EXPECT_TRUE(lines.next(line));
  expect_in("lines.txt:2: a line of more than 16 MiB, the limit", refusal_of([&] { lines.next(line); }));
}

TEST(LineFile, ExtendAndShrinkAreInverse) {
  for (const std::size_t first :
       {std::size_t{0}, std::size_t{3}, (std::size_t{1} << 20) - 2, (std::size_t{1} << 20) - 1,
        std::size_t{1} << 20}) {  // the first line end is at the end of a block
    const std::string a(first, 'a');
    LineFile lines(file_with(a + "\r\nb\nc"));
    std::string_view line;
    ASSERT_TRUE(lines.next(line));
    EXPECT_TRUE(lines.extend(line));
    EXPECT_EQ(line, a + "\r\nb");
    EXPECT_TRUE(lines.extend(line));
    EXPECT_EQ(line, a + "\r\nb\nc");
    EXPECT_EQ(lines.number(), 1);
    EXPECT_EQ(lines.last_number(), 3);
    EXPECT_FALSE(lines.extend(line));
    lines.shrink(line);
    EXPECT_EQ(line, a);
    ASSERT_TRUE(lines.next(line));
    EXPECT_EQ(line, "b");
    EXPECT_EQ(lines.number(), 2);
    EXPECT_TRUE(lines.extend(line));
    EXPECT_FALSE(lines.next(line)) << "an appended line is not returned again";
  }
  LineFile lines(file_with("a\n"));
  std::string_view line;
  ASSERT_TRUE(lines.next(line));
  EXPECT_FALSE(lines.extend(line)) << "a line end at the end of the file begins no line";
}

TEST(LineFile, ExtendStopsAtTheLimit) {
  const std::string file = file_with("a\n");
  std::filesystem::resize_file(file, 64u << 20);
  LineFile lines(file);
  std::string_view line;
  ASSERT_TRUE(lines.next(line));
  EXPECT_FALSE(lines.extend(line));
  EXPECT_EQ(line, "a");
}

TEST(LineFile, RejectsMissingFile) {
  expect_in("no such file", refusal_of([] { LineFile("/nowhere/at.all"); }));
  expect_in("a folder, a device or a pipe", refusal_of([] { LineFile("/dev/zero"); }));
  const std::string pipe = (std::filesystem::temp_directory_path() / "pipe").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_in("a folder, a device or a pipe", refusal_of([&] { LineFile{pipe}; }));
}

/// Files of the kernel report a size of 0 bytes.
TEST(ReadBytes, ReadsBeyondTheReportedSize) {
  const std::string file = "/proc/version";
  ASSERT_EQ(std::filesystem::file_size(file), 0u);
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  const std::size_t size = text.str().size();
  ASSERT_GT(size, 8u);
  EXPECT_EQ(read_bytes(file, size), text.str());
  EXPECT_EQ(read_bytes(file, std::size_t{1} << 62), text.str()) << "as much memory as the content needs";
  expect_in("/proc/version: larger than 0 MiB", refusal_of([&] { read_bytes(file, size - 1); }));
}

}  // namespace

}  // namespace sf::base
