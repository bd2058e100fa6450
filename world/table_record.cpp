#include "world/table_record.h"

#include <algorithm>

#include "world/well_known_geometry.h"

namespace sf::world {

namespace {

constexpr std::string_view kContinuations = "0123456789+-.,()";  // first characters of lines within a geometry
constexpr std::size_t kMaxFields = 10'000;                       // per record; further fields are ignored
constexpr int kMaxUnclosed = 8;

}  // namespace

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") + 1 - first);
}

/// Removes a byte order mark, and the CR left by a CR before CRLF (Python's csv in text mode).
void TableRecord::trim_line() {
  if (lines_.number() == 1 && line_.starts_with("\xEF\xBB\xBF")) line_.remove_prefix(3);
  while (line_.ends_with('\r')) line_.remove_suffix(1);
}

bool TableRecord::next() {
  fields_.clear();
  while (lines_.next(line_)) {
    trim_line();
    if (!without_blanks(line_).empty()) return true;
  }
  return false;
}

bool TableRecord::extend() {
  const bool more = lines_.extend(line_);
  trim_line();
  return more;
}

void TableRecord::part() {
  lines_.shrink(line_);
  trim_line();
}

std::string_view TableRecord::field(std::size_t i) const {
  return i < fields_.size() ? without_blanks(line_.substr(fields_[i].begin, fields_[i].size())) : std::string_view();
}

bool TableRecord::split(char separator, bool joins) {
  fields_.clear();
  behind_ = {};
  separator_ = separator;
  joins_ = joins;
  closed_ = true;
  unclosed_left_ = kMaxUnclosed;
  const auto is_blank = [&](char c) { return (c == ' ' || c == '\t') && c != separator_ && separator_ != ' '; };
  for (std::size_t at = 0; at != std::string_view::npos && fields_.size() < kMaxFields;) {
    while (at < line_.size() && is_blank(line_[at])) ++at;
    const bool is_quoted = at < line_.size() && line_[at] == '"';
    const std::size_t end = is_quoted ? quoted_field(at + 1) : plain_field(at);
    at = end < line_.size() ? end + 1 : std::string_view::npos;
  }
  return closed_;
}

/// @return the separator after it, or the end
std::size_t TableRecord::quoted_field(std::size_t begin) {
  const std::size_t end = closing_quote(begin);
  closed_ = closed_ && end < line_.size();
  fields_.push_back({begin, end, true});
  const Span rest{std::min(end + 1, line_.size()), std::min(line_.find(separator_, end), line_.size())};
  if (behind_quote().empty()) behind_ = rest;
  return rest.end;
}

/// A field ends at the next separator after the geometry at its start, if there is one. Tabs and bars are not part of a
/// geometry, provided that it ends in its line.
std::size_t TableRecord::plain_field(std::size_t begin) {
  std::size_t length = 0;
  const bool may_contain = separator_ != '\t' && separator_ != '|';
  if (unclosed_left_ > 0 && !is_separator(begin)) {
    GeometryGuess guess = guess_geometry(line_.substr(begin));
    const bool has_one_field = fields_.empty() && (may_contain || line_.find(separator_) == std::string_view::npos);
    const bool goes_on = guess.is_open && joins_ && has_one_field;
    if (goes_on) {
      const bool is_closed = close_parentheses(begin);
      guess = guess_geometry(line_.substr(begin));
      closed_ = is_closed && guess.length > 0;
    }
    if (guess.content != GeometryGuess::Content::none && guess.length == 0) --unclosed_left_;
    if (goes_on || may_contain) length = guess.length;
  }
  const std::size_t end = std::min(line_.find(separator_, begin + length), line_.size());
  fields_.push_back({begin, end});
  return end;
}

/// Returns the first quote that ends a field; two in a row are an escaped quote. Returns the end of the line if there
/// is none.
std::size_t TableRecord::closing_quote(std::size_t from) {
  for (;;) {
    const std::size_t at = line_.find('"', from);
    if (at == std::string_view::npos) {
      from = line_.size();
      if (!joins_ || !extend()) return line_.size();
    } else if (at + 1 < line_.size() && line_[at + 1] == '"') {
      from = at + 2;
    } else {
      return at;
    }
  }
}

/// Appends lines to an unquoted geometry at the start of a record, as long as they continue it.
bool TableRecord::close_parentheses(std::size_t from) {
  std::ptrdiff_t open = 0;
  for (;;) {
    const std::string_view text = line_.substr(from);
    open += std::count(text.begin(), text.end(), '(') - std::count(text.begin(), text.end(), ')');
    if (open <= 0) return true;
    from = line_.size();
    const bool more = extend();
    const std::string_view next = without_blanks(line_.substr(std::min(from, line_.size())));
    if (!more || (!next.empty() && kContinuations.find(next.front()) == std::string_view::npos)) return false;
  }
}

}  // namespace sf::world
