#pragma once
// Tracks calls of users' code (plug-ins, Python), to name the call that ends the process.
//
//   const base::PluginCall call("controller 'mine' of robot 'r0'", 3.2);   // around each call
//
// After `watch_plugin_calls`, a call of exit() by users' code ends the process with one line and exit code 1. A fatal
// signal ends it with one line and that signal.

#include <atomic>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

namespace sf::base {

/// Returns the time limit for exit handlers [s], 10 by default. Python's exit handlers wait for its threads.
double seconds_to_end();
/// Call it before threads and child processes exist. @param seconds in [1e-3, 1e6]
void set_seconds_to_end(double seconds);

/// The calls of one process. The parent process can read them if they are in shared memory.
struct PluginCalls {
  static constexpr int kThreads = 64;
  struct Call {
    std::atomic<std::uint32_t> number{0};  ///< odd while the call is under way
    double time = 0.0;                     ///< [s] simulated; NaN: none
    char who[148] = {};
  };
  Call calls[kThreads];               ///< one per living thread that has made a call; further threads are not tracked
  std::atomic<int> blamed{-1};        ///< row of the call that called exit() or received a fatal signal; -1: none
  std::atomic<bool> finished{false};  ///< the program reached its own end
  std::atomic<int> code{0};           ///< [1] exit code at that end, before exit handlers change it
};

/// Marks one call on the thread that makes it. Has no effect within another call. If the call forks the process and
/// returns in the copy, the copy ends here, because only one process may drive the robots.
class PluginCall {
 public:
  /// @param who "controller 'mine' of robot 'r0'"; truncated to 147 bytes
  /// @param time [s] simulated; NaN: none
  explicit PluginCall(std::string_view who, double time = std::nan(""));
  ~PluginCall();
  PluginCall(const PluginCall&) = delete;
  PluginCall& operator=(const PluginCall&) = delete;

 private:
  PluginCalls::Call* call_;
};

/// Records the calls of this process in `calls`, whose owner reports how the process ends. Null: uses the process's own
/// memory.
void share_plugin_calls(PluginCalls* calls);

/// Installs handlers for exit(), quick_exit() and those fatal signals that have no handler. For programs, not for
/// libraries.
void watch_plugin_calls();
/// Call it after loading a user's library: exit() runs the newest handler first, so this one runs before the library's.
/// Does nothing without `watch_plugin_calls`.
void renew_plugin_watch();

/// Marks any later exit() as the program's own. If plug-ins were called and no parent supervises the process, it ends
/// with one line if it still runs after seconds_to_end(). @param code exit code
void finish_plugin_calls(int code);

/// Names the call that ended the process: "controller 'a' of robot 'b' ended the process (exit code 0) at 3.200 s
/// simulated". Empty if no call was under way.
/// @param how "exit code 0"
std::string blame(const PluginCalls& calls, const std::string& how);

/// Names the calls under way: "controller 'a' of robot 'b' at 3.200 s simulated". Empty if there are none.
std::string under_way(const PluginCalls& calls);

/// Returns "a thread of controller 'a' of robot 'b' is still running", naming the plug-ins called last, one of which
/// keeps the process from ending.
std::string goes_on(const PluginCalls& calls);

/// Returns e.g. "signal 11, Segmentation fault".
std::string signal_text(int signal);

}  // namespace sf::base
