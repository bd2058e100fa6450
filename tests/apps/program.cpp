#include "tests/apps/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

#include "base/error.h"
#include "netio/socket.h"
#include "tests/refusal.h"

extern char** environ;

namespace sf {

namespace {

using Clock = std::chrono::steady_clock;

/// The program under test: from this build, or another build of the same sources (one with sanitizers).
const char* program_path() {
  const char* other = std::getenv("SENSORFARM_PROGRAM");
  return other != nullptr ? other : SF_PROGRAM;
}

void nap() { std::this_thread::sleep_for(std::chrono::milliseconds(5)); }

std::vector<std::string> environment_of(const Environment& added) {
  std::vector<std::string> words;
  for (char** word = environ; *word != nullptr; ++word) {
    const std::string text = *word;
    const std::string name = text.substr(0, text.find('='));
    bool keep = name != "DISPLAY" && name != "WAYLAND_DISPLAY" && name != "SENSORFARM_DEVICE" &&
                name != "SENSORFARM_REQUIRE_VULKAN";
    for (const auto& [key, value] : added) keep = keep && name != key;
    if (keep) words.push_back(text);
  }
  for (const auto& [key, value] : added) words.push_back(key + "=" + value);
  return words;
}

/// @throws base::InputError if another process uses it.
netio::Socket take_tcp(unsigned port) {
  netio::Socket socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(netio::kLoopback);
  if (bind(socket.descriptor(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw base::InputError("port " + std::to_string(port) + " is marked");
  return socket;
}

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> all;
  for (std::string& word : words) all.push_back(word.data());
  all.push_back(nullptr);
  return all;
}

}  // namespace

Folder::Folder() {
  std::string name = (std::filesystem::temp_directory_path() / "sensorfarm_test_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) std::abort();
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string Folder::write(const std::string& name, const std::string& text) const {
  std::ofstream(path(name), std::ios::binary) << text;
  return path(name);
}

Program::Program(const Words& arguments, const Environment& environment, const std::string& out, const std::string& err,
                 const std::string& program)
    : out_(out.empty() ? folder_.path("out") : out), err_(err.empty() ? folder_.path("err") : err) {
  Words words{program.empty() ? program_path() : program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<std::string> variables = environment_of(environment);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, 1, out_.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addopen(&files, 2, err_.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  const int failed =
      posix_spawnp(&pid_, words[0].c_str(), &files, nullptr, pointers(words).data(), pointers(variables).data());
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) ADD_FAILURE() << "cannot start " << words[0];
  ended_ = failed != 0;
}

Program::~Program() {
  if (!running()) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, &status_, 0);
}

std::string Program::err() const { return std::filesystem::is_fifo(err_) ? "" : read_file(err_); }

bool Program::running() {
  if (!ended_) ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
  return !ended_;
}

bool Program::prints(const std::string& text) {
  const auto deadline = Clock::now() + std::chrono::minutes(1);
  while (err().find(text) == std::string::npos) {
    if (!running() || Clock::now() > deadline) return err().find(text) != std::string::npos;
    nap();
  }
  return true;
}

namespace {

bool has_handler(const std::string& process, int signal) {
  const std::string status = read_file(process + "/status");
  const std::size_t at = status.find("SigCgt:");
  if (at == std::string::npos) return false;
  return (std::strtoull(status.c_str() + at + 7, nullptr, 16) >> (signal - 1) & 1u) != 0;
}

}  // namespace

bool Program::handles(int number) {
  const auto deadline = Clock::now() + std::chrono::minutes(1);
  for (; running() && Clock::now() < deadline; nap()) {
    const std::string process = "/proc/" + std::to_string(pid_);
    if (has_handler(process, number)) return true;
    // A supervising parent forwards signals (apps/processes/supervision.h).
    const int child = std::atoi(read_file(process + "/task/" + std::to_string(pid_) + "/children").c_str());
    if (child > 0 && has_handler("/proc/" + std::to_string(child), number)) return true;
  }
  return false;
}

void Program::signal(int number) const { kill(pid_, number); }

Outcome Program::wait() {
  const auto deadline = Clock::now() + std::chrono::minutes(2);
  while (running()) {
    if (Clock::now() > deadline) {
      ADD_FAILURE() << "did not end within two minutes; standard error: " << err();
      kill(pid_, SIGKILL);
    }
    nap();
  }
  Outcome outcome;
  outcome.code = WIFEXITED(status_) ? WEXITSTATUS(status_) : -1;
  outcome.signal = WIFSIGNALED(status_) ? WTERMSIG(status_) : 0;
  outcome.out = out_ == "/dev/full" ? "" : read_file(out_);
  outcome.err = err();
  return outcome;
}

Outcome Program::stop(int number) {
  signal(number);
  return wait();
}

Outcome run_program(const Words& arguments, const Environment& environment) {
  return Program(arguments, environment).wait();
}

Outcome run_successfully(const Words& arguments, const Environment& environment) {
  const Outcome outcome = run_program(arguments, environment);
  EXPECT_EQ(outcome.code, 0) << testing::PrintToString(arguments) << "\n" << outcome.out << outcome.err;
  return outcome;
}

void expect_refused(const Words& arguments, const std::string& message, const std::string& also) {
  const Outcome outcome = run_program(arguments);
  SCOPED_TRACE(testing::PrintToString(arguments));
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
  EXPECT_EQ(outcome.err.rfind("sensorfarm: ", 0), 0u) << outcome.err;
  expect_in(message, outcome.err);
  expect_in(also, outcome.err);
  EXPECT_EQ(outcome.out, "");
}

bool until(const std::function<bool()>& done) {
  for (int i = 0; i < 6000; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

bool succeeds(const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()) == 0; }

Environment no_device() { return {{"VK_DRIVER_FILES", "/nonexistent"}, {"VK_ICD_FILENAMES", "/nonexistent"}}; }

std::string our_world(const std::string& name) { return SF_SOURCE_DIR "/worlds/" + name; }

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::size_t count_lines(const std::string& text) {
  std::istringstream lines(text);
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line);) count += !line.empty();
  return count;
}

unsigned free_ports(unsigned count) {
  // Tests may run in parallel: each starts its search at another port.
  unsigned base = 11'000 + static_cast<unsigned>(getpid()) * 64 % 20'000;
  constexpr unsigned kBlock = 64;  // ports per mark
  static std::vector<netio::Socket> marks;
  for (int attempt = 0; attempt < 200; ++attempt, base = 11'000 + (base + count) % 20'000) {
    const std::size_t before = marks.size();
    try {
      for (unsigned block = base / kBlock; block <= (base + count - 1) / kBlock; ++block)
        marks.push_back(take_tcp(kBlock * block));
      std::vector<netio::Socket> sockets;
      for (unsigned i = 0; i < count; ++i)
        sockets.push_back(netio::open_udp({netio::kLoopback, static_cast<std::uint16_t>(base + i)}));
      return base;
    } catch (const base::InputError&) {
      marks.erase(marks.begin() + static_cast<std::ptrdiff_t>(before), marks.end());
    }
  }
  ADD_FAILURE() << "no free ports";
  return 0;
}

}  // namespace sf
