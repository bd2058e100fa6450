// Controllers that end, stop or fork their process: they are reported by name and fail only their own scenario.

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/instrumented.h"
#include "tests/refusal.h"

namespace sf {

namespace {

const std::string kPlugin = SF_BINARY_DIR "/test_plugin.so";
const char* const kHall =
    "model( name \"hall\" size [20 6 1] boundary 1 noblocks 0 )\n"
    "position( name \"r0\" pose [-8 0 0 0] size [0.3 0.3 0.1] )\n";

/// A world, and scenarios with a plug-in controller that does something to its process.
struct Bench {
  /// Otherwise AddressSanitizer would handle faults and exit with its own code.
  Bench() { setenv("ASAN_OPTIONS", "handle_segv=0:handle_sigbus=0", 1); }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;
  ~Bench() { unsetenv("ASAN_OPTIONS"); }

  Folder folder;
  std::string world = folder.write("hall.world", kHall);

  std::string scenario(const std::string& name, const std::string& how, const std::string& more = "") const {
    return folder.write(name + ".toml", "world = \"hall.world\"\nduration = 2\n[default]\ncontroller = \"" + kPlugin +
                                            ":test-ends\"\nsettings = { how = \"" + how + "\"" + more +
                                            " }\n[expect]\ncontacts = 0\n");
  }
  std::string file() const { return folder.path("pid"); }
  Words run(const std::string& how, const Words& more = {}) const {
    return with({"run", world, "--duration", "2", "--controller", kPlugin + ":test-ends", "--set", "how=" + how,
                 "--set", "file=" + file()},
                more);
  }
  /// Returns the process id that a controller has written, after a moment in which the process may end; 0 if it has
  /// ended.
  pid_t left_running() const {
    const pid_t pid = std::atoi(read_file(file()).c_str());
    for (int i = 0; i < 200 && pid > 0 && kill(pid, 0) == 0; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return pid == 0 || kill(pid, 0) != 0 ? 0 : pid;
  }
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

struct End {
  const char* how;
  const char* reason;
};
/// Every way in which a plug-in can end the process, and how it is reported.
const End kEnds[] = {
    {"exit 0", "(exit code 0)"},      // looks like success
    {"exit 3", "(exit code 3)"},      // a code that the program uses
    {"quick_exit", "(exit code 0)"},  // skips handlers of exit()
    {"_exit", "(exit code 0)"},       // skips all handlers
    {"abort", "signal 6"},            // raised by the library
    {"terminate", "signal 6"},        // like an uncaught exception
    {"segv", "signal 11"},            // sent
    {"null", "signal 11"},            // a fault
    {"bus", "signal 7"},              // like a mapped file that shrinks
    {"recursion", "signal 11"},       // no stack left for a handler
    {"kill", "signal 9"},             // cannot be handled; sent by the system when memory runs out
    {"term", "signal 15"},            // without a stop request
};

}  // namespace

TEST(OwnProcesses, EachExitIsReportedAndOtherScenariosRun) {
  const Bench bench;
  Words words{"test", bench.scenario("first", "")};
  for (std::size_t i = 0; i < std::size(kEnds); ++i)
    words.push_back(bench.scenario("end" + std::to_string(i), kEnds[i].how));
  words.insert(words.end(), {bench.scenario("last", ""), "--junit", bench.folder.path("out.xml")});
  const Outcome outcome = run_program(words);
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  const std::string xml = read_file(bench.folder.path("out.xml"));
  expect_in("pass " + bench.folder.path("first.toml"), outcome.out);
  expect_in("pass " + bench.folder.path("last.toml"), outcome.out);
  EXPECT_TRUE(has(xml, "<testsuite name=\"last\" tests=\"1\" failures=\"0\"")) << xml;
  for (std::size_t i = 0; i < std::size(kEnds); ++i) {
    const std::string name = "end" + std::to_string(i);
    const std::size_t at = outcome.out.find("FAIL " + bench.folder.path(name + ".toml"));
    ASSERT_NE(at, std::string::npos) << name << outcome.out;
    const std::string line = outcome.out.substr(outcome.out.find('\n', at) + 1, 300);
    EXPECT_EQ(line.find("  FAIL controller 'test-ends' of robot 'r0' ended the process ("), 0u) << line;
    EXPECT_TRUE(has(line.substr(0, line.find('\n')), kEnds[i].reason)) << kEnds[i].how << ": " << line;
    EXPECT_TRUE(has(line.substr(0, line.find('\n')), "at 1.000 s simulated")) << kEnds[i].how << ": " << line;
    EXPECT_TRUE(has(xml, "<testsuite name=\"" + name + "\" tests=\"1\" failures=\"0\" errors=\"1\"")) << name << xml;
  }
  EXPECT_TRUE(has(xml, "<error message=\"controller &apos;test-ends&apos; of robot &apos;r0&apos; ended")) << xml;
}

TEST(OwnProcesses, RunReportsEachExit) {
  const Bench bench;
  for (const End& end : kEnds) {
    if (std::string(end.how) == "term") continue;  // treated as a stop request
    const Outcome outcome = run_program(bench.run(end.how, {"--record", bench.folder.path("run")}));
    EXPECT_EQ(outcome.code, 1) << end.how << outcome.err;
    EXPECT_TRUE(has(outcome.err, "controller 'test-ends' of robot 'r0' ended the process (")) << end.how << outcome.err;
    EXPECT_TRUE(has(outcome.err, end.reason)) << end.how << outcome.err;
    const Outcome plotted = run_program({"verify", bench.folder.path("run")});
    EXPECT_TRUE(has(plotted.out + plotted.err, "complete ticks")) << end.how << plotted.out << plotted.err;
  }
}

/// For debuggers, and with ranks that share a fleet. A signal still ends the program.
TEST(OwnProcesses, InProcessExitsAreReportedIfHandlersRun) {
  const Bench bench;
  const Outcome exited = run_program(bench.run("exit 0", {"--in-process"}));
  EXPECT_EQ(exited.code, 1);
  expect_in("'r0' ended the process (exit code 0) at 1.000 s simulated", exited.err);
  const Outcome crashed = run_program(bench.run("null", {"--in-process"}));
  EXPECT_NE(crashed.code, 0);
  expect_in("'r0' ended the process (Segmentation fault)", crashed.err);
  const Outcome tested = run_program({"test", bench.scenario("a", "exit 0"), bench.scenario("b", ""), "--in-process"});
  EXPECT_EQ(tested.code, 1);
  EXPECT_FALSE(has(tested.out, "b.toml")) << tested.out;
}

TEST(OwnProcesses, APlugInThreadIsNamedByTheCallThatWaitsForIt) {
  const Bench bench;
  const Outcome outcome = run_program(bench.run("thread"));
  EXPECT_EQ(outcome.code, 1);
  expect_in("ended the process (exit code 0)", outcome.err);
}

TEST(OwnProcesses, AnExitDuringControllerCreationIsReported) {
  const Bench bench;
  const Outcome outcome = run_program({"test", bench.scenario("bad", "_exit", ", at_once = true"),
                                       bench.scenario("good", ""), "--junit", bench.folder.path("out.xml")});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  expect_in("  FAIL controller 'test-ends' of robot 'r0' ended the process (exit code 0)\n", outcome.out);
  expect_in("pass " + bench.folder.path("good.toml"), outcome.out);
  EXPECT_TRUE(has(read_file(bench.folder.path("out.xml")), "errors=\"1\""));
}

TEST(OwnProcesses, ExceptionsFailOnlyTheirScenario) {
  const Bench bench;
  const Outcome outcome = run_program(
      {"test", bench.scenario("a", "text"), bench.scenario("b", "number"), bench.scenario("c", ""), "--jobs", "3"});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  expect_in("failed at 1.000 s: \\x1b[2Jred\\x07 sensorfarm: all is well\n", outcome.out);
  expect_in("failed at 1.000 s: it threw something that is not a std::exception", outcome.out);
  // In the order of the files, whatever came first.
  EXPECT_LT(outcome.out.find("a.toml"), outcome.out.find("b.toml"));
  EXPECT_LT(outcome.out.find("b.toml"), outcome.out.find("c.toml"));
  expect_in("pass " + bench.folder.path("c.toml"), outcome.out);
}

TEST(OwnProcesses, TimeIsLimitedOnRequest) {
  const Bench bench;
  const Outcome outcome = run_program({"test", bench.scenario("a", "loop"), bench.scenario("b", ""), "--timeout", "3"});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_TRUE(has(
      outcome.out,
      "it took longer than 3 s (--timeout); it was running controller 'test-ends' of robot 'r0' at 1.000 s simulated"))
      << outcome.out;
  expect_in("pass " + bench.folder.path("b.toml"), outcome.out);
}

/// A process that a controller leaves behind is ended even in a separate group or session.
TEST(OwnProcesses, ChildrenOfControllersAreEnded) {
  for (const char* how : {"child", "daemon"}) {
    const Bench bench;
    run_successfully({"test", bench.scenario("a", how, ", file = \"" + bench.file() + "\"")});
    EXPECT_EQ(bench.left_running(), 0) << how;
    EXPECT_FALSE(read_file(bench.file()).empty()) << how;
    std::filesystem::remove(bench.file());
    EXPECT_EQ(run_program(bench.run(how)).code, 0) << how;
    EXPECT_EQ(bench.left_running(), 0) << how;
    EXPECT_FALSE(read_file(bench.file()).empty()) << how;
  }
}

/// Otherwise the copy would drive the robots a second time, into the same recording.
TEST(OwnProcesses, AForkThatReturnsEndsAndTheOriginalContinues) {
  const Bench bench;
  const Outcome outcome = run_successfully(bench.run("copy", {"--record", bench.folder.path("run")}));
  EXPECT_EQ(outcome.out.find("robots"), outcome.out.rfind("robots")) << outcome.out;
  EXPECT_EQ(run_program({"verify", bench.folder.path("run")}).code, 0);
}

TEST(OwnProcesses, ClosedStreamsAndAnotherFolderLoseNothing) {
  const Bench bench;
  run_successfully({"test", bench.scenario("a", "close"), bench.scenario("b", "chdir")});
  const std::string here = std::filesystem::current_path();
  const std::string relative = std::filesystem::relative(bench.folder.path("run"), here);
  run_successfully(bench.run("chdir", {"--record", relative}));
  EXPECT_EQ(run_program({"verify", bench.folder.path("run")}).code, 0);
}

/// The call never returns.
TEST(OwnProcesses, TheFirstStopRequestEndsACallThatNeverReturns) {
  const Bench bench;
  for (const char* how : {"loop", "sleep"})
    for (const int signal : {SIGINT, SIGTERM}) {
      Program program(bench.run(how, {"--record", bench.folder.path("run"), "--json"}));
      const std::string recording = bench.folder.path("run/run.mcap");
      EXPECT_TRUE(until([&] { return std::filesystem::exists(recording); }));
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
      const Outcome outcome = program.stop(signal);
      EXPECT_EQ(outcome.code, 1) << how << outcome.err;
      EXPECT_TRUE(has(outcome.err, "controller 'test-ends' of robot 'r0' at 1.000 s simulated has not returned"))
          << how << outcome.err;
      std::filesystem::remove_all(bench.folder.path("run"));
    }
}

/// The same applies to a call that began after the request.
TEST(OwnProcesses, AStopRequestEndsCallsThatBeginLater) {
  const Bench bench;
  const std::string two = bench.folder.write(
      "two.world", std::string(kHall) + "position( name \"r1\" pose [8 0 0 0] size [0.3 0.3 0.1] )\n");
  Words words = bench.run("follow");
  words[1] = two;
  const Outcome outcome = run_program(words);
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  expect_in("of robot 'r1' at 1.000 s simulated has not returned", outcome.err);
}

/// An exit handler that waits for a thread, as Python's does: the report is printed, and a stop request ends it.
TEST(OwnProcesses, ARunningThreadIsEndedByAStopRequest) {
  const Bench bench;
  for (const bool here : {false, true}) {
    const std::string report = bench.folder.path(here ? "here" : "child");
    Program program(bench.run("linger", here ? Words{"--in-process"} : Words{}), {}, report);
    EXPECT_TRUE(until([&] { return !read_file(report).empty(); }));
    EXPECT_TRUE(has(read_file(report), "robots"));
    const Outcome outcome = program.stop();
    if (here) continue;  // ends like any program: by the signal, or with a code if it arrived before the end
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    expect_in("a thread of controller 'test-ends' of robot 'r0' is still running", outcome.err);
  }
}

/// Also without a request, after the time that exit handlers have.
TEST(OwnProcesses, ARunningThreadIsEnded) {
  const Bench bench;
  const Environment soon{{"SENSORFARM_SECONDS_TO_END", "0.15"}};
  Program child(bench.run("linger"), soon), here(bench.run("linger", {"--in-process"}), soon),
      test({"test", bench.scenario("a", "linger")}, soon);
  for (Program* program : {&child, &here, &test}) {
    const Outcome outcome = program->wait();
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_TRUE(has(outcome.out + outcome.err, "a thread of controller 'test-ends' of robot 'r0' is still running"))
        << outcome.out << outcome.err;
  }
}

TEST(OwnProcesses, TheExitTimeMustBeANumber) {
  for (const char* text : {"soon", "0", "-1", "nan", "1e7", "1 s"}) {
    const Outcome outcome = run_program({"--version"}, {{"SENSORFARM_SECONDS_TO_END", text}});
    EXPECT_EQ(outcome.code, 2) << text;
    expect_in("SENSORFARM_SECONDS_TO_END expects a number of seconds", outcome.err);
  }
  EXPECT_EQ(run_program({"--version"}, {{"SENSORFARM_SECONDS_TO_END", ""}}).code, 0) << "as if it were not set";
}

/// Exit handlers of plug-ins do not turn a failure into a success or into a different error.
TEST(OwnProcesses, ExitHandlersDoNotChangeTheExitCode) {
  const Bench bench;
  const Outcome outcome = run_program(bench.run("cover"));
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  expect_in("failed at 1.000 s: out of luck", outcome.err);
  const Outcome tested = run_program({"test", bench.scenario("a", "cover")});
  EXPECT_EQ(tested.code, 1) << tested.err;
  expect_in("failed at 1.000 s: out of luck", tested.out);
  const Outcome refused = run_program({"test", bench.scenario("b", "cover", ", at_once = true")});
  EXPECT_EQ(refused.code, 2) << refused.out;
  expect_in("out of luck", refused.err);
}

/// Standard output contains only the report.
TEST(OwnProcesses, OutputOfControllersIsNotInJson) {
  const Bench bench;
  for (const Words& more : {Words{"--json"}, Words{"--json", "--in-process"}}) {
    const Outcome outcome = run_successfully(bench.run("print", more));
    EXPECT_EQ(Json(outcome.out).number("/robots"), 1.0) << outcome.out;
    expect_in("a controller prints", outcome.err);
  }
  EXPECT_TRUE(has(run_program(bench.run("print")).out, "a controller prints"));
}

/// Files are not opened in place of closed streams.
TEST(OwnProcesses, ClosedStandardStreamsStayClosed) {
  const Bench bench;
  const std::string junit = bench.folder.path("out.xml");
  for (const char* closed : {"<&-", ">&-", "2>&-", "<&- >&- 2>&-"}) {
    std::filesystem::remove(junit);
    const Outcome outcome = Program({"-c", std::string("exec \"$0\" \"$@\" ") + closed, SF_PROGRAM, "test",
                                     bench.scenario("a", ""), "--junit", junit},
                                    {}, "", "", "sh")
                                .wait();
    const bool has_output = !has(std::string(" ") + closed, " >&-");
    EXPECT_EQ(outcome.code, has_output ? 0 : 2) << closed << outcome.err;
    EXPECT_TRUE(has(read_file(junit), "<testsuite name=\"a\" tests=\"1\" failures=\"0\"")) << closed;
    if (std::string(closed) == ">&-") {
      expect_in("standard output cannot be written", outcome.err);
    }
  }
}

/// Shells start background commands this way, and scripts end some of them with `kill -INT`.
TEST(OwnProcesses, SigintIsHandledEvenIfIgnored) {
  const Bench bench;
  Words words{"-c", "trap '' INT; exec \"$0\" \"$@\"", SF_PROGRAM};
  for (const std::string& word : bench.run("loop", {"--record", bench.folder.path("run")})) words.push_back(word);
  Program program(words, {}, "", "", "sh");
  EXPECT_TRUE(until([&] { return std::filesystem::exists(bench.folder.path("run/run.mcap")); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(program.stop().code, 1);
}

TEST(OwnProcesses, AStopRequestEndsTestsAndReportsFinishedOnes) {
  const Bench bench;
  const std::string junit = bench.folder.path("out.xml");
  Program program(
      {"test", bench.scenario("a", ""), bench.scenario("b", "sleep"), bench.scenario("c", ""), "--junit", junit});
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  const Outcome outcome = program.stop();
  EXPECT_EQ(outcome.code, 128 + SIGINT) << outcome.err;
  expect_in("interrupted: ", outcome.err);
  EXPECT_TRUE(has(read_file(junit), "<error message=\"interrupted\">")) << read_file(junit);
}

TEST(OwnProcesses, SweepsReportExitsByName) {
  const Bench bench;
  bench.scenario("base", "exit 0");
  const std::string sweep =
      bench.folder.write("sweep.toml", "scenario = \"base.toml\"\nseeds = 2\n[grid]\nduration = [0.5, 2]\n");
  const Outcome outcome = run_program({"sweep", sweep, "-o", bench.folder.path("out"), "--jobs", "1"});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  expect_in("controller 'test-ends' of robot 'r0' ended the process (exit code 0) at 1.000 s", outcome.err);
  EXPECT_TRUE(has(outcome.out + outcome.err, "2 ")) << outcome.out;
}

/// For every limit, one line states the reason; every case has a report, and none ends with a signal. The driver's own
/// limits are between these.
TEST(OwnProcesses, AMemoryLimitIsReported) {
  if (instrumented()) GTEST_SKIP() << "sanitizers need all addresses";
  for (const char* kilobytes : {"131072", "200000", "220000", "240000", "262144", "280000", "300000"}) {
    const Outcome outcome = Program({"-c", std::string("ulimit -v ") + kilobytes + "; exec \"$0\" \"$@\"", SF_PROGRAM,
                                     "run", our_world("cave.world"), "--robots", "50", "--duration", "0.1"},
                                    {}, "", "", "sh")
                                .wait();
    EXPECT_EQ(outcome.signal, 0) << kilobytes;
    if (outcome.code == 0) continue;
    EXPECT_TRUE(has(outcome.err, "ulimit -v")) << kilobytes << outcome.err;
  }
}

/// Tests and sweeps also state it, for the scenario or job that failed.
TEST(OwnProcesses, AMemoryLimitIsReportedForChildren) {
  if (instrumented()) GTEST_SKIP() << "sanitizers need all addresses";
  const Folder folder;
  const std::string scenario = folder.write(
      "a.toml", "world = \"" + our_world("cave.world") + "\"\nrobots = 50\nduration = 0.1\n[expect]\ncontacts = 99\n");
  const std::string sweep = folder.write("s.toml", "scenario = \"a.toml\"\nseeds = 1\n");
  for (const char* kilobytes : {"200000", "240000", "262144", "280000"})
    for (const Words& words : {Words{"test", scenario}, Words{"sweep", sweep, "-o", folder.path(kilobytes)}}) {
      const Words all = with({"-c", std::string("ulimit -v ") + kilobytes + "; exec \"$0\" \"$@\"", SF_PROGRAM}, words);
      const Outcome outcome = Program(all, {}, "", "", "sh").wait();
      EXPECT_EQ(outcome.signal, 0) << kilobytes << words[0];
      if (outcome.code != 0) {
        EXPECT_TRUE(has(outcome.out + outcome.err, "ulimit -v")) << kilobytes << outcome.out << outcome.err;
      }
    }
}

TEST(OwnProcesses, TruncatedLibrariesAreRejected) {
  const Bench bench;
  const std::string whole = read_file(kPlugin);
  const auto refusal = [&](const std::string& bytes) {
    const Outcome outcome =
        run_program({"run", bench.world, "--duration", "1", "--controller", bench.folder.write("cut.so", bytes)});
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    return outcome.err;
  };
  EXPECT_TRUE(has(refusal(whole.substr(0, whole.size() / 2)), "cut.so: is truncated: it has "));  // half of it
  EXPECT_TRUE(has(refusal(whole.substr(0, 4096)), "is truncated"));       // ends after the first page
  EXPECT_TRUE(has(refusal(whole.substr(0, 100)), "is truncated"));        // ends in the section table
  EXPECT_TRUE(has(refusal(""), "cannot be loaded as a shared library"));  // empty
  EXPECT_TRUE(has(refusal(std::string(9000, 'x')), "cannot be loaded as a shared library"));  // not a library
}

}  // namespace sf
