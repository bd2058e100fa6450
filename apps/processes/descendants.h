#pragma once
// Processes that children of this one leave running.

#include <sys/types.h>

#include <set>

namespace sf::apps {

/// From its construction on, processes whose parents end become children of this one (PR_SET_CHILD_SUBREAPER) in place
/// of init's, so that none escapes. One at a time.
class Descendants {
 public:
  Descendants();
  ~Descendants();
  Descendants(const Descendants&) = delete;
  Descendants& operator=(const Descendants&) = delete;

  /// Kills all children that this process did not have before, and what these leave in turn, and waits for them for 1 s
  /// at most. @param spared children that go on
  void end(const std::set<pid_t>& spared = {}) const;

 private:
  std::set<pid_t> before_;
};

}  // namespace sf::apps
