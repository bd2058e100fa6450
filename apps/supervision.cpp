#include "apps/supervision.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <new>
#include <string>
#include <string_view>

#include "apps/descendants.h"
#include "apps/progress_line.h"
#include "apps/stop_signals.h"
#include "apps/text.h"
#include "base/elapsed.h"
#include "base/plugin_calls.h"
#include "cluster/ranks.h"

namespace sf::apps {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::array kStops{SIGINT, SIGTERM, SIGHUP};
constexpr double kForwardAfter = 0.1;  ///< [s] the terminal, or `timeout`, signals parent and child alike
constexpr double kPatience = 0.4;      ///< [s] with a call that was under way when the stop was requested

/// In memory that parent and child share.
struct Page {
  base::PluginCalls calls;
  std::atomic<unsigned> stops{0};  ///< signals that the child has taken
};

bool is_code(std::string_view argument) {
  argument = argument.substr(argument.find('=') + 1);
  const std::size_t slash = argument.rfind('/');
  const std::size_t colon = argument.find(':', slash == std::string_view::npos ? 0 : slash);
  argument = argument.substr(0, colon);
  return argument.ends_with(".so") || argument.ends_with(".py");
}

/// [byte] that addresses or data are limited to; nullopt: nothing is limited. Drivers crash where they end.
std::optional<rlim_t> memory_limit() {
  std::optional<rlim_t> least;
  for (const auto resource : {RLIMIT_AS, RLIMIT_DATA}) {
    rlimit limit{};
    if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) continue;
    least = std::min(least.value_or(RLIM_INFINITY), limit.rlim_cur);
  }
  return least;
}

bool is_ignored(int signal) {
  struct sigaction action {};
  sigaction(signal, nullptr, &action);
  return action.sa_handler == SIG_IGN;
}

class Supervisor {
 public:
  Supervisor(pid_t child, const Page& page, const sigset_t& signals) : child_(child), page_(page), signals_(signals) {}

  /// @return the exit code of this process
  int run() {
    int status = 0;
    for (pid_t ended = 0; ended == 0; ended = waitpid(child_, &status, WNOHANG)) {
      const timespec turn{0, 20'000'000};
      const int signal = sigtimedwait(&signals_, nullptr, &turn);
      if (std::find(kStops.begin(), kStops.end(), signal) != kStops.end()) note_stop(signal);
      if (stops_ > 0) hurry();
    }
    descendants_.end();
    return code_of(status);
  }

 private:
  void note_stop(int signal) {
    // `nohup` ignores SIGHUP. Shells ignore SIGINT for commands in the background, which the program handles all the
    // same.
    if (signal == SIGHUP && is_ignored(signal)) return;
    if (stops_++ == 0)
      for (int i = 0; i < base::PluginCalls::kThreads; ++i) at_stop_[i] = page_.calls.calls[i].number;
    last_ = signal;
    since_ = Clock::now();
  }

  /// Passes on what the child did not get from elsewhere, and ends it where a call does not return.
  void hurry() {
    const double waited = base::seconds_since(since_);
    if (waited > kForwardAfter && page_.stops < stops_ && forwarded_ < stops_) {
      forwarded_ = stops_;
      kill(child_, last_);
    }
    if (waited < kPatience || killed_) return;
    for (int i = 0; i < base::PluginCalls::kThreads; ++i)
      if (at_stop_[i] % 2 != 0 && page_.calls.calls[i].number == at_stop_[i]) killed_ = true;
    if (!killed_) return;
    Progress::clear();
    print_message("{} does not return, {:g} s after the request to stop: it ends without a report",
                  base::under_way(page_.calls), kPatience);
    kill(child_, SIGKILL);
  }

  int code_of(int status) const {
    if (killed_) return EXIT_FAILURE;
    const bool by_signal = WIFSIGNALED(status);
    const int number = by_signal ? WTERMSIG(status) : WEXITSTATUS(status);
    if (!by_signal && page_.calls.finished) return number;
    const bool passed_on = stops_ > 0 && std::find(kStops.begin(), kStops.end(), number) != kStops.end();
    if (by_signal && (passed_on || number == SIGPIPE || number == SIGQUIT)) {  // as without a child
      std::signal(number, SIG_DFL);
      sigset_t all;
      sigfillset(&all);
      sigprocmask(SIG_UNBLOCK, &all, nullptr);
      raise(number);
    }
    const std::string how = by_signal ? base::signal_text(number) : fmt::format("exit code {}", number);
    std::string what = base::blame(page_.calls, how);
    if (what.empty()) what = fmt::format("the process was ended ({}), outside of any call of a plug-in", how);
    if (const std::optional<rlim_t> limit = memory_limit(); limit && by_signal)
      what += fmt::format("; memory is limited to {} MiB (ulimit -v), which not all libraries survive: raise it",
                          *limit >> 20);
    Progress::clear();
    print_message("{}", what);
    return EXIT_FAILURE;
  }

  pid_t child_;
  const Page& page_;
  sigset_t signals_;
  Descendants descendants_;
  std::array<std::uint32_t, base::PluginCalls::kThreads> at_stop_{};  ///< numbers of calls
  unsigned stops_ = 0;                                                ///< signals that came
  unsigned forwarded_ = 0;                                            ///< of these
  int last_ = 0;
  Clock::time_point since_;
  bool killed_ = false;  ///< for a call that did not return
};

}  // namespace

bool needs_supervision(int argc, const char* const* argv) {
  if (argc < 2 || cluster::is_rank()) return false;
  const std::string_view command = argv[1];
  const auto any = [&](auto&& test) { return std::any_of(argv + 1, argv + argc, test); };
  if (any([](std::string_view word) { return word == "--in-process"; })) return false;
  const char* const plugins = std::getenv("SENSORFARM_PLUGINS");
  // Files of experiments may name controllers, too; sweeps have processes of their own.
  return memory_limit() || (plugins != nullptr && *plugins != '\0') || command == "experiment" || any(is_code);
}

std::optional<int> supervise() {
  void* const memory = mmap(nullptr, sizeof(Page), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return std::nullopt;
  Page& page = *new (memory) Page;
  sigset_t signals, before;
  sigemptyset(&signals);
  for (const int signal : kStops) sigaddset(&signals, signal);
  sigaddset(&signals, SIGCHLD);
  sigprocmask(SIG_BLOCK, &signals, &before);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child > 0) return Supervisor(child, page, signals).run();
  sigprocmask(SIG_SETMASK, &before, nullptr);
  if (child < 0) return std::nullopt;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(EXIT_FAILURE);
  base::share_plugin_calls(&page.calls);
  count_stops(&page.stops);
  return std::nullopt;
}

}  // namespace sf::apps
