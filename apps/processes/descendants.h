#pragma once
// Processes that children of this process leave running.

#include <sys/types.h>

#include <set>

namespace sf::apps {

/// While it exists, processes whose parents end become children of this process (PR_SET_CHILD_SUBREAPER) instead of
/// init's, so that none escapes. Only one instance at a time.
class Descendants {
 public:
  Descendants();
  ~Descendants();
  Descendants(const Descendants&) = delete;
  Descendants& operator=(const Descendants&) = delete;

  /// Kills all children started since construction, and the children that these leave behind, and waits at most 1 s for
  /// them. @param spared children to keep
  void end(const std::set<pid_t>& spared = {}) const;

 private:
  std::set<pid_t> before_;
};

}  // namespace sf::apps
