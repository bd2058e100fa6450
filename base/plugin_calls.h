#pragma once
// Calls of users' code (plug-ins, Python) under way, so that the one that ends the process is named.
//
//   const base::PluginCall call("controller 'mine' of robot 'r0'", 3.2);   // around each call
//
// After `watch_plugin_calls`, exit() by users' code ends the process with one line and exit code 1, a fatal signal with
// one line and that signal.

#include <atomic>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

namespace sf::base {

/// [s] for exit handlers, since those of Python wait for its threads: 10 unless set.
double seconds_to_end();
/// @param seconds in [1e-3, 1e6]. To be called before threads and child processes exist.
void set_seconds_to_end(double seconds);

/// The calls of one process. Its parent can read them where they are in shared memory.
struct PluginCalls {
  static constexpr int kThreads = 64;
  struct Call {
    std::atomic<std::uint32_t> number{0};  ///< odd: under way
    double time = 0.0;                     ///< [s] simulated; NaN: none
    char who[148] = {};
  };
  Call calls[kThreads];               ///< per living thread that has made one; more threads are not seen
  std::atomic<int> blamed{-1};        ///< row of the call that called exit() or got a fatal signal; -1: none
  std::atomic<bool> finished{false};  ///< the program has come to its own end
  std::atomic<int> code{0};           ///< [1] exit code of that end, whatever exit handlers make of it
};

/// One call, on the thread that makes it. Within another call it has no effect. Where the call returns in a copy of the
/// process that it has forked, the copy ends here: one process drives the robots.
class PluginCall {
 public:
  /// @param who "controller 'mine' of robot 'r0'"; at most 147 bytes are kept
  /// @param time [s] simulated; NaN: none
  explicit PluginCall(std::string_view who, double time = std::nan(""));
  ~PluginCall();
  PluginCall(const PluginCall&) = delete;
  PluginCall& operator=(const PluginCall&) = delete;

 private:
  PluginCalls::Call* call_;
};

/// Notes the calls of this process in `calls`, whose owner reports how it ends; null: in memory of its own.
void share_plugin_calls(PluginCalls* calls);

/// Installs handlers of exit(), quick_exit() and fatal signals that have none. For programs, not for libraries.
void watch_plugin_calls();
/// To be called after a library of a user is loaded: the newest handler of exit() runs first, before the library's.
/// Without `watch_plugin_calls` it does nothing.
void renew_plugin_watch();

/// From now on exit() is the program's own. Without a parent that watches, a process whose plug-ins were called and
/// that goes on for seconds_to_end() ends with one line. @param code exit code
void finish_plugin_calls(int code);

/// Names the call that ended the process: "controller 'a' of robot 'b' ended the process (exit code 0) at 3.200 s
/// simulated". Empty: no call was under way.
/// @param how "exit code 0"
std::string blame(const PluginCalls& calls, const std::string& how);

/// Calls under way: "controller 'a' of robot 'b' at 3.200 s simulated". Empty: none.
std::string under_way(const PluginCalls& calls);

/// "a thread of controller 'a' of robot 'b' goes on": plug-ins that were called last, one of which keeps the process
/// from its end.
std::string goes_on(const PluginCalls& calls);

/// "signal 11, Segmentation fault"
std::string signal_text(int signal);

}  // namespace sf::base
