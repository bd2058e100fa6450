#include "world/stage/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <unordered_set>

#include "base/files.h"
#include "base/installation.h"
#include "world/foreign_world.h"
#include "world/ros_map.h"
#include "world/stage/parse_state.h"

namespace sf::world {

namespace {

// Limits far above any real world. They prevent hostile or broken files from exhausting the stack or memory.
constexpr std::uint32_t kMaxDepth = 64;
constexpr std::uint32_t kMaxWeight = 4'000'000;
constexpr int kMaxIncludes = 256;
constexpr std::size_t kMaxMacros = 20'000;

Entity begin_entity(ParseState& r, const Token& word) {
  Entity entity{.word = word.text, .type = word.text, .at = location(r, word)};
  if (const auto macro = r.macros.find(word.text); macro != r.macros.end()) {
    if (r.weight + macro->second.weight > kMaxWeight) {
      fail(r, word.line, fmt::format("the macros of this world expand to more than {} properties", kMaxWeight));
    }
    const SourceLocation at = entity.at;
    entity = macro->second;
    entity.word = word.text;
    entity.at = at;
  }
  r.weight += entity.weight;
  return entity;
}

void read_body(ParseState& r, Entity& entity, std::uint32_t level);

Entity read_entity(ParseState& r, std::uint32_t level) {
  Entity entity = begin_entity(r, now(r));
  ++r.at;
  read_body(r, entity, level);
  return entity;
}

void add_child(ParseState& r, Entity& entity, Entity child, int line) {
  entity.depth = std::max(entity.depth, child.depth + 1);
  entity.weight += child.weight;
  if (entity.depth > kMaxDepth) fail(r, line, fmt::format("nested deeper than {} levels", kMaxDepth));
  entity.children.push_back(std::move(child));
}

// Reads from the opening to the closing parenthesis.
void read_body(ParseState& r, Entity& entity, std::uint32_t level) {
  const int line = now(r).line;
  if (level > kMaxDepth) fail(r, line, fmt::format("nested deeper than {} levels", kMaxDepth));
  if (r.weight > kMaxWeight) fail(r, line, fmt::format("more than {} properties in one world", kMaxWeight));
  KeyRows rows;
  for (const Property& property : entity.properties) rows.emplace(property.key, rows.size());
  std::unordered_set<std::string> written;
  std::vector<Property> repeats;
  for (++r.at; now(r).kind != TokenKind::close;) {
    if (now(r).kind == TokenKind::end) {
      fail(r, line, fmt::format("the '(' of '{}' is never closed; expected ')'", entity.word));
    }
    if (now(r).kind != TokenKind::word) {
      fail(r, now(r).line,
           fmt::format("expected a property, an entity or ')' in '{}', found {}", entity.word, shown(now(r))));
    }
    if (next(r).kind == TokenKind::open) {
      const int child_line = now(r).line;
      add_child(r, entity, read_entity(r, level + 1), child_line);
    } else {
      Property property = read_property(r);
      const bool is_repeat = property.key.ends_with(']') && written.contains(property.key);
      is_repeat ? repeats.push_back(std::move(property)) : add_property(r, entity, rows, written, std::move(property));
    }
  }
  add_repeats(r, entity, rows, written, std::move(repeats));
  ++r.at;
  sort_keys(entity);
}

void read_define(ParseState& r) {
  const int line = now(r).line;
  ++r.at;
  const Token name = now(r);
  const Token base = next(r);
  if (name.kind != TokenKind::word || base.kind != TokenKind::word) {
    fail(r, line, "expected: define NEW-NAME BASE-TYPE ( ... )");
  }
  if (name.text == base.text)
    fail(r, line, fmt::format("'{}' is defined in terms of itself; use another base type", name.text));
  ++r.at;
  if (next(r).kind != TokenKind::open) {
    fail(r, line, fmt::format("expected '(' after 'define {} {}', found {}", name.text, base.text, shown(next(r))));
  }

  Entity macro = read_entity(r, 1);
  macro.at = location(r, name);
  const auto [first, fresh] = r.macros.try_emplace(name.text, std::move(macro));
  if (r.macros.size() > kMaxMacros) fail(r, line, fmt::format("more than {} definitions in one world", kMaxMacros));
  const SourceLocation before = first->second.at;
  const bool same_text = before.file == r.file && before.line == name.line;
  if (!fresh && !same_text) {
    warn(r, line,
         fmt::format("'{}' is defined again; the first definition ({}:{}) is used", name.text,
                     r.document.files[before.file], before.line));
  }
}

void read_file(ParseState& r, const std::string& file, const std::string& text);

[[noreturn]] void refuse_cycle(const ParseState& r, int line, const std::string& file) {
  std::string chain;
  for (const std::string& open : r.open_files) chain += open + " -> ";
  fail(r, line, "this include is circular: " + chain + file);
}

// A ROS map is included by its YAML file, not by its picture.
void refuse_picture(const ParseState& r, int line, const std::string& name, const std::string& found) {
  constexpr auto kPictures = std::to_array<std::string_view>(
      {".pgm", ".pbm", ".ppm", ".pnm", ".png", ".jpg", ".jpeg", ".bmp", ".gif", ".tif", ".tiff", ".svg"});
  std::string ending = std::filesystem::path(name).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::find(kPictures.begin(), kPictures.end(), ending) == kPictures.end()) return;
  std::string yaml = "the .yaml file of the ROS map, which names the picture";
  for (const char* suffix : {".yaml", ".yml"})
    if (std::filesystem::is_regular_file(std::filesystem::path(found).replace_extension(suffix)))
      yaml = fmt::format("the file of the ROS map: include \"{}\"",
                         std::filesystem::path(name).replace_extension(suffix).string());
  fail(r, line,
       fmt::format("\"{}\" is a picture; expected {}; or use it as a floor plan: model( bitmap \"{}\" size [x y z] )",
                   name, yaml, name));
}

void read_include(ParseState& r) {
  const int line = now(r).line;
  ++r.at;
  if (now(r).kind != TokenKind::text) fail(r, line, "expected: include \"file\"");
  const std::string name = now(r).text;
  ++r.at;
  const std::string found = find_file(r.document, {r.file, line}, name);
  refuse_picture(r, line, name, found);
  if (found.empty()) {
    fail(r, line,
         fmt::format("cannot find the include \"{}\"; searched the folders of this file and of the world file, "
                     "$STAGEPATH and the installed worlds",
                     name));
  }
  if (is_ros_map(found)) {
    if (!r.document.ros_map.empty()) fail(r, line, "a second ROS map; expected one per world");
    r.document.ros_map = found;
    r.document.ros_map_at = {r.file, line};
    return;
  }
  if (std::find(r.open_files.begin(), r.open_files.end(), found) != r.open_files.end()) refuse_cycle(r, line, found);
  if (const std::string other = file_in_stage(r.document, name, found); !other.empty())
    warn(r, line, fmt::format("this includes {}; Stage includes {}", found, other));
  if (++r.includes > kMaxIncludes) fail(r, line, fmt::format("more than {} includes", kMaxIncludes));

  // Saves the state of the including file, and restores it after the include.
  const std::uint32_t outer_file = r.file;
  const std::size_t outer_at = r.at;
  std::vector<Token> outer_tokens = std::move(r.tokens);
  const std::string text = base::read_text(found);
  refuse_foreign(found, text);
  read_file(r, found, text);
  r.tokens = std::move(outer_tokens);
  r.at = outer_at;
  r.file = outer_file;
}

void read_item(ParseState& r, std::unordered_set<std::string>& written) {
  const Token& token = now(r);
  if (token.kind == TokenKind::close) fail(r, token.line, "this ')' has no matching '('");
  if (token.kind != TokenKind::word) {
    fail(r, token.line, fmt::format("expected include, define, a property or an entity, found {}", shown(token)));
  }
  if (token.text == "include") return read_include(r);
  if (token.text == "define") return read_define(r);
  if (next(r).kind != TokenKind::open) return add_property(r, r.document.root, r.root_rows, written, read_property(r));
  const int line = token.line;
  add_child(r, r.document.root, read_entity(r, 1), line);
}

void read_file(ParseState& r, const std::string& file, const std::string& text) {
  const auto known = std::find(r.document.files.begin(), r.document.files.end(), file);
  r.file = static_cast<std::uint32_t>(known - r.document.files.begin());
  if (known == r.document.files.end()) r.document.files.push_back(file);
  r.open_files.push_back(std::filesystem::path(file).lexically_normal().string());
  r.tokens = tokenize(file, text);
  r.at = 0;
  std::unordered_set<std::string> written;
  while (now(r).kind != TokenKind::end) read_item(r, written);
  r.open_files.pop_back();
}

}  // namespace

Document parse(const std::string& file, const std::string& text) {
  ParseState r;
  r.document.root.word = "the world";
  read_file(r, file, text);
  sort_keys(r.document.root);
  for (const auto& [name, entity] : r.macros) {
    r.document.macros.push_back(name);
    if (entity.type == "position") r.document.robots.push_back(name);
  }
  return std::move(r.document);
}

namespace fs = std::filesystem;

namespace {

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

}  // namespace

std::string find_file(const Document& document, SourceLocation from, const std::string& name) {
  if (name.empty()) return {};
  const fs::path wanted(name);
  if (wanted.is_absolute()) return is_file(wanted) ? wanted.lexically_normal().string() : std::string();

  std::vector<fs::path> folders{fs::path(document.files[from.file]).parent_path(),
                                fs::path(document.files[0]).parent_path()};
  if (const char* path = std::getenv("STAGEPATH")) {
    std::istringstream list(path);
    for (std::string folder; std::getline(list, folder, ':');) folders.emplace_back(folder);
  }
  for (const fs::path& folder : folders) {
    const fs::path candidate = (folder / wanted).lexically_normal();
    if (is_file(candidate)) return candidate.string();
  }
  const std::string shipped = base::installed_file("worlds/" + name);
  return is_file(shipped) ? shipped : std::string();
}

std::string file_in_stage(const Document& document, const std::string& name, const std::string& found) {
  const fs::path candidate = (fs::path(document.files[0]).parent_path() / name).lexically_normal();
  return candidate != fs::path(found) && is_file(candidate) ? candidate.string() : std::string();
}

}  // namespace sf::world
