#include "world/toml.h"

#include <fmt/format.h>

#include <algorithm>

namespace sf::world {

/// toml++ 3.3 takes some of what a file says for granted and, built for release, tells the compiler to do so too. Here
/// its assumptions are checked, and broken ones are the file's fault.
struct NoToml {};
[[noreturn]] inline void distrust() { throw NoToml{}; }

}  // namespace sf::world

#undef NDEBUG
#define TOML_ASSERT(assumption) ((assumption) ? void() : ::sf::world::distrust())
#include <toml++/toml.h>

#include "base/error.h"

namespace sf::world {

namespace {

constexpr int kDeepest = 32;

/// The same text in ASCII: comments may be in any language, all else is ours. (toml++ up to 3.3 runs into undefined
/// behaviour at some characters beyond.)
std::string in_ascii(const std::string& file, std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark) text.remove_prefix(kByteOrderMark.size());
  std::string plain(text);
  int line = 1;
  bool quoted = false;  // some quote stands in the line so far
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
      throw base::InputError(file, line, "a character beyond ASCII; expected such only in comments of their own line");
    c = '?';
  }
  return plain;
}

int line_of(const toml::source_region& source) { return static_cast<int>(source.begin.line); }

TomlNode plain(const std::string& file, const toml::node& node, int depth) {
  TomlNode out;
  out.line = line_of(node.source());
  if (depth > kDeepest)
    throw base::InputError(file, out.line, fmt::format("nested too deep; expected {} levels at most", kDeepest));
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
  try {
    return plain(file, toml::parse(in_ascii(file, text), file), 0);
  } catch (const toml::parse_error& error) {
    throw base::InputError(file, line_of(error.source()), fmt::format("not TOML: {}", error.description()));
  } catch (const NoToml&) {
    throw base::InputError(file, 0, "not TOML; expected lines like: scale = 0.5");
  }
}

}  // namespace sf::world
