#include "scene/simplify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <set>

#include "scene/solids.h"

namespace sf::scene {

namespace {

constexpr int kMostMeshLevels = 10;
constexpr double kLeastGain = 0.7;

using Cell = std::array<std::int64_t, 3>;

/// Sum of a cell's vertices, and its row in the result.
struct Cluster {
  glm::dvec3 sum{};
  double count = 0.0;
  std::uint32_t row = 0;
};

}  // namespace

ClusteredMesh clustered(const world::Mesh& mesh, double cell) {
  ClusteredMesh result{.mesh = {.file = mesh.file, .vertices = {}, .corners = {}}, .sources = {}};
  world::Mesh& out = result.mesh;
  glm::dvec3 low(HUGE_VAL);
  for (const glm::dvec3& p : mesh.vertices) low = glm::min(low, p);
  std::map<Cell, Cluster> clusters;
  std::vector<Cluster*> cluster_of;
  for (const glm::dvec3& p : mesh.vertices) {
    const glm::dvec3 at = glm::floor((p - low) / cell);
    Cluster& cluster =
        clusters[{static_cast<std::int64_t>(at.x), static_cast<std::int64_t>(at.y), static_cast<std::int64_t>(at.z)}];
    cluster.sum += p, cluster.count += 1.0;
    cluster_of.push_back(&cluster);
  }
  for (auto& [key, cluster] : clusters) {
    cluster.row = static_cast<std::uint32_t>(out.vertices.size());
    out.vertices.push_back(cluster.sum / cluster.count);
  }
  std::set<std::array<std::uint32_t, 3>> known;
  for (std::size_t i = 0; i < mesh.corners.size(); i += 3) {
    std::array<std::uint32_t, 3> rows;
    for (std::size_t k = 0; k < 3; ++k) rows[k] = cluster_of[mesh.corners[i + k]]->row;
    std::array<std::uint32_t, 3> sorted = rows;
    std::ranges::sort(sorted);
    const glm::dvec3 &a = out.vertices[rows[0]], &b = out.vertices[rows[1]], &c = out.vertices[rows[2]];
    if (glm::length(glm::cross(b - a, c - a)) <= 1e-9 * cell * cell || !known.insert(sorted).second) continue;
    out.corners.insert(out.corners.end(), rows.begin(), rows.end());
    result.sources.push_back(static_cast<std::uint32_t>(i / 3));
  }
  return result;
}

std::vector<MeshLevel> levels_of(const world::Mesh& mesh, std::span<const std::uint32_t> materials) {
  glm::dvec3 low(HUGE_VAL), high(-HUGE_VAL);
  for (const glm::dvec3& p : mesh.vertices) low = glm::min(low, p), high = glm::max(high, p);
  std::vector<MeshLevel> levels;
  double cell = glm::length(high - low) / 8.0;
  for (int k = 0; k < kMostMeshLevels; ++k, cell *= 0.5) {
    const auto [coarse, sources] = clustered(mesh, cell);
    if (static_cast<double>(coarse.corners.size()) > kLeastGain * static_cast<double>(mesh.corners.size())) break;
    if (coarse.corners.empty()) continue;
    std::vector<std::uint32_t> kept;
    for (std::size_t i = 0; i < sources.size() && !materials.empty(); ++i) kept.push_back(materials[sources[i]]);
    levels.push_back({build_tree(mesh_of(coarse, std::move(kept))), std::sqrt(3.0) * cell});
  }
  return levels;
}

const SurfaceTree& level_for(const std::vector<MeshLevel>& levels, double allowed, const SurfaceTree& exact) {
  const auto fits = [&](const MeshLevel& level) { return level.displacement <= allowed; };
  const auto level = std::ranges::find_if(levels, fits);
  return level == levels.end() ? exact : level->tree;
}

}  // namespace sf::scene
