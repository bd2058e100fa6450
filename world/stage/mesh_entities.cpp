#include "world/stage/mesh_entities.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/rigid_transform.h"
#include "world/meshes/mesh_file.h"

namespace sf::world {

namespace {

constexpr double kMostAll = 2.0 * kMostTriangles;  // triangles of all meshes

const Triangles& triangles_of(BuildState& b, const std::string& file, SourceLocation at) {
  const auto [found, is_new] = b.triangles.try_emplace(file);
  if (!is_new) return found->second;
  found->second = read_triangles(file);
  for (const std::string& note : found->second.notes) warn(b.context, at, fmt::format("{}: {}", file, note));
  return found->second;
}

glm::dmat3 rotation(BuildState& b, const Entity& entity) {
  const auto angles = tuple(b.context, entity, "mesh_rotation", 3, "[roll pitch yaw]");
  if (!angles) return glm::dmat3(1.0);
  const double unit = b.context.radians_per_unit;
  return base::rotation_of(unit * (*angles)[0], unit * (*angles)[1], unit * (*angles)[2]);
}

/// Scales to a box about the origin, with its foot at z = 0. A mesh without an extent along an axis keeps none.
void fit(std::vector<glm::dvec3>& vertices, const Size& size) {
  const MeshBox box = box_of(vertices);
  const glm::dvec3 from = box.size(), to{size.x, size.y, size.z};
  for (glm::dvec3& p : vertices)
    for (int axis = 0; axis < 3; ++axis) {
      const double part = from[axis] > 0.0 ? (p[axis] - box.low[axis]) / from[axis] : 0.0;
      p[axis] = (axis < 2 && from[axis] > 0.0 ? part - 0.5 : part) * to[axis];
    }
}

void require_within(const BuildState& b, const Entity& entity, const Mesh& mesh) {
  for (const glm::dvec3& p : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(p[axis]) <= kMaxLength))
        fail(b.context, location_of(entity, "mesh"),
             fmt::format(
                 "this mesh reaches {:g} m from its origin; expected at most {:g} m: give 'size' or 'mesh_scale'",
                 std::abs(p[axis]), kMaxLength));
}

/// Leaves out triangles whose corners are on one line, as at the poles of many spheres.
/// @param materials per triangle, or empty
void leave_out_flat(BuildState& b, const Entity& entity, Mesh& mesh, std::vector<std::uint32_t>& materials) {
  std::size_t kept = 0, flat = 0, first = 0;  // number of the first, from 1
  for (std::size_t i = 0; i < mesh.corners.size(); i += 3) {
    const auto at = [&](std::size_t k) { return mesh.vertices[mesh.corners[i + k]]; };
    const glm::dvec3 normal = glm::cross(at(1) - at(0), at(2) - at(0));
    if (!(glm::dot(normal, normal) > 0.0)) {
      if (flat++ == 0) first = i / 3 + 1;
      continue;
    }
    if (!materials.empty()) materials[kept / 3] = materials[i / 3];
    for (std::size_t k = 0; k < 3; ++k) mesh.corners[kept++] = mesh.corners[i + k];
  }
  if (!materials.empty()) materials.resize(kept / 3);
  mesh.corners.resize(kept);
  const SourceLocation at = location_of(entity, "mesh");
  if (kept == 0) fail(b.context, at, "all triangles of this mesh have an area of 0");
  if (flat > 0)
    warn(b.context, at,
         fmt::format("{} of {} triangles in {} are left out, since their area is 0; the first is number {}", flat,
                     flat + kept / 3, mesh.file, first));
}

}  // namespace

std::optional<std::uint32_t> mesh_of(BuildState& b, const Entity& entity, Size& size) {
  if (find(entity, "mesh") == nullptr) {
    for (const char* key : {"mesh_scale", "mesh_rotation"})
      if (find(entity, key) != nullptr)
        warn(b.context, location_of(entity, key), fmt::format("'{}' has no effect without 'mesh \"FILE\"'", key));
    return {};
  }
  const SourceLocation at = location_of(entity, "mesh");
  const bool fits = find(entity, "size") != nullptr, scaled = find(entity, "mesh_scale") != nullptr;
  if (fits && scaled)
    fail(b.context, location_of(entity, "mesh_scale"),
         "'size' fits the mesh into a box; expected it or 'mesh_scale', not both");
  if (find(entity, "outlines") != nullptr) fail(b.context, at, "a model has a mesh or a file of 'outlines', not both");
  if (find(entity, "random_size") != nullptr)
    fail(b.context, location_of(entity, "random_size"),
         "a mesh has one size; expected 'random_size' in a model without 'mesh'");
  const double scale = number(b.context, entity, "mesh_scale", 1.0);
  if (!(scale > 0.0)) fail(b.context, location_of(entity, "mesh_scale"), "'mesh_scale' expects a number above 0");
  const std::string file = file_of(b.context, entity, "mesh");
  const glm::dmat3 R = rotation(b, entity);
  const Size box = fits ? size : Size{0.0, 0.0, 0.0};
  const MeshKey key{file, {R[0].x, R[0].y, R[0].z, R[1].x, R[1].y, R[1].z, scale, box.x, box.y, box.z}};
  auto known = b.mesh_rows.find(key);
  if (known == b.mesh_rows.end()) {
    const Triangles& triangles = triangles_of(b, file, at);
    charge(b.context, at, b.context.usage.triangles, static_cast<double>(triangles.corners.size() / 3), kMostAll,
           "triangles of meshes", "simplify them, or leave some out");
    Mesh mesh{file, triangles.vertices, triangles.corners};
    for (glm::dvec3& p : mesh.vertices) p = R * p * scale;
    if (fits) fit(mesh.vertices, size);
    require_within(b, entity, mesh);
    std::vector<std::uint32_t> material_of = triangles.material_of;
    leave_out_flat(b, entity, mesh, material_of);
    const MeshBox placed = box_of(mesh.vertices);
    const Size above{placed.size().x, placed.size().y, std::max(0.0, placed.high.z)};
    known = b.mesh_rows.emplace(key, MeshRow{static_cast<std::uint32_t>(b.world.meshes.size()), above}).first;
    if (!material_of.empty())
      b.world.mesh_materials.push_back({known->second.row, triangles.materials, std::move(material_of)});
    b.world.meshes.push_back(std::move(mesh));
  }
  if (!fits) size = known->second.size;
  return known->second.row;
}

void add_mesh(BuildState& b, std::uint32_t mesh, const Segment& surface, const Pose& X_B) {
  if (surface.seen_by_laser) b.world.mesh_models.push_back({mesh, surface.model, X_B});
}

}  // namespace sf::world
