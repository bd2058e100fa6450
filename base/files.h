#pragma once
// Files from outside: whole ones of limited size, and larger ones a line at a time.

#include <cstddef>
#include <string>
#include <string_view>

namespace sf::base {

/// The whole content of a file. @throws InputError when the file is missing, not a regular file (a folder, a
/// device, a pipe), empty, larger than `most` bytes, or not readable to its end.
std::string read_bytes(const std::string& file, std::size_t most);
/// Likewise for a text. @throws InputError also for a text without content.
std::string read_text(const std::string& file, std::size_t most = 64u << 20);

/// The lines of a text file of any size, read in blocks.
class LineFile {
 public:
  /// @throws InputError when the file is missing or not a regular file
  explicit LineFile(const std::string& file);
  ~LineFile();
  LineFile(const LineFile&) = delete;

  /// The next line without its end (LF or CRLF) in `line`, which lives until the next call; false after the last one.
  /// @throws InputError for a line of more than 16 MiB, and when reading fails
  bool next(std::string_view& line);
  /// Appends the following line to the current one, with the line end between them. @return false, without a change,
  /// where none follows, or both have more than 16 MiB
  bool extend(std::string_view& line);
  /// Undoes `extend`: the current line is the first one again, and `next` returns the one after it.
  void shrink(std::string_view& line);
  int number() const { return number_; }                   ///< of the (first) line, 1-based
  int last_number() const { return number_ + appended_; }  ///< of the last one appended to it

 private:
  bool refill();
  std::size_t find_end(std::size_t from);
  std::string_view line_to(std::size_t end) const;
  std::string file_;
  int descriptor_;
  std::string buffer_;
  std::size_t begin_ = 0;      ///< of the current line
  std::size_t end_ = 0;        ///< of its text, with appended lines
  std::size_t first_end_ = 0;  ///< of its text without them
  int number_ = 0;
  int appended_ = 0;
};

}  // namespace sf::base
