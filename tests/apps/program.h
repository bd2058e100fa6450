#pragma once
// Runs the built program as users do: a process with arguments, an environment, two streams and an exit code.

#include <sys/types.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace sf {

using Words = std::vector<std::string>;
using Environment = std::vector<std::pair<std::string, std::string>>;

/// A temporary folder for one test, removed by the destructor.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string path(const std::string& name = "") const { return (path_ / name).string(); }
  /// Writes `text` to the file `name` in the folder and returns its path.
  std::string write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

struct Outcome {
  int code = -1;   ///< exit code; -1: ended by a signal
  int signal = 0;  ///< signal that ended it
  std::string out;
  std::string err;
};

/// A running program; the destructor kills it if it still runs. Its environment has no display.
class Program {
 public:
  /// @param environment added to the test's own
  /// @param out, err files for its streams
  /// @param program another program, found in PATH
  explicit Program(const Words& arguments, const Environment& environment = {}, const std::string& out = "",
                   const std::string& err = "", const std::string& program = "");
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Returns standard error so far.
  std::string err() const;
  bool running();
  /// Waits until `text` is on standard error; false if the program ends first, or after a minute.
  bool prints(const std::string& text);
  /// Waits until the program handles the signal; false if it ends first, or after a minute.
  bool handles(int number);
  void signal(int number) const;
  /// Sends the signal and waits until the program ends.
  Outcome stop(int number = SIGINT);
  /// Waits until the program ends; kills it after two minutes.
  Outcome wait();

 private:
  Folder folder_;
  std::string out_, err_;
  pid_t pid_ = -1;
  bool ended_ = false;
  int status_ = 0;
};

/// Runs the program until it ends.
Outcome run_program(const Words& arguments, const Environment& environment = {});
/// Runs the program and expects success.
Outcome run_successfully(const Words& arguments, const Environment& environment = {});
/// Runs the program and expects a refusal: exit code 2 and one line with `message` and `also`.
void expect_refused(const Words& arguments, const std::string& message = "", const std::string& also = "");

/// Polls `done` for up to a minute.
bool until(const std::function<bool()>& done);

/// Returns `words` followed by `more`.
Words with(Words words, const Words& more);

/// True if this machine's shell runs `command` without an error.
bool succeeds(const std::string& command);
/// True if Python has the modules that the clients need.
inline bool have_python() { return succeeds("python3 -c 'import argparse, select, socket, struct'"); }

/// An environment without drivers, so that Vulkan finds no device.
Environment no_device();

/// Returns the path of a world in the sources, e.g. "rooms.world".
std::string our_world(const std::string& name);

/// Returns the contents of a file; empty if it does not exist.
std::string read_file(const std::string& path);

/// Returns the number of non-empty lines in `text`.
std::size_t count_lines(const std::string& text);

/// Returns the first of `count` consecutive free UDP ports on loopback. They are reserved for this test until it ends:
/// one TCP port per 64, which no program here uses, serves as a mark.
unsigned free_ports(unsigned count);

}  // namespace sf
