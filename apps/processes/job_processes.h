#pragma once
// A list of jobs, done by child processes: one that crashes costs its job and no other.

#include <cstddef>
#include <functional>
#include <string>

namespace sf::apps {

struct JobCalls {
  /// Called once in each child, before its first job. Makes what its jobs share, such as a device.
  std::function<void()> begin;
  /// Does job `row`, in a child. Failures of the job itself are its own affair; an exception ends all (below).
  std::function<void(std::size_t row)> run;
  /// Called in the parent when the child that did `row` died.
  /// @param cause "its process was ended by signal 9 (Killed)", or with the plug-in's call that did it
  std::function<void(std::size_t row, const std::string& cause)> died;
  /// Called in the parent when `row` came to its end. May be empty; only with `own_processes`.
  std::function<void(std::size_t row)> ended;
  /// Called in the parent about a hundred times a second. @param done number of jobs that came to an end
  std::function<void(std::size_t done)> wait;
  std::function<bool()> stop;  ///< polled in the parent; true ends the children at once
  /// Each job has a child of its own, which ends by exit(), so that all is written that plug-ins have printed.
  bool own_processes = false;
  double timeout = 0.0;  ///< [s] of wall-clock time per job, after which its child is killed; 0: none
};

/// Does jobs 0 to `count` - 1, in no particular order, in up to `processes` children. They die with the parent, and
/// processes that they start die with them. The caller has no other threads and no device: children are forks.
/// @param processes at least 1
/// @return false when `stop` ended it
/// @throws base::InputError or base::DeviceError that a child's `begin` or `run` threw; the others are ended
bool run_in_processes(std::size_t count, unsigned processes, const JobCalls& calls);

}  // namespace sf::apps
