#include "apps/processes/descendants.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

namespace sf::apps {

namespace {

/// Parses /proc's "PID (NAME) STATE PARENT ..."; NAME may contain spaces and parentheses. Returns 0 if the process has
/// ended.
pid_t parent_of(const std::filesystem::path& process) {
  std::string text;
  std::getline(std::ifstream(process / "stat"), text);
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos || name_end + 4 > text.size()) return 0;
  return static_cast<pid_t>(std::atol(text.c_str() + name_end + 4));
}

std::set<pid_t> children() {
  std::set<pid_t> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
    const pid_t pid = std::atoi(entry.path().filename().c_str());
    if (pid > 0 && parent_of(entry.path()) == getpid()) found.insert(pid);
  }
  return found;
}

}  // namespace

Descendants::Descendants() : before_(children()) { prctl(PR_SET_CHILD_SUBREAPER, 1); }

Descendants::~Descendants() { prctl(PR_SET_CHILD_SUBREAPER, 0); }

void Descendants::end(const std::set<pid_t>& spared) const {
  for (int turn = 0; turn < 100; ++turn) {
    bool any = false;
    for (const pid_t pid : children()) {
      if (before_.count(pid) > 0 || spared.count(pid) > 0) continue;
      any = true;
      kill(pid, SIGKILL);
      waitpid(pid, nullptr, WNOHANG);
    }
    if (!any) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

}  // namespace sf::apps
