#include "world/roads/rndf_statement_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/error.h"
#include "base/number_text.h"

namespace sf::world {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
bool is_control(char c) { return (static_cast<unsigned char>(c) < 0x20 && !is_blank(c)) || c == '\x7f'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Removes the first field from `text`.
std::string_view take_field(std::string_view& text) {
  text = trimmed(text);
  const auto* const end = std::find_if(text.begin(), text.end(), is_blank);
  const auto length = static_cast<std::size_t>(end - text.begin());
  const std::string_view field = text.substr(0, length);
  text = trimmed(text.substr(length));
  return field;
}

}  // namespace

std::string point_id_text(PointId id) { return fmt::format("{}.{}.{}", id.segment, id.lane, id.point); }

std::optional<PointId> read_point_id(std::string_view text, int parts) {
  std::uint16_t numbers[3] = {0, 0, 0};
  const char* at = text.data();
  const char* const last = text.data() + text.size();
  for (int i = 0; i < parts; ++i) {
    if (i > 0 && (at == last || *at++ != '.')) return std::nullopt;
    const auto [end, error] = std::from_chars(at, last, numbers[i]);
    if (error != std::errc()) return std::nullopt;
    at = end;
  }
  if (at != last) return std::nullopt;
  return PointId{numbers[0], numbers[1], numbers[2]};
}

bool is_number(std::string_view keyword) { return !keyword.empty() && keyword[0] >= '0' && keyword[0] <= '9'; }

std::string quoted(std::string_view text) {
  constexpr std::size_t kMost = 40;
  std::string shown = "'";
  for (const char c : text.substr(0, kMost)) {
    const bool printable = c >= ' ' && c < '\x7f';
    shown += printable ? std::string(1, c) : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  }
  return shown + (text.size() > kMost ? "...'" : "'");
}

StatementReader::StatementReader(std::string file, std::string_view text, Diagnostics& diagnostics)
    : file_(std::move(file)), text_(text), diagnostics_(diagnostics) {
  if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;
}

void StatementReader::fail(const std::string& message) const { throw base::InputError(file_, now_.line, message); }

// Copies one line without its comments. A comment counts as a blank.
bool StatementReader::read_line() {
  current_.clear();
  if (at_ >= text_.size()) return false;
  ++line_;
  while (at_ < text_.size()) {
    const char c = text_[at_++];
    const char after = at_ < text_.size() ? text_[at_] : '\0';
    if (c == '\n') return true;
    if (c == '\r') {
      if (after == '\n') ++at_;
      return true;
    }
    if (comment_ > 0) {
      if (c == '*' && after == '/') comment_ = 0, ++at_;
    } else if (c == '/' && after == '*') {
      comment_ = line_, ++at_;
      current_ += ' ';
    } else if (is_control(c)) {
      throw base::InputError(
          file_, line_,
          fmt::format("byte {:#04x} is not text; expected an RNDF or MDF", static_cast<unsigned char>(c)));
    } else {
      current_ += c;
    }
  }
  return true;
}

bool StatementReader::next() {
  while (read_line()) {
    std::string_view rest = trimmed(current_);
    if (rest.empty()) continue;
    now_.line = line_;
    now_.keyword = take_field(rest);
    now_.rest = rest;
    now_.fields.clear();
    while (!rest.empty()) now_.fields.push_back(take_field(rest));
    return true;
  }
  if (comment_ > 0) throw base::InputError(file_, comment_, "this comment is never closed; expected */");
  return false;
}

std::string_view StatementReader::field(std::size_t i, std::string_view what) const {
  if (i < now_.fields.size()) return now_.fields[i];
  fail(fmt::format("{} is missing after {}", what, quoted(now_.keyword)));
}

std::string StatementReader::extra(std::size_t count) const {
  return fmt::format("{} was not expected after {}", quoted(now_.fields[count]),
                     count == 0 ? quoted(now_.keyword) : quoted(now_.fields[count - 1]));
}

void StatementReader::expect_fields(std::size_t count) const {
  if (now_.fields.size() > count)
    diagnostics_.add_warning(now_.line, extra(count), "put comments between /* and */",
                             "it and the rest of the line are ignored");
}

void StatementReader::require_fields(std::size_t count) const {
  if (now_.fields.size() > count) fail(extra(count) + "; put comments between /* and */");
}

int StatementReader::whole(std::size_t i, int least, std::string_view what) const {
  return whole(field(i, what), least, what);
}

int StatementReader::whole(std::string_view text, int least, std::string_view what) const {
  const std::optional<int> value = base::number_of<int>(text);
  if (value && *value >= least && *value <= kMaxRoadNumber) return *value;
  fail(fmt::format("{} is {}; expected a whole number from {} to {}", what, quoted(text), least, kMaxRoadNumber));
}

double StatementReader::decimal(std::size_t i, std::string_view what) const {
  std::string_view text = field(i, what);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  if (const std::optional<double> value = base::finite_number(text)) return *value;
  fail(fmt::format("{} is {}; expected a number such as -77.205045", what, quoted(text)));
}

PointId StatementReader::numbers(std::string_view text, int count, std::string_view what) const {
  std::uint16_t parts[3] = {0, 0, 0};
  const char* at = text.data();
  const char* const last = text.data() + text.size();
  bool good = true;
  for (int i = 0; i < count && good; ++i) {
    if (i > 0 && (at == last || *at++ != '.')) good = false;
    const auto [end, error] = std::from_chars(at, last, parts[i]);
    good = good && error == std::errc() && parts[i] <= kMaxRoadNumber;
    at = end;
  }
  if (good && at == last) return {parts[0], parts[1], parts[2]};
  fail(fmt::format("{} is {}; expected {} such as {}", what, quoted(text),
                   count == 2 ? "two numbers separated by a dot" : "three numbers separated by dots",
                   count == 2 ? "1.2" : "1.2.3"));
}

PointId StatementReader::point(std::size_t i, std::string_view what) const { return numbers(field(i, what), 3, what); }

PointId StatementReader::pair(std::size_t i, std::string_view what) const { return numbers(field(i, what), 2, what); }

}  // namespace sf::world
