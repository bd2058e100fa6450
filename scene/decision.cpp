#include "scene/decision.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "scene/rasterizer.h"

namespace sf::scene {

namespace {

constexpr double kSideError = 0x1p-48;

constexpr double kHeightError = 0x1p-48;

/// One edge of a face: its corners in the order of their coordinates.
struct Edge {
  glm::dvec3 a, b;       ///< [m] in the mesh's frame
  double side = 0.0;     ///< of the beam, positive on the side of the face
  bool certain = false;  ///< the sign of `side` is certain
  bool left = false;     ///< seen from the sensor, the face is to the left of a -> b
};

/// A face that possibly covers the beam.
struct Cover {
  std::uint32_t face = 0;
  double range = 0.0;  ///< [m]
  bool grazing = false;
  std::array<Edge, 4> edges;
  std::uint32_t edge_count = 0;

  std::span<Edge> sides() { return std::span(edges).first(edge_count); }
  std::span<const Edge> sides() const { return std::span(edges).first(edge_count); }
};

bool before(glm::dvec3 a, glm::dvec3 b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}

/// Fills in one of the face's sides, positive inside if it is seen from its front.
/// @param d in the mesh's frame
void set_edge(const SceneMesh& mesh, const Face& face, std::uint32_t k, std::uint32_t corners, glm::dvec3 d,
              Edge& edge) {
  edge.a = mesh.tree->mesh.vertices[face[k]];
  edge.b = mesh.tree->mesh.vertices[face[(k + 1) % corners]];
  const bool swap = before(edge.b, edge.a);
  if (swap) std::swap(edge.a, edge.b);
  const glm::dvec3 a = edge.a - mesh.X_FS.p, b = edge.b - mesh.X_FS.p, n = glm::cross(a, b);
  const double side = glm::dot(d, n);
  edge.side = swap ? -side : side;
  edge.left = !swap;
  edge.certain = std::abs(side) > kSideError * (glm::length(a) * glm::length(b));
}

/// Returns the face's sides of the beam, as seen from its front or its back.
/// @param whole all of them; else it ends, with one that is certainly negative, where the beam passes outside
Cover cover_of(const Candidate& candidate, glm::dvec3 d, bool front, bool whole) {
  const SceneMesh& mesh = *candidate.mesh;
  const Face& face = mesh.tree->mesh.faces[candidate.face - mesh.first_face];
  const std::uint32_t corners = corners_of(face);
  Cover cover;
  while (cover.edge_count < corners) {
    Edge& edge = cover.edges[cover.edge_count];
    set_edge(mesh, face, cover.edge_count++, corners, d, edge);
    if (!front) edge.side = -edge.side, edge.left = !edge.left;
    if (!whole && edge.certain && edge.side < 0.0) break;
  }
  return cover;
}

void turn_around(Cover& cover) {
  for (Edge& edge : cover.sides()) edge.side = -edge.side, edge.left = !edge.left;
}

bool possible(const Cover& cover) {
  return std::ranges::none_of(cover.sides(), [](const Edge& e) { return e.certain && e.side < 0.0; });
}

/// Returns true if a face possibly covers the beam from the other side of an edge of `owner`.
bool shares(const Cover& other, const Edge& edge, const Cover& owner) {
  return other.face != owner.face && std::ranges::any_of(other.sides(), [&](const Edge& e) {
           return e.a == edge.a && e.b == edge.b && e.left != edge.left;
         });
}

bool certain(const Cover& cover) {
  return std::ranges::all_of(cover.sides(), [](const Edge& e) { return e.certain; });
}

/// Returns true if the beam certainly meets a surface at a face: it certainly covers the beam, or all faces that are
/// connected to it by edges near the beam leave no such edge open. At a vertex on the outline of a body, one of the
/// faces around it has an open edge.
bool closed(const Cover& cover, std::span<const Cover> covers) {
  thread_local std::vector<const Cover*> connected;  // keeps its memory
  connected.assign(1, &cover);
  for (std::size_t k = 0; k < connected.size(); ++k)
    for (const Edge& edge : connected[k]->sides()) {
      if (edge.certain) continue;
      bool open = true;
      for (const Cover& other : covers) {
        if (!shares(other, edge, *connected[k])) continue;
        open = false;
        if (std::ranges::find(connected, &other) == connected.end()) connected.push_back(&other);
      }
      if (open) return false;
    }
  return true;
}

/// Returns the smallest sine of an angle to a face at which ranges are within their bound. @param sizes [m]
double least_sine(double sizes) { return 0x1p-53 * (32.0 * sizes) / kRangeError; }

}  // namespace

void list_meshes(const base::RigidTransform& X_WS, double range_max, std::span<const Instance> instances,
                 std::vector<SceneMesh>& out) {
  out.clear();
  std::uint32_t first = 0;
  for (const Instance& instance : instances) {
    const SurfaceTree& tree = *instance.tree;
    if (tree.empty()) continue;
    SceneMesh mesh{.tree = &tree, .X_FS = X_WS, .first_face = first, .owner = instance.owner};
    if (!instance.at_origin) mesh.X_FS = base::relative(instance.X_WI, X_WS);
    const double moved = instance.at_origin ? 0.0 : tree.radius;
    mesh.least_sine = least_sine(range_max + tree.longest_edge + moved);
    mesh.centre = glm::transpose(mesh.X_FS.R) * (tree.centre - mesh.X_FS.p);
    const double distance = glm::length(mesh.centre);
    mesh.reach = tree.radius + 1e-6 * (tree.radius + distance);
    if (!(distance - mesh.reach <= range_max)) continue;
    out.push_back(mesh);
    first += static_cast<std::uint32_t>(tree.mesh.faces.size());
  }
}

SeenPlane floor_plane(const base::RigidTransform& X_WS, double range_max) {
  return {-glm::transpose(X_WS.R)[2], X_WS.p.z, least_sine(range_max), base::kFloorHit};
}

const SceneMesh& mesh_with(std::span<const SceneMesh> meshes, std::uint32_t face) {
  if (meshes.size() == 1) return meshes.front();
  const auto after = std::upper_bound(meshes.begin(), meshes.end(), face,
                                      [](std::uint32_t f, const SceneMesh& mesh) { return f < mesh.first_face; });
  return *(after - 1);
}

SeenPlane seen_plane(const SceneMesh& mesh, std::uint32_t face) {
  const Plane& plane = mesh.tree->planes[face - mesh.first_face];
  const glm::dmat3& R = mesh.X_FS.R;
  const std::vector<std::uint32_t>&owners = mesh.tree->mesh.owners, &materials = mesh.tree->mesh.materials;
  return {{glm::dot(R[0], plane.normal), glm::dot(R[1], plane.normal), glm::dot(R[2], plane.normal)},
          glm::dot(plane.normal, plane.point - mesh.X_FS.p),
          mesh.least_sine,
          owners.empty() ? mesh.owner : owners[face - mesh.first_face],
          materials.empty() ? world::kNoMaterial : materials[face - mesh.first_face]};
}

void list_candidates(std::span<const SceneMesh> meshes, std::span<const DrawnFace> drawn, std::uint32_t vector,
                     std::vector<Candidate>& out) {
  out.clear();
  for (const DrawnFace& face : drawn) {
    if ((face.vectors & vector) == 0) continue;
    const SceneMesh& mesh = mesh_with(meshes, face.face);
    Candidate& candidate = out.emplace_back(Candidate{face.face, &mesh, seen_plane(mesh, face.face)});
    const glm::dvec3 point = mesh.tree->planes[face.face - mesh.first_face].point;
    candidate.flat = std::abs(candidate.plane.height) <= kHeightError * glm::length(point - mesh.X_FS.p);
  }
}

Decision decide(std::span<const Candidate> candidates, glm::dvec3 direction, Decision nearest) {
  thread_local std::vector<Cover> covers;  // keeps its memory
  covers.clear();
  bool edge_on = false;
  for (const Candidate& candidate : candidates) {
    const SeenPlane& plane = candidate.plane;
    const double sine = sine_of(plane, direction), range = plane.height / sine;
    if (!candidate.flat && !(range > 0.0 && range <= nearest.range * (1.0 + 1e-9))) continue;
    Cover cover = cover_of(candidate, candidate.mesh->X_FS.R * direction, plane.height >= 0.0, candidate.flat);
    if (candidate.flat) {
      edge_on = edge_on || possible(cover);
      turn_around(cover);
      edge_on = edge_on || possible(cover);
      continue;
    }
    if (!possible(cover)) continue;
    cover.face = candidate.face, cover.range = range, cover.grazing = std::abs(sine) < plane.least_sine;
    covers.push_back(cover);
    if (range < nearest.range && certain(cover)) nearest.range = range, nearest.face = candidate.face;
  }
  for (const Cover& cover : covers) {
    const bool nearer = cover.range < nearest.range || (cover.range == nearest.range && cover.face <= nearest.face);
    if (nearer) nearest = {cover.range, cover.face, cover.grazing || !closed(cover, covers)};
  }
  nearest.flagged = nearest.flagged || edge_on;
  return nearest;
}

}  // namespace sf::scene
