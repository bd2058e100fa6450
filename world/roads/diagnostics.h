#pragma once
// What is wrong in a road network or a mission: files that were written by hand have slips in them whose meaning is
// clear, and others that have none.
//
// Read strictly, the first problem is thrown. Otherwise a problem of clear meaning becomes a warning that says how it
// is read, and the others are gathered, so that one reading names them all.

#include <string>
#include <vector>

#include "base/error.h"
#include "world/world.h"

namespace sf::world {

/// A file of another kind: nothing else in it is worth a word.
struct WrongFormatError : base::InputError {
  using base::InputError::InputError;
};

class Diagnostics {
 public:
  /// @param warnings gets what is tolerated; must outlive this
  Diagnostics(std::string file, bool strict, std::vector<Warning>& warnings)
      : file_(std::move(file)), strict_(strict), warnings_(&warnings) {}

  bool strict() const { return strict_; }

  /// Something of clear meaning. @param remedy what to do, @param taken how it is read meanwhile
  /// @throws base::InputError where this is strict
  void add_warning(int line, const std::string& what, const std::string& remedy, const std::string& taken);
  /// Something without a meaning. @throws base::InputError where this is strict, and beyond a hundred of them
  void add_error(int line, const std::string& what);

  /// `act()`; false where it threw, which is one problem of `line` then. @throws base::InputError where this is strict
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

  /// @throws base::InputError with all that was refused, line by line, where anything was.
  void throw_errors();

 private:
  void keep(int line, const std::string& text);

  std::string file_;
  bool strict_;
  std::vector<Warning>* warnings_;
  std::vector<std::pair<int, std::string>> refused_;  ///< line, and the whole message
};

}  // namespace sf::world
