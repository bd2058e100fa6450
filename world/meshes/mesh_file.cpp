#include "world/meshes/mesh_file.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/error.h"
#include "base/files.h"
#include "base/pose.h"

namespace sf::world {

namespace {

struct MeshFormat {
  std::string_view ending;
  Triangles (*read)(const std::string& file, std::string_view bytes);
};
constexpr MeshFormat kFormats[] = {
    {".stl", read_stl},   {".obj", read_obj},   {".ply", read_ply},        {".glb", read_gltf},
    {".gltf", read_gltf}, {".urdf", read_urdf}, {".dae", read_other_mesh}, {".fbx", read_other_mesh},
};

/// Returns the corners of the convex hull, counter-clockwise (Andrew's monotone chain).
std::vector<glm::dvec2> hull_of(std::vector<glm::dvec2> points) {
  const auto before = [](glm::dvec2 a, glm::dvec2 b) { return std::pair(a.x, a.y) < std::pair(b.x, b.y); };
  std::ranges::sort(points, before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<glm::dvec2> hull;
  const auto add_chain = [&](auto first, auto last) {
    const std::size_t start = hull.size();
    for (auto p = first; p != last; ++p) {
      while (hull.size() >= start + 2 && base::cross(hull.back() - hull[hull.size() - 2], *p - hull.back()) <= 0.0)
        hull.pop_back();
      hull.push_back(*p);
    }
    hull.pop_back();
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  return hull;
}

double distance_from_line(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  return std::abs(base::cross(b - a, p - a)) / glm::length(b - a);
}

/// Leaves out corners that are nearer than `most` to the line between those that stay.
std::vector<glm::dvec2> simplified(const std::vector<glm::dvec2>& hull, double most) {
  std::vector<glm::dvec2> kept{hull[0]};
  for (std::size_t last = 0, i = 1; i < hull.size(); ++i) {
    const glm::dvec2 next = hull[(i + 1) % hull.size()];
    const auto stays = [&](std::size_t k) { return !(distance_from_line(hull[k], hull[last], next) < most); };
    bool any = next == hull[last];
    for (std::size_t k = last + 1; k <= i && !any; ++k) any = stays(k);
    if (any) kept.push_back(hull[i]), last = i;
  }
  return kept;
}

}  // namespace

Triangles read_triangles(const std::string& file) {
  const auto format = std::ranges::find(kFormats, base::ending_of(file), &MeshFormat::ending);
  if (format == std::end(kFormats))
    throw base::InputError(file, 0,
                           "is no mesh by its name; expected .stl, .obj, .ply, .glb, .gltf, .dae, .fbx or .urdf");
  return format->read(file, base::read_bytes(file, kMostMeshBytes));
}

MeshBox box_of(const std::vector<glm::dvec3>& vertices) {
  if (vertices.empty()) return {};
  MeshBox box{vertices[0], vertices[0]};
  for (const glm::dvec3& p : vertices) box.low = glm::min(box.low, p), box.high = glm::max(box.high, p);
  return box;
}

std::vector<Segment> outline_from_above(const std::vector<glm::dvec3>& vertices) {
  const MeshBox box = box_of(vertices);
  std::vector<glm::dvec2> points;
  points.reserve(vertices.size());
  for (const glm::dvec3& p : vertices) points.emplace_back(p.x, p.y);
  std::vector<glm::dvec2> corners = hull_of(std::move(points));
  if (corners.size() < 2 || !(box.low.z < box.high.z)) return {};
  const bool solid = corners.size() > 2;  // else an upright plane
  if (solid) corners = simplified(corners, 1e-3 * std::max(box.size().x, box.size().y));
  std::vector<Segment> sides(solid ? corners.size() : 1);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    sides[i].a = corners[i], sides[i].b = corners[(i + 1) % corners.size()];
    sides[i].z_min = box.low.z, sides[i].z_max = box.high.z;
    sides[i].solid_left = solid;
  }
  return sides;
}

}  // namespace sf::world
