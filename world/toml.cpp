#include "world/toml.h"

#include <fmt/format.h>

#include <algorithm>

namespace sf::world {

/// toml++ 3.3 makes assumptions about its input, which release builds pass on to the compiler. This checks them, and
/// reports a violation as an error in the file.
struct NoToml {};
[[noreturn]] inline void distrust() { throw NoToml{}; }

}  // namespace sf::world

// toml++ itself rejects deeper values; dotted keys are counted below.
#define TOML_MAX_NESTED_VALUES 32
#undef NDEBUG
#define TOML_ASSERT(assumption) ((assumption) ? void() : ::sf::world::distrust())
#include <toml++/toml.h>

#include "base/error.h"

namespace sf::world {

namespace {

constexpr int kDeepest = 32;
constexpr std::size_t kMaxBytes = 4u << 20;

/// Returns the same text in ASCII: comments may contain any characters, the rest only ASCII. (toml++ up to 3.3 has
/// undefined behaviour for some other characters.)
std::string in_ascii(const std::string& file, std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark) text.remove_prefix(kByteOrderMark.size());
  std::string plain(text);
  int line = 1;
  bool quoted = false;  // the line has had a quote
  bool comment = false;
  for (char& c : plain) {
    if (c == '\n') {
      ++line;
      quoted = comment = false;
    }
    quoted = quoted || c == '"' || c == '\'';
    comment = comment || (c == '#' && !quoted);
    if (static_cast<unsigned char>(c) < 0x80) continue;
    if (!comment)
      throw base::InputError(file, line, "a non-ASCII character; allowed only in comments on their own line");
    c = '?';
  }
  return plain;
}

/// Returns the last character of the quoted text that starts at `at`; three quotes start a multi-line text. An
/// unterminated text ends at the end of its line; toml++ reports the error.
std::size_t end_of_text(std::string_view text, std::size_t at, int& line) {
  const char quote = text[at];
  const bool long_one = text.substr(at, 3) == std::string(3, quote);
  for (std::size_t i = at + (long_one ? 3 : 1); i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\') {
      ++i;
    } else if (text[i] == quote && (!long_one || text.substr(i, 3) == std::string(3, quote))) {
      return long_one ? i + 2 : i;
    } else if (text[i] == '\n' && !long_one) {
      return i - 1;
    }
    if (i < text.size() && text[i] == '\n') ++line;
  }
  return text.size();
}

/// Rejects keys with too many parts, because toml++ nests a table for each part and destroys the tables recursively.
/// Dots in numbers and in quoted texts do not count: any other character between two keys ends a sequence of parts, and
/// quoted texts are skipped.
void check_keys(const std::string& file, std::string_view text) {
  int line = 1;
  int points = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '\n') ++line;
    if (c == '#') at = std::min(text.find('\n', at), text.size()) - 1;
    if (c == '"' || c == '\'') at = end_of_text(text, at, line);
    if (c == '.' && ++points > kDeepest)
      throw base::InputError(
          file, line,
          fmt::format("nested too deeply: a key of more than {0} parts; expected at most {0} levels", kDeepest));
    if (c == '=' || c == ',' || c == '[' || c == ']' || c == '{' || c == '}' || c == '\n') points = 0;
  }
}

int line_of(const toml::source_region& source) { return static_cast<int>(source.begin.line); }

TomlNode plain(const std::string& file, const toml::node& node, int depth) {
  TomlNode out;
  out.line = line_of(node.source());
  if (depth > kDeepest)
    throw base::InputError(file, out.line, fmt::format("nested too deeply; expected at most {} levels", kDeepest));
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, inner] : *table) {
      TomlNode& item = out.items.emplace_back(plain(file, inner, depth + 1));
      item.key = key.str();
      item.line = line_of(key.source());
    }
    return out;
  }
  if (const toml::array* array = node.as_array()) {
    out.kind = TomlNode::Kind::list;
    for (const toml::node& inner : *array) out.items.push_back(plain(file, inner, depth + 1));
  } else if (const auto* flag = node.as_boolean()) {
    out.kind = TomlNode::Kind::flag;
    out.flag = flag->get();
  } else if (const auto* whole = node.as_integer()) {
    out.kind = TomlNode::Kind::number;
    out.number = static_cast<double>(whole->get());
  } else if (const auto* number = node.as_floating_point()) {
    out.kind = TomlNode::Kind::number;
    out.number = number->get();
  } else if (const auto* text = node.as_string()) {
    out.kind = TomlNode::Kind::text;
    out.text = text->get();
  } else {
    out.kind = TomlNode::Kind::other;
  }
  return out;
}

}  // namespace

const TomlNode* find(const TomlNode& table, std::string_view key) {
  const auto found =
      std::find_if(table.items.begin(), table.items.end(), [&](const TomlNode& item) { return item.key == key; });
  return found == table.items.end() ? nullptr : &*found;
}

TomlNode parse_toml(const std::string& file, std::string_view text) {
  if (text.size() > kMaxBytes)
    throw base::InputError(file, 0, fmt::format("larger than {} MiB, the limit for TOML files", kMaxBytes >> 20));
  try {
    const std::string ascii = in_ascii(file, text);
    check_keys(file, ascii);
    return plain(file, toml::parse(ascii, file), 0);
  } catch (const toml::parse_error& error) {
    throw base::InputError(file, line_of(error.source()), fmt::format("not TOML: {}", error.description()));
  } catch (const NoToml&) {
    throw base::InputError(file, 0, "not TOML; expected lines like: scale = 0.5");
  }
}

}  // namespace sf::world
