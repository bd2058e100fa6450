#pragma once
// Runs a list of jobs in child processes. A crash fails only its own job.

#include <cstddef>
#include <functional>
#include <string>

namespace sf::apps {

struct JobCalls {
  /// Called once in each child, before its first job. Creates objects shared by its jobs, such as a device.
  std::function<void()> begin;
  /// Runs job `row` in a child. It handles failures of the job itself; an exception ends all jobs (see below).
  std::function<void(std::size_t row)> run;
  /// Called in the parent after the child that ran `row` died.
  /// @param cause "its process was ended by signal 9 (Killed)", or the plug-in's call that caused it
  std::function<void(std::size_t row, const std::string& cause)> died;
  /// Called in the parent when `row` has finished. May be empty; only with `own_processes`.
  std::function<void(std::size_t row)> ended;
  /// Called in the parent about a hundred times a second. @param done number of finished jobs
  std::function<void(std::size_t done)> wait;
  std::function<bool()> stop;  ///< polled in the parent; true ends the children at once
  /// Runs each job in a separate child, which ends with exit(), so that buffered output of plug-ins is written.
  bool own_processes = false;
  double timeout = 0.0;  ///< [s] wall-clock time per job, after which its child is killed; 0: unlimited
};

/// Runs jobs 0 to `count` - 1, in any order, in up to `processes` children. The children die with the parent, and
/// processes started by them die with them. The caller must have no other threads and no device, since children are
/// forks.
/// @param processes at least 1
/// @return false if `stop` ended it
/// @throws base::InputError or base::DeviceError thrown by a child's `begin` or `run`; all other children are ended
bool run_in_processes(std::size_t count, unsigned processes, const JobCalls& calls);

}  // namespace sf::apps
