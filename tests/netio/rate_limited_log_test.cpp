// Log lines of a running service: non-blocking and limited in rate.

#include "netio/rate_limited_log.h"
#include "tests/units.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <string>

namespace sf::netio {
namespace {

struct Pipe {
  std::array<int, 2> ends{};
  Pipe() { EXPECT_EQ(pipe(ends.data()), 0); }
  ~Pipe() {
    for (const int end : ends)
      if (end >= 0) close(end);
  }
  /// Reads all data in the pipe.
  std::string read_all() const {
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    std::string text;
    char bytes[4096];
    for (ssize_t n = 0; (n = read(ends[0], bytes, sizeof bytes)) > 0;) text.append(bytes, static_cast<std::size_t>(n));
    return text;
  }
};

TEST(RateLimitedLog, WritesLines) {
  const Pipe pipe;
  RateLimitedLog log(pipe.ends[1]);
  log.write("one", 0);
  log.write("two", 1);
  EXPECT_EQ(pipe.read_all(), "sensorfarm: one\nsensorfarm: two\n");
  EXPECT_EQ(log.left_out(), 0u);
}

/// Writes a burst, then at a limited rate. The first line after a gap states the number of missing lines.
TEST(RateLimitedLog, LimitsAndCountsAFlood) {
  const Pipe pipe;
  RateLimitedLog log(pipe.ends[1]);
  for (int i = 0; i < 1000; ++i) log.write("flood", 0);
  EXPECT_EQ(log.left_out(), 1000 - static_cast<std::uint64_t>(RateLimitedLog::kBurst));
  pipe.read_all();
  log.write("later", kSecond);
  EXPECT_EQ(pipe.read_all(), "sensorfarm: later (980 more lines were left out before this one)\n");
  log.write("at once", kSecond);
  EXPECT_EQ(pipe.read_all(), "sensorfarm: at once\n");
}

/// With a full pipe `write` returns, and continues once the pipe is read.
TEST(RateLimitedLog, UnreadPipeDoesNotBlock) {
  const Pipe pipe;
  RateLimitedLog log(pipe.ends[1]);
  const std::string text(1000, 'x');
  for (int i = 0; i < 500; ++i) log.write(text, i * kSecond);
  EXPECT_GT(log.left_out(), 300u) << "64 KiB fit into a pipe";
  pipe.read_all();
  log.write("read", 501 * kSecond);
  EXPECT_NE(pipe.read_all().find("sensorfarm: read ("), std::string::npos);
}

/// Without a reader no signal ends the program.
TEST(RateLimitedLog, ClosedPipeDoesNotEndTheProgram) {
  Pipe pipe;
  close(pipe.ends[0]);
  pipe.ends[0] = -1;
  RateLimitedLog log(pipe.ends[1]);
  log.write("lost", 0);
  EXPECT_EQ(log.left_out(), 1u);
}

}  // namespace
}  // namespace sf::netio
