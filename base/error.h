#pragma once
// Two families of errors. A broken contract inside the farm is a `check` that aborts with the values.
// What the user gave us (a file, an option, a machine) is an `InputError` that says where, what was expected and what
// to do.

#include <stdexcept>
#include <string>

namespace sf::base {

/// Something the user can mend. `what()` is one complete line: `file:line: message` where a file is known.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
  /// @param line 1-based; 0 when the whole file is meant.
  InputError(const std::string& file, int line, const std::string& message)
      : std::runtime_error(file + (line > 0 ? std::string(":").append(std::to_string(line)) : std::string()) + ": " +
                           message) {}
};

/// No usable device: its own type, since programs end with exit code 3.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Aborts with file, line and `message` when `condition` is false: our bug, never the user's.
void check(bool condition, const char* file, int line, const std::string& message);

}  // namespace sf::base

#define SF_CHECK(condition, message)                                         \
  do {                                                                       \
    if (!(condition)) ::sf::base::check(false, __FILE__, __LINE__, message); \
  } while (false)
