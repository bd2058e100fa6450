#pragma once
// Decides in 64 bits which of the faces near a beam is the nearest.
//
// An edge's side s = d . (q_a x q_b) is computed with its corners in one order, so that both faces of an edge get the
// same number. Its error is below 2^-48 |q_a| |q_b|. A face covers a beam certainly if all its sides exceed it, and
// possibly if none is below its negative. The nearest of all that possibly cover it is the result: no beam passes
// between faces that share an edge. It has a flag unless it certainly covers the beam, or every edge that does not is
// shared with another face that possibly covers the beam from the other side, and so on around a vertex.

#include <cstdint>
#include <span>
#include <vector>

#include "base/rigid_transform.h"
#include "scene/surface_tree.h"

namespace sf::scene {

/// A mesh of a scan.
struct SceneMesh {
  const SurfaceTree* tree = nullptr;
  base::RigidTransform X_FS;     ///< the sensor in the mesh's frame
  std::uint32_t first_face = 0;  ///< number of its first face among those of all meshes
  double least_sine = 0.0;       ///< beams at smaller angles to a face, as sine, have a flag
  glm::dvec3 centre{};           ///< [m] middle of the mesh in the sensor's frame
  double reach = 0.0;            ///< [m] radius of a sphere around it that contains the mesh, with room for rounding
  std::uint32_t owner = 0;       ///< as Instance::owner
};

struct Instance;

/// Plane of a face in the sensor's frame. Beam d meets it at range height / (normal . d).
struct SeenPlane {
  glm::dvec3 normal{};                          ///< unit vector
  double height = 0.0;                          ///< [m]
  double least_sine = 0.0;                      ///< as SceneMesh::least_sine
  std::uint32_t owner = 0;                      ///< as Mesh::owners
  std::uint32_t material = world::kNoMaterial;  ///< as Mesh::materials
};

/// Sets `out` to the meshes within range of a scan, by first face.
void list_meshes(const base::RigidTransform& X_WS, double range_max, std::span<const Instance> instances,
                 std::vector<SceneMesh>& out);

/// Returns the mesh with a face. @param face less than the number of faces of all meshes
const SceneMesh& mesh_with(std::span<const SceneMesh> meshes, std::uint32_t face);
SeenPlane seen_plane(const SceneMesh& mesh, std::uint32_t face);
/// Returns the plane z = 0 of the world.
SeenPlane floor_plane(const base::RigidTransform& X_WS, double range_max);

/// Returns normal . d, in the order of operations that all evaluations of a range share.
inline double sine_of(const SeenPlane& plane, glm::dvec3 d) {
  return (plane.normal.x * d.x + plane.normal.y * d.y) + plane.normal.z * d.z;
}

/// A face that may cover beams of a tile.
struct DrawnFace {
  std::uint32_t face = 0;     ///< among those of all meshes
  std::uint32_t vectors = 0;  ///< bit mask of the tile's vectors
};

struct Decision {
  double range = 0.0;      ///< [m]
  std::uint32_t face = 0;  ///< among those of all meshes, kFloorFace or kNoFace
  bool flagged = false;
};

/// A face that may cover beams of one vector.
struct Candidate {
  std::uint32_t face = 0;           ///< among those of all meshes
  const SceneMesh* mesh = nullptr;  ///< its mesh
  SeenPlane plane;
  bool flat = false;  ///< the sensor may be in its plane
};

/// Lists the drawn faces of a vector in `out`. @param vector its bit in `DrawnFace::vectors`
void list_candidates(std::span<const SceneMesh> meshes, std::span<const DrawnFace> drawn, std::uint32_t vector,
                     std::vector<Candidate>& out);

/// @param direction unit vector in the sensor's frame
/// @param nearest the range and face if no candidate is nearer, such as the floor
Decision decide(std::span<const Candidate> candidates, glm::dvec3 direction, Decision nearest);

}  // namespace sf::scene
