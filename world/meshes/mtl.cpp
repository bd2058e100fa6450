#include "world/meshes/mtl.h"

#include <algorithm>

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

/// Reads `map_Kd [-OPTION VALUES ...] FILE`. A file's name may have blanks.
void read_texture(WordReader& in, MtlMaterial& material) {
  material.scale = glm::vec2(1.0f), material.offset = glm::vec2(0.0f), material.clamp = false;
  std::string_view file = trimmed(in.rest());
  while (file.starts_with('-')) {
    const std::string_view option = in.word();
    glm::vec2 ignored, &numbers = option == "-s" ? material.scale : option == "-o" ? material.offset : ignored;
    file = trimmed(in.rest());
    float value = 0.0f;
    for (int k = 0; k < 3 && WordReader(file).number(value); ++k) {
      if (k < 2) numbers[k] = value;
      in.word(), file = trimmed(in.rest());
    }
    if (const std::string_view word = WordReader(file).word(); word == "on" || word == "off" || option == "-imfchan") {
      if (option == "-clamp") material.clamp = word == "on";
      in.word(), file = trimmed(in.rest());
    }
  }
  material.texture = file;
  std::ranges::replace(material.texture, '\\', '/');  // as written on Windows
}

}  // namespace

void read_mtl(std::string_view text, std::map<std::string, MtlMaterial, std::less<>>& out) {
  MtlMaterial* material = nullptr;
  bool colored = false;
  for (std::string_view line; take_line(text, line);) {
    WordReader in(line);
    const std::string_view word = in.word();
    if (word == "newmtl") {
      material = &(out[std::string(trimmed(in.rest()))] = {});
      colored = false;
    } else if (material == nullptr) {
      continue;
    } else if (word == "map_Kd") {
      read_texture(in, *material);
      material->reflectance = kDefaultReflectance;
      if (!colored) material->color = glm::dvec3(1.0);
    } else if (word == "map_d") {
      material->alpha = true;
    } else if (word == "Kd" && read_color(in, material->color)) {
      colored = true;
      if (material->texture.empty()) material->reflectance = luminance(material->color);
    }
  }
}

}  // namespace sf::world
