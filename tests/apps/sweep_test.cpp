// `sweep` as users run it: processes, shares, kills, and Slurm's scripts and variables.

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <thread>

#include "tests/apps/program.h"
#include "tests/refusal.h"

namespace sf {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kJobs = 24;

/// Twelve points with two seeds; a job takes some hundredths of a second.
std::string write_sweep(const Folder& folder, const std::string& duration = "1", const std::string& expect = "") {
  folder.write("small.toml", "world = \"" + our_world("rooms.world") + "\"\nrobots = 2\nduration = " + duration + "\n" +
                                 (expect.empty() ? "" : "[expect]\n" + expect));
  return folder.write("sweep.toml",
                      "scenario = \"small.toml\"\nseeds = 2\n[grid]\nrobots = [1, 2, 3]\n"
                      "[sample]\npoints = 4\n[sample.range]\nlink.delay = { from = 0, to = 0.3 }\n");
}

/// The sweep's results and tables, by name.
std::map<std::string, std::string> tables_of(const Folder& folder, const std::string& out) {
  std::map<std::string, std::string> tables;
  for (const char* name : {"jobs.csv", "points.csv", "report.md"})
    tables[name] = read_file(folder.path(out + "/" + name));
  return tables;
}

/// Paths of the results, with their modification times.
std::map<std::string, fs::file_time_type> results_of(const std::string& out) {
  std::map<std::string, fs::file_time_type> results;
  std::error_code none;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(out) / "jobs", none))
    if (entry.path().extension() == ".txt") results[entry.path().filename()] = entry.last_write_time();
  return results;
}

TEST(SweepCommand, TablesDoNotDependOnTheNumberOfProcesses) {
  const Folder folder;
  const std::string file = write_sweep(folder, "1", "contacts = 1000\n");
  const Outcome one = run_successfully({"sweep", file, "-o", folder.path("one"), "--jobs", "1"});
  EXPECT_NE(one.out.find("24 jobs: 24 pass\n"), std::string::npos) << one.out;
  EXPECT_EQ(one.err.find('\r'), std::string::npos) << "no progress without a terminal: " << one.err;
  ASSERT_EQ(run_program({"sweep", file, "-o", folder.path("three"), "--jobs", "3"}).code, 0);
  EXPECT_EQ(tables_of(folder, "three"), tables_of(folder, "one"));

  // Shares in any order; the last one writes the tables.
  for (const char* share : {"3/3", "1/3"}) {
    const Outcome part = run_successfully({"sweep", file, "-o", folder.path("parts"), "--share", share});
    EXPECT_NE(part.err.find("8 jobs: 8 pass"), std::string::npos) << part.err;
    EXPECT_FALSE(fs::exists(folder.path("parts/jobs.csv")));
  }
  // As `srun` starts it.
  run_successfully(
      {"sweep", file, "-o", folder.path("parts")},
      {{"SLURM_STEP_ID", "0"}, {"SLURM_PROCID", "1"}, {"SLURM_NTASKS", "3"}, {"SLURM_CPUS_PER_TASK", "2"}});
  EXPECT_EQ(tables_of(folder, "parts"), tables_of(folder, "one"));
  EXPECT_EQ(count_lines(tables_of(folder, "one")["jobs.csv"]), 1 + kJobs);
}

/// Starts the sweep and sends it `end` when some jobs are done. On a busy machine, all jobs may be done by then: tries
/// again in another folder.
Outcome interrupted(const std::string& file, int end, std::string& out) {
  for (;; out += "x") {
    Program program({"sweep", file, "-o", out, "--jobs", "2"});
    while (program.running() && results_of(out).size() < 4) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    Outcome outcome = program.stop(end);
    if (results_of(out).size() < kJobs || out.size() > 200) return outcome;
  }
}

/// Interrupts with `end` in the middle, and continues from there.
void interrupt_and_continue(int end) {
  const Folder folder;
  const std::string file = write_sweep(folder, "20");
  std::string out = folder.path("out");
  const Outcome killed = interrupted(file, end, out);
  const auto kept = results_of(out);
  ASSERT_GE(kept.size(), 4u) << killed.err;
  ASSERT_LT(kept.size(), kJobs) << "it was to be stopped in the middle";
  EXPECT_FALSE(fs::exists(out + "/jobs.csv"));
  if (end == SIGKILL) {
    EXPECT_EQ(killed.signal, SIGKILL);
  } else {
    EXPECT_EQ(killed.code, 128 + end);
    EXPECT_NE(killed.err.find("interrupted: "), std::string::npos) << killed.err;
  }

  const Outcome merged = run_program({"sweep", file, "-o", out, "--merge"});
  EXPECT_EQ(merged.code, 1) << "jobs are missing";
  EXPECT_NE(read_file(out + "/jobs.csv").find(",missing,"), std::string::npos);

  ASSERT_EQ(run_program({"sweep", file, "-o", out}).code, 0);
  const auto all = results_of(out);
  EXPECT_EQ(all.size(), kJobs);
  for (const auto& [name, time] : kept) EXPECT_EQ(all.at(name), time) << name << " was done already";
  ASSERT_EQ(run_program({"sweep", file, "-o", folder.path("undisturbed")}).code, 0);
  EXPECT_EQ(tables_of(folder, fs::path(out).filename()), tables_of(folder, "undisturbed"));
}

TEST(SweepCommand, AKilledSweepContinues) { interrupt_and_continue(SIGKILL); }
TEST(SweepCommand, CtrlCKeepsFinishedJobs) { interrupt_and_continue(SIGINT); }

TEST(SweepCommand, MissedExpectationsShowInTablesAndExitCode) {
  const Folder folder;
  const std::string file = write_sweep(folder, "0.5", "distance = 1000\n");
  const Outcome outcome = run_program({"sweep", file, "-o", folder.path("out")});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.out.find("24 jobs: 24 missed"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("job 0 missed: distance: expected >= 1000, got "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("14 more jobs: see jobs.csv"), std::string::npos) << outcome.err;
}

TEST(SweepCommand, TenFailuresAreListedAndTheRestCounted) {
  const Folder folder;
  folder.write("small.toml",
               "world = \"" + our_world("rooms.world") + "\"\nrobots = 1\nduration = 0.1\n[expect]\ndistance = 1000\n");
  for (const auto& [seeds, rest] : {std::pair{"10", ""}, {"11", "sensorfarm: 1 more job: see jobs.csv\n"}}) {
    const std::string file =
        folder.write("sweep.toml", "scenario = \"small.toml\"\nseeds = " + std::string(seeds) + "\n");
    const Outcome outcome = run_program({"sweep", file, "-o", folder.path(seeds)});
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("job 9 missed: "), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find("job 10 "), std::string::npos) << outcome.err;
    const std::size_t more = outcome.err.find('\n', outcome.err.find("job 9 ")) + 1;
    EXPECT_EQ(outcome.err.substr(more, outcome.err.find("sensorfarm: wrote ") - more), rest);
  }
}

/// A controller that crashes, a controller that reports an error, and other jobs that succeed.
TEST(SweepCommand, AFailureAffectsOnlyItsJob) {
  const Folder folder;
  // Of three values, the smallest and the largest are checked in advance: an error in the middle one appears in its
  // job.
  folder.write("small.toml", "world = \"" + our_world("testpath/testpath.world") +
                                 "\"\nduration = 0.5\n[default]\ncontroller = \"lane-keeping\"\n");
  const std::string file =
      folder.write("sweep.toml",
                   "scenario = \"small.toml\"\n[grid]\ndefault.settings = [{ kp = 0.5 }, { kp = 0.5, ki = 0.1 }]\n"
                   "default.controller = [\"lane-keeping\", \"wander\"]\n");
  expect_refused({"sweep", file, "-o", folder.path("out")}, "sweep.toml:4: default.controller = wander");

  const std::string pairs = folder.write("pairs.toml",
                                         "scenario = \"small.toml\"\n[grid]\n"
                                         "default.controller = [\"lane-keeping\", \"none\"]\n"
                                         "expect = [{ contacts = 100 }, { mean_error = 100 }]\n");
  const Outcome outcome = run_program({"sweep", pairs, "-o", folder.path("pairs")});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_NE(outcome.out.find("4 jobs: 3 pass, 1 failed"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("job 3 failed: "), std::string::npos) << outcome.err;
  const auto before = results_of(folder.path("pairs"));
  EXPECT_EQ(run_program({"sweep", pairs, "-o", folder.path("pairs")}).code, 1);
  EXPECT_EQ(results_of(folder.path("pairs")), before) << "failed jobs stay as they are";
  EXPECT_EQ(run_program({"sweep", pairs, "-o", folder.path("pairs"), "--retry"}).code, 1);
  const auto after = results_of(folder.path("pairs"));
  EXPECT_NE(after.at("000003.txt"), before.at("000003.txt")) << "--retry runs them once more";
  EXPECT_EQ(after.at("000000.txt"), before.at("000000.txt")) << "and no other";
}

TEST(SweepCommand, ADeadProcessAffectsOnlyItsJob) {
  if (std::getenv("SENSORFARM_INSTRUMENTED") != nullptr) GTEST_SKIP() << "Python's plug-in is not instrumented";
  if (!fs::exists(SF_BINARY_DIR "/sensorfarm_python.so")) GTEST_SKIP() << "built without Python";
  const Folder folder;
  folder.write("crash.py",
               "import os, signal\n"
               "class Crash:\n"
               "  def __init__(self, robot, settings):\n    pass\n"
               "  def step(self, input):\n    os.kill(os.getpid(), signal.SIGKILL)\n");
  folder.write("small.toml", "world = \"" + our_world("rooms.world") + "\"\nrobots = 1\nduration = 0.5\n");
  const std::string file = folder.write(
      "sweep.toml",
      "scenario = \"small.toml\"\n[grid]\ndefault.controller = [\"wander\", \"crash.py:Crash\", \"none\"]\n");
  const Outcome outcome = run_program({"sweep", file, "-o", folder.path("out"), "--jobs", "1"});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_NE(outcome.out.find("3 jobs: 2 without expectations, 1 failed"), std::string::npos)
      << outcome.out << outcome.err;
  expect_in("job 1 failed: controller 'Crash' of robot 'roomba1' ended the process (signal 9, Killed)", outcome.err);
}

TEST(SweepCommand, SlurmScriptsListMissingJobs) {
  const Folder folder;
  const std::string file = write_sweep(folder, "0.5");
  const std::string out = folder.path("o u t");
  Words words{"sweep", file, "-o", out, "--slurm", "--tasks", "4", "--jobs", "2", "--sbatch=--time=5"};
  run_successfully(words);
  const std::string path = out + "/sweep.sbatch", script = read_file(path);
  for (const char* line : {"#SBATCH --array=0-3\n", "#SBATCH --cpus-per-task=2\n", "#SBATCH --time=5\n"})
    EXPECT_NE(script.find(line), std::string::npos) << line << script;
  EXPECT_TRUE(succeeds("bash -n '" + path + "'"));

  // As sbatch runs two of its four tasks; the other two died with their machine.
  const std::string task = "SENSORFARM= SLURM_JOB_ID=7 SLURM_PROCID=0 SLURM_NTASKS=1 SLURM_ARRAY_TASK_ID=";
  for (const char* number : {"0", "2"}) EXPECT_TRUE(succeeds(task + number + " bash '" + path + "'")) << number;
  EXPECT_EQ(results_of(out).size(), kJobs / 2);
  ASSERT_EQ(run_program(words).code, 0);
  EXPECT_NE(read_file(path).find("#SBATCH --array=1,3\n"), std::string::npos) << read_file(path);
  for (const char* number : {"1", "3"}) EXPECT_TRUE(succeeds(task + number + " bash '" + path + "'")) << number;
  ASSERT_EQ(run_program({"sweep", file, "-o", folder.path("here")}).code, 0);
  EXPECT_EQ(tables_of(folder, "o u t"), tables_of(folder, "here"));
  EXPECT_NE(run_program(words).out.find("24 jobs: "), std::string::npos) << "no job is missing: prints the tables";
}

/// Fifty points are listed, and the number of the rest.
TEST(SweepCommand, ListsFiftyPoints) {
  const Folder folder;
  folder.write("small.toml", "world = \"" + our_world("rooms.world") + "\"\nduration = 0.1\n");
  for (const int points : {49, 50, 51}) {
    std::string values = "1";
    for (int i = 2; i <= points; ++i) values += ", " + std::to_string(i);
    const std::string file =
        folder.write("sweep.toml", "scenario = \"small.toml\"\n[grid]\nrobots = [" + values + "]\n");
    const Outcome list = run_successfully({"sweep", file, "--list"}, no_device());
    EXPECT_EQ(count_lines(list.out), 1u + std::min(points, 50) + (points > 50 ? 1u : 0u)) << list.out;
    EXPECT_NE(list.out.find("     0  robots = 1\n"), std::string::npos) << list.out;
    EXPECT_NE(list.out.find("    48  robots = 49\n"), std::string::npos) << list.out;
    EXPECT_EQ(list.out.find("    49  robots = 50\n") != std::string::npos, points >= 50) << list.out;
    EXPECT_EQ(list.out.find("    50  ") != std::string::npos, false) << list.out;
    EXPECT_EQ(list.out.find("\n1 points more\n") != std::string::npos, points == 51) << list.out;
  }
}

TEST(SweepCommand, WrongUsageIsRejected) {
  const Folder folder;
  const std::string file = write_sweep(folder);
  const auto refused = [&](Words words, const Environment& environment = {}) {
    words.insert(words.begin(), {"sweep", file});
    const Outcome outcome = run_program(words, environment);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
    return outcome.err;
  };
  EXPECT_NE(refused({}).find("--out"), std::string::npos);
  for (const char* share : {"0/2", "3/2", "1", "1/", "/2", "-1/2", "1/2/3"})
    EXPECT_NE(refused({"-o", folder.path("out"), "--share", share}).find("a share K/N"), std::string::npos) << share;
  EXPECT_NE(refused({"-o", folder.path("out"), "--tasks", "3"}).find("--slurm"), std::string::npos);
  EXPECT_NE(refused({"-o", folder.path("out"), "--slurm", "--sbatch=time"}).find("--sbatch 'time'"), std::string::npos);
  EXPECT_NE(refused({"-o", folder.path("a\"b"), "--slurm"}).find("cannot be used in a batch script"),
            std::string::npos);
  expect_in("SLURM_PROCID is '2'", refused({"-o", folder.path("out")},
                                           {{"SLURM_STEP_ID", "0"}, {"SLURM_PROCID", "2"}, {"SLURM_NTASKS", "2"}}));
  EXPECT_EQ(run_program({"sweep", file, "-o", folder.path("out"), "--require-vulkan"}, no_device()).code, 3);
  const Outcome list = run_successfully({"sweep", file, "--list"}, no_device());
  EXPECT_NE(list.out.find("12 points x 2 seeds = 24 jobs"), std::string::npos) << list.out;
}

}  // namespace
}  // namespace sf
