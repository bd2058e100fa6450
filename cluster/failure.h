#pragma once
// Errors that all ranks know of: the job ends as a process of its own would, with one message and one exit code.

#include <functional>
#include <stdexcept>
#include <string>

#include "cluster/ranks.h"

namespace sf::cluster {

/// The first rank's error, thrown on all of them.
class Failure : public std::runtime_error {
 public:
  Failure(int code, const std::string& message) : std::runtime_error(message), code_(code) {}
  int code() const { return code_; }  ///< exit code of the program

 private:
  int code_;
};

/// Exit code of the exception that is being handled: 2 base::InputError, 3 base::DeviceError, 1 any other.
/// @param message out
int code_of_current(std::string& message);

/// Runs `body` on all ranks. @throws Failure on all of them where it threw on one
void agree(Ranks& ranks, const std::function<void()>& body);
/// Likewise; without ranks `body()` with its own error. @param ranks may be null
void agree(Ranks* ranks, const std::function<void()>& body);

}  // namespace sf::cluster
