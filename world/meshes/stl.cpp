// STL: a list of triangles, as text or binary (3D Systems, 1989).

#include <fmt/format.h>

#include <array>
#include <cstring>

#include "world/meshes/triangles.h"
#include "world/meshes/words.h"

namespace sf::world {

namespace {

constexpr std::size_t kHeader = 84, kRecord = 50;  ///< [bytes] the number of triangles ends the header

std::uint32_t count_in(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= kHeader) std::memcpy(&count, bytes.data() + kHeader - sizeof count, sizeof count);
  return count;
}

void add_triangle(TriangleBuilder& out, const std::array<glm::dvec3, 3>& corners, const MeshPlace& at) {
  const std::uint64_t first = out.vertices();
  for (const glm::dvec3& p : corners) out.add_vertex(p, at);
  out.add_face(std::array{first, first + 1, first + 2}, at);
}

Triangles read_binary(TriangleBuilder& out, std::string_view bytes) {
  const std::uint64_t count = count_in(bytes);
  out.expect(count);
  if (bytes.size() < kHeader + kRecord * count)
    out.fail(fmt::format("ends after {} bytes; expected {} for its {} triangles, {} bytes each", bytes.size(),
                         kHeader + kRecord * count, count, kRecord));
  for (std::uint64_t k = 0; k < count; ++k) {
    std::array<float, 12> numbers;  // the normal, which is not used, then the corners
    std::memcpy(numbers.data(), bytes.data() + kHeader + kRecord * k, sizeof numbers);
    std::array<glm::dvec3, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = {numbers[3 * i + 3], numbers[3 * i + 4], numbers[3 * i + 5]};
    add_triangle(out, corners, {"triangle", k + 1});
  }
  return out.finish();
}

Triangles read_text(TriangleBuilder& out, std::string_view text) {
  WordReader in(text);
  std::array<glm::dvec3, 3> corners;
  std::size_t count = 0;
  bool open = false;  // a solid has not ended
  for (std::string_view word = in.word(); !word.empty(); word = in.word()) {
    const auto at = [&] { return MeshPlace{"line", in.line()}; };
    if (is_word(word, "solid") || is_word(word, "endsolid")) {
      open = is_word(word, "solid");
      in.skip_line();  // its name
    } else if (is_word(word, "vertex")) {
      if (count == 3) out.fail(at(), "a facet has a fourth vertex; expected three");
      glm::dvec3& p = corners[count++];
      if (!in.number(p.x) || !in.number(p.y) || !in.number(p.z)) out.fail(at(), "expected: vertex X Y Z");
    } else if (is_word(word, "endfacet")) {
      if (count != 3) out.fail(at(), fmt::format("a facet has {} vertices; expected three", count));
      add_triangle(out, corners, at());
      count = 0;
    }
  }
  if (count > 0 || open) out.fail("ends within a solid; expected 'endsolid'");
  return out.finish();
}

/// Returns whether a file is text: it begins with "solid" and a facet or an end follows.
bool is_text(std::string_view bytes) {
  constexpr std::size_t kLooked = 4096;  // [bytes], more than the name of a solid
  WordReader in(bytes.substr(0, kLooked));
  if (!is_word(in.word(), "solid")) return false;
  in.skip_line();
  const std::string_view next = in.word();
  return is_word(next, "facet") || is_word(next, "endsolid") || bytes.size() < kHeader;
}

}  // namespace

/// Some binary files begin with "solid" as text does; their size then matches their number of triangles.
Triangles read_stl(const std::string& file, std::string_view bytes) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  TriangleBuilder out(file);
  const bool sized = bytes.size() >= kHeader && bytes.size() == kHeader + kRecord * std::uint64_t{count_in(bytes)};
  const std::string_view text = bytes.substr(bytes.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0);
  if (!sized && is_text(text)) return read_text(out, text);
  if (bytes.size() < kHeader)
    out.fail("is too short for an STL file; expected text that begins with 'solid', or 84 bytes");
  return read_binary(out, bytes);
}

}  // namespace sf::world
