#pragma once
// Records of a text table: RFC 4180 with any separator, and with geometries whose commas are not quoted.

#include <string>
#include <string_view>
#include <vector>

#include "base/files.h"

namespace sf::world {

/// Returns `text` without surrounding blanks and line ends.
std::string_view without_blanks(std::string_view text);

/// The current record of a file. Views are valid until the next non-const call.
class TableRecord {
 public:
  explicit TableRecord(const std::string& file) : lines_(file) {}

  /// Advances to the next line that is not blank. It has no fields until `split`. Returns false after the last line.
  bool next();
  /// Splits the record.
  /// @param joins appends following lines while a quote is open, or the parentheses of an unquoted geometry at the
  /// start of the record
  /// @return whether all of them are closed
  bool split(char separator, bool joins);
  /// Undoes the joining of lines.
  void part();

  std::size_t size() const { return fields_.size(); }  ///< up to 10 000; further fields are ignored
  /// Returns field `i` without its quotes and surrounding blanks; empty beyond the last field.
  std::string_view field(std::size_t i) const;
  bool is_quoted(std::size_t i) const { return fields_[i].is_quoted; }
  /// Returns the first text between a closing quote and the next separator; empty in a well-formed record.
  std::string_view behind_quote() const { return without_blanks(line_.substr(behind_.begin, behind_.size())); }
  std::string_view line() const { return line_; }
  bool is_joined() const { return last_line() > first_line(); }
  int first_line() const { return lines_.number(); }  ///< 1-based
  int last_line() const { return lines_.last_number(); }

 private:
  struct Span {
    std::size_t begin = 0, end = 0;
    bool is_quoted = false;
    std::size_t size() const { return end - begin; }
  };
  void trim_line();
  bool extend();
  bool is_separator(std::size_t at) const { return at < line_.size() && line_[at] == separator_; }
  std::size_t quoted_field(std::size_t begin);
  std::size_t plain_field(std::size_t begin);
  std::size_t closing_quote(std::size_t from);
  bool close_parentheses(std::size_t from);

  base::LineFile lines_;
  std::string_view line_;     ///< several lines if joined
  std::vector<Span> fields_;  ///< in `line_`, without their quotes
  Span behind_;               ///< in `line_`
  char separator_ = ',';
  bool joins_ = false;
  bool closed_ = true;
  int unclosed_left_ = 0;  ///< fields that may still be searched for the end of a geometry; bounds the work per record
};

}  // namespace sf::world
