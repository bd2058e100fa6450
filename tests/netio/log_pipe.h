#pragma once
// Reads the lines that a log writes, through a pipe.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <string>

namespace sf::netio {

/// Lines of a log.
struct LogPipe {
  std::array<int, 2> ends{};
  LogPipe() { EXPECT_EQ(pipe2(ends.data(), O_NONBLOCK), 0); }
  ~LogPipe() { close(ends[0]), close(ends[1]); }
  int descriptor() const { return ends[1]; }
  std::string read_all() const {
    std::string text;
    char bytes[4096];
    for (ssize_t n = 0; (n = ::read(ends[0], bytes, sizeof bytes)) > 0;)
      text.append(bytes, static_cast<std::size_t>(n));
    return text;
  }
};

}  // namespace sf::netio
