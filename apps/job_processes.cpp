#include "apps/job_processes.h"

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
#include <cstring>
#include <new>
#include <thread>
#include <vector>

#include "base/error.h"

namespace sf::apps {

namespace {

constexpr std::size_t kNoRow = SIZE_MAX;
constexpr std::size_t kMostProcesses = 1024;
enum Code : int { kFine = 0, kFailed = 1, kInput = 2, kDevice = 3 };

/// In memory that parent and children share.
struct Board {
  std::atomic<std::size_t> next{0};  ///< row that is handed out next
  std::atomic<std::size_t> done{0};
  std::atomic<std::size_t> rows[kMostProcesses];  ///< row of each child; kNoRow: between two
  char errors[kMostProcesses][1024];              ///< what a child threw
};
static_assert(std::atomic<std::size_t>::is_always_lock_free);

class SharedBoard {
 public:
  SharedBoard() : memory_(mmap(nullptr, sizeof(Board), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) throw base::InputError("no memory to share with processes");
    new (memory_) Board;
  }
  ~SharedBoard() { munmap(memory_, sizeof(Board)); }
  SharedBoard(const SharedBoard&) = delete;
  SharedBoard& operator=(const SharedBoard&) = delete;
  Board* operator->() const { return static_cast<Board*>(memory_); }

 private:
  void* memory_;
};

/// @return the exit code
int work(const SharedBoard& board, std::size_t slot, std::size_t count, const JobCalls& calls) {
  const auto fail = [&](int code, const char* what) {
    std::strncpy(board->errors[slot], what, sizeof board->errors[slot] - 1);
    return code;
  };
  try {
    calls.begin();
    for (std::size_t row = board->next++; row < count; row = board->next++) {
      board->rows[slot] = row;
      calls.run(row);
      board->rows[slot] = kNoRow;
      ++board->done;
    }
    return kFine;
  } catch (const base::InputError& error) {
    return fail(kInput, error.what());
  } catch (const base::DeviceError& error) {
    return fail(kDevice, error.what());
  } catch (const std::exception& error) {
    return fail(kFailed, error.what());
  }
}

class Children {
 public:
  Children(std::size_t count, const JobCalls& calls) : count_(count), calls_(calls) {}
  ~Children() {
    for (const pid_t pid : pids_)
      if (pid > 0) kill(pid, SIGKILL);
    for (const pid_t pid : pids_)
      if (pid > 0) waitpid(pid, nullptr, 0);
  }

  void start(std::size_t slot) {
    if (slot >= pids_.size()) pids_.resize(slot + 1, 0);
    board_->rows[slot] = kNoRow;
    const pid_t parent = getpid();
    const pid_t pid = fork();
    if (pid < 0)
      throw base::InputError(
          fmt::format("no process more can be started: {}; expected --jobs to be smaller", std::strerror(errno)));
    if (pid > 0) {
      pids_[slot] = pid;
      return;
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(kFailed);  // it died before the line above
    std::signal(SIGINT, SIG_IGN);             // Ctrl-C goes to all of a terminal; the parent decides
    _exit(work(board_, slot, count_, calls_));
  }

  /// Takes note of all that ended. @return whether some are still at work
  bool look() {
    bool working = false;
    for (std::size_t slot = 0; slot < pids_.size(); ++slot) {
      int status = 0;
      if (pids_[slot] > 0 && waitpid(pids_[slot], &status, WNOHANG) == pids_[slot]) {
        pids_[slot] = 0;
        take_leave(slot, status);
      }
      working = working || pids_[slot] > 0;
    }
    return working;
  }

  std::size_t done() const { return board_->done; }

 private:
  void take_leave(std::size_t slot, int status) {
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if (code == kFine) return;
    if (code == kInput) throw base::InputError(board_->errors[slot]);
    if (code == kDevice) throw base::DeviceError(board_->errors[slot]);
    const std::size_t row = board_->rows[slot];
    const std::string cause =
        WIFSIGNALED(status)
            ? fmt::format("its process was ended by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))
            : fmt::format("its process ended with exit code {}{}{}", code, code == kFailed ? ": " : "",
                          code == kFailed ? board_->errors[slot] : "");
    // Between two jobs, or before the first, the fault is not a job's: another process would have it as well.
    if (row == kNoRow) throw base::InputError("a process died outside of any job: " + cause);
    calls_.died(row, cause);
    ++board_->done;
    if (board_->next < count_) start(slot);
  }

  std::size_t count_;
  const JobCalls& calls_;
  SharedBoard board_;
  std::vector<pid_t> pids_;
};

}  // namespace

bool run_in_processes(std::size_t count, unsigned processes, const JobCalls& calls) {
  Children children(count, calls);
  const std::size_t width = std::min({count, static_cast<std::size_t>(processes), kMostProcesses});
  for (std::size_t slot = 0; slot < width; ++slot) children.start(slot);
  while (children.look()) {
    if (calls.stop()) return false;
    calls.wait(children.done());
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

}  // namespace sf::apps
