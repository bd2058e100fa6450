#include "world/meshes/mtl.h"

#include "world/meshes/words.h"

namespace sf::world {

namespace {

/// Reads `Kd R [G B]`. @return false for other forms of a colour, such as a spectrum
bool read_color(WordReader& in, glm::dvec3& color) {
  glm::dvec3 read;
  if (!in.number(read.x)) return false;
  const std::string_view rest = in.rest();
  if (!in.number(read.y) || !in.number(read.z)) {
    if (!WordReader(rest).word().empty()) return false;
    read = glm::dvec3(read.x);
  }
  color = read;
  return true;
}

}  // namespace

void read_mtl(std::string_view text, std::map<std::string, Material, std::less<>>& out) {
  Material* material = nullptr;
  bool textured = false;
  for (std::string_view line; take_line(text, line);) {
    WordReader in(line);
    const std::string_view word = in.word();
    if (word == "newmtl") {
      material = &(out[std::string(trimmed(in.rest()))] = {});
      textured = false;
    } else if (material == nullptr) {
      continue;
    } else if (word == "map_Kd") {
      textured = true;
      material->reflectance = kDefaultReflectance;
    } else if (word == "Kd" && read_color(in, material->color) && !textured) {
      material->reflectance = luminance(material->color);
    }
  }
}

}  // namespace sf::world
