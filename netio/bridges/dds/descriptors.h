#pragma once
// Implementations of DDS do not survive it where descriptors run out as they start.

#include <fcntl.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace sf::bridges {

/// @throws std::runtime_error where fewer than `needed` more files and sockets may be opened
inline void require_descriptors(std::size_t needed) {
  std::vector<int> opened;
  while (opened.size() < needed) {
    const int one = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (one < 0) break;
    opened.push_back(one);
  }
  for (const int one : opened) ::close(one);
  if (opened.size() < needed)
    throw std::runtime_error("only " + std::to_string(opened.size()) + " more files and sockets may be opened, and " +
                             std::to_string(needed) + " are needed; raise the limit (ulimit -n)");
}

}  // namespace sf::bridges
