#include "base/plugin_calls.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "base/printable.h"

namespace sf::base {

namespace {

constexpr std::array kFatal{SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL};
constexpr int kNone = -1;

PluginCalls own_calls;
std::atomic<PluginCalls*> shared_calls{&own_calls};
std::atomic<std::uint64_t> taken_rows{0};  ///< bit k is set while a thread uses row k
static_assert(PluginCalls::kThreads == 64);
thread_local int thread_row = kNone;  ///< row of this thread in the calls
double end_limit = 10.0;              ///< [s]
bool is_watching = false;             ///< true once handlers are installed
thread_local bool forked_in_call = false;
bool is_copy = false;  ///< a plug-in call forked this process

bool is_under_way(const PluginCalls::Call& call) { return call.number % 2 != 0; }

/// Releases the row of an ending thread. Keeps it if a call on the thread has called exit(), because exit handlers run
/// later and need it.
struct RowHolder {
  ~RowHolder() {
    if (thread_row == kNone || is_under_way(shared_calls.load()->calls[thread_row])) return;
    taken_rows &= ~(std::uint64_t{1} << thread_row);
    thread_row = kNone;
  }
};

/// @return kNone when all rows are taken
int take_row() {
  static thread_local const RowHolder holder;
  for (std::uint64_t before = taken_rows; ~before != 0;) {
    const int first = __builtin_ctzll(~before);
    if (taken_rows.compare_exchange_weak(before, before | std::uint64_t{1} << first)) return first;
  }
  return kNone;
}

/// Returns the row of this thread's current call, or kNone.
int call_of_thread() {
  return thread_row != kNone && is_under_way(shared_calls.load()->calls[thread_row]) ? thread_row : kNone;
}

/// Runs before the fork, because the original may return from its call before the copy runs.
void note_fork() { forked_in_call = call_of_thread() != kNone; }

/// Runs in a process that a call forked: the copy must not write to the memory of the original.
void note_copy() {
  is_copy = forked_in_call;
  if (is_copy) shared_calls = &own_calls;
}

/// Prints how an unsupervised process ended. Does not allocate, because the heap may be corrupt.
void report_end(const char* how) {
  const int blamed = own_calls.blamed;
  const PluginCalls::Call* const call = blamed == kNone ? nullptr : &own_calls.calls[blamed];
  std::array<char, 64> time{};
  if (call != nullptr && !std::isnan(call->time))
    std::snprintf(time.data(), time.size(), " at %.3f s simulated", call->time);
  std::array<char, 512> line{};
  std::snprintf(line.data(), line.size(), "sensorfarm: %s ended the process (%s)%s\n",
                call == nullptr ? "a thread of a plug-in" : call->who, how, time.data());
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line.data(), std::strlen(line.data()));
}

/// @return true when users' code ends this process
bool note_end() {
  if (is_copy || shared_calls.load()->finished) return false;
  shared_calls.load()->blamed = call_of_thread();
  return true;
}

std::string late_line;  ///< built in advance, because the heap may be locked when it is needed

void on_late(int) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, late_line.data(), late_line.size());
  _exit(own_calls.code != EXIT_SUCCESS ? own_calls.code.load() : EXIT_FAILURE);
}

void on_exit_called(int code, void*) {
  if (!note_end()) return;
  std::fflush(nullptr);
  if (shared_calls != &own_calls) _exit(code);
  report_end(fmt::format("exit code {}", code).c_str());
  _exit(EXIT_FAILURE);
}

void on_quick_exit_called() {
  if (!note_end() || shared_calls != &own_calls) return;
  report_end("quick_exit");
  _exit(EXIT_FAILURE);
}

/// Not async-signal-safe, but the process cannot continue anyway.
void on_fatal(int signal) {
  std::signal(signal, SIG_DFL);
  const char* const name = sigdescr_np(signal);
  if (call_of_thread() != kNone && note_end() && shared_calls == &own_calls)
    report_end(name != nullptr ? name : "signal");
  raise(signal);
}

void install_handlers() {
  pthread_atfork(note_fork, nullptr, note_copy);
  std::at_quick_exit(on_quick_exit_called);
  // Alternate stack, for infinite recursion on the main thread.
  static std::array<char, 1 << 16> stack;
  stack_t other{};
  other.ss_sp = stack.data();
  other.ss_size = stack.size();
  sigaltstack(&other, nullptr);
  for (const int signal : kFatal) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_DFL) continue;  // keep a sanitizer's handler
    struct sigaction action {};
    action.sa_handler = on_fatal;
    action.sa_flags = static_cast<int>(SA_ONSTACK | SA_NODEFER);
    sigaction(signal, &action, nullptr);
  }
}

std::string time_text(const PluginCalls::Call& call) {
  return std::isnan(call.time) ? "" : fmt::format(" at {:.3f} s simulated", call.time);
}

std::string who_of(const PluginCalls::Call& call) { return one_line({call.who, strnlen(call.who, sizeof call.who)}); }

using Suspects = std::vector<const PluginCalls::Call*>;

template <class Test>
Suspects suspects_of(const PluginCalls& calls, Test&& test) {
  Suspects suspects;
  for (int i = 0; i < PluginCalls::kThreads; ++i)
    if (test(i)) suspects.push_back(&calls.calls[i]);
  return suspects;
}

/// @param suspects not empty
std::string names_of(const Suspects& suspects) {
  constexpr std::size_t kMost = 4;
  std::string names = who_of(*suspects[0]);
  for (std::size_t i = 1; i < std::min(suspects.size(), kMost); ++i) names += " or " + who_of(*suspects[i]);
  if (suspects.size() > kMost) names += fmt::format(" or one of {} others", suspects.size() - kMost);
  return names;
}

/// Names the blamed calls, or else all calls under way, each followed by `what` and the time.
std::string named(const PluginCalls& calls, const std::string& what) {
  const int blamed = calls.blamed;
  const Suspects suspects =
      suspects_of(calls, [&](int i) { return i == blamed || (blamed == kNone && is_under_way(calls.calls[i])); });
  return suspects.empty() ? "" : names_of(suspects) + what + time_text(*suspects[0]);
}

Suspects called(const PluginCalls& calls) {
  return suspects_of(calls, [&](int i) { return calls.calls[i].number > 0; });
}

}  // namespace

PluginCall::PluginCall(std::string_view who, double time) : call_(nullptr) {
  if (thread_row == kNone) thread_row = take_row();
  if (thread_row == kNone || call_of_thread() != kNone) return;
  call_ = &shared_calls.load()->calls[thread_row];
  const std::size_t size = std::min(who.size(), sizeof call_->who - 1);
  std::memcpy(call_->who, who.data(), size);
  call_->who[size] = '\0';
  call_->time = time;
  ++call_->number;
}

PluginCall::~PluginCall() {
  if (is_copy) _exit(EXIT_SUCCESS);
  if (call_ != nullptr) ++call_->number;
}

void share_plugin_calls(PluginCalls* calls) { shared_calls = calls != nullptr ? calls : &own_calls; }

void watch_plugin_calls() {
  if (!is_watching) install_handlers();
  is_watching = true;
  renew_plugin_watch();
}

void renew_plugin_watch() {
  if (is_watching) on_exit(on_exit_called, nullptr);
}

double seconds_to_end() { return end_limit; }

void set_seconds_to_end(double seconds) { end_limit = seconds; }

void finish_plugin_calls(int code) {
  PluginCalls& calls = *shared_calls.load();
  calls.code = code;
  calls.finished = true;
  if (&calls != &own_calls || called(calls).empty()) return;
  late_line = fmt::format("sensorfarm: {} {:g} s after the end of the program\n", goes_on(calls), end_limit);
  std::signal(SIGALRM, on_late);
  const double whole = std::floor(end_limit);
  const itimerval once{.it_interval = {},
                       .it_value = {static_cast<time_t>(whole), static_cast<suseconds_t>(1e6 * (end_limit - whole))}};
  setitimer(ITIMER_REAL, &once, nullptr);
}

std::string goes_on(const PluginCalls& calls) {
  const Suspects suspects = called(calls);
  return fmt::format("a thread of {} is still running", suspects.empty() ? "a plug-in" : names_of(suspects));
}

std::string under_way(const PluginCalls& calls) { return named(calls, ""); }

std::string blame(const PluginCalls& calls, const std::string& how) {
  return named(calls, fmt::format(" ended the process ({})", how));
}

std::string signal_text(int signal) {
  const char* const name = sigdescr_np(signal);
  return fmt::format("signal {}, {}", signal, name != nullptr ? name : "?");
}

}  // namespace sf::base
