#include "netio/byte_line.h"

#include <poll.h>

namespace sf::netio {

std::size_t ByteLine::read(std::span<std::uint8_t> bytes) {
  if (lost_) return 0;
  flush();
  const auto received = receive(bytes);
  lost_ = lost_ || !received;
  return received.value_or(0);
}

bool ByteLine::write(std::span<const std::uint8_t> bytes) {
  flush();
  if (lost_ || waiting_.size() + bytes.size() > most_) return false;
  waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  flush();
  return true;
}

void ByteLine::flush() {
  if (lost_ || waiting_.empty()) return;
  const auto sent = send(waiting_);
  lost_ = !sent;
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(sent.value_or(0)));
}

void ByteLine::drain() {
  for (int tries = 0; tries < 10 && !lost_ && !waiting_.empty(); ++tries) {
    pollfd line{descriptor_.descriptor(), POLLOUT, 0};
    poll(&line, 1, 10);
    flush();
  }
}

}  // namespace sf::netio
