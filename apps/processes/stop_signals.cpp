#include "apps/processes/stop_signals.h"

#include <algorithm>
#include <csignal>
#include <optional>
#include <thread>

namespace sf::apps {

namespace {

std::atomic<bool> stop{false};
std::atomic<int> stop_signal{SIGINT};  // set by a stop on another rank, too
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);
std::optional<int> chosen_code;

std::atomic<unsigned> own_count{0};
std::atomic<unsigned>* stops = &own_count;

void on_signal(int number) {
  stop_signal = number;
  stop = true;
  ++*stops;
}

}  // namespace

const std::atomic<bool>& stop_requested() { return stop; }

void heed_stop(const char* what) {
  if (stop) throw Incomplete(what);
}

int interrupted_code() { return chosen_code.value_or(128 + stop_signal); }

void set_interrupted_code(int code) { chosen_code = code; }

void count_stops(std::atomic<unsigned>* count) { stops = count; }

void install_stop_handlers() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  // The handler is reset, so that a second signal ends the program at once.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // `nohup` ignores it
}

void remove_stop_handlers() {
  if (stops != &own_count) return;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    sigaction(number, nullptr, &action);
    if (action.sa_handler == on_signal) std::signal(number, SIG_DFL);
  }
}

void keep_pace(std::chrono::steady_clock::time_point start, double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto due = start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  while (Clock::now() < due && !stop_requested())
    std::this_thread::sleep_until(std::min(due, Clock::now() + std::chrono::milliseconds(50)));
}

}  // namespace sf::apps
