#include "apps/processes/job_processes.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <map>
#include <new>
#include <stdexcept>
#include <thread>

#include "base/error.h"

namespace sf::apps {
namespace {

/// Counts that children report to this process, in shared memory.
struct Counts {
  std::atomic<int> begun{0};
  std::atomic<int> runs[8] = {};
  std::atomic<bool> go{false};
};

class JobProcesses : public testing::Test {
 protected:
  JobProcesses() { new (memory_) Counts; }
  ~JobProcesses() override { munmap(memory_, sizeof(Counts)); }
  Counts& counts() { return *static_cast<Counts*>(memory_); }

  /// Counts calls and runs `job`. Stops after a minute, which no test needs.
  JobCalls calls(std::function<void(std::size_t row)> job = [](std::size_t) {}) {
    return {.begin = [this] { ++counts().begun; },
            .run =
                [this, job](std::size_t row) {
                  ++counts().runs[row];
                  job(row);
                },
            .died = [this](std::size_t row, const std::string& cause) { died_[row] = cause; },
            .wait = [](std::size_t) {},
            .stop = [this] { return ++polls_ > 6000; }};
  }
  std::string refusal(const JobCalls& calls) {
    try {
      run_in_processes(2, 1, calls);
    } catch (const base::InputError& error) {
      return std::string("input: ") + error.what();
    } catch (const base::DeviceError& error) {
      return std::string("device: ") + error.what();
    }
    return "";
  }

  std::map<std::size_t, std::string> died_;

 private:
  void* memory_ = mmap(nullptr, sizeof(Counts), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  int polls_ = 0;
};

TEST_F(JobProcesses, EachJobIsDoneOnce) {
  for (const unsigned processes : {1u, 2u, 5u}) {
    for (auto& runs : counts().runs) runs = 0;
    EXPECT_TRUE(run_in_processes(5, processes, calls()));
    for (std::size_t row = 0; row < 8; ++row)
      EXPECT_EQ(counts().runs[row], row < 5 ? 1 : 0) << row << " of " << processes;
  }
  EXPECT_TRUE(died_.empty());
}

TEST_F(JobProcesses, ThereAreNoMoreChildrenThanJobs) {
  EXPECT_TRUE(run_in_processes(2, 8, calls()));
  EXPECT_EQ(counts().begun, 2);
  EXPECT_TRUE(run_in_processes(0, 8, calls()));
  EXPECT_EQ(counts().begun, 2);
}

TEST_F(JobProcesses, ADeadChildIsReplacedAndItsCauseReported) {
  EXPECT_TRUE(run_in_processes(4, 1, calls([](std::size_t row) {
                                 if (row == 0) raise(SIGKILL);
                                 if (row == 1) _exit(7);
                                 if (row == 2) throw std::runtime_error("out of luck");
                               })));
  const std::map<std::size_t, std::string> expected{{0, "its process was terminated by signal 9 (Killed)"},
                                                    {1, "its process ended with exit code 7"},
                                                    {2, "its process ended with exit code 1: out of luck"}};
  EXPECT_EQ(died_, expected);
  EXPECT_EQ(counts().runs[3], 1);
  EXPECT_EQ(counts().begun, 4);
}

/// The second job waits until the first, whose child died, is reported as done.
TEST_F(JobProcesses, JobsWhoseChildDiedAreDone) {
  JobCalls all = calls([this](std::size_t row) {
    if (row == 0) _exit(7);
    while (!counts().go) std::this_thread::yield();
  });
  all.wait = [this](std::size_t done) { counts().go = counts().go || done == 1; };
  EXPECT_TRUE(run_in_processes(2, 2, all));
}

TEST_F(JobProcesses, InputAndDeviceErrorsEndAll) {
  EXPECT_EQ(refusal(calls([](std::size_t) { throw base::InputError("no such file"); })), "input: no such file");
  EXPECT_EQ(refusal(calls([](std::size_t) { throw base::DeviceError("no device"); })), "device: no device");
  EXPECT_EQ(counts().runs[1], 0);
  EXPECT_TRUE(died_.empty());
}

TEST_F(JobProcesses, AFaultOutsideOfAnyJobEndsAll) {
  JobCalls all = calls();
  all.begin = [] { throw std::runtime_error("no luck"); };
  EXPECT_EQ(refusal(all), "input: a process died outside any job: its process ended with exit code 1: no luck");
  EXPECT_TRUE(died_.empty());
}

TEST_F(JobProcesses, ChildrenLeaveCtrlCToTheirParent) {
  EXPECT_TRUE(run_in_processes(1, 1, calls([](std::size_t) { raise(SIGINT); })));
  EXPECT_TRUE(died_.empty());
}

/// A job that never returns is ended.
TEST_F(JobProcesses, StopEndsChildrenAtOnce) {
  JobCalls all = calls([](std::size_t) { pause(); });
  all.stop = [this] { return counts().runs[0] > 0; };
  EXPECT_FALSE(run_in_processes(2, 1, all));
  EXPECT_EQ(counts().runs[1], 0);
}

}  // namespace
}  // namespace sf::apps
