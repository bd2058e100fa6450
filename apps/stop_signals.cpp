#include "apps/stop_signals.h"

#include <csignal>

namespace sf::apps {

namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void on_signal(int) { stop = true; }

}  // namespace

const std::atomic<bool>& stop_requested() { return stop; }

void install_stop_handlers() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  // Once only: who asks twice is not kept waiting.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // else `nohup` said not to
}

}  // namespace sf::apps
