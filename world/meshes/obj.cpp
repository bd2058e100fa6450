// OBJ (Wavefront): vertices, faces, their materials and texture coordinates of a text; groups, normals, lines and
// curves are not used.

#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <string>

#include "base/error.h"
#include "base/files.h"
#include "world/meshes/mtl.h"
#include "world/meshes/triangles.h"
#include "world/meshes/words.h"

namespace sf::world {

namespace {

constexpr float kNoCoordinate = std::numeric_limits<float>::quiet_NaN();

/// Returns the row, from 0, of the number of an element of `count` so far. Negative numbers count from the last one.
std::optional<std::uint64_t> row_of(std::int64_t number, std::size_t count) {
  const auto size = static_cast<std::int64_t>(count);
  if (number == 0 || number > size || number < -size) return {};
  return static_cast<std::uint64_t>(number > 0 ? number - 1 : size + number);
}

/// Returns the row of a face's corner, `v`, `v/vt`, `v//vn` or `v/vt/vn`.
std::uint64_t corner_of(const TriangleBuilder& out, std::string_view word, const MeshPlace& at) {
  const std::string_view number = word.substr(0, word.find('/'));
  std::int64_t row = 0;
  if (!WordReader(number).number(row) || row == 0)
    out.fail(at, fmt::format("'{}' is no corner of a face; expected the number of a vertex, from 1 or before the end",
                             word));
  const auto found = row_of(row, out.vertices());
  if (!found) out.fail(at, fmt::format("a face refers to vertex {} of {} so far", row, out.vertices()));
  return *found;
}

/// Returns the texture coordinates of a corner; NaN: none.
glm::vec2 coordinate_of(std::span<const glm::vec2> all, std::string_view word) {
  const std::size_t slash = word.find('/');
  std::int64_t number = 0;
  if (slash == std::string_view::npos) return glm::vec2(kNoCoordinate);
  const std::string_view rest = word.substr(slash + 1);
  if (!WordReader(rest.substr(0, rest.find('/'))).number(number)) return glm::vec2(kNoCoordinate);
  const auto row = row_of(number, all.size());
  return row ? all[*row] : glm::vec2(kNoCoordinate);
}

/// Materials that an OBJ file names.
class MaterialNames {
 public:
  MaterialNames(std::string file, TriangleBuilder& out) : file_(std::move(file)), out_(out) {}
  void read_libraries(std::string_view names, const MeshPlace& at);
  void use(std::string_view name);
  void note_unknown();
  /// Converts coordinates of the current material, whose v points up, to those of its texture.
  void place(std::span<glm::vec2> coordinates) const {
    for (glm::vec2& c : coordinates) c = scale_ * c + offset_, c.y = 1.0f - c.y;
  }

 private:
  static constexpr std::size_t kMostLibraries = 100, kMostBytes = 16u << 20;  ///< of one library

  void read_library(const std::filesystem::path& path, const MeshPlace& at);
  std::uint32_t add(const std::string& name, const MtlMaterial& material);

  std::string file_;
  TriangleBuilder& out_;
  std::set<std::filesystem::path> libraries_;
  std::map<std::string, MtlMaterial, std::less<>> known_;
  std::map<std::string, std::uint32_t, std::less<>> rows_;  ///< of those that were used
  std::map<std::string, std::uint32_t> textures_;           ///< rows by file
  glm::vec2 scale_{1.0f}, offset_{0.0f};                    ///< of the current material
  std::string unknown_;                                     ///< the first one; empty: none
};

/// @param names files in the folder of the OBJ file; one file may have blanks in its name
void MaterialNames::read_libraries(std::string_view names, const MeshPlace& at) {
  const std::filesystem::path folder = std::filesystem::path(file_).parent_path();
  std::error_code error;
  const std::filesystem::path whole = folder / trimmed(names);
  if (std::filesystem::is_regular_file(whole, error)) return read_library(whole, at);
  WordReader in(names);
  for (std::string_view name = in.word(); !name.empty(); name = in.word()) read_library(folder / name, at);
}

void MaterialNames::read_library(const std::filesystem::path& path, const MeshPlace& at) {
  if (!libraries_.insert(path).second) return;
  if (libraries_.size() > kMostLibraries)
    out_.fail(at, fmt::format("names more than {} files of materials; expected at most that", kMostLibraries));
  try {
    std::map<std::string, MtlMaterial, std::less<>> found;
    read_mtl(base::read_bytes(path.string(), kMostBytes), found);
    for (auto& [name, material] : found) {
      if (!material.texture.empty()) material.texture = (path.parent_path() / material.texture).string();
      known_.insert_or_assign(name, std::move(material));
    }
  } catch (const base::InputError& trouble) {
    out_.add_note(fmt::format("materials are left out: {}", trouble.what()));
  }
}

/// Adds a material with its texture. @return its row
std::uint32_t MaterialNames::add(const std::string& name, const MtlMaterial& material) {
  TextureUse use;
  if (!material.texture.empty()) {
    const auto [known, is_new] = textures_.try_emplace(material.texture, 0u);
    if (is_new) known->second = out_.add_texture({material.texture, "", material.alpha});
    use.texture = known->second;
    if (material.clamp) use.u = use.v = TextureWrap::clamp;
  }
  return out_.add_material(name, material, use);
}

void MaterialNames::use(std::string_view name) {
  const auto known = known_.find(name);
  if (known != known_.end()) scale_ = known->second.scale, offset_ = known->second.offset;
  const auto used = rows_.find(name);
  if (used != rows_.end()) return out_.use_material(used->second);
  if (known == known_.end()) {
    if (unknown_.empty()) unknown_ = name;
    return out_.use_material(kNoMaterial);
  }
  const std::uint32_t row = add(known->first, known->second);
  rows_.emplace(name, row);
  out_.use_material(row);
}

void MaterialNames::note_unknown() {
  if (!unknown_.empty())
    out_.add_note(
        fmt::format("material '{}' is in none of its files of materials; faces of such materials have the "
                    "default reflectance",
                    unknown_));
}

}  // namespace

Triangles read_obj(const std::string& file, std::string_view bytes) {
  TriangleBuilder out(file);
  MaterialNames materials(file, out);
  std::vector<std::uint64_t> corners;
  std::vector<glm::vec2> all_coordinates, coordinates;  // of the texture
  std::string joined;                                   // of a line that continues after a backslash
  MeshPlace at{"line", 0};
  for (std::string_view line; take_line(bytes, line);) {
    ++at.number;
    if (line.ends_with('\\') && !bytes.empty()) {
      joined.append(line.substr(0, line.size() - 1)) += ' ';
      continue;
    }
    if (!joined.empty()) line = joined.append(line);
    WordReader in(line);
    const std::string_view word = in.word();
    if (word == "v") {
      glm::dvec3 p;
      if (!in.number(p.x) || !in.number(p.y) || !in.number(p.z)) out.fail(at, "expected: v X Y Z");
      out.add_vertex(p, at);
    } else if (word == "vt") {
      glm::vec2& c = all_coordinates.emplace_back(0.0f);
      if (!in.number(c.x) || (!trimmed(in.rest()).empty() && !in.number(c.y))) c = glm::vec2(kNoCoordinate);
    } else if (word == "f") {
      corners.clear(), coordinates.clear();
      for (std::string_view corner = in.word(); !corner.empty() && corner[0] != '#'; corner = in.word()) {
        corners.push_back(corner_of(out, corner, at));
        coordinates.push_back(coordinate_of(all_coordinates, corner));
      }
      materials.place(coordinates);
      out.add_face(corners, at, coordinates);
    } else if (word == "mtllib") {
      materials.read_libraries(in.rest(), at);
    } else if (word == "usemtl") {
      materials.use(trimmed(in.rest()));
    }
    joined.clear();
  }
  materials.note_unknown();
  return out.finish();
}

}  // namespace sf::world
