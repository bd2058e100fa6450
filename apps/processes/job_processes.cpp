#include "apps/processes/job_processes.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <thread>
#include <utility>
#include <vector>

#include "apps/processes/descendants.h"
#include "apps/processes/memory_limit.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "base/plugin_calls.h"

namespace sf::apps {

namespace {

constexpr std::size_t kNoRow = SIZE_MAX;
constexpr std::size_t kMostProcesses = 1024;
using Clock = std::chrono::steady_clock;
enum Code : int { kFine = 0, kFailed = 1, kInput = 2, kDevice = 3 };

/// A child's part of the shared memory.
struct Seat {
  std::atomic<std::size_t> row{kNoRow};  ///< current job; kNoRow: between two jobs
  char error[1024] = {};                 ///< message of the exception
  base::PluginCalls calls;
};

/// Memory shared by parent and children.
class Board {
 public:
  explicit Board(std::size_t seats)
      : size_(sizeof(Counts) + seats * sizeof(Seat)),
        memory_(mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) throw base::InputError("no memory to share with child processes");
    new (memory_) Counts;
  }
  ~Board() { munmap(memory_, size_); }
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  std::atomic<std::size_t>& next() const { return static_cast<Counts*>(memory_)->next; }
  std::atomic<std::size_t>& done() const { return static_cast<Counts*>(memory_)->done; }
  Seat& seat(std::size_t slot) const { return reinterpret_cast<Seat*>(static_cast<Counts*>(memory_) + 1)[slot]; }

 private:
  struct alignas(Seat) Counts {
    std::atomic<std::size_t> next{0};  ///< next row to hand out
    std::atomic<std::size_t> done{0};
  };
  std::size_t size_;
  void* memory_;
};
static_assert(std::atomic<std::size_t>::is_always_lock_free && std::atomic<double>::is_always_lock_free);

/// @return the exit code
int work(const Board& board, Seat& seat, std::size_t count, const JobCalls& calls) {
  const auto fail = [&](int code, const char* what) {
    std::strncpy(seat.error, what, sizeof seat.error - 1);
    return code;
  };
  try {
    calls.begin();
    for (std::size_t row = board.next()++; row < count; row = board.next()++) {
      seat.row = row;
      calls.run(row);
      if (calls.own_processes) break;
      seat.row = kNoRow;
      ++board.done();
    }
    return kFine;
  } catch (const base::InputError& error) {
    return fail(kInput, error.what());
  } catch (const base::DeviceError& error) {
    return fail(kDevice, error.what());
  } catch (const std::bad_alloc&) {
    return fail(kFailed, kNoMemory);
  } catch (const std::exception& error) {
    return fail(kFailed, error.what());
  }
}

class Children {
 public:
  Children(std::size_t count, std::size_t width, const JobCalls& calls)
      : count_(count), calls_(calls), board_(width), children_(width) {}
  ~Children() {
    for (const Child& child : children_)
      if (child.pid > 0) kill(-child.pid, SIGKILL), kill(child.pid, SIGKILL);
    descendants_.end();
  }

  void start(std::size_t slot) {
    Seat& seat = *new (&board_.seat(slot)) Seat;
    std::fflush(nullptr);  // otherwise both processes would write the buffered output
    const pid_t parent = getpid();
    const pid_t pid = fork();
    if (pid < 0)
      throw base::InputError(
          fmt::format("no more processes can be started: {}; lower --jobs, or raise the limit of processes (ulimit -u)",
                      std::strerror(errno)));
    if (pid > 0) {
      setpgid(pid, pid);  // parent and child both call it, since either may run first
      children_[slot] = {pid, kNoRow, Clock::now()};
      return;
    }
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(kFailed);  // the parent died before the line above
    // The parent handles Ctrl-C. A process in the background may write to the terminal but does not read from it.
    for (const int signal : {SIGINT, SIGTTOU, SIGTTIN}) std::signal(signal, SIG_IGN);
    if (calls_.own_processes) std::signal(SIGTERM, SIG_DFL);  // only a job itself would send it to a single process
    base::share_plugin_calls(&seat.calls);
    const int code = work(board_, seat, count_, calls_);
    seat.calls.code = code;
    seat.calls.finished = true;
    if (calls_.own_processes) std::exit(code);
    std::fflush(nullptr);
    _exit(code);
  }

  /// Collects children that have ended.
  /// @return true if some are still running
  bool look() {
    bool working = false;
    for (std::size_t slot = 0; slot < children_.size(); ++slot) {
      int status = 0;
      const pid_t pid = children_[slot].pid;
      if (pid > 0) stop_where_late(slot);
      if (pid > 0 && waitpid(pid, &status, WNOHANG) == pid) {
        kill(-pid, SIGKILL);
        children_[slot].pid = 0;
        if (!others_work()) descendants_.end();
        take_leave(slot, status);
      }
      working = working || children_[slot].pid > 0;
    }
    return working;
  }

  std::size_t done() const { return board_.done(); }

 private:
  struct Child {
    pid_t pid = 0;             ///< 0: none
    std::size_t row = kNoRow;  ///< as of the last look
    Clock::time_point since;   ///< when `row` or `ends` last changed
    bool ends = false;         ///< has finished its work
    bool late = false;         ///< killed because it took too long
  };

  bool others_work() const {
    return std::any_of(children_.begin(), children_.end(), [](const Child& child) { return child.pid > 0; });
  }

  void stop_where_late(std::size_t slot) {
    Child& child = children_[slot];
    const Seat& seat = board_.seat(slot);
    const bool ends = seat.calls.finished;
    const std::size_t row = seat.row;
    if (row != std::exchange(child.row, row) || ends != std::exchange(child.ends, ends)) child.since = Clock::now();
    const double most = ends ? base::seconds_to_end() : calls_.timeout;
    if (most == 0.0 || row == kNoRow || child.late || base::seconds_since(child.since) < most) return;
    child.late = true;
    kill(child.pid, SIGKILL);
  }

  std::string cause_of(std::size_t slot, int status) const {
    const Seat& seat = board_.seat(slot);
    if (children_[slot].late && seat.calls.finished)
      return fmt::format("its process did not end within {:g} s: {}", base::seconds_to_end(),
                         base::goes_on(seat.calls));
    if (children_[slot].late) {
      const std::string who = base::under_way(seat.calls);
      return fmt::format("it took longer than {:g} s (--timeout){}", calls_.timeout,
                         who.empty() ? "" : "; it was running " + who);
    }
    const std::string limit = WIFSIGNALED(status) ? memory_limit_note() : "";
    if (!seat.calls.finished) {
      const std::string how =
          WIFSIGNALED(status) ? base::signal_text(WTERMSIG(status)) : fmt::format("exit code {}", WEXITSTATUS(status));
      if (const std::string who = base::blame(seat.calls, how); !who.empty()) return who + limit;
    }
    if (WIFSIGNALED(status))
      return fmt::format("its process was terminated by signal {} ({}){}", WTERMSIG(status),
                         strsignal(WTERMSIG(status)), limit);
    const bool failed = seat.calls.finished && seat.calls.code == kFailed;
    return fmt::format("its process ended with exit code {}{}{}",
                       seat.calls.finished ? seat.calls.code.load() : WEXITSTATUS(status), failed ? ": " : "",
                       failed ? seat.error : "");
  }

  void take_leave(std::size_t slot, int status) {
    const Seat& seat = board_.seat(slot);
    const int own = seat.calls.finished ? seat.calls.code.load() : -1;
    const int code = WIFEXITED(status) ? own : -1;  // exit handlers may crash
    const std::size_t row = seat.row;
    if (own == kInput) throw base::InputError(seat.error);
    if (own == kDevice) throw base::DeviceError(seat.error);
    if (calls_.own_processes && code == kFine) {
      if (row != kNoRow && calls_.ended) calls_.ended(row);
      if (row != kNoRow) ++board_.done();
    } else if (row != kNoRow || code != kFine) {
      const std::string cause = cause_of(slot, status);
      // Outside of any job, the error is not the job's fault, and another process would fail in the same way.
      if (row == kNoRow) throw base::InputError("a process died outside any job: " + cause);
      calls_.died(row, cause);
      ++board_.done();
    } else {
      return;
    }
    if (board_.next() < count_) start(slot);
  }

  std::size_t count_;
  const JobCalls& calls_;
  Descendants descendants_;
  Board board_;
  std::vector<Child> children_;
};

}  // namespace

bool run_in_processes(std::size_t count, unsigned processes, const JobCalls& calls) {
  const std::size_t width = std::min({count, static_cast<std::size_t>(processes), kMostProcesses});
  Children children(count, width, calls);
  for (std::size_t slot = 0; slot < width; ++slot) children.start(slot);
  while (children.look()) {
    if (calls.stop()) return false;
    calls.wait(children.done());
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

}  // namespace sf::apps
