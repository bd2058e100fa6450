#include "world/meshes/triangles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <utility>

#include "base/error.h"

namespace sf::world {

void TriangleBuilder::fail(const MeshPlace& at, std::string_view message) const {
  if (at.kind == std::string_view("line"))
    throw base::InputError(file_, static_cast<int>(at.number), std::string(message));
  throw base::InputError(file_, 0, fmt::format("{} {}: {}", at.kind, at.number, message));
}

void TriangleBuilder::fail(std::string_view message) const { throw base::InputError(file_, 0, std::string(message)); }

void TriangleBuilder::expect(std::uint64_t triangles) const {
  if (triangles > kMostTriangles)
    fail(fmt::format("has {} triangles; expected at most {}: simplify it, or divide it into several models", triangles,
                     kMostTriangles));
}

void TriangleBuilder::add_vertex(const glm::dvec3& p, const MeshPlace& at) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(p[axis]) <= kMostCoordinate))
      fail(at, fmt::format("the coordinate {:g} is not a number within {:g} of 0", p[axis], kMostCoordinate));
  out_.vertices.push_back(p);
}

/// Returns whether all corners turn in one direction and all triangles around the first corner face one side, within
/// the rounding of coordinates in text or float32.
bool TriangleBuilder::is_convex(std::span<const std::uint64_t> corners) const {
  constexpr double kRounding = 1e-5;  // of the face's size
  const std::size_t n = corners.size();
  const auto at = [&](std::size_t i) { return out_.vertices[corners[i % n]]; };
  glm::dvec3 normal{};
  double size = 0.0;
  for (std::size_t i = 1; i + 1 < n; ++i) normal += glm::cross(at(i) - at(0), at(i + 1) - at(0));
  for (std::size_t i = 1; i < n; ++i) size = std::max(size, glm::length(at(i) - at(0)));
  const double most = kRounding * size * glm::length(normal);
  const auto turns_back = [&](glm::dvec3 a, glm::dvec3 b) {
    return glm::dot(glm::cross(a, b), normal) < -most * std::max(glm::length(a), glm::length(b));
  };
  for (std::size_t i = 0; i < n; ++i)
    if (turns_back(at(i + 1) - at(i), at(i + 2) - at(i + 1)) ||
        (i > 0 && i + 1 < n && turns_back(at(i) - at(0), at(i + 1) - at(0))))
      return false;
  return true;
}

/// @param corners number of those of a face
void TriangleBuilder::add_coordinates(std::span<const glm::vec2> coordinates, std::size_t corners) {
  if (material_ == kNoMaterial || out_.texture_of[material_].texture == kNoTexture) return;
  const auto is_good = [](glm::vec2 c) {
    return std::abs(c.x) <= kMostTextureCoordinate && std::abs(c.y) <= kMostTextureCoordinate;
  };
  const bool good = coordinates.size() == corners && std::ranges::all_of(coordinates, is_good);
  if (!good && !std::exchange(lacking_, true))
    add_note(
        "faces of textured materials lack texture coordinates, or have some that are not finite or beyond 1e6; "
        "they have the colour at the top left of the texture");
  out_.coordinates.resize(out_.corners.size() - 3 * (corners - 2));  // faces before this one
  const auto at = [&](std::size_t i) { return good ? coordinates[i] : glm::vec2{}; };
  for (std::size_t i = 1; i + 1 < corners; ++i)
    out_.coordinates.insert(out_.coordinates.end(), {at(0), at(i), at(i + 1)});
}

void TriangleBuilder::add_face(std::span<const std::uint64_t> corners, const MeshPlace& at,
                               std::span<const glm::vec2> coordinates) {
  if (corners.size() < 3) fail(at, "a face has fewer than three corners");
  for (const std::uint64_t corner : corners)
    if (corner >= vertices()) fail(at, fmt::format("a face refers to vertex {} of {} so far", corner + 1, vertices()));
  if (corners.size() > 3 && !is_convex(corners))
    fail(at, fmt::format("a face with {} corners is not convex; expected convex faces: divide it into triangles where "
                         "the file is made",
                         corners.size()));
  expect(out_.corners.size() / 3 + corners.size() - 2);
  const auto row = [&](std::size_t i) { return static_cast<std::uint32_t>(corners[i]); };
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    out_.corners.insert(out_.corners.end(), {row(0), row(i), row(i + 1)});
  add_coordinates(coordinates, corners.size());
  if (material_ == kNoMaterial) return;
  out_.material_of.resize(out_.corners.size() / 3 - (corners.size() - 2), kNoMaterial);  // faces before this one
  out_.material_of.resize(out_.corners.size() / 3, material_);
}

std::uint32_t TriangleBuilder::add_texture(TextureSource texture) {
  out_.textures.push_back(std::move(texture));
  return static_cast<std::uint32_t>(out_.textures.size() - 1);
}

std::uint32_t TriangleBuilder::add_material(const std::string& name, Material material, const TextureUse& texture) {
  if (const glm::dvec3& c = material.color; !std::isfinite(c.x + c.y + c.z))
    fail(fmt::format("material '{}' has the colour ({:g}, {:g}, {:g}); expected numbers from 0 to 1", name, c.x, c.y,
                     c.z));
  if (!(material.reflectance >= 0.0 && material.reflectance <= kMostReflectance))
    fail(fmt::format("material '{}' has the reflectance {:g}; expected 0 to {:g}", name, material.reflectance,
                     kMostReflectance));
  bool clamped = clamped_;
  for (int k = 0; k < 3; ++k) {
    double& part = material.color[k];
    clamped = clamped || !(part >= 0.0 && part <= 1.0);
    part = part > 0.0 ? std::min(part, 1.0) : 0.0;
  }
  if (std::exchange(clamped_, clamped) != clamped)
    add_note(fmt::format("the colour of material '{}' is not within 0 to 1; such colours are clamped", name));
  out_.materials.push_back(material);
  out_.texture_of.push_back(texture);
  return static_cast<std::uint32_t>(out_.materials.size() - 1);
}

void TriangleBuilder::add(const Triangles& part) {
  expect((out_.corners.size() + part.corners.size()) / 3);
  const std::uint64_t first = vertices();
  const auto first_material = static_cast<std::uint32_t>(out_.materials.size());
  const auto first_texture = static_cast<std::uint32_t>(out_.textures.size());
  out_.textures.insert(out_.textures.end(), part.textures.begin(), part.textures.end());
  for (std::size_t i = 0; i < part.materials.size(); ++i) {
    TextureUse use = part.texture_of.empty() ? TextureUse{} : part.texture_of[i];
    if (use.texture != kNoTexture) use.texture += first_texture;
    add_material(std::to_string(i + 1), part.materials[i], use);
  }
  std::uint64_t number = 0;
  for (const glm::dvec3& p : part.vertices) add_vertex(p, {"vertex", ++number});
  for (std::size_t i = 0; i + 2 < part.corners.size(); i += 3) {
    const auto row = [&](std::size_t k) { return first + part.corners[i + k]; };
    const std::uint32_t material = part.material_of.empty() ? kNoMaterial : part.material_of[i / 3];
    material_ = material == kNoMaterial ? material : first_material + material;
    const auto coordinates = std::span(part.coordinates).subspan(part.coordinates.empty() ? 0 : i);
    add_face(std::array{row(0), row(1), row(2)}, {"triangle", i / 3 + 1},
             coordinates.first(std::min<std::size_t>(3, coordinates.size())));
  }
  material_ = kNoMaterial;
  out_.notes.insert(out_.notes.end(), part.notes.begin(), part.notes.end());
}

Triangles TriangleBuilder::finish() {
  if (out_.corners.empty()) fail("has no triangles; expected a surface");
  std::vector<std::uint32_t> rows(out_.vertices.size(), 0xFFFFFFFFu);  // of vertices that triangles use
  std::vector<glm::dvec3> used;
  for (std::uint32_t& corner : out_.corners) {
    std::uint32_t& row = rows[corner];
    if (row == 0xFFFFFFFFu) row = static_cast<std::uint32_t>(used.size()), used.push_back(out_.vertices[corner]);
    corner = row;
  }
  out_.vertices = std::move(used);
  if (out_.material_of.empty())
    out_.materials.clear();
  else
    out_.material_of.resize(out_.corners.size() / 3, kNoMaterial);
  if (out_.coordinates.empty())
    out_.textures.clear(), out_.texture_of.clear();
  else
    out_.coordinates.resize(out_.corners.size());
  return std::move(out_);
}

}  // namespace sf::world
