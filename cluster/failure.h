#pragma once
// Errors that are shared by all ranks: the job ends with one message and one exit code, like a single process.

#include <functional>
#include <stdexcept>
#include <string>

#include "cluster/ranks.h"

namespace sf::cluster {

/// The first rank's error, thrown on all ranks.
class Failure : public std::runtime_error {
 public:
  Failure(int code, const std::string& message) : std::runtime_error(message), code_(code) {}
  int code() const { return code_; }  ///< exit code of the program

 private:
  int code_;
};

/// Returns the exit code of the exception that is being handled: 2 base::InputError, 3 base::DeviceError, 1 any other.
/// @param message out
int code_of_current(std::string& message);

/// Runs `body` on all ranks. @throws Failure on all ranks if it throws on one
void agree(Ranks& ranks, const std::function<void()>& body);
/// Does the same; without ranks it calls `body()`, which throws its own error. @param ranks may be null
void agree(Ranks* ranks, const std::function<void()>& body);

}  // namespace sf::cluster
