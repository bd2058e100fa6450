#include "apps/processes/supervision.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <set>
#include <string>
#include <string_view>

#include "apps/processes/descendants.h"
#include "apps/processes/memory_limit.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/text.h"
#include "base/elapsed.h"
#include "base/files.h"
#include "base/installation.h"
#include "base/plugin_calls.h"
#include "base/thread_pool.h"
#include "cluster/ranks.h"

namespace sf::apps {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::array kStops{SIGINT, SIGTERM, SIGHUP};
constexpr double kForwardAfter = 0.1;  ///< [s] the terminal or `timeout` signals parent and child alike
/// [s] for calls that continue after a stop request; the rest of the limit is for ending the process
constexpr double kPatience = 0.8 * std::chrono::duration<double>(base::kStopLimit).count();
constexpr timespec kTurn{0, 20'000'000};
constexpr int kTurnsInCalls = 5;  ///< calls that are shorter than this many turns do not block the process

/// In memory shared by parent and child.
struct Page {
  base::PluginCalls calls;
  std::atomic<unsigned> stops{0};  ///< number of signals that the child has received
};

bool is_code(std::string_view argument) {
  argument = argument.substr(argument.find('=') + 1);
  const std::size_t slash = argument.rfind('/');
  const std::size_t colon = argument.find(':', slash == std::string_view::npos ? 0 : slash);
  argument = argument.substr(0, colon);
  return argument.ends_with(".so") || argument.ends_with(".py");
}

/// Returns whether a world file, or a file that it includes, names a file of code in a `ctrl` or `dynamics`.
/// @param seen paths that were read
bool world_has_code(const std::string& file, std::set<std::string>& seen) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error) || !seen.insert(file).second) return false;
  const std::string text = base::read_text(file);
  for (const std::string_view key : {"ctrl", "dynamics", "include"})
    for (std::size_t at = 0; (at = text.find(key, at)) != std::string::npos;) {
      const std::size_t begin = text.find('"', at),
                        end = text.find('"', begin == std::string::npos ? begin : begin + 1);
      if (end == std::string::npos) break;
      const std::string value = text.substr(begin + 1, end - begin - 1);
      if (key != "include" && base::names_a_plugin(value.substr(0, value.find(' ')))) return true;
      if (key == "include" && world_has_code((std::filesystem::path(file).parent_path() / value).string(), seen))
        return true;
      at = end;
    }
  return false;
}

/// The same for an argument such as "a.world" or "--robot-from=a.world:car".
bool is_world_with_code(const std::string_view argument) {
  const std::string_view value = argument.substr(argument.find('=') + 1);
  std::set<std::string> seen;
  try {
    return world_has_code(base::installed_file(std::string(value.substr(0, value.rfind(':')))), seen);
  } catch (const std::exception&) {
    return false;  // reported when the world is loaded
  }
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
      const int signal = sigtimedwait(&signals_, nullptr, &kTurn);
      if (std::find(kStops.begin(), kStops.end(), signal) != kStops.end()) note_stop(signal);
      if (stops_ > 0) pass_on();
      if (!killed_) end_where_late();
    }
    descendants_.end();
    return code_of(status);
  }

 private:
  void note_stop(int signal) {
    // `nohup` ignores SIGHUP. Shells ignore SIGINT for background commands, but the program handles it anyway.
    if (signal == SIGHUP && is_ignored(signal)) return;
    ++stops_;
    last_ = signal;
    since_ = Clock::now();
  }

  /// Forwards signals that the child has not received directly.
  void pass_on() {
    if (base::seconds_since(since_) <= kForwardAfter || page_.stops >= stops_ || forwarded_ >= stops_) return;
    forwarded_ = stops_;
    kill(child_, last_);
  }

  /// Ends the child if a call, a sequence of calls or a thread delays its exit.
  void end_where_late() {
    if (page_.calls.finished && !finished_at_) finished_at_ = Clock::now();
    if (finished_at_) {
      const double most = stops_ > 0 ? kPatience : base::seconds_to_end();
      if (base::seconds_since(std::max(*finished_at_, since_)) < most) return;
      return end(fmt::format("{} {:g} s after {}: it is stopped with the process", base::goes_on(page_.calls), most,
                             stops_ > 0 ? "the request to stop" : "the end of the program"));
    }
    const std::string calls = base::under_way(page_.calls);
    turns_in_calls_ = calls.empty() ? 0 : turns_in_calls_ + 1;
    if (stops_ == 0 || base::seconds_since(since_) < kPatience || turns_in_calls_ < kTurnsInCalls) return;
    end(fmt::format("{} has not returned {:g} s after the request to stop: exiting without a report", calls,
                    kPatience));
  }

  void end(const std::string& why) {
    killed_ = true;
    Progress::clear();
    print_message("{}", why);
    kill(child_, SIGKILL);
  }

  int code_of(int status) const {
    const int own = page_.calls.code;  // 0 before its end
    const int failed = own != EXIT_SUCCESS ? own : EXIT_FAILURE;
    if (killed_) return failed;
    const bool by_signal = WIFSIGNALED(status);
    const int number = by_signal ? WTERMSIG(status) : WEXITSTATUS(status);
    if (!by_signal && page_.calls.finished) return own;
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
    if (what.empty()) what = fmt::format("the process was terminated ({}) outside any call of a plug-in", how);
    if (by_signal) what += memory_limit_note();
    Progress::clear();
    print_message("{}", what);
    return failed;
  }

  pid_t child_;
  const Page& page_;
  sigset_t signals_;
  Descendants descendants_;
  unsigned stops_ = 0;      ///< number of signals received
  unsigned forwarded_ = 0;  ///< number of them forwarded
  int last_ = 0;
  Clock::time_point since_;                       ///< time of the last signal
  std::optional<Clock::time_point> finished_at_;  ///< when the program was found to have ended
  int turns_in_calls_ = 0;                        ///< successive turns in which a call was in progress
  bool killed_ = false;                           ///< because it took too long
};

}  // namespace

bool needs_supervision(int argc, const char* const* argv) {
  if (argc < 2 || cluster::is_rank()) return false;
  const std::string_view command = argv[1];
  const auto any = [&](auto&& test) { return std::any_of(argv + 1, argv + argc, test); };
  if (any([](std::string_view word) { return word == "--in-process"; })) return false;
  const char* const plugins = std::getenv("SENSORFARM_PLUGINS");
  // Scenarios may name controllers, too. `test` and sweeps start their own processes.
  if (command == "run" && any([](std::string_view word) { return word.ends_with(".toml"); })) return true;
  if ((command == "run" || command == "serve" || command == "robot") && any(is_world_with_code)) return true;
  return !memory_limit_note().empty() || (plugins != nullptr && *plugins != '\0') || command == "experiment" ||
         any(is_code);
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
