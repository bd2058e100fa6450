#include "apps/reports/mesh_report.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "scene/closed_bodies.h"
#include "scene/solids.h"
#include "world/terrain.h"

namespace sf::apps {

namespace {

void count_fault(MeshReport::Faults& faults, std::size_t triangle) {
  faults.first = faults.count++ == 0 ? triangle + 1 : std::min(faults.first, triangle + 1);
}

/// Finds triangles with equal corners. @param equal of scene::equal_vertices
MeshReport::Faults repeated_triangles(const scene::Mesh& mesh, std::span<const std::uint32_t> equal) {
  std::vector<std::pair<std::array<std::uint32_t, 3>, std::size_t>> corners;
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const scene::Face& face = mesh.faces[i];
    corners.push_back({{equal[face[0]], equal[face[1]], equal[face[2]]}, i});
    std::ranges::sort(corners.back().first);
  }
  std::ranges::sort(corners);
  MeshReport::Faults repeated;
  for (std::size_t i = 1; i < corners.size(); ++i)
    if (corners[i].first == corners[i - 1].first) count_fault(repeated, corners[i].second);
  return repeated;
}

/// Returns why bodies of a mesh are open.
std::string openness_text(const MeshReport& report) {
  std::string text;
  const auto add_faults = [&](const MeshReport::Faults& faults, std::string_view word, std::string_view what) {
    if (faults.count > 0)
      text += fmt::format("{}{} {} (first: triangle {})", text.empty() ? "" : ", ", counted(faults.count, word), what,
                          faults.first);
  };
  add_faults(report.single, "edge", "of one triangle");
  add_faults(report.shared, "edge", "of three or more");
  add_faults(report.repeated, "triangle", "with the corners of another");
  return text.empty() ? "they meet themselves, have no volume, or overlap in too many places" : text;
}

std::string mesh_text(const world::Mesh& mesh, const std::optional<MeshReport>& report) {
  const std::string what = mesh.file + ": " + counted(mesh.corners.size() / 3, "triangle");
  if (!report) return fmt::format("{}; not examined: more than {} in all", what, kMostExamined);
  if (report->closed == report->bodies) return fmt::format("{}, closed: back faces are hidden", what);
  if (report->closed == 0) return fmt::format("{}, not closed, seen from both sides: {}", what, openness_text(*report));
  return fmt::format("{}, {} of {} bodies closed, the others seen from both sides: {}", what, report->closed,
                     report->bodies, openness_text(*report));
}

}  // namespace

MeshReport report_of(const world::Mesh& mesh) {
  scene::Mesh triangles{mesh.vertices, {}, {}, {}};
  for (std::size_t i = 0; i + 2 < mesh.corners.size(); i += 3)
    triangles.faces.push_back({mesh.corners[i], mesh.corners[i + 1], mesh.corners[i + 2], mesh.corners[i + 2]});
  MeshReport report;
  const std::vector<std::uint32_t> equal = scene::equal_vertices(triangles);
  scene::for_each_edge(scene::edges_of(triangles, equal), [&](std::span<const scene::FaceEdge> same) {
    if (same.size() == 1) count_fault(report.single, same[0].face);
    if (same.size() > 2) count_fault(report.shared, same[0].face);
  });
  report.repeated = repeated_triangles(triangles, equal);
  const scene::FaceSides sides = scene::find_closed_bodies(scene::mesh_of(mesh));  // as it is drawn
  report.bodies = sides.bounds.size();
  std::vector<std::uint8_t> closed(report.bodies, 0);
  for (std::size_t face = 0; face < sides.body.size(); ++face)
    if (sides.outward[face] != 0) closed[sides.body[face]] = 1;
  report.closed = static_cast<std::size_t>(std::ranges::count(closed, 1));
  return report;
}

std::vector<std::optional<MeshReport>> mesh_reports(const world::World& world) {
  std::vector<std::optional<MeshReport>> reports;
  std::size_t left = kMostExamined;
  for (const world::Mesh& mesh : world.meshes) {
    const std::size_t triangles = mesh.corners.size() / 3;
    if (triangles > left) {
      reports.emplace_back();
      continue;
    }
    left -= triangles;
    reports.push_back(report_of(mesh));
  }
  return reports;
}

std::string surfaces_text(const world::World& world) {
  std::string text;
  if (!world.meshes.empty())
    text += row("meshes", "{} with {}, in {}", world.meshes.size(), counted(triangles_of(world.meshes), "triangle"),
                counted(world.mesh_models.size(), "model"));
  const std::vector<std::optional<MeshReport>> reports = mesh_reports(world);
  for (std::size_t i = 0; i < std::min(reports.size(), kMostMeshRows); ++i)
    text += row("", mesh_text(world.meshes[i], reports[i]));
  if (reports.size() > kMostMeshRows) text += row("", "and {} more (--json lists all)", reports.size() - kMostMeshRows);
  for (const world::Terrain& terrain : world.terrain) {
    const auto [low, high] = std::ranges::minmax(terrain.heights);
    const glm::dvec2 size = world::size_of(terrain);
    text += row("terrain", "{}: {} x {} points, {:g} x {:g} m, heights from {:g} to {:g} m", terrain.file,
                terrain.columns, terrain.rows, size.x, size.y, low, high);
  }
  return text;
}

}  // namespace sf::apps
