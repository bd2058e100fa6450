// PLY (Stanford, Turk 1994): tables of numbers, of which `vertex` and `face` are used, as text or binary.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>

#include "world/meshes/triangles.h"
#include "world/meshes/words.h"

namespace sf::world {

namespace {

enum class Type : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };
constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
constexpr std::uint64_t kMostCorners = 1'000;  ///< of one face

std::optional<Type> type_named(std::string_view name) {
  constexpr std::array<std::array<std::string_view, 2>, 8> kNames{{{"char", "int8"},
                                                                   {"uchar", "uint8"},
                                                                   {"short", "int16"},
                                                                   {"ushort", "uint16"},
                                                                   {"int", "int32"},
                                                                   {"uint", "uint32"},
                                                                   {"float", "float32"},
                                                                   {"double", "float64"}}};
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (std::ranges::find(kNames[i], name) != kNames[i].end()) return static_cast<Type>(i);
  return {};
}

struct PlyProperty {
  std::string name;
  Type type = Type::f32;
  std::optional<Type> count;  ///< of a list
};
struct PlyTable {
  std::string name;
  std::uint64_t rows = 0;
  std::vector<PlyProperty> properties;
};

class PlyReader {
 public:
  PlyReader(const std::string& file, std::string_view bytes) : out_(file), rest_(bytes) {}
  Triangles read() {
    read_header();
    for (const PlyTable& table : tables_) read_table(table);
    return out_.finish();
  }

 private:
  enum class Form { text, little, big };

  void read_header();
  void read_header_line(std::string_view word, WordReader& in, const MeshPlace& at);
  void read_table(const PlyTable& table);
  void read_row(const PlyTable& table, const MeshPlace& at);
  double number(Type type, const MeshPlace& at);
  void add(const PlyTable& table, const glm::dvec3& p, const MeshPlace& at);

  TriangleBuilder out_;
  std::string_view rest_;
  Form form_ = Form::text;
  std::vector<PlyTable> tables_;
  std::vector<std::uint64_t> corners_;
};

void PlyReader::read_header_line(std::string_view word, WordReader& in, const MeshPlace& at) {
  if (word == "format") {
    const std::string_view name = in.word();
    form_ = name == "ascii" ? Form::text : name == "binary_little_endian" ? Form::little : Form::big;
    if (form_ == Form::big && name != "binary_big_endian")
      out_.fail(at,
                fmt::format("unknown format '{}'; expected ascii, binary_little_endian or binary_big_endian", name));
  } else if (word == "element") {
    PlyTable& table = tables_.emplace_back();
    table.name = in.word();
    if (!in.number(table.rows)) out_.fail(at, "expected: element NAME COUNT");
    // Each row takes at least a byte.
    if (table.rows > rest_.size())
      out_.fail(at, fmt::format("{} rows do not fit into the {} bytes of the file", table.rows, rest_.size()));
  } else if (word == "property" && !tables_.empty()) {
    PlyProperty property;
    std::string_view type = in.word();
    const bool list = type == "list";
    if (list) {
      property.count = type_named(in.word());
      type = in.word();
    }
    const std::optional<Type> found = type_named(type);
    property.name = in.word();
    if (!found || (list && !property.count) || property.name.empty())
      out_.fail(at,
                "expected: property TYPE NAME, or property list TYPE TYPE NAME, with types such as float and uchar");
    property.type = *found;
    tables_.back().properties.push_back(std::move(property));
  } else if (word != "comment" && word != "obj_info" && !word.empty()) {
    out_.fail(at,
              fmt::format("unknown line '{}' in the header; expected format, element, property or end_header", word));
  }
}

void PlyReader::read_header() {
  std::string_view line;
  MeshPlace at{"line", 1};
  if (!take_line(rest_, line) || line != "ply") out_.fail(at, "expected 'ply' in the first line");
  for (;;) {
    ++at.number;
    if (!take_line(rest_, line)) out_.fail("ends within its header; expected 'end_header'");
    WordReader in(line);
    const std::string_view word = in.word();
    if (word == "end_header") break;
    read_header_line(word, in, at);
  }
  for (const PlyTable& table : tables_)
    if (table.name == "face") out_.expect(table.rows);
}

double PlyReader::number(Type type, const MeshPlace& at) {
  if (form_ == Form::text) {
    WordReader in(rest_);
    double value = 0.0;
    if (!in.number(value)) out_.fail(at, "expected a number");
    rest_ = in.rest();
    return value;
  }
  const std::size_t size = kSizes[static_cast<std::size_t>(type)];
  if (rest_.size() < size) out_.fail(at, "the file ends here");
  std::array<char, 8> bytes{};
  std::copy_n(rest_.begin(), size, bytes.begin());
  if (form_ == Form::big) std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
  rest_.remove_prefix(size);
  const auto as = [&](auto value) {
    std::memcpy(&value, bytes.data(), sizeof value);
    return static_cast<double>(value);
  };
  switch (type) {
    case Type::i8:
      return as(std::int8_t{});
    case Type::u8:
      return as(std::uint8_t{});
    case Type::i16:
      return as(std::int16_t{});
    case Type::u16:
      return as(std::uint16_t{});
    case Type::i32:
      return as(std::int32_t{});
    case Type::u32:
      return as(std::uint32_t{});
    case Type::f32:
      return as(float{});
    case Type::f64:
      return as(double{});
  }
  return 0.0;
}

void PlyReader::read_row(const PlyTable& table, const MeshPlace& at) {
  glm::dvec3 p{};
  corners_.clear();
  for (const PlyProperty& property : table.properties) {
    const bool corners = property.name == "vertex_indices" || property.name == "vertex_index";
    const double count = property.count ? number(*property.count, at) : 1.0;
    if (!(count >= 0.0 && count <= 4e9) || count != std::floor(count) || (corners && count > kMostCorners))
      out_.fail(at, fmt::format("a list has {} elements", count));
    for (std::uint64_t k = 0; k < static_cast<std::uint64_t>(count); ++k) {
      const double value = number(property.type, at);
      if (corners && !(value >= 0.0 && value < 4e9 && value == std::floor(value)))
        out_.fail(at, fmt::format("'{}' is {}; expected rows of vertices, from 0", property.name, value));
      if (corners) corners_.push_back(static_cast<std::uint64_t>(value));
      if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
        p[property.name[0] - 'x'] = value;
    }
  }
  add(table, p, at);
}

void PlyReader::add(const PlyTable& table, const glm::dvec3& p, const MeshPlace& at) {
  if (table.name == "vertex") out_.add_vertex(p, at);
  if (table.name == "face") out_.add_face(corners_, at);
}

void PlyReader::read_table(const PlyTable& table) {
  const auto has = [&](std::string_view name) {
    return std::ranges::any_of(table.properties, [&](const PlyProperty& p) { return p.name == name; });
  };
  if (table.name == "vertex" && !(has("x") && has("y") && has("z"))) out_.fail("its vertices have no x, y and z");
  if (table.name == "face" && !has("vertex_indices") && !has("vertex_index"))
    out_.fail("its faces have no list 'vertex_indices'");
  if (table.properties.empty() && table.rows > 0) out_.fail(fmt::format("'{}' has no properties", table.name));
  for (std::uint64_t row = 0; row < table.rows; ++row) read_row(table, {table.name.c_str(), row + 1});
}

}  // namespace

Triangles read_ply(const std::string& file, std::string_view bytes) { return PlyReader(file, bytes).read(); }

}  // namespace sf::world
