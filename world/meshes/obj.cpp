// OBJ (Wavefront): vertices and faces of a text; groups, normals, textures, lines and curves are not used.

#include <fmt/format.h>

#include <algorithm>
#include <string>

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

}  // namespace

Triangles read_obj(const std::string& file, std::string_view bytes) {
  TriangleBuilder out(file);
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
    }
    joined.clear();
  }
  return out.finish();
}

}  // namespace sf::world
