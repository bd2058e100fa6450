#include "apps/reports/progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "netio/rate_limited_log.h"

namespace sf::apps {

Progress::Progress(std::string what) : what_(std::move(what)), on_terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (drawn_) netio::write_nonblocking(STDERR_FILENO, "\r\033[K");
}

void Progress::clear() {
  if (isatty(STDERR_FILENO) == 1) netio::write_nonblocking(STDERR_FILENO, "\r\033[K");
}

void Progress::show(double part, const std::string& note) {
  const auto now = std::chrono::steady_clock::now();
  if (!on_terminal_ || now < next_) return;
  next_ = now + std::chrono::milliseconds(100);
  constexpr int kWidth = 30;
  const int done = static_cast<int>(std::clamp(part, 0.0, 1.0) * kWidth);
  const std::string line =
      fmt::format("\r\033[K{} [{:#<{}}{:.<{}}] {:3.0f} % {}", what_, "", done, "", kWidth - done, 100.0 * part, note);
  drawn_ = netio::write_nonblocking(STDERR_FILENO, line) || drawn_;
}

}  // namespace sf::apps
