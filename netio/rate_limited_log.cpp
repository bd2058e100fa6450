#include "netio/rate_limited_log.h"

#include <poll.h>
#include <unistd.h>

#include <limits.h>
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/printable.h"
#include "base/time.h"

namespace sf::netio {

bool write_nonblocking(int descriptor, std::string_view text) {
  // A writable pipe accepts PIPE_BUF bytes without blocking. O_NONBLOCK is not set, because other processes may share
  // the pipe.
  pollfd writable{descriptor, POLLOUT, 0};
  if (poll(&writable, 1, 0) != 1 || (writable.revents & POLLOUT) == 0 || (writable.revents & POLLERR) != 0)
    return false;
  return ::write(descriptor, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF)) > 0;
}

void RateLimitedLog::write(std::string_view text, std::int64_t now) {
  allowed_ = std::min(kBurst, allowed_ + kLinesPerSecond * 1e-9 * static_cast<double>(now - last_));
  last_ = now;
  const std::uint64_t silent = left_out_ - reported_;
  const std::string line =
      fmt::format("sensorfarm: {}{}\n", base::one_line(text),
                  silent > 0 ? fmt::format(" ({} more lines were left out before this one)", silent) : "");
  if (allowed_ < 1.0 || !write_nonblocking(descriptor_, line)) {
    ++left_out_;
    return;
  }
  allowed_ -= 1.0;
  reported_ = left_out_;
}

std::uint64_t RepeatedEvent::count(std::int64_t now, std::uint64_t tolerated) {
  constexpr std::int64_t kPeriod = 10 * base::kSecond;
  if (count_ == 0 || (tolerated > 0 && now - since_ > kPeriod)) {
    count_ = 0;
    since_ = now;
  }
  ++count_;
  if (now < next_line_ || count_ < tolerated) return 0;
  next_line_ = now + kPeriod;
  return std::exchange(count_, 0);
}

std::string packets_text(std::uint64_t count) { return count == 1 ? "1 packet" : fmt::format("{} packets", count); }

}  // namespace sf::netio
