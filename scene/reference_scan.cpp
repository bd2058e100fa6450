#include "scene/reference_scan.h"

#include <array>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace sf::scene {

namespace {

using Real = long double;
using Vector = glm::vec<3, Real>;

struct Ray {
  Vector origin, direction;
};

Vector rotate(const glm::dmat3& R, Vector v) { return Vector(R[0]) * v.x + Vector(R[1]) * v.y + Vector(R[2]) * v.z; }

/// Range to the triangle by Moeller and Trumbore (1997), or infinity.
Real triangle_range(const Ray& ray, const Vector& a, const Vector& b, const Vector& c) {
  const Vector ab = b - a, ac = c - a, p = glm::cross(ray.direction, ac), from = ray.origin - a;
  const Real determinant = glm::dot(ab, p);
  if (determinant == 0.0L) return HUGE_VALL;
  const Real u = glm::dot(from, p) / determinant;
  const Vector q = glm::cross(from, ab);
  const Real v = glm::dot(ray.direction, q) / determinant;
  if (u < 0.0L || v < 0.0L || u + v > 1.0L) return HUGE_VALL;
  const Real range = glm::dot(ac, q) / determinant;
  return range > 0.0L ? range : HUGE_VALL;
}

Real face_range(const Ray& ray, const Mesh& mesh, const Face& face) {
  std::array<Vector, 4> p;
  for (int k = 0; k < 4; ++k) p[k] = Vector(mesh.vertices[face[k]]);
  const Real range = triangle_range(ray, p[0], p[1], p[2]);
  return corners_of(face) == 3 ? range : std::min(range, triangle_range(ray, p[0], p[2], p[3]));
}

Vector normal_of(const Mesh& mesh, const Face& face) {
  const Vector a(mesh.vertices[face[0]]), b(mesh.vertices[face[1]]), c(mesh.vertices[face[2]]);
  return glm::normalize(glm::cross(b - a, c - a));
}

/// Returns a normal in the world in the sensor's frame, toward the sensor.
glm::vec3 seen_from(const glm::dmat3& R_WS, Vector normal, Vector direction) {
  if (glm::dot(normal, direction) > 0.0L) normal = -normal;
  return glm::vec3(rotate(glm::transpose(R_WS), normal));
}

/// Texture coordinates where a ray meets the plane of a face.
glm::vec<2, Real> coordinates_along(const Ray& ray, const Mesh& mesh, std::size_t face) {
  const auto corner = [&](int k) { return Vector(mesh.vertices[mesh.faces[face][k]]); };
  const auto c = [&](std::size_t k) { return glm::vec<2, Real>(mesh.coordinates[face][k]); };
  const Vector ab = corner(1) - corner(0), ac = corner(2) - corner(0), p = glm::cross(ray.direction, ac);
  const Vector from = ray.origin - corner(0);
  const Real determinant = glm::dot(ab, p), u = glm::dot(from, p) / determinant;
  const Real v = glm::dot(ray.direction, glm::cross(from, ab)) / determinant;
  return c(0) + u * (c(1) - c(0)) + v * (c(2) - c(0));
}

/// Sets the texture coordinates of a hit, and their spread by differences.
void set_coordinates(const Ray& ray, const Mesh& mesh, std::size_t face, ReferenceHit& hit) {
  constexpr Real kStep = 1e-7L;
  const Vector d = glm::normalize(ray.direction);
  const Vector e = glm::normalize(glm::cross(d, std::abs(d.z) < 0.7L ? Vector(0, 0, 1) : Vector(1, 0, 0)));
  glm::vec<2, Real> gradient[2];
  for (const int k : {0, 1}) {
    const Vector step = kStep * (k == 0 ? e : glm::cross(d, e));
    gradient[k] = (coordinates_along({ray.origin, d + step}, mesh, face) -
                   coordinates_along({ray.origin, d - step}, mesh, face)) /
                  (2.0L * kStep);
  }
  hit.coordinates = glm::dvec2(coordinates_along(ray, mesh, face));
  const auto product = [&](int a, int b) {
    return static_cast<float>(gradient[0][a] * gradient[0][b] + gradient[1][a] * gradient[1][b]);
  };
  hit.spread = {product(0, 0), product(0, 1), product(1, 1)};
}

struct FieldMeeting {
  Real range = HUGE_VALL;  ///< infinite: none
  Vector normal{};
};

/// The smallest range to the triangles of a height field.
FieldMeeting field_range(const Ray& ray, const HeightField& field) {
  const auto point = [&](std::int32_t i, std::int32_t j) {
    return Vector(Real(i) * field.cell.x, Real(j) * field.cell.y, field.heights[field.at(i, j)]);
  };
  FieldMeeting nearest;
  const auto try_one = [&](const Vector& a, const Vector& b, const Vector& c) {
    const Real range = triangle_range(ray, a, b, c);
    if (range < nearest.range) nearest = {range, glm::normalize(glm::cross(b - a, c - a))};
  };
  for (std::int32_t j = 0; j + 1 < field.rows; ++j)
    for (std::int32_t i = 0; i + 1 < field.columns; ++i) {
      const Vector a = point(i, j), e = point(i + 1, j + 1);
      try_one(a, point(i + 1, j), e), try_one(a, e, point(i, j + 1));
    }
  return nearest;
}

}  // namespace

ReferenceHit reference_scan(const RigidTransform& X_WS, glm::dvec3 direction, double range_max,
                            const SceneView& scene) {
  const Ray ray_W{Vector(X_WS.p), rotate(X_WS.R, Vector(direction))};
  ReferenceHit hit{.range = range_max};
  if (scene.floor && ray_W.direction.z != 0.0L) {
    const Real range = -ray_W.origin.z / ray_W.direction.z;
    if (range > 0.0L && range < hit.range)
      hit = {range, base::kFloorHit, std::abs(ray_W.direction.z) / glm::length(ray_W.direction),
             seen_from(X_WS.R, {0, 0, 1}, ray_W.direction)};
  }
  const auto ray_in = [&](const RigidTransform& X_WF) {
    const glm::dmat3 R_FW = glm::transpose(X_WF.R);
    return Ray{rotate(R_FW, ray_W.origin - Vector(X_WF.p)), rotate(R_FW, ray_W.direction)};
  };
  if (scene.terrain.field != nullptr) {
    const Ray ray = ray_in(scene.terrain.X_WF);
    const FieldMeeting met = field_range(ray, *scene.terrain.field);
    if (met.range < hit.range)
      hit = {met.range, base::kFloorHit, std::abs(glm::dot(met.normal, glm::normalize(ray.direction))),
             seen_from(X_WS.R, rotate(scene.terrain.X_WF.R, met.normal), ray_W.direction)};
  }
  for (const Instance& instance : scene.instances) {
    const Ray ray = ray_in(instance.X_WI);
    const Mesh& mesh = instance.tree->mesh;
    for (const Face& face : mesh.faces) {
      const Real range = face_range(ray, mesh, face);
      if (!(range < hit.range)) continue;
      const Vector normal = normal_of(mesh, face);
      const auto row = static_cast<std::size_t>(&face - mesh.faces.data());
      hit = {range, mesh.owners.empty() ? instance.owner : mesh.owners[row],
             std::abs(glm::dot(normal, glm::normalize(ray.direction))),
             seen_from(X_WS.R, rotate(instance.X_WI.R, normal), ray_W.direction),
             mesh.materials.empty() ? world::kNoMaterial : mesh.materials[row]};
      if (!mesh.coordinates.empty()) set_coordinates(ray, mesh, row, hit);
    }
  }
  return hit;
}

}  // namespace sf::scene
