#pragma once
// Ctrl-C and SIGTERM ask; the loop ends where it is whole.

#include <atomic>

namespace sf::apps {

/// Set once SIGINT or SIGTERM came. A second one ends the program at once.
const std::atomic<bool>& stop_requested();

/// Takes the signals over. To be called once, before the loop.
void catch_stop_signals();

}  // namespace sf::apps
