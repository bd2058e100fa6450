// Spatial scans against Embree's packets: processor time per beam on one thread, with poses and a hash of the ranges,
// and the error of each method against every face in `long double`.
//
//   build/release/lidar_cost [SCENE [SENSOR [POSES [TURNS]]]]; default: city100 lidar64x1024 20 7

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "base/hash.h"
#include "bench/cost.h"
#include "bench/lidar_scenes.h"
#include "bench/spatial_embree.h"
#include "scene/rasterizer.h"
#include "scene/reference_scan.h"

namespace sf::bench {

namespace {

constexpr double kRange = 100.0;
constexpr std::size_t kChecked = 2'000;  ///< beams checked against the reference

class FarmCaster : public SpatialCaster {
 public:
  /// @param field null: the triangles of `tree`
  FarmCaster(const scene::SurfaceTree& tree, const scene::HeightField* field, const std::vector<glm::dvec3>& beams,
             std::uint32_t row)
      : instance_{&tree, {}, true},
        field_(field),
        pattern_(scene::make_pattern(beams, row)),
        hits_(beams.size()),
        quality_(beams.size()) {}
  std::string name() const override { return field_ == nullptr ? "farm" : "farm, terrain"; }
  void cast(const base::RigidTransform& X_WS, std::span<double> ranges) override { scan(X_WS, ranges, {}); }
  double uncertain() const {
    return static_cast<double>(rasterizer_.counts().uncertain) / static_cast<double>(rasterizer_.counts().beams);
  }

 protected:
  void scan(const base::RigidTransform& X_WS, std::span<double> ranges, std::span<float> cosines) {
    const std::span instances(&instance_, field_ == nullptr ? 1 : 0);
    rasterizer_.scan(X_WS, pattern_, kRange, {instances, false, {field_, {}}}, {ranges, hits_, quality_, cosines});
  }

 private:
  scene::Instance instance_;
  const scene::HeightField* field_;
  scene::BeamPattern pattern_;
  std::vector<std::uint32_t> hits_;
  std::vector<base::QualityFlag> quality_;
  scene::Rasterizer rasterizer_;
};

/// Every column has its own time, and is cast by a scan of its own.
class RollingCaster : public SpatialCaster {
 public:
  RollingCaster(const scene::SurfaceTree& tree, const std::vector<glm::dvec3>& beams, std::uint32_t row)
      : instance_{&tree, {}, true}, hits_(beams.size()), quality_(beams.size()) {
    std::vector<double> times;
    for (std::size_t i = 0; i < beams.size(); ++i) times.push_back(static_cast<double>(i % row));
    pattern_ = scene::make_pattern(beams, row, times);
  }
  std::string name() const override { return "farm, rolling"; }
  void cast(const base::RigidTransform& X_WS, std::span<double> ranges) override {
    for (const scene::BeamTile& tile : pattern_)
      rasterizer_.scan(X_WS, {&tile, 1}, kRange, {{&instance_, 1}, false}, {ranges, hits_, quality_});
  }

 private:
  scene::Instance instance_;
  scene::BeamPattern pattern_;
  std::vector<std::uint32_t> hits_;
  std::vector<base::QualityFlag> quality_;
  scene::Rasterizer rasterizer_;
};

/// With the cosines that intensities need.
class CosineCaster : public FarmCaster {
 public:
  using FarmCaster::FarmCaster;
  std::string name() const override { return "farm, cosines"; }
  void cast(const base::RigidTransform& X_WS, std::span<double> ranges) override {
    cosines_.resize(ranges.size());
    scan(X_WS, ranges, cosines_);
  }

 private:
  std::vector<float> cosines_;
};

struct Method : Timing {
  std::unique_ptr<SpatialCaster> caster;
  std::uint64_t hash = 0;
  double worst = 0.0;     ///< [m]
  std::size_t wrong = 0;  ///< beams off by more than 1 cm
};

/// Casts from all poses, into poisoned memory. @return the hash of all ranges
std::uint64_t cast_all(SpatialCaster& caster, const LidarScene& scene, std::vector<double>& ranges) {
  std::uint64_t hash = 0;
  for (const base::RigidTransform& X_WS : scene.poses) {
    caster.cast(X_WS, ranges);
    hash = base::hash_bytes(ranges.data(), ranges.size() * sizeof(double), hash);
  }
  return hash;
}

/// One beam with its true range.
struct Sample {
  std::size_t pose = 0, beam = 0;
  long double range = 0.0L;  ///< [m]
};

std::vector<Sample> samples_of(const LidarScene& scene, const scene::SurfaceTree& tree,
                               const std::vector<glm::dvec3>& beams) {
  const scene::Instance instance{&tree, {}, true};
  const std::size_t all = beams.size() * scene.poses.size(), step = all / kChecked | 1;
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < all; i += step) {
    const std::size_t pose = i / beams.size(), beam = i % beams.size();
    const auto hit = scene::reference_scan(scene.poses[pose], beams[beam], kRange, {{&instance, 1}, false});
    samples.push_back({pose, beam, hit.range});
  }
  return samples;
}

void check(Method& method, const LidarScene& scene, const std::vector<Sample>& samples, std::vector<double>& ranges) {
  std::size_t pose = scene.poses.size();
  for (const Sample& sample : samples) {
    if (sample.pose != pose) method.caster->cast(scene.poses[pose = sample.pose], ranges);
    const double error = static_cast<double>(std::abs(sample.range - static_cast<long double>(ranges[sample.beam])));
    method.wrong += !(error <= 0.01);
    method.worst = std::max(method.worst, error);
  }
}

int run(const std::string& scene_name, const std::string& sensor, int poses, std::size_t turns) {
  const LidarScene scene = lidar_scene(scene_name, poses);
  std::uint32_t row = 0;
  const std::vector<glm::dvec3> beams = lidar_beams(sensor, row);
  const Cost start = now();
  const scene::SurfaceTree tree = scene::build_tree(scene.mesh);
  const Cost built = since(start);
  std::vector<Method> methods;
  const auto add = [&](std::unique_ptr<SpatialCaster> caster) {
    methods.emplace_back();
    methods.back().method = caster->name();
    methods.back().caster = std::move(caster);
  };
  add(std::make_unique<FarmCaster>(tree, nullptr, beams, row));
  add(std::make_unique<CosineCaster>(tree, nullptr, beams, row));
  if (row > 0) add(std::make_unique<RollingCaster>(tree, beams, row));
  if (!scene.field.empty()) add(std::make_unique<FarmCaster>(tree, &scene.field, beams, row));
  for (auto& caster : embree_casters(scene.mesh, beams, kRange)) add(std::move(caster));
  std::vector<double> ranges(beams.size());
  take_turns(methods, turns, "farm", [&](std::size_t k, std::size_t) {
    std::ranges::fill(ranges, std::nan(""));
    const Cost before = now();
    methods[k].hash = cast_all(*methods[k].caster, scene, ranges);
    const Cost cost = since(before);
    if (std::ranges::any_of(ranges, [](double r) { return std::isnan(r); })) fmt::print("{}: NaN\n", methods[k].method);
    return cost;
  });
  fmt::print("{}, {}: {} faces, tree {:.2f} s, {} beams, {} poses, {} turns\n", scene_name, sensor,
             tree.mesh.faces.size(), built.cpu_s, beams.size(), poses, turns);
  for (const Method& method : methods)
    if (const auto* const farm = dynamic_cast<FarmCaster*>(method.caster.get()))
      fmt::print("  {:16} {:.4f} % uncertain\n", method.method, 100.0 * farm->uncertain());
  const std::vector<Sample> samples = samples_of(scene, tree, beams);
  for (Method& method : methods) {
    check(method, scene, samples, ranges);
    fmt::print(
        "  {:16} {:7.2f} ns/beam, {:5.2f} times the farm's; worst {:.1e} m, {} of {} off by 1 cm, hash {:016x}\n",
        method.method, 1e9 * method.typical.cpu_s / static_cast<double>(beams.size()) / poses, 1.0 / method.cpu_ratio,
        method.worst, method.wrong, samples.size(), method.hash);
  }
  return 0;
}

}  // namespace

}  // namespace sf::bench

int main(int count, char** arguments) {
  const auto word = [&](int i, const char* fallback) { return std::string(i < count ? arguments[i] : fallback); };
  return sf::bench::run(word(1, "city100"), word(2, "lidar64x1024"), std::atoi(word(3, "20").c_str()),
                        static_cast<std::size_t>(std::atoi(word(4, "7").c_str())));
}
