#pragma once
// Keeps tests that run at the same time in separate DDS domains.

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace sf::ros2 {

/// Takes a free domain, by a lock that the process keeps.
inline std::uint32_t reserve_domain() {
  constexpr std::uint32_t kDomains = 230;
  const auto first = static_cast<std::uint32_t>(getpid());
  for (std::uint32_t k = 0; k < kDomains; ++k) {
    const std::uint32_t domain = 1 + (first + k) % kDomains;
    const auto file =
        std::filesystem::temp_directory_path() / ("sensorfarm_test_domain_" + std::to_string(domain) + ".lock");
    const int lock = open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
    if (lock >= 0 && flock(lock, LOCK_EX | LOCK_NB) == 0) return domain;
    if (lock >= 0) close(lock);
  }
  return 1 + first % kDomains;
}

/// Returns this process's domain, which no other test has until the process ends.
inline std::uint32_t own_domain() {
  static const std::uint32_t domain = reserve_domain();
  return domain;
}

}  // namespace sf::ros2
