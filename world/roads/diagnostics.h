#pragma once
// Collected problems of a road network or a mission. Hand-written files have slips with a clear meaning, and slips
// without one.
//
// In strict mode the first problem is thrown. Otherwise a problem with a clear meaning becomes a warning that states
// the interpretation, and the others are collected, so that one error lists them all.

#include <string>
#include <vector>

#include "base/error.h"
#include "world/world.h"

namespace sf::world {

/// A file of another format. It ends the diagnosis: other problems of the file are not reported.
struct WrongFormatError : base::InputError {
  using base::InputError::InputError;
};

class Diagnostics {
 public:
  /// @param warnings receives the tolerated problems; must outlive this object
  Diagnostics(std::string file, bool strict, std::vector<Warning>& warnings)
      : file_(std::move(file)), strict_(strict), warnings_(&warnings) {}

  bool strict() const { return strict_; }

  /// A problem with a clear meaning. @param remedy advice for the user, @param taken the interpretation used
  /// @throws base::InputError in strict mode. Past 10 000 warnings it adds an error
  void add_warning(int line, const std::string& what, const std::string& remedy, const std::string& taken);
  /// A problem without a clear meaning. @throws base::InputError in strict mode, and at the hundredth such problem
  void add_error(int line, const std::string& what);

  /// Calls `act()`. An exception counts as one problem of `line`, and the result is false. @throws base::InputError in
  /// strict mode
  template <class Act>
  bool attempt(const int& line, Act&& act) {
    if (strict_) return act(), true;
    try {
      act();
      return true;
    } catch (const WrongFormatError&) {
      throw;
    } catch (const base::InputError& error) {
      keep(line, error.what());
      return false;
    }
  }

  /// @throws base::InputError with all collected errors in order of lines, when there are any.
  void throw_errors();

 private:
  void keep(int line, const std::string& text);

  std::string file_;
  bool strict_;
  std::vector<Warning>* warnings_;
  std::vector<std::pair<int, std::string>> refused_;  ///< line, and the whole message
};

}  // namespace sf::world
