#pragma once
// SIGINT (Ctrl-C), SIGTERM and SIGHUP request a stop. Loops stop at the next point where their output is complete.

#include <atomic>
#include <chrono>
#include <stdexcept>

namespace sf::apps {

/// True once one of them was received. A second signal ends the program at once.
const std::atomic<bool>& stop_requested();

/// A command was stopped before its work was complete. `main` prints the message and exits with `interrupted_code`.
class Incomplete : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// For commands that write several files, each of them complete. @throws Incomplete if a stop was requested
void heed_stop(const char* what = "interrupted: written files are complete, others are missing");

/// Exit code of such a command: 128 plus the signal's number, as in shells (130 after Ctrl-C).
int interrupted_code();
/// Sets one exit code for all signals (--interrupted-code). @param code in [0, 255]
void set_interrupted_code(int code);

/// Sets the counter that the handlers increment, for a parent that forwards other signals
/// (apps/processes/supervision.h).
void count_stops(std::atomic<unsigned>* count);

/// Installs the handlers, except for SIGHUP if it is ignored (nohup). Call once, before the loop.
void install_stop_handlers();

/// Call after the program's end, when `stop_requested` is no longer polled: the signals then end the process, unless a
/// parent counts them and ends it.
void remove_stop_handlers();

/// Sleeps until `seconds` [s] have passed since `start`; returns at once if they have, and within 50 ms of a stop
/// request.
void keep_pace(std::chrono::steady_clock::time_point start, double seconds);

}  // namespace sf::apps
