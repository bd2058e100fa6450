#pragma once
// Access to the output of --json by JSON pointers such as "/beams/0/range_m".

#include <memory>
#include <string>
#include <vector>

#include "tests/apps/program.h"

namespace sf {

class Json {
 public:
  /// Fails the test if `text` is not valid JSON; the object is then empty.
  explicit Json(const std::string& text);
  ~Json();

  /// Each fails the test and returns 0, "" or false if there is no value of that type.
  double number(const std::string& pointer) const;
  std::string text(const std::string& pointer) const;
  bool flag(const std::string& pointer) const;
  std::size_t size(const std::string& pointer) const;  ///< of an array or object

  bool has(const std::string& pointer) const;
  bool is_null(const std::string& pointer) const;
  std::vector<std::string> keys() const;  ///< of the root

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// Runs the program, expects success, and reads its standard output.
Json run_json(const Words& arguments);

}  // namespace sf
