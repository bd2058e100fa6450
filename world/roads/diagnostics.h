#pragma once
// Collects the problems of a road network or a mission. Some mistakes in hand-written files have an obvious
// interpretation, others do not.
//
// In strict mode the first problem is thrown. Otherwise, a problem with an obvious interpretation becomes a warning
// that states it. All others are collected, so that one error lists them all.

#include <string>
#include <vector>

#include "base/error.h"
#include "world/world.h"

namespace sf::world {

/// Thrown for a file of another format. Ends the diagnosis: other problems of the file are not reported.
struct WrongFormatError : base::InputError {
  using base::InputError::InputError;
};

class Diagnostics {
 public:
  /// @param warnings receives the tolerated problems; must outlive this object
  Diagnostics(std::string file, bool strict, std::vector<Warning>& warnings)
      : file_(std::move(file)), strict_(strict), warnings_(&warnings) {}

  bool strict() const { return strict_; }

  /// Adds a problem with an obvious interpretation.
  /// @param remedy advice for the user
  /// @param taken the interpretation used
  /// @throws base::InputError in strict mode. After 10 000 warnings, adds an error
  void add_warning(int line, const std::string& what, const std::string& remedy, const std::string& taken);
  /// Adds a problem without an obvious interpretation.
  /// @throws base::InputError in strict mode, and at the hundredth such problem
  void add_error(int line, const std::string& what);

  /// Calls `act()`. An exception counts as one problem of `line` and gives false.
  /// @throws base::InputError in strict mode
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

  /// @throws base::InputError with all collected errors in order of lines, if there are any
  void throw_errors();

 private:
  void keep(int line, const std::string& text);

  std::string file_;
  bool strict_;
  std::vector<Warning>* warnings_;
  std::vector<std::pair<int, std::string>> refused_;  ///< line and whole message
};

}  // namespace sf::world
