#pragma once
// SIGINT (Ctrl-C), SIGTERM and SIGHUP ask for a stop; the loop ends where it is whole.

#include <atomic>
#include <chrono>
#include <stdexcept>

namespace sf::apps {

/// Set once one of them came. A second one ends the program at once.
const std::atomic<bool>& stop_requested();

/// A command was stopped before its work was complete: `main` prints the message and exits with `interrupted_code`.
class Incomplete : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// For commands that write several files, each of them whole. @throws Incomplete when a stop was requested
void heed_stop(const char* what = "interrupted: the files that were written are whole, others are not there");

/// Exit code of such a command: as shells have it, 128 and the signal's number (130 after Ctrl-C).
int interrupted_code();
/// Another code for all signals (--interrupted-code). @param code in [0, 255]
void set_interrupted_code(int code);

/// Where the handlers count the signals that come, for a parent that passes on others (apps/processes/supervision.h).
void count_stops(std::atomic<unsigned>* count);

/// Takes the signals over, but for a SIGHUP that is ignored (nohup). To be called once, before the loop.
void install_stop_handlers();

/// To be called after the program's end, when nothing looks at `stop_requested` any more: the signals end the process,
/// unless a parent counts them and does.
void remove_stop_handlers();

/// Sleeps until `seconds` [s] have passed since `start`, not at all when they have; ends within 50 ms of a request to
/// stop.
void keep_pace(std::chrono::steady_clock::time_point start, double seconds);

}  // namespace sf::apps
