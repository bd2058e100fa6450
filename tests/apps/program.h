#pragma once
// The built program as a user runs it: a process with arguments, an environment, two streams and an exit code.

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace sf {

using Words = std::vector<std::string>;
using Environment = std::vector<std::pair<std::string, std::string>>;

/// A folder of its own for one test, gone with it.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string path(const std::string& name = "") const { return (path_ / name).string(); }
  /// Writes `text` to `name` in it and returns the file's path.
  std::string write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

struct Outcome {
  int code = -1;   ///< exit code; -1: ended by a signal
  int signal = 0;  ///< that ended it
  std::string out;
  std::string err;
};

/// A running program; killed when it goes, if it still runs. There is no display in its environment.
class Program {
 public:
  /// @param environment added to the test's own
  /// @param out, err files that its streams are written to, other than its own
  /// @param program another than the built one, found in PATH
  explicit Program(const Words& arguments, const Environment& environment = {}, const std::string& out = "",
                   const std::string& err = "", const std::string& program = "");
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Standard error so far.
  std::string err() const;
  bool running();
  /// Until `text` stands on standard error; false when it ended before, or after a minute.
  bool says(const std::string& text);
  /// Until it handles the signal; false when it ended before, or after a minute.
  bool handles(int number);
  void signal(int number) const;
  /// Until it ends; killed after two minutes.
  Outcome wait();

 private:
  Folder folder_;
  std::string out_, err_;
  pid_t pid_ = -1;
  bool ended_ = false;
  int status_ = 0;
};

/// Runs it to its end.
Outcome run_program(const Words& arguments, const Environment& environment = {});

/// This machine's shell runs `command` without an error.
bool succeeds(const std::string& command);
/// With the modules that clients need.
inline bool have_python() { return succeeds("python3 -c 'import argparse, select, socket, struct'"); }

/// Environment without drivers: Vulkan finds no device.
Environment no_device();

/// A world in the sources, e.g. "rooms.world".
std::string our_world(const std::string& name);

/// Contents of a file; empty when it does not exist.
std::string read_file(const std::string& path);

/// Lines of `text` that are not empty.
std::size_t count_lines(const std::string& text);

/// First of `count` neighbouring UDP ports on loopback that nobody has now. They are kept from other tests until this
/// one ends: a TCP port among every 64, which no program of ours uses, is taken as a mark.
unsigned free_ports(unsigned count);

}  // namespace sf
