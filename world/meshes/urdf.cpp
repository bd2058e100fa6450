// URDF: all links of a robot as one mesh, with its joints at 0.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>

#include "base/elementary.h"
#include "base/error.h"
#include "base/files.h"
#include "base/plugin.h"
#include "world/meshes/mesh_file.h"
#include "world/meshes/urdf_robot.h"

namespace sf::world {

namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kSides = 64;  ///< of a cylinder, and around a sphere

/// Appends a surface of revolution about the z axis. @param profile (radius, z) [m] of each ring of kSides vertices
void add_round(std::span<const glm::dvec2> profile, Triangles& out) {
  const auto first = static_cast<std::uint32_t>(out.vertices.size());
  for (const glm::dvec2& ring : profile)
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const double angle = 2.0 * M_PI * i / kSides;
      out.vertices.emplace_back(ring.x * base::cos(angle), ring.x * base::sin(angle), ring.y);
    }
  for (std::uint32_t r = 0; r + 1 < profile.size(); ++r)
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const std::uint32_t a = first + r * kSides + i, b = first + r * kSides + (i + 1) % kSides;
      if (profile[r].x > 0.0) out.corners.insert(out.corners.end(), {a, b, b + kSides});
      if (profile[r + 1].x > 0.0) out.corners.insert(out.corners.end(), {a, b + kSides, a + kSides});
    }
}

void add_box(const glm::dvec3& size, Triangles& out) {
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces{
      {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
  const auto first = static_cast<std::uint32_t>(out.vertices.size());
  for (std::uint32_t k = 0; k < 8; ++k)
    out.vertices.push_back(0.5 * size * glm::dvec3{k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1});
  for (const auto& f : kFaces)
    for (const std::uint32_t corner : {f[0], f[1], f[2], f[0], f[2], f[3]}) out.corners.push_back(first + corner);
}

Triangles solid_of(const UrdfShape& shape) {
  Triangles out;
  const double r = shape.size.x, half = 0.5 * shape.size.z;
  if (shape.kind == UrdfShape::Kind::box) add_box(shape.size, out);
  if (shape.kind == UrdfShape::Kind::cylinder)
    add_round(std::array<glm::dvec2, 4>{{{0, -half}, {r, -half}, {r, half}, {0, half}}}, out);
  if (shape.kind == UrdfShape::Kind::sphere) {
    std::vector<glm::dvec2> profile{{0, -r}};
    for (std::uint32_t k = 1; k < kSides / 2; ++k) {
      const double angle = 2.0 * M_PI * k / kSides;
      profile.emplace_back(r * base::sin(angle), -r * base::cos(angle));
    }
    profile.emplace_back(0, r);
    add_round(profile, out);
  }
  return out;
}

/// Resolves a URI. Searches for `package://NAME/PATH` in the parents of the URDF's folder, then in the folders that
/// $AMENT_PREFIX_PATH and $ROS_PACKAGE_PATH list.
std::optional<std::string> file_of(const std::string& urdf, std::string_view uri) {
  const fs::path folder = fs::absolute(urdf).parent_path();
  constexpr std::string_view kPackage = "package://", kFile = "file://";
  if (uri.starts_with(kFile)) uri.remove_prefix(kFile.size());
  if (!uri.starts_with(kPackage)) return (folder / uri).string();
  uri.remove_prefix(kPackage.size());
  const fs::path inside(uri.substr(std::min(uri.find('/'), uri.size() - 1) + 1));
  std::vector<fs::path> places;
  for (fs::path at = folder;; at = at.parent_path()) {
    if (at.filename() == uri.substr(0, uri.find('/'))) places.push_back(at / inside);
    places.push_back(at / uri);
    if (at == at.parent_path()) break;
  }
  for (const auto& [variable, below] : {std::pair("AMENT_PREFIX_PATH", "share"), std::pair("ROS_PACKAGE_PATH", "")}) {
    const char* const value = std::getenv(variable);
    for (std::string_view list = value != nullptr ? value : ""; !list.empty();) {
      const std::size_t end = std::min(list.find(':'), list.size());
      places.push_back(fs::path(list.substr(0, end)) / below / uri);
      list.remove_prefix(std::min(end + 1, list.size()));
    }
  }
  const auto found = std::ranges::find_if(places, [](const fs::path& place) {
    std::error_code error;
    return fs::is_regular_file(place, error);
  });
  return found == places.end() ? std::nullopt : std::optional(found->string());
}

class RobotReader {
 public:
  explicit RobotReader(const std::string& file) : file_(file), builder_(file) {}
  Triangles read(const UrdfRobot& robot);

 private:
  bool add(const std::vector<UrdfShape>& shapes, std::string& reason);
  Triangles part_of(const UrdfShape& shape);
  const Triangles& mesh_of(const std::string& path);

  std::string file_;
  TriangleBuilder builder_;
  std::uint64_t triangles_ = 0;  ///< in it
  std::map<std::string, Triangles> meshes_;
};

const Triangles& RobotReader::mesh_of(const std::string& path) {
  if (base::ending_of(path) == ".urdf") throw base::InputError(path, 0, "is a robot within a robot");
  const auto known = meshes_.find(path);
  return known != meshes_.end() ? known->second : meshes_.emplace(path, read_triangles(path)).first->second;
}

/// Returns a shape's triangles in the robot's frame. @throws base::InputError with the reason
Triangles RobotReader::part_of(const UrdfShape& shape) {
  Triangles part;
  if (shape.kind == UrdfShape::Kind::mesh) {
    const std::optional<std::string> path = file_of(file_, shape.file);
    if (!path) throw base::InputError(fmt::format("'{}' is in no known folder", shape.file));
    part = mesh_of(*path);
    for (glm::dvec3& p : part.vertices) p *= shape.size;
  } else {
    if (!(shape.size.x > 0.0 && shape.size.y > 0.0 && shape.size.z > 0.0))
      throw base::InputError("a shape has a size that is not above 0");
    part = solid_of(shape);
  }
  for (glm::dvec3& p : part.vertices) p = shape.X * glm::dvec4(p, 1.0);
  if (shape.color && part.material_of.empty()) {  // as in RViz, materials of a mesh file count more
    part.materials = {{*shape.color, luminance(*shape.color)}};
    part.material_of.assign(part.corners.size() / 3, 0);
  }
  return part;
}

/// Adds all shapes of a link, or none. @param reason out: why none was added
bool RobotReader::add(const std::vector<UrdfShape>& shapes, std::string& reason) {
  std::vector<Triangles> parts;
  std::uint64_t triangles = triangles_;
  try {
    for (std::size_t i = 0; i < shapes.size() && triangles <= kMostTriangles; ++i) {
      parts.push_back(part_of(shapes[i]));
      triangles += parts.back().corners.size() / 3;
    }
  } catch (const base::InputError& error) {
    return reason = error.what(), false;
  }
  builder_.expect(triangles_ = triangles);
  for (const Triangles& part : parts) builder_.add(part);
  return !parts.empty();
}

Triangles RobotReader::read(const UrdfRobot& robot) {
  std::vector<std::string> notes;
  if (!robot.parser_errors.empty()) notes.push_back("parts are left out: " + robot.parser_errors);
  for (const UrdfLink& link : robot.links) {
    std::string visual, collision;
    if (add(link.visual, visual)) continue;
    const bool instead = add(link.collision, collision);
    if (!visual.empty())
      notes.push_back(
          fmt::format("link '{}' {}: {}", link.name, instead ? "has its shape for collisions" : "is left out", visual));
    else if (!collision.empty())
      notes.push_back(fmt::format("link '{}' is left out: {}", link.name, collision));
  }
  if (builder_.vertices() == 0 && !notes.empty()) builder_.fail("has no shape that can be read: " + notes.front());
  Triangles out = builder_.finish();
  if (robot.movable > 0) notes.push_back(fmt::format("movable joints ({}) stay at 0", robot.movable));
  out.notes.insert(out.notes.end(), notes.begin(), notes.end());
  return out;
}

}  // namespace

Triangles read_urdf(const std::string& file, std::string_view bytes) {
  refuse_deep_xml(file, bytes);
  static const auto& plugin = *static_cast<const UrdfPlugin*>(
      base::load_plugin(kUrdfSymbol, "robots cannot be read from URDF", "urdfdom 3.0 (Debian: liburdfdom-model3.0)"));
  Triangles out = RobotReader(file).read(plugin.read(file, std::string(bytes)));
  if (bytes.find("<sensor") != std::string_view::npos)
    out.notes.push_back("its sensors are left out; give them to the model, such as lidar( )");
  return out;
}

}  // namespace sf::world
