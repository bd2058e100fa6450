#pragma once
// Reads files from outside: whole files of limited size, and larger files line by line.

#include <cstddef>
#include <string>
#include <string_view>

namespace sf::base {

/// Returns the ending of a file's name in lower case, such as ".stl"; empty: it has none.
std::string ending_of(const std::string& file);

/// Returns the whole content of a file. @throws InputError when the file is missing, not a regular file (a folder, a
/// device, a pipe), empty, larger than `most` bytes, or not readable to its end.
std::string read_bytes(const std::string& file, std::size_t most);
/// Same for a text file. @throws InputError also for a text without content.
std::string read_text(const std::string& file, std::size_t most = 64u << 20);

/// Reads the lines of a text file of any size, block by block.
class LineFile {
 public:
  /// @throws InputError when the file is missing or not a regular file
  explicit LineFile(const std::string& file);
  ~LineFile();
  LineFile(const LineFile&) = delete;

  /// Sets `line` to the next line without its end (LF or CRLF). The view is valid until the next call. Returns false
  /// after the last line.
  /// @throws InputError for a line of more than 16 MiB and for read errors
  bool next(std::string_view& line);
  /// Appends the following line to the current one, with the line end between them. @return false, without a change,
  /// when there is no following line or both together exceed 16 MiB
  bool extend(std::string_view& line);
  /// Undoes `extend`: restores the first line as the current line; `next` then returns the line after it.
  void shrink(std::string_view& line);
  int number() const { return number_; }                   ///< of the (first) line, 1-based
  int last_number() const { return number_ + appended_; }  ///< of the last appended line

 private:
  bool refill();
  std::size_t find_end(std::size_t from);
  std::string_view line_to(std::size_t end) const;
  std::string file_;
  int descriptor_;
  std::string buffer_;
  std::size_t begin_ = 0;      ///< start of the current line
  std::size_t end_ = 0;        ///< end of its text, including appended lines
  std::size_t first_end_ = 0;  ///< end of its text, excluding appended lines
  int number_ = 0;
  int appended_ = 0;
};

}  // namespace sf::base
