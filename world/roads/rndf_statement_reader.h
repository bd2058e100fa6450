#pragma once
// The lines of RNDF and MDF files (DARPA, "Route Network Definition File (RNDF) and Mission Data File (MDF) Formats",
// 14 March 2007): one statement a line, fields separated by blanks and tabs, comments between /* and */.
//
// Read as real files are: LF, CR and CRLF end lines, blanks may trail, comments may stand alone or run over several
// lines, a byte order mark is skipped.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "world/roads/diagnostics.h"

namespace sf::world {

/// Whole numbers of these formats are in [0, 32768].
inline constexpr int kMaxRoadNumber = 32768;

/// `segment.lane.point` (lane 0: perimeter of a zone) or `zone.spot.point`. All in [0, 32768]; {0, 0, 0}: none.
struct PointId {
  std::uint16_t segment = 0;
  std::uint16_t lane = 0;
  std::uint16_t point = 0;

  friend bool operator==(PointId, PointId) = default;
  friend auto operator<=>(PointId, PointId) = default;
};
std::string text_of(PointId id);
/// "3.1.5", or "3.1" where two parts are expected; nothing where it is none.
std::optional<PointId> read_point_id(std::string_view text, int parts = 3);

/// One line that says something. All views live until the next call of `StatementReader::next`.
struct AccuracyStatement {
  std::string_view keyword;              ///< its first field
  std::vector<std::string_view> fields;  ///< those after it
  std::string_view rest;                 ///< all of the line after the keyword, without the blanks around it
  int line = 0;                          ///< 1-based
};

/// Cuts a file into statements.
class StatementReader {
 public:
  /// @param text must outlive this, as `diagnostics` must
  StatementReader(std::string file, std::string_view text, Diagnostics& diagnostics);

  /// Moves on to the next line that is not empty; false at the end of the file.
  /// @throws base::InputError for a comment that is never closed, or a byte that no text has.
  bool next();
  const AccuracyStatement& now() const { return now_; }
  const std::string& file() const { return file_; }
  /// Lines read so far: at the end, the file's last line.
  int line() const { return line_; }

  /// @throws base::InputError, always, at the current statement.
  [[noreturn]] void fail(const std::string& message) const;

  /// Field `i` of the current statement as a whole number in [least, 32768], as decimal number, as way-point.
  /// @param what the field is, e.g. "the number of lanes"
  /// @throws base::InputError where it is missing or something else.
  int whole(std::size_t i, int least, std::string_view what) const;
  double decimal(std::size_t i, std::string_view what) const;
  PointId point(std::size_t i, std::string_view what) const;
  /// The keyword itself as a way-point: `M.L.P latitude longitude`.
  PointId keyword_point(std::string_view what) const { return numbers(now_.keyword, 3, what); }
  /// The keyword itself as a whole number in [least, 32768].
  int keyword_whole(int least, std::string_view what) const { return whole(now_.keyword, least, what); }
  /// `M.L` as {M, L, 0}.
  PointId pair(std::size_t i, std::string_view what) const;
  /// Tolerates more than `count` fields after the keyword: what they say is left out.
  void expect_fields(std::size_t count) const;
  /// @throws base::InputError for them.
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
  int comment_ = 0;  ///< line where the open comment began; 0: none is open
  std::string current_;
  AccuracyStatement now_;
};

/// The keyword of a way-point line is its number: true when `keyword` starts with a digit.
bool is_number(std::string_view keyword);

/// Field as an error quotes it: shortened, without control characters.
std::string quoted(std::string_view text);

}  // namespace sf::world
