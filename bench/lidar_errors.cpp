// Whole scans against faces in `long double`, beam by beam: prints the beams without a flag whose error exceeds the
// stated bound, which must be none, and the largest error. Takes minutes per scene.
//
//   build/release/lidar_errors [BEAMS [FIRST [END]]]; default: 1000000 beams in each of the scenes [0, 10)
//
// Faces that no beam of a block can meet are left out by their bounding spheres; all others are intersected.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <vector>

#include "base/rigid_transform.h"
#include "bench/lidar_scenes.h"
#include "bench/usage.h"
#include "scene/rasterizer.h"
#include "scene/reference_scan.h"

namespace sf::bench {

namespace {

constexpr double kRange = 100.0;    // [m]
constexpr std::size_t kBlock = 32;  // beams

struct Case {
  const char* scene;
  const char* sensor;
  double away = 0.0;    ///< [m] of all vertices from the origin
  bool field = false;   ///< the scene's height field instead of its triangles
  bool turned = false;  ///< the scene is a moved body
};
constexpr Case kCases[] = {
    {"city10", "lidar64x1024"},
    {"city100", "lidar64x1024"},
    {"city100", "camera320x240"},
    {"city30", "lidar16x1800", 1e7},
    {"city30", "lidar64x1024", 0.0, false, true},
    {"room", "lidar64x1024"},
    {"room", "camera320x240", 1e5},
    {"room", "lidar16x1800", 0.0, false, true},
    {"terrain", "lidar64x1024"},
    {"terrain", "lidar64x1024", 0.0, true},
};

/// Faces of a scene with their bounding spheres in the world.
class Faces {
 public:
  Faces(const scene::Mesh& mesh, const base::RigidTransform& X_WI) : all_(mesh.faces), X_WI_(X_WI) {
    near_.mesh.vertices = mesh.vertices;
    for (const scene::Face& face : mesh.faces) {
      glm::dvec3 centre{};
      for (const std::uint32_t corner : face) centre += 0.25 * mesh.vertices[corner];
      double radius = 0.0;
      for (const std::uint32_t corner : face) radius = std::max(radius, glm::distance(mesh.vertices[corner], centre));
      spheres_.push_back({base::transform(X_WI, centre), radius});
    }
  }
  /// Keeps the faces within the range of a pose.
  void look_from(glm::dvec3 p) {
    p_ = p;
    within_.clear();
    for (std::uint32_t i = 0; i < spheres_.size(); ++i)
      if (glm::distance(spheres_[i].centre, p) <= kRange + 1.01 * spheres_[i].radius) within_.push_back(i);
  }
  /// Returns the instance of those that directions in the world may meet.
  const scene::Instance& near(std::span<const glm::dvec3> directions) {
    glm::dvec3 axis{};
    for (const glm::dvec3& d : directions) axis += d;
    axis = glm::normalize(axis);
    double cosine = 1.0;
    for (const glm::dvec3& d : directions) cosine = std::min(cosine, glm::dot(axis, d) - 1e-9);
    const double sine = std::sqrt(1.0 - cosine * cosine);
    near_.mesh.faces.clear();
    for (const std::uint32_t i : within_) {
      const glm::dvec3 v = spheres_[i].centre - p_;
      const double along = glm::dot(v, axis), aside = std::sqrt(std::max(0.0, glm::dot(v, v) - along * along));
      if (aside * cosine - along * sine <= 1.01 * spheres_[i].radius + 1e-6 * (aside + std::abs(along)))
        near_.mesh.faces.push_back(all_[i]);
    }
    instance_ = {&near_, X_WI_};
    return instance_;
  }

 private:
  struct Sphere {
    glm::dvec3 centre;
    double radius;
  };
  const std::vector<scene::Face>& all_;
  base::RigidTransform X_WI_;
  std::vector<Sphere> spheres_;
  glm::dvec3 p_{};
  std::vector<std::uint32_t> within_;
  scene::SurfaceTree near_;  ///< its mesh alone
  scene::Instance instance_;
};

struct Errors {
  std::size_t flagged = 0, outside = 0;
  double worst = 0.0;  ///< [m] without a flag
  void add(double error, double bound, bool is_flagged) {
    flagged += is_flagged;
    if (is_flagged) return;
    outside += !(error <= bound);
    worst = std::max(worst, error);
  }
};

/// One scan, in 64 and in 32 bits.
struct Scan {
  std::vector<double> ranges;
  std::vector<std::uint32_t> hits;
  std::vector<base::QualityFlag> quality;

  Scan(scene::Rasterizer& rasterizer, const base::RigidTransform& X_WS, const scene::BeamPattern& pattern,
       const scene::SceneView& view, std::size_t beams, bool single)
      : ranges(beams, HUGE_VAL), hits(beams), quality(beams) {
    rasterizer.scan(X_WS, pattern, kRange, view,
                    {.ranges = ranges, .hits = hits, .quality = quality, .single = single});
  }
};

std::size_t run(const Case& c, std::size_t beams_wanted) {
  std::uint32_t row = 0;
  const std::vector<glm::dvec3> beams = lidar_beams(c.sensor, row);
  const auto poses = static_cast<int>((beams_wanted + beams.size() - 1) / beams.size());
  LidarScene scene = lidar_scene(c.scene, poses);
  for (glm::dvec3& p : scene.mesh.vertices) p += glm::dvec3{c.away, -0.7 * c.away, 0.0};
  base::RigidTransform X_WI;
  if (c.turned) X_WI = {base::rotation_of(0.3, -0.2, 2.0), {12.5, -7.25, 3.0}};
  const scene::SurfaceTree tree = scene::build_tree(scene.mesh);
  const scene::Instance instance{&tree, X_WI, !c.turned};
  const scene::SceneView view =
      c.field ? scene::SceneView{{}, false, {&scene.field, {}}} : scene::SceneView{{&instance, 1}, false, {}};
  const scene::BeamPattern pattern = lidar_pattern(beams, row);
  scene::Rasterizer rasterizer;
  Faces faces(scene.mesh, X_WI);
  Errors exact, single;
  std::vector<glm::dvec3> block;
  for (base::RigidTransform X_WS : scene.poses) {
    X_WS.p += glm::dvec3{c.away, -0.7 * c.away, 0.0};
    X_WS = base::compose(X_WI, X_WS);
    const Scan in_64(rasterizer, X_WS, pattern, view, beams.size(), false),
        in_32(rasterizer, X_WS, pattern, view, beams.size(), true);
    faces.look_from(X_WS.p);
    for (std::size_t first = 0; first < beams.size(); first += kBlock) {
      const std::size_t end = std::min(beams.size(), first + kBlock);
      block.clear();
      for (std::size_t i = first; i < end; ++i) block.push_back(X_WS.R * beams[i]);
      const scene::SceneView near{{&faces.near(block), 1}, false, {}};
      for (std::size_t i = first; i < end; ++i) {
        const long double range = scene::reference_scan(X_WS, beams[i], kRange, near).range;
        const auto add = [&](Errors& errors, const Scan& scan, double bound) {
          errors.add(static_cast<double>(std::abs(range - static_cast<long double>(scan.ranges[i]))), bound,
                     scan.quality[i] != base::QualityFlag::none);
        };
        add(exact, in_64, scene::kRangeError), add(single, in_32, scene::kSingleRangeError);
      }
    }
  }
  fmt::print("{}{}{}, {}, {:g} m away: {} faces, {} beams\n", c.scene, c.field ? " (height field)" : "",
             c.turned ? " (moved)" : "", c.sensor, c.away, scene.mesh.faces.size(), beams.size() * scene.poses.size());
  for (const auto& [mode, errors] : {std::pair("exact", exact), std::pair("single", single)})
    fmt::print("  {:6} {} outside the bound, {} flagged, largest error {:.1e} m\n", mode, errors.outside,
               errors.flagged, errors.worst);
  std::fflush(stdout);
  return exact.outside + single.outside;
}

}  // namespace

}  // namespace sf::bench

int main(int count, char** arguments) {
  return sf::bench::run_main(count, arguments, "lidar_errors [BEAMS [FIRST [END]]]; default: 1000000 0 10", [&] {
    const auto number = [&](int i, std::size_t otherwise) {
      return i < count ? static_cast<std::size_t>(std::atoll(arguments[i])) : otherwise;
    };
    std::size_t outside = 0;
    for (std::size_t i = number(2, 0); i < std::min(number(3, 10), std::size(sf::bench::kCases)); ++i)
      outside += sf::bench::run(sf::bench::kCases[i], number(1, 1'000'000));
    return outside == 0 ? 0 : 1;
  });
}
