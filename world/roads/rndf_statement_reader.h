#pragma once
// The lines of RNDF and MDF files (DARPA, "Route Network Definition File (RNDF) and Mission Data File (MDF) Formats",
// 14 March 2007): one statement per line, fields separated by blanks and tabs, comments between /* and */.
//
// Tolerates the variants of real files: line ends LF, CR and CRLF, trailing blanks, comments on separate lines or
// across several lines, and a byte order mark.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "world/roads/diagnostics.h"

namespace sf::world {

/// Integers in these formats are in [0, 32768].
inline constexpr int kMaxRoadNumber = 32768;

/// `segment.lane.point` (lane 0: perimeter of a zone) or `zone.spot.point`. All in [0, 32768]; {0, 0, 0}: none.
struct PointId {
  std::uint16_t segment = 0;
  std::uint16_t lane = 0;
  std::uint16_t point = 0;

  friend bool operator==(PointId, PointId) = default;
  friend auto operator<=>(PointId, PointId) = default;
};
std::string point_id_text(PointId id);
/// Reads "3.1.5", or "3.1" if two parts are expected. Returns nullopt for any other text.
std::optional<PointId> read_point_id(std::string_view text, int parts = 3);

/// One statement. All views are valid until the next call of `StatementReader::next`.
struct RoadStatement {
  std::string_view keyword;              ///< first field
  std::vector<std::string_view> fields;  ///< fields after the keyword
  std::string_view rest;                 ///< the line after the keyword, without surrounding blanks
  int line = 0;                          ///< 1-based
};

/// Splits a file into statements.
class StatementReader {
 public:
  /// @param text must outlive the reader, as must `diagnostics`
  StatementReader(std::string file, std::string_view text, Diagnostics& diagnostics);

  /// Advances to the next non-empty line. Returns false at the end of the file.
  /// @throws base::InputError for an unterminated comment, or a byte that is not text
  bool next();
  const RoadStatement& now() const { return now_; }
  const std::string& file() const { return file_; }
  /// Returns the number of the last line read; at the end, that of the file's last line.
  int line() const { return line_; }

  /// Throws base::InputError with the line of the current statement.
  [[noreturn]] void fail(const std::string& message) const;

  /// Returns field `i` of the current statement as an integer in [least, 32768], as a decimal number, or as a
  /// way-point.
  /// @param what name of the field for errors, e.g. "the number of lanes"
  /// @throws base::InputError if the field is missing or malformed
  int whole(std::size_t i, int least, std::string_view what) const;
  double decimal(std::size_t i, std::string_view what) const;
  PointId point(std::size_t i, std::string_view what) const;
  /// Returns the keyword itself as a way-point: `M.L.P latitude longitude`.
  PointId keyword_point(std::string_view what) const { return numbers(now_.keyword, 3, what); }
  /// Returns the keyword itself as an integer in [least, 32768].
  int keyword_whole(int least, std::string_view what) const { return whole(now_.keyword, least, what); }
  /// Returns `M.L` as {M, L, 0}.
  PointId pair(std::size_t i, std::string_view what) const;
  /// Ignores fields after the first `count` following the keyword, with a warning.
  void expect_fields(std::size_t count) const;
  /// @throws base::InputError if more than `count` fields follow the keyword
  void require_fields(std::size_t count) const;

 private:
  bool read_line();
  std::string_view field(std::size_t i, std::string_view what) const;
  int whole(std::string_view text, int least, std::string_view what) const;
  PointId numbers(std::string_view text, int count, std::string_view what) const;

  std::string extra(std::size_t count) const;

  std::string file_;
  std::string_view text_;
  Diagnostics& diagnostics_;
  std::size_t at_ = 0;
  int line_ = 0;
  int comment_ = 0;  ///< line where the open comment started; 0: no open comment
  std::string current_;
  RoadStatement now_;
};

/// Returns true if `keyword` starts with a digit: the keyword of a way-point line is its number.
bool is_number(std::string_view keyword);

/// Returns a field as quoted in errors: shortened, without control characters.
std::string quoted(std::string_view text);

}  // namespace sf::world
