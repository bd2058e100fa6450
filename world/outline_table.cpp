#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include "base/error.h"
#include "base/files.h"
#include "world/outline_rows.h"
#include "world/well_known_geometry.h"

namespace sf::world {

namespace {

constexpr std::string_view kSeparators = ",;\t|";
constexpr std::array<std::string_view, 8> kGeometryNames{"wkt",          "geom",  "geometry", "the_geom",
                                                         "wkb_geometry", "shape", "way",      "wkt_geom"};
constexpr std::string_view kContinuations = "0123456789+-.,()";  // first characters of lines within a geometry
constexpr std::size_t kNoColumn = std::string_view::npos;
constexpr std::size_t kKnownField = 1'000'000;  // weighs more than any number of fields
constexpr std::size_t kMaxFields = 10'000;      // of a row; those beyond are ignored
constexpr std::size_t kShownColumns = 20;
constexpr std::size_t kShownCharacters = 32;

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == kNoColumn) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") + 1 - first);
}

bool same_letters(std::string_view text, std::string_view word) {
  return std::equal(text.begin(), text.end(), word.begin(), word.end(),
                    [](unsigned char a, unsigned char b) { return std::tolower(a) == b; });
}

bool is_geometry_name(std::string_view name) {
  return std::any_of(kGeometryNames.begin(), kGeometryNames.end(),
                     [&](std::string_view known) { return same_letters(name, known); });
}

/// The whole text is one, as far as its parentheses show.
bool is_geometry(std::string_view text) {
  const GeometryGuess guess = guess_geometry(text);
  return guess.content != GeometryGuess::Content::none && guess.length == text.size();
}

/// Separated values: RFC 4180, with any of four separators, and geometries whose commas are not quoted.
class OutlineTable : public OutlineRows {
 public:
  explicit OutlineTable(const std::string& file) : file_(file), lines_(file) {}

  bool next(OutlineRow& row) override {
    while (lines_.next(line_)) {
      drop_mark();
      if (without_blanks(line_).empty() || (!begun_ && !begin())) continue;
      read_record();
      row.line = lines_.number();
      row.geometry = geometry_of_record();
      row.height = without_blanks(field(height_));
      return true;
    }
    return false;
  }

  std::string columns() const override {
    if (names_.empty()) return "its first line does not name its columns";
    std::string text = "its columns are ";
    for (std::size_t i = 0; i < std::min(names_.size(), kShownColumns); ++i)
      text += fmt::format("{}'{}'", i > 0 ? ", " : "", names_[i].substr(0, kShownCharacters));
    return text + (names_.size() > kShownColumns ? ", ..." : "");
  }
  std::string remark() const override {
    if (!unnamed_) return {};
    return "the first line does not name the columns, so those without geometries are ignored, heights too";
  }

 private:
  void drop_mark() {  // byte order mark
    if (lines_.number() == 1 && line_.starts_with("\xEF\xBB\xBF")) line_.remove_prefix(3);
  }
  std::string_view field(std::size_t column) const {
    return column < fields_.size() ? line_.substr(fields_[column].begin, fields_[column].end - fields_[column].begin)
                                   : std::string_view();
  }

  /// Reads how the table is written from its first line. @return whether that is a row, too
  bool begin() {
    if (line_.size() == 5 && line_.starts_with("sep=")) {  // as Excel writes and reads it
      separator_ = line_.back();
      return false;
    }
    if (line_.find('\r') != kNoColumn)
      throw base::InputError(file_, 1, "a line ends in CR alone; convert the ends of lines to LF (tr '\\r' '\\n')");
    begun_ = true;
    if (separator_ == 0) choose_separator();
    read_record();
    for (std::size_t i = 0; i < fields_.size(); ++i)
      if (guess_geometry(without_blanks(field(i))).content != GeometryGuess::Content::none) {
        unnamed_ = fields_.size() > 1;
        return true;
      }
    for (std::size_t i = 0; i < fields_.size(); ++i) {  // the first of equal names counts
      names_.emplace_back(without_blanks(field(i)));
      if (height_ == kNoColumn && same_letters(names_[i], "height")) height_ = i;
      if (named_ == kNoColumn && is_geometry_name(names_[i])) named_ = i;
    }
    return false;
  }

  /// That which makes known names or geometries of the line, else the most fields.
  void choose_separator() {
    std::size_t best = 0;
    char chosen = ',';
    for (const char separator : kSeparators) {
      separator_ = separator;
      split(false);
      std::size_t score = fields_.size();
      for (std::size_t i = 0; i < fields_.size(); ++i) {
        const std::string_view text = without_blanks(field(i));
        if (is_geometry_name(text) || same_letters(text, "height") || is_geometry(text)) score += kKnownField;
      }
      if (score > best) chosen = separator;
      best = std::max(best, score);
    }
    separator_ = chosen;
  }

  /// A record of several lines whose geometry does not end well has a quote that was never closed: its first line is
  /// then a record of its own. The lines after it up to the next quote are not joined again, so that each line is
  /// scanned twice at most.
  void read_record() {
    const bool closed = split(lines_.number() >= joined_);
    if (closed && (lines_.last_number() == lines_.number() || geometry_ends_well())) return;
    joined_ = std::max(joined_, lines_.last_number());
    lines_.shrink(line_);
    drop_mark();
    split(false);
  }
  bool geometry_ends_well() {
    const std::string_view text = geometry_of_record();
    return text.empty() || is_geometry(text);
  }

  /// Sets `fields_`. @param joins appends following lines where a quote is open  @return whether all quotes are closed
  bool split(bool joins) {
    fields_.clear();
    bool closed = true;
    for (std::size_t at = 0; at != kNoColumn && fields_.size() < kMaxFields;) {
      while (at < line_.size() && (line_[at] == ' ' || (line_[at] == '\t' && separator_ != '\t'))) ++at;
      std::size_t end = at;
      if (at < line_.size() && line_[at] == '"') {
        end = closing_quote(++at, joins);
        closed = closed && end < line_.size();
        fields_.push_back({at, end});
        at = line_.find(separator_, end);
      } else {
        std::size_t length = guess_geometry(line_.substr(at)).length;
        if (length == kNoColumn && joins && fields_.empty()) {
          closed = close_parentheses(at);
          length = guess_geometry(line_.substr(at)).length;
        }
        end = length == kNoColumn ? kNoColumn : line_.find(separator_, at + length);
        fields_.push_back({at, std::min(end, line_.size())});
        at = end;
      }
      if (at != kNoColumn) ++at;
    }
    return closed;
  }

  /// The first quote that ends a field; two in a row stand for one within it. The end of the line where there is none.
  std::size_t closing_quote(std::size_t from, bool joins) {
    for (;;) {
      const std::size_t at = line_.find('"', from);
      if (at == kNoColumn) {
        from = line_.size();
        const bool more = joins && lines_.extend(line_);
        drop_mark();
        if (!more) return from;
      } else if (at + 1 < line_.size() && line_[at + 1] == '"') {
        from = at + 2;
      } else {
        return at;
      }
    }
  }

  /// Appends lines to a geometry without quotes that begins a row, as long as they go on with it.
  bool close_parentheses(std::size_t from) {
    std::ptrdiff_t open = 0;
    for (;;) {
      const std::string_view text = line_.substr(from);
      open += std::count(text.begin(), text.end(), '(') - std::count(text.begin(), text.end(), ')');
      if (open <= 0) return true;
      from = line_.size();
      const bool more = lines_.extend(line_);
      drop_mark();
      const std::string_view next = without_blanks(line_.substr(from));
      if (!more || (!next.empty() && kContinuations.find(next.front()) == std::string_view::npos)) return false;
    }
  }

  /// The column of the first row that has walls is the column of all; a name decides between several.
  std::string_view geometry_of_record() {
    if (geometry_ != kNoColumn) return without_blanks(field(geometry_));
    std::size_t best = named_;
    int most = 0;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const auto content = guess_geometry(without_blanks(field(i))).content;
      if (content == GeometryGuess::Content::none) continue;
      const int score = (content == GeometryGuess::Content::walls ? 4 : 2) + (is_geometry_name(name(i)) ? 1 : 0);
      if (score > most) best = i;
      most = std::max(most, score);
    }
    if (most >= 4) geometry_ = best;
    return without_blanks(field(best));
  }
  std::string_view name(std::size_t column) const {
    return column < names_.size() ? names_[column] : std::string_view();
  }

  struct Span {
    std::size_t begin, end;
  };
  std::string file_;
  base::LineFile lines_;
  std::string_view line_;     ///< or several, where a field contains line ends
  std::vector<Span> fields_;  ///< of `line_`, without their quotes
  std::vector<std::string> names_;
  char separator_ = 0;  ///< 0: not known yet
  bool begun_ = false;
  bool unnamed_ = false;              ///< several columns without names
  int joined_ = 0;                    ///< lines before this one are not joined with the following ones
  std::size_t named_ = kNoColumn;     ///< column with a name for geometries
  std::size_t geometry_ = kNoColumn;  ///< column with geometries, once one was found
  std::size_t height_ = kNoColumn;
};

}  // namespace

std::unique_ptr<OutlineRows> open_outline_table(const std::string& file) {
  return std::make_unique<OutlineTable>(file);
}

}  // namespace sf::world
