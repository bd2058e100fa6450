#pragma once
// Two families of errors. `check` aborts with the values when a contract inside the farm is broken. `InputError`
// reports a fault in the user's input (a file, an option, a machine) and names the place, the expected value and the
// remedy.

#include <stdexcept>
#include <string>

namespace sf::base {

/// An error that the user can correct. `what()` is one complete line: `file:line: message` if a file is known.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
  /// @param line 1-based; 0 refers to the whole file
  InputError(const std::string& file, int line, const std::string& message)
      : std::runtime_error(file + (line > 0 ? std::string(":").append(std::to_string(line)) : std::string()) + ": " +
                           message) {}
};

/// Thrown when there is no usable device. A separate type, because programs then end with exit code 3.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Aborts with file, line and `message` when `condition` is false. For errors of the program, never of the user.
void check(bool condition, const char* file, int line, const std::string& message);

}  // namespace sf::base

#define SF_CHECK(condition, message)                                         \
  do {                                                                       \
    if (!(condition)) ::sf::base::check(false, __FILE__, __LINE__, message); \
  } while (false)
