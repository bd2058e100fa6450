#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include "base/error.h"
#include "base/printable.h"
#include "world/outline_rows.h"
#include "world/table_record.h"
#include "world/well_known_geometry.h"

namespace sf::world {

namespace {

constexpr std::string_view kSeparators = ",;\t| ";
constexpr std::array<std::string_view, 8> kGeometryNames{"wkt",          "geom",  "geometry", "the_geom",
                                                         "wkb_geometry", "shape", "way",      "wkt_geom"};
constexpr std::size_t kNoColumn = std::string_view::npos;
constexpr std::size_t kKnownField = 1'000'000;    // outweighs any number of fields
constexpr std::size_t kMaxLookahead = 64u << 20;  // characters of lines that are joined to find the separator
constexpr std::size_t kShownColumns = 20;
constexpr std::size_t kShownCharacters = 32;

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

bool is_geometry_name(std::string_view name) {
  return name.size() <= kShownCharacters &&
         std::find(kGeometryNames.begin(), kGeometryNames.end(), lower_case(name)) != kGeometryNames.end();
}
bool is_height_name(std::string_view name) { return name.size() == 6 && lower_case(name) == "height"; }
bool is_known_name(std::string_view name) { return is_geometry_name(name) || is_height_name(name); }

bool may_be_geometry(std::string_view text) { return guess_geometry(text).content != GeometryGuess::Content::none; }
/// Returns whether the whole text is one geometry, judging by its parentheses.
bool is_geometry(std::string_view text) { return !text.empty() && guess_geometry(text).length == text.size(); }

/// Separated values with a column of geometries. The first lines determine the dialect.
class OutlineTable : public OutlineRows {
 public:
  explicit OutlineTable(const std::string& file) : file_(file), record_(file) {}

  bool next(OutlineRow& row) override {
    while (record_.next()) {
      if (searching_) {
        if (!begin()) continue;
      } else {
        read_record();
      }
      check_blanks();
      row.line = record_.first_line();
      row.geometry = geometry_of_record();
      row.height = record_.field(height_);
      row.behind_quote = record_.behind_quote();
      return true;
    }
    return false;
  }

  std::string columns() const override {
    if (names_.empty()) return "its first line does not name the columns";
    std::string text = "its columns are ";
    for (std::size_t i = 0; i < std::min(names_.size(), kShownColumns); ++i)
      text += fmt::format("{}{}", i > 0 ? ", " : "", shown(i));
    return text + (names_.size() > kShownColumns ? ", ..." : "");
  }
  std::string remark() const override { return fmt::format("{}", fmt::join(remarks_, "; ")); }

 private:
  /// Returns a column's name on one line.
  std::string shown(std::size_t column) const {
    if (column >= names_.size()) return fmt::format("{}", column + 1);
    return "'" + base::one_line(std::string_view(names_[column]).substr(0, kShownCharacters)) + "'";
  }

  /// Determines the dialect from a line before the first geometry: the line with known names, possibly below a title or
  /// a comment, or else the first line.
  /// @return whether the line is a row
  bool begin() {
    if (takes_separator()) return false;
    if (record_.line().find('\r') != kNoColumn)
      throw base::InputError(file_, record_.first_line(),
                             "a line ends in CR alone; convert line ends to LF (tr '\\r' '\\n')");
    const char before = separator_;
    if (!is_stated_) choose_separator();
    read_record();
    bool has_geometry = false, has_name = false, has_number = false;
    for (std::size_t i = 0; i < record_.size(); ++i) {
      const std::string_view text = record_.field(i);
      has_geometry = has_geometry || may_be_geometry(text);
      has_name = has_name || is_known_name(text);
      has_number = has_number || (!text.empty() && text.find_first_not_of("0123456789.+-eE") == kNoColumn);
    }
    if (has_geometry) return end_search(), true;
    if (names_.empty() || (has_name && !has_number)) return take_names(), false;
    separator_ = before;
    return true;
  }

  /// Warns about blanks that align columns, since they shift the fields after them.
  void check_blanks() {
    if (separator_ != ' ' || names_.empty() || is_uneven_ || record_.size() == names_.size()) return;
    is_uneven_ = true;
    remarks_.push_back(
        fmt::format("line {} has {} fields for {} names, since two blanks enclose an empty field: heights may not be "
                    "read; separate fields by tabs or single blanks",
                    record_.first_line(), record_.size(), names_.size()));
  }

  /// Handles `sep=;`, as written and read by Excel.
  bool takes_separator() {
    std::string_view line = record_.line();
    if (line.size() == 7 && line.starts_with('"') && line.ends_with('"')) line = line.substr(1, 5);
    if (!names_.empty() || line.size() != 5 || lower_case(line.substr(0, 4)) != "sep=") return false;
    separator_ = line.back();
    return is_stated_ = true;
  }

  void end_search() {
    searching_ = false;
    if (record_.size() < 2) return;
    if (names_.empty()) {
      remarks_.emplace_back(
          "the first line does not name the columns, so columns without geometries, such as heights, are ignored");
    } else {
      remarks_.push_back(
          fmt::format("no line before the first geometry has a known column name such as 'WKT' or 'height' ({}), so "
                      "heights are not read",
                      columns()));
    }
  }

  void take_names() {
    if (std::any_of(names_.begin(), names_.end(), [](const std::string& name) { return !name.empty(); }))
      remarks_.push_back(fmt::format("line {} names the columns; earlier lines are not read", record_.first_line()));
    names_.clear();
    for (std::size_t i = 0; i < record_.size(); ++i) {  // the first of equal names counts
      names_.emplace_back(record_.field(i));
      if (height_ == kNoColumn && is_height_name(names_[i])) height_ = i;
      if (named_ == kNoColumn && is_geometry_name(names_[i])) named_ = i;
    }
    if (!record_.behind_quote().empty())
      remarks_.push_back(fmt::format("line {}: the text after a closing quote is ignored", record_.first_line()));
    searching_ = named_ == kNoColumn && height_ == kNoColumn;
    const auto like = std::find_if(names_.begin(), names_.end(), [](const std::string& name) {
      return lower_case(name).find("height") != std::string::npos;
    });
    if (height_ == kNoColumn && like != names_.end())
      remarks_.push_back(fmt::format("no column is named 'height', so heights such as those of {} are not read",
                                     shown(static_cast<std::size_t>(like - names_.begin()))));
  }

  /// Chooses the separator that gives known names or geometries in the line, or else the most fields in the first line.
  void choose_separator() {
    const std::string candidates = (separator_ != 0 ? std::string(1, separator_) : "") + std::string(kSeparators);
    std::size_t best = 0;
    char chosen = candidates.front();
    for (const char separator : candidates) {
      const std::size_t score = score_of(separator);
      if (score > best) chosen = separator;
      best = std::max(best, score);
    }
    separator_ = chosen;
  }

  /// Blanks only separate known fields that no other separator would, since names and titles also contain blanks.
  std::size_t score_of(char separator) {
    const bool is_closed = record_.split(separator, lookahead_left_ > 0);
    if (record_.is_joined()) lookahead_left_ -= std::min(lookahead_left_, record_.line().size());
    if (!is_closed || (record_.is_joined() && !record_.behind_quote().empty())) {
      record_.part();
      record_.split(separator, false);
    }
    std::size_t known = 0;
    bool fits = true;
    for (std::size_t i = 0; i < record_.size(); ++i) {
      const std::string_view text = record_.field(i);
      if (is_known_name(text) || is_geometry(text)) {
        ++known;
      } else if (separator == ' ' && !record_.is_quoted(i)) {
        fits = fits && text.find_first_of(kSeparators) == kNoColumn;
      }
    }
    const std::size_t fields = names_.empty() && (separator != ' ' || known > 0) ? record_.size() : 0;
    const bool is_clean = record_.behind_quote().empty();
    record_.part();
    return fits ? known * kKnownField / (is_clean ? 1 : 2) + (is_clean ? fields : 0) : 0;
  }

  /// A record of several lines whose geometry is malformed has an unclosed quote. Its first line then becomes a
  /// separate record. The lines after it, up to the next quote, are not joined again, so each line is scanned at most
  /// twice.
  void read_record() {
    const bool is_closed = record_.split(separator_, record_.first_line() >= joined_);
    if (is_closed && (!record_.is_joined() || ends_well())) return;
    joined_ = std::max(joined_, record_.last_line());
    record_.part();
    record_.split(separator_, false);
  }
  bool ends_well() {
    if (searching_ && !record_.behind_quote().empty()) return false;  // a line of names
    const std::string_view text = geometry_of_record();
    return text.empty() || is_geometry(text);
  }

  /// The column of the first row with walls is used for all rows. A name decides between several.
  std::string_view geometry_of_record() {
    if (geometry_ == kNoColumn) return record_.field(choose_column());
    if (rival_ == kNoColumn && named_ != kNoColumn && geometry_ != named_ && has_walls(named_)) add_rival(named_);
    return record_.field(geometry_);
  }
  std::size_t choose_column() {
    std::size_t best = named_;
    int most = 0;
    for (std::size_t i = 0; i < record_.size(); ++i) {
      const GeometryGuess guess = guess_geometry(record_.field(i));
      const bool is_broken = guess.length != record_.field(i).size();
      if (guess.content == GeometryGuess::Content::none || (is_broken && named_ != kNoColumn && i != named_)) continue;
      const int type = guess.content == GeometryGuess::Content::walls ? 8 : 4;
      const int score = type + (i < names_.size() && is_geometry_name(names_[i]) ? 2 : 0) + (has_walls(i) ? 1 : 0);
      if (score > most) best = i;
      most = std::max(most, score);
    }
    if (!has_walls(best)) return best;  // for example an empty geometry
    geometry_ = best;
    for (std::size_t i = 0; i < record_.size() && best != named_ && rival_ == kNoColumn; ++i)
      if (i != best && has_walls(i)) add_rival(i);
    return best;
  }
  bool has_walls(std::size_t column) {
    try {
      read_geometry(record_.field(column), 1.0, scratch_);
      return !scratch_.parts.empty();
    } catch (const base::InputError&) {
      return false;
    }
  }
  void add_rival(std::size_t column) {
    rival_ = column;
    remarks_.push_back(
        fmt::format("columns {0} and {1} both have walls: column {0}, the first, is read; name the right column 'WKT', "
                    "or remove the other",
                    shown(geometry_), shown(column)));
  }

  std::string file_;
  TableRecord record_;
  std::vector<std::string> names_;
  std::vector<std::string> remarks_;
  char separator_ = 0;                ///< 0: not known yet
  bool is_stated_ = false;            ///< set by `sep=`
  bool is_uneven_ = false;            ///< a row separated by blanks has more or fewer fields than names
  bool searching_ = true;             ///< neither a known column name nor a geometry was found yet
  int joined_ = 0;                    ///< lines before this one are not joined with the following ones
  std::size_t named_ = kNoColumn;     ///< column with a name for geometries
  std::size_t geometry_ = kNoColumn;  ///< column with geometries, once found
  std::size_t rival_ = kNoColumn;     ///< another such column
  std::size_t height_ = kNoColumn;
  std::size_t lookahead_left_ = kMaxLookahead;
  WellKnownGeometry scratch_;
};

}  // namespace

std::unique_ptr<OutlineRows> open_outline_table(const std::string& file) {
  return std::make_unique<OutlineTable>(file);
}

}  // namespace sf::world
