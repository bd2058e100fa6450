#include "world/well_known_text.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <string>

#include "base/error.h"

namespace sf::world {

namespace {

constexpr std::size_t kShown = 24;  // characters of the text in errors

class TextReader {
 public:
  explicit TextReader(std::string_view text) : text_(text) {}

  [[noreturn]] void fail(std::string_view expected) {
    skip_blanks();
    const std::string_view rest = text_.substr(at_, kShown);
    throw base::InputError(fmt::format("expected {}, found {}", expected,
                                       rest.empty() ? "the end of the line" : fmt::format("'{}'", rest)));
  }
  /// The next word in capital letters; empty before anything else.
  std::string word() {
    skip_blanks();
    std::string word;
    for (; at_ < text_.size() && std::isalpha(static_cast<unsigned char>(text_[at_])); ++at_)
      word += static_cast<char>(std::toupper(static_cast<unsigned char>(text_[at_])));
    return word;
  }
  bool take(char c) {
    skip_blanks();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail(fmt::format("'{}'", c));
  }
  bool at_end() {
    skip_blanks();
    return at_ == text_.size();
  }
  double number() {
    skip_blanks();
    double value = 0.0;
    const char* const begin = text_.data() + at_;
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (error != std::errc() || !std::isfinite(value)) fail("a finite number");
    at_ += static_cast<std::size_t>(end - begin);
    return value;
  }
  /// Another number follows.
  bool is_number() {
    skip_blanks();
    return at_ < text_.size() && text_[at_] != ',' && text_[at_] != ')';
  }

 private:
  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  std::string_view text_;
  std::size_t at_ = 0;
};

std::vector<glm::dvec2> read_points(TextReader& in) {
  std::vector<glm::dvec2> points;
  in.expect('(');
  do {
    const double x = in.number();
    const double y = in.number();
    points.push_back({x, y});
    while (in.is_number()) in.number();  // z, m
  } while (in.take(','));
  in.expect(')');
  return points;
}

TextGeometry read_lines(TextReader& in, bool closed) {
  TextGeometry geometry{closed, {}};
  in.expect('(');
  do {
    geometry.lines.push_back(read_points(in));
  } while (in.take(','));
  in.expect(')');
  return geometry;
}

std::vector<TextGeometry> read_parts(TextReader& in, const std::string& type) {
  if (type == "LINESTRING") return {{false, {read_points(in)}}};
  if (type == "MULTILINESTRING") return {read_lines(in, false)};
  if (type == "POLYGON") return {read_lines(in, true)};
  std::vector<TextGeometry> polygons;
  in.expect('(');
  do {
    polygons.push_back(read_lines(in, true));
  } while (in.take(','));
  in.expect(')');
  return polygons;
}

}  // namespace

std::vector<TextGeometry> read_geometry(std::string_view text) {
  TextReader in(text);
  const std::string type = in.word();
  if (type != "POLYGON" && type != "MULTIPOLYGON" && type != "LINESTRING" && type != "MULTILINESTRING") {
    if (type.empty()) in.fail("POLYGON, MULTIPOLYGON, LINESTRING or MULTILINESTRING");
    throw base::InputError(fmt::format(
        "'{}' has no walls; expected POLYGON, MULTIPOLYGON, LINESTRING or MULTILINESTRING", type.substr(0, kShown)));
  }
  std::string dimensions = in.word();
  if (dimensions == "Z" || dimensions == "M" || dimensions == "ZM") dimensions = in.word();
  std::vector<TextGeometry> parts;
  if (dimensions.empty()) {
    parts = read_parts(in, type);
  } else if (dimensions != "EMPTY") {
    throw base::InputError(
        fmt::format("expected '(' or EMPTY after {}, found '{}'", type, dimensions.substr(0, kShown)));
  }
  if (!in.at_end()) in.fail("the end of the geometry");
  return parts;
}

}  // namespace sf::world
