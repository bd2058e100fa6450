#pragma once
// SIGINT (Ctrl-C), SIGTERM and SIGHUP ask for a stop; the loop ends where it is whole.

#include <atomic>

namespace sf::apps {

/// Set once one of them came. A second one ends the program at once.
const std::atomic<bool>& stop_requested();

/// Takes the signals over, but for a SIGHUP that is ignored (nohup). To be called once, before the loop.
void install_stop_handlers();

}  // namespace sf::apps
