#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <string>

#include "world/geometry_reader.h"

namespace sf::world {

namespace {

constexpr std::size_t kShownText = 24;  // characters of the text in errors
constexpr std::size_t kMinDigits = 18;  // of hexadecimal binary: byte order, type and a number of members
constexpr std::string_view kTextBlanks = " \t\r\n";
constexpr std::string_view kDigits = "0123456789abcdefABCDEF";

constexpr std::string_view kFirstCharacters = "0PLMGCTSplmgcts";  // of digits, types and SRID

struct TypeName {
  std::string_view name;
  GeometryType type;
};
constexpr std::array<TypeName, 16> kTypes{{{"POINT", GeometryType::point},
                                           {"LINESTRING", GeometryType::linestring},
                                           {"LINEARRING", GeometryType::linestring},
                                           {"POLYGON", GeometryType::polygon},
                                           {"MULTIPOINT", GeometryType::multipoint},
                                           {"MULTILINESTRING", GeometryType::multilinestring},
                                           {"MULTIPOLYGON", GeometryType::multipolygon},
                                           {"GEOMETRYCOLLECTION", GeometryType::collection},
                                           {"CIRCULARSTRING", GeometryType::circularstring},
                                           {"COMPOUNDCURVE", GeometryType::compoundcurve},
                                           {"CURVEPOLYGON", GeometryType::curvepolygon},
                                           {"MULTICURVE", GeometryType::multicurve},
                                           {"MULTISURFACE", GeometryType::multisurface},
                                           {"POLYHEDRALSURFACE", GeometryType::polyhedralsurface},
                                           {"TIN", GeometryType::tin},
                                           {"TRIANGLE", GeometryType::triangle}}};

bool equals(std::string_view word, std::string_view capitals) {
  return std::equal(word.begin(), word.end(), capitals.begin(), capitals.end(),
                    [](unsigned char a, char b) { return std::toupper(a) == b; });
}
bool is_dimensions(std::string_view word) { return equals(word, "Z") || equals(word, "M") || equals(word, "ZM"); }

/// Finds a type with or without the letters of its dimensions, as in POLYGONZ.
const TypeName* find_type(std::string_view word) {
  for (const TypeName& row : kTypes)
    if (equals(word.substr(0, row.name.size()), row.name) &&
        (word.size() == row.name.size() || is_dimensions(word.substr(row.name.size()))))
      return &row;
  return nullptr;
}

class TextReader {
 public:
  explicit TextReader(std::string_view text) : text_(text) {}

  [[noreturn]] void fail(std::string_view expected) {
    skip_blanks();
    const std::string_view rest = text_.substr(at_, kShownText);
    throw base::InputError(fmt::format("expected {}, found {}", expected,
                                       rest.empty() ? "the end of the text" : fmt::format("'{}'", rest)));
  }
  /// Reads `SRID=n;`. @return 0: none
  std::uint32_t srid() {
    const std::size_t start = at_;
    std::uint32_t value = 0;
    if (equals(word(), "SRID") && take('=')) {
      skip_blanks();
      const char* const begin = text_.data() + at_;
      at_ += static_cast<std::size_t>(std::from_chars(begin, text_.data() + text_.size(), value).ptr - begin);
      if (take(';')) return value;
    }
    at_ = start;
    return 0;
  }
  /// Reads a type. Returns null and reads nothing if the word is not a type.
  const TypeName* tag() {
    const std::size_t start = at_;
    const TypeName* const type = find_type(word());
    if (type == nullptr) at_ = start;
    if (type == nullptr) return nullptr;
    const std::size_t after = at_;
    if (!is_dimensions(word())) at_ = after;
    return type;
  }
  bool take_empty() {
    const std::size_t start = at_;
    if (equals(word(), "EMPTY")) return true;
    at_ = start;
    return false;
  }
  bool is(char c) {
    skip_blanks();
    return at_ < text_.size() && text_[at_] == c;
  }
  bool take(char c) {
    if (!is(c)) return false;
    ++at_;
    return true;
  }
  bool at_end() {
    skip_blanks();
    return at_ == text_.size();
  }
  std::size_t at() const { return at_; }

  GeometryType type(std::optional<GeometryType> implied) {
    const TypeName* const found = tag();
    if (found == nullptr && implied) return *implied;
    if (found == nullptr) fail("POLYGON, MULTIPOLYGON, LINESTRING or MULTILINESTRING");
    if (!is('(') && !is('E') && !is('e')) fail(fmt::format("'(' or EMPTY after {}", found->name));
    return found->type;
  }
  template <class F>
  void each(const F& f) {
    if (take('(')) {
      do f();
      while (take(','));
      if (!take(')')) fail("')'");
    } else if (!take_empty()) {
      fail("'('");
    }
  }
  glm::dvec2 point() {
    const double x = number(true);
    const double y = number(true);
    for (int more = 0; more < 2 && !is(',') && !is(')') && !at_end(); ++more) number(false);  // z, m
    return {x, y};
  }
  void skip_points(GeometryType) {
    each([&] {
      if (is('(')) return each([&] { point(); });
      if (!take_empty()) point();
    });
  }

 private:
  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || (text_[at_] >= '\t' && text_[at_] <= '\r'))) ++at_;
  }
  /// Reads the next word; empty before anything else.
  std::string_view word() {
    skip_blanks();
    const std::size_t start = at_;
    while (at_ < text_.size() && std::isalpha(static_cast<unsigned char>(text_[at_]))) ++at_;
    return text_.substr(start, at_ - start);
  }
  double number(bool finite) {
    skip_blanks();
    double value = 0.0;
    const char* begin = text_.data() + at_;
    const char* const last = text_.data() + text_.size();
    if (is('+')) ++begin;
    auto [end, error] = std::from_chars(begin, last, value);
    if (error == std::errc::result_out_of_range)
      value = std::strtod(std::string(begin, end).c_str(), nullptr);  // 1e-999
    const bool ends = end == last || (!std::isalnum(static_cast<unsigned char>(*end)) && *end != '+' && *end != '-');
    if (error == std::errc::invalid_argument || !ends || (finite && !std::isfinite(value))) fail("a finite number");
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }
  std::string_view text_;
  std::size_t at_ = 0;
};

/// Removes leading blanks, and the PostgreSQL or SQL prefix of hexadecimal digits.
std::string_view unmarked(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kTextBlanks), text.size()));
  if (text.starts_with("\\x") || text.starts_with("0x") || text.starts_with("0X")) text.remove_prefix(2);
  return text;
}

int nibble(char c) { return c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10; }
std::uint32_t byte_at(std::string_view digits, std::size_t i) {
  return static_cast<std::uint32_t>(16 * nibble(digits[2 * i]) + nibble(digits[2 * i + 1]));
}

/// A geometry in hexadecimal digits, classified by its first digits.
struct HexGeometry {
  std::size_t digits = 0;  ///< 0: not a geometry
  TypeCode code;
};
HexGeometry hex_geometry(std::string_view text) {
  if (!text.starts_with("00") && !text.starts_with("01")) return {};
  const std::size_t digits = std::min(text.find_first_not_of(kDigits), text.size());
  if (digits < kMinDigits || digits % 2 != 0) return {};
  TypeCode code;
  for (std::size_t i = 0; i < 4; ++i) code.code = code.code << 8 | byte_at(text, text[1] == '1' ? 4 - i : 1 + i);
  return code.valid() ? HexGeometry{digits, code} : HexGeometry{};
}

bool is_word_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_decimal(char c) { return c >= '0' && c <= '9'; }

/// Matches words between parentheses.
bool is_number(std::string_view word) { return equals(word, "NAN") || equals(word, "INF") || equals(word, "INFINITY"); }
bool is_member(std::string_view word) {
  return find_type(word) != nullptr || is_dimensions(word) || equals(word, "EMPTY");
}

/// Scans the text between parentheses as long as it can be part of a geometry.
class Follower {
 public:
  Follower(std::string_view text, std::size_t open) : text_(text), at_(open) {
    while (at_ < text_.size() && (depth_ > 0 || at_ == open) && step()) {
    }
  }
  std::size_t length() const { return depth_ == 0 ? at_ : 0; }  ///< up to the last parenthesis; 0: not reached
  bool is_open() const { return depth_ > 0 && at_ == text_.size(); }
  bool begins() const { return has_content_ || is_open(); }  ///< with a number or a member

 private:
  bool is_after(std::string_view characters) const { return characters.find(before_) != std::string_view::npos; }

  /// @return false if the following text cannot be part of a geometry
  bool step() {
    const char c = text_[at_];
    if (kTextBlanks.find(c) != std::string_view::npos) return ++at_, true;
    if (is_part_of_number(c)) return number();
    if (is_word_letter(c)) return word();
    if (c != '(' && c != ')' && c != ',') return false;
    if (c == '(' ? is_after(")0") : is_after("(,")) return false;
    depth_ += c == '(' ? 1 : c == ')' ? -1 : 0;
    before_ = c;
    return ++at_, true;
  }
  static bool is_part_of_number(char c) { return is_decimal(c) || c == '+' || c == '-' || c == '.'; }
  /// Scans numbers up to the next parenthesis, comma or letter.
  bool number() {
    if (is_after(")a")) return false;
    while (at_ < text_.size() && (is_part_of_number(text_[at_]) || text_[at_] == ' ')) ++at_;
    has_content_ = true;
    before_ = '0';
    return true;
  }
  bool word() {
    std::size_t end = at_;
    while (end < text_.size() && is_word_letter(text_[end])) ++end;
    const std::string_view word = text_.substr(at_, end - at_);
    const bool is_exponent = equals(word, "E") && (is_decimal(text_[at_ - 1]) || text_[at_ - 1] == '.');
    const bool is_value = is_exponent || is_number(word);
    if (!is_value && (!is_member(word) || is_after(")0"))) return false;
    has_content_ = true;
    before_ = is_value ? '0' : 'a';
    at_ = end;
    return true;
  }

  std::string_view text_;
  std::size_t at_;
  std::ptrdiff_t depth_ = 0;
  char before_ = 'a';  ///< last non-blank character: '0' for a number, 'a' for a word
  bool has_content_ = false;
};

GeometryGuess::Content content_of(GeometryType type) {
  const bool points = type == GeometryType::point || type == GeometryType::multipoint;
  return points ? GeometryGuess::Content::points : GeometryGuess::Content::walls;
}

}  // namespace

GeometryGuess guess_geometry(std::string_view text) {
  const std::string_view binary = unmarked(text);
  if (binary.empty() || kFirstCharacters.find(binary.front()) == std::string_view::npos) return {};
  if (const HexGeometry hex = hex_geometry(binary); hex.digits > 0)
    return {content_of(hex.code.type()), static_cast<std::size_t>(binary.data() - text.data()) + hex.digits};
  TextReader in(text);
  in.srid();
  const TypeName* const type = in.tag();
  if (type == nullptr) return {};
  if (in.is('(')) {
    const Follower inside(text, in.at());
    if (!inside.begins()) return {};
    return {content_of(type->type), inside.length(), inside.is_open()};
  }
  if (in.take_empty()) return {content_of(type->type), in.at()};
  return {};
}

void read_geometry(std::string_view text, double arc_error, WellKnownGeometry& geometry) {
  const std::string_view binary = unmarked(text);
  if (const std::size_t digits = hex_geometry(binary).digits; digits > 0) {
    if (binary.find_first_not_of(kTextBlanks, digits) != std::string_view::npos)
      throw base::InputError(fmt::format("expected hexadecimal digits, found '{}'", binary.substr(digits, kShownText)));
    std::string bytes(digits / 2, '\0');
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(byte_at(binary, i));
    return read_binary_geometry(bytes, arc_error, geometry);
  }
  if (binary.size() >= kMinDigits && binary.size() % 2 == 1 &&
      binary.find_first_not_of(kDigits) == std::string_view::npos)
    throw base::InputError(
        fmt::format("expected an even number of hexadecimal digits, found {}; is the field truncated?", binary.size()));
  TextReader in(text);
  geometry.clear();
  geometry.srid = in.srid();
  GeometryReader(in, arc_error, geometry).read();
  if (!in.at_end()) in.fail("the end of the geometry");
}

}  // namespace sf::world
