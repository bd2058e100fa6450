#pragma once
// SIGINT (Ctrl-C), SIGTERM and SIGHUP ask for a stop; the loop ends where it is whole.

#include <atomic>
#include <chrono>

namespace sf::apps {

/// Set once one of them came. A second one ends the program at once.
const std::atomic<bool>& stop_requested();

/// Takes the signals over, but for a SIGHUP that is ignored (nohup). To be called once, before the loop.
void install_stop_handlers();

/// Sleeps until `seconds` [s] have passed since `start`, not at all when they have; ends within 50 ms of a request to
/// stop.
void keep_pace(std::chrono::steady_clock::time_point start, double seconds);

}  // namespace sf::apps
