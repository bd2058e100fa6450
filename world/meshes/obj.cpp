// OBJ (Wavefront): vertices, faces and their materials of a text; groups, normals, textures, lines and curves are not
// used.

#include <fmt/format.h>

#include <filesystem>
#include <set>
#include <string>

#include "base/error.h"
#include "base/files.h"
#include "world/meshes/mtl.h"
#include "world/meshes/triangles.h"
#include "world/meshes/words.h"

namespace sf::world {

namespace {

/// Returns the row of a face's corner, `v`, `v/vt`, `v//vn` or `v/vt/vn`. Negative numbers count from the last vertex.
std::uint64_t corner_of(const TriangleBuilder& out, std::string_view word, const MeshPlace& at) {
  const std::string_view number = word.substr(0, word.find('/'));
  std::int64_t row = 0;
  if (!WordReader(number).number(row) || row == 0)
    out.fail(at, fmt::format("'{}' is no corner of a face; expected the number of a vertex, from 1 or before the end",
                             word));
  const auto count = static_cast<std::int64_t>(out.vertices());
  if (row > count || row < -count) out.fail(at, fmt::format("a face refers to vertex {} of {} so far", row, count));
  return static_cast<std::uint64_t>(row > 0 ? row - 1 : count + row);
}

/// Materials that an OBJ file names.
class MaterialNames {
 public:
  MaterialNames(std::string file, TriangleBuilder& out) : file_(std::move(file)), out_(out) {}
  void read_libraries(std::string_view names, const MeshPlace& at);
  void use(std::string_view name);
  void note_unknown();

 private:
  static constexpr std::size_t kMostLibraries = 100, kMostBytes = 16u << 20;  ///< of one library

  void read_library(const std::filesystem::path& path, const MeshPlace& at);

  std::string file_;
  TriangleBuilder& out_;
  std::set<std::filesystem::path> libraries_;
  std::map<std::string, Material, std::less<>> known_;
  std::map<std::string, std::uint32_t, std::less<>> rows_;  ///< of those that were used
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
    read_mtl(base::read_bytes(path.string(), kMostBytes), known_);
  } catch (const base::InputError& trouble) {
    out_.add_note(fmt::format("materials are left out: {}", trouble.what()));
  }
}

void MaterialNames::use(std::string_view name) {
  const auto used = rows_.find(name);
  if (used != rows_.end()) return out_.use_material(used->second);
  const auto known = known_.find(name);
  if (known == known_.end()) {
    if (unknown_.empty()) unknown_ = name;
    return out_.use_material(kNoMaterial);
  }
  const std::uint32_t row = out_.add_material(known->first, known->second);
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
  std::string joined;  // of a line that continues after a backslash
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
    } else if (word == "f") {
      corners.clear();
      for (std::string_view corner = in.word(); !corner.empty() && corner[0] != '#'; corner = in.word())
        corners.push_back(corner_of(out, corner, at));
      out.add_face(corners, at);
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
