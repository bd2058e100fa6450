// Spatial scans against Embree's packets: processor time per beam on one thread, with poses and a hash of the ranges,
// and the error of each method against every face in `long double`.
//
//   build/release/lidar_cost [SCENE [SENSOR [POSES [TURNS [METHODS [CHECKED]]]]]]; default: city100 lidar64x1024 20 7
//   "" 2000
//
// Prints medians over turns, and sums of each pose's least time, which other load on the machine disturbs less.
// METHODS: a regular expression for names of methods; the farm's is always measured. CHECKED: beams that are checked
// against the reference.
// LIDAR_ISA=avx2 limits both sides to AVX2.

#include <fmt/format.h>

#include <hwy/targets.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <optional>
#include <random>
#include <regex>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "base/srgb.h"
#include "bench/cost.h"
#include "bench/lidar_scenes.h"
#include "bench/spatial_embree.h"
#include "bench/usage.h"
#include "scene/join_triangles.h"
#include "scene/rasterizer.h"
#include "scene/reference_scan.h"
#include "sensors/camera_light.h"
#include "sensors/lidar_modes.h"
#include "sensors/spatial_scene.h"

namespace sf::bench {

namespace {

constexpr double kRange = 100.0;

class FarmCaster : public SpatialCaster {
 public:
  /// @param field null: the triangles of `tree`
  FarmCaster(const scene::SurfaceTree& tree, const scene::HeightField* field, const std::vector<glm::dvec3>& beams,
             std::uint32_t row)
      : instance_{&tree, {}, true},
        field_(field),
        pattern_(lidar_pattern(beams, row)),
        hits_(beams.size()),
        quality_(beams.size()) {}
  std::string name() const override { return field_ == nullptr ? "farm" : "farm, terrain"; }
  void cast(const base::RigidTransform& X_WS, std::span<double> ranges) override { scan(X_WS, ranges, {}); }
  std::span<const std::uint32_t> hits() const { return hits_; }
  double uncertain() const {
    return static_cast<double>(rasterizer_.counts().uncertain) / static_cast<double>(rasterizer_.counts().beams);
  }

 protected:
  void scan(const base::RigidTransform& X_WS, std::span<double> ranges, std::span<float> cosines, bool single = false) {
    const std::span instances(&instance_, field_ == nullptr ? 1 : 0);
    rasterizer_.scan(X_WS, pattern_, kRange, {instances, false, {field_, {}}},
                     {.ranges = ranges, .hits = hits_, .quality = quality_, .cosines = cosines, .single = single});
  }

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

/// With ranges in 32 bits.
class SingleCaster : public FarmCaster {
 public:
  using FarmCaster::FarmCaster;
  std::string name() const override { return "farm, single"; }
  void cast(const base::RigidTransform& X_WS, std::span<double> ranges) override { scan(X_WS, ranges, {}, true); }
};

/// A forest, whose meshes may be coarser.
class ForestCaster : public SpatialCaster {
 public:
  ForestCaster(std::string name, const sensors::SpatialScene& scene, double angle, const std::vector<glm::dvec3>& beams,
               std::uint32_t row)
      : name_(std::move(name)),
        scene_(scene),
        angle_(angle),
        pattern_(lidar_pattern(beams, row)),
        hits_(beams.size()),
        quality_(beams.size()) {}
  std::string name() const override { return name_; }
  std::span<const std::uint32_t> hits() const { return hits_; }
  void cast(const base::RigidTransform& X_WS, std::span<double> ranges) override {
    scene_.list({.p = X_WS.p, .range = kRange, .angle = angle_}, list_);
    rasterizer_.scan(X_WS, pattern_, kRange, {list_.instances, list_.floor}, {ranges, hits_, quality_});
  }

 private:
  std::string name_;
  const sensors::SpatialScene& scene_;
  double angle_;
  scene::BeamPattern pattern_;
  sensors::SceneList list_;
  std::vector<std::uint32_t> hits_;
  std::vector<base::QualityFlag> quality_;
  scene::Rasterizer rasterizer_;
};

/// Every n-th column; the others interpolated.
template <class Caster>
class SkipCaster : public SpatialCaster {
 public:
  /// @param make (beams, length of a ring) -> Caster
  template <class Make>
  SkipCaster(const std::vector<glm::dvec3>& beams, std::uint32_t row, std::uint32_t skip, const Make& make)
      : skip_(skip), hits_(beams.size()), quality_(beams.size()) {
    beams_.directions = beams;
    for (std::uint32_t i = 0; i < beams.size(); ++i) {
      if (i % row % skip != 0 && i % row + 1 != row) continue;
      beams_.cast.push_back(i);
      beams_.part_directions.push_back(beams[i]);
    }
    beams_.between = sensors::interpolation_weights(beams_);
    const auto rings = static_cast<std::uint32_t>(beams.size() / row);
    cast_ = make(beams_.part_directions, static_cast<std::uint32_t>(beams_.cast.size()) / rings);
    part_.resize(beams_.cast.size());
  }
  std::string name() const override { return fmt::format("farm, skip{}", skip_); }
  void cast(const base::RigidTransform& X_WS, std::span<double> ranges) override {
    cast_->cast(X_WS, part_);
    for (std::size_t c = 0; c < part_.size(); ++c) {
      ranges[beams_.cast[c]] = part_[c];
      hits_[beams_.cast[c]] = cast_->hits()[c];
    }
    sensors::interpolate_columns(beams_, kRange, {ranges, 1, hits_, quality_});
  }

 private:
  std::uint32_t skip_;
  sensors::LidarBeams beams_;
  std::unique_ptr<Caster> cast_;
  std::vector<double> part_;
  std::vector<std::uint32_t> hits_;
  std::vector<base::QualityFlag> quality_;
};

/// Gives all faces one material, whose picture repeats each metre along the two axes that a face is most parallel to.
scene::Mesh with_texture(scene::Mesh mesh) {
  mesh.materials.assign(mesh.faces.size(), 0);
  for (const scene::Face& face : mesh.faces) {
    const glm::dvec3 n = glm::abs(scene::plane_of(mesh, face).normal);
    const int across = n.x > n.y && n.x > n.z ? 0 : n.y > n.z ? 1 : 2;
    const auto at = [&](std::size_t k) {
      const glm::dvec3& p = mesh.vertices[face[k]];
      return glm::vec2(glm::dvec2(p[(across + 1) % 3], p[(across + 2) % 3]));
    };
    mesh.coordinates.push_back({at(0), at(1), at(2)});
  }
  return mesh;
}

/// A camera's light in a world with a texture of 1024 x 1024 px.
sensors::CameraLight light_of(bool textured) {
  world::World world;
  if (!textured) return {world, {}};
  world.textures.push_back({"", 1024, 1024, {}});
  std::mt19937 random(1);
  for (int i = 0; i < 3 << 20; ++i) world.textures[0].rgb.push_back(static_cast<std::uint8_t>(random()));
  return {world, {{}}, {{.texture = 0}}};
}

/// A camera's colours: normals, shadows and shading of each tile, without paint.
class ColourCaster : public FarmCaster, private scene::TileSink {
 public:
  ColourCaster(const scene::SurfaceTree& tree, const scene::HeightField* field, const std::vector<glm::dvec3>& beams,
               bool shadows)
      : FarmCaster(tree, field, beams, 0),
        shadows_(shadows),
        textured_(!tree.mesh.coordinates.empty()),
        light_(light_of(textured_)),
        colours_(beams.size()) {}
  std::string name() const override {
    return textured_ ? "farm, textures" : shadows_ ? "farm, colours" : "farm, no shadows";
  }
  void cast(const base::RigidTransform& X_WS, std::span<double> ranges) override {
    const std::span instances(&instance_, field_ == nullptr ? 1 : 0);
    const scene::SceneView scene{instances, false, {field_, {}}};
    scratch_.shadows.begin(X_WS.p, light_.to_sun(), shadows_ ? scene : scene::SceneView{});
    X_WS_ = X_WS;
    rasterizer_.scan(X_WS, pattern_, kRange, scene,
                     {.ranges = ranges, .hits = hits_, .quality = quality_, .sink = this});
  }
  void take(const scene::BeamTile& tile, const scene::TileSurfaces& surfaces) override {
    light_.shade(X_WS_, tile, {kRange, 1.0f / (160 * 160)}, surfaces, scratch_);  // of 320 px and 90 degrees
    std::uint32_t colours[scene::kTileBeams];
    const std::uint32_t beams = tile.used * scene::kWidth;
    const auto& light = scratch_.lanes.light;
    base::srgb_colors(light[0], light[1], light[2], std::span(colours).first(beams));
    for (std::uint32_t i = 0; i < beams; ++i) colours_[tile.place[i]] = colours[i];
  }
  /// Of the colours of the last cast.
  std::uint64_t colour_hash() const { return base::hash_bytes(colours_.data(), colours_.size() * sizeof(colours_[0])); }

 private:
  bool shadows_, textured_;
  sensors::CameraLight light_;
  sensors::CameraLight::Scratch scratch_;
  base::RigidTransform X_WS_;
  std::vector<std::uint32_t> colours_;
};

struct Method : Timing {
  std::unique_ptr<SpatialCaster> caster;
  std::uint64_t hash = 0;
  std::vector<double> least = {};   ///< [s] per pose: smallest processor time over all turns
  std::vector<double> errors = {};  ///< [m]
  std::size_t wrong = 0;            ///< beams off by more than 1 cm
};

/// Casts from all poses, into poisoned memory. Sets the hash of all ranges.
void cast_all(Method& method, const LidarScene& scene, std::vector<double>& ranges) {
  method.hash = 0;
  method.least.resize(scene.poses.size(), HUGE_VAL);
  for (std::size_t i = 0; i < scene.poses.size(); ++i) {
    const double start = now().cpu_s;
    method.caster->cast(scene.poses[i], ranges);
    method.hash = base::hash_bytes(ranges.data(), ranges.size() * sizeof(double), method.hash);
    method.least[i] = std::min(method.least[i], now().cpu_s - start);
  }
}

/// One beam with its true range.
struct Sample {
  std::size_t pose = 0, beam = 0;
  long double range = 0.0L;  ///< [m]
};

/// @param checked number of samples, about  @param range_of (pose, beam) -> true range
template <class RangeOf>
std::vector<Sample> samples_of(const LidarScene& scene, std::size_t beams, std::size_t checked,
                               const RangeOf& range_of) {
  const std::size_t all = beams * scene.poses.size(), step = all / checked | 1;
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < all; i += step) samples.push_back({i / beams, i % beams, range_of(i / beams, i % beams)});
  return samples;
}

void check(Method& method, const LidarScene& scene, const std::vector<Sample>& samples, std::vector<double>& ranges) {
  std::size_t pose = scene.poses.size();
  for (const Sample& sample : samples) {
    if (sample.pose != pose) method.caster->cast(scene.poses[pose = sample.pose], ranges);
    const double error = static_cast<double>(std::abs(sample.range - static_cast<long double>(ranges[sample.beam])));
    method.wrong += !(error <= 0.01);
    method.errors.push_back(error);
  }
  std::ranges::sort(method.errors);
}

int run(const std::string& scene_name, const std::string& sensor, int poses, std::size_t turns,
        const std::string& wanted, std::size_t checked) {
  LidarScene scene = lidar_scene(scene_name, poses);
  std::uint32_t row = 0;
  const std::vector<glm::dvec3> beams = lidar_beams(sensor, row);
  const Cost start = now();
  scene.mesh = scene::join_triangles(std::move(scene.mesh));
  const scene::SurfaceTree tree = scene::build_tree(scene.mesh);
  const Cost built = since(start);
  const scene::SurfaceTree textured = row == 0 ? scene::build_tree(with_texture(scene.mesh)) : scene::SurfaceTree{};
  const bool is_forest = !scene.forest.models.empty();
  std::optional<sensors::SpatialScene> forest;
  if (is_forest) forest.emplace(scene.forest, kRange, sensors::SceneExtras{.coarse = true});
  std::vector<Method> methods;
  const auto add = [&](std::unique_ptr<SpatialCaster> caster) {
    methods.emplace_back();
    methods.back().method = caster->name();
    methods.back().caster = std::move(caster);
  };
  const auto add_skips = [&]<class Make>(const Make& make) {
    using Caster = typename std::invoke_result_t<Make, const std::vector<glm::dvec3>&, std::uint32_t>::element_type;
    for (const std::uint32_t skip : {2u, 4u})
      if (row > 0) add(std::make_unique<SkipCaster<Caster>>(beams, row, skip, make));
  };
  if (is_forest) {
    for (const auto& [name, angle] :
         {std::pair("farm", 0.0), std::pair("farm, coarse1", 0.001), std::pair("farm, coarse4", 0.004)})
      add(std::make_unique<ForestCaster>(name, *forest, angle, beams, row));
    add_skips([&](const std::vector<glm::dvec3>& cast, std::uint32_t columns) {
      return std::make_unique<ForestCaster>("", *forest, 0.0, cast, columns);
    });
  } else {
    add(std::make_unique<FarmCaster>(tree, nullptr, beams, row));
    add(std::make_unique<CosineCaster>(tree, nullptr, beams, row));
    add(std::make_unique<SingleCaster>(tree, nullptr, beams, row));
    if (row > 0) add(std::make_unique<RollingCaster>(tree, beams, row));
    for (const bool shadows : {false, true})
      if (row == 0) add(std::make_unique<ColourCaster>(tree, nullptr, beams, shadows));
    if (row == 0) add(std::make_unique<ColourCaster>(textured, nullptr, beams, true));
    add_skips([&](const std::vector<glm::dvec3>& cast, std::uint32_t columns) {
      return std::make_unique<FarmCaster>(tree, nullptr, cast, columns);
    });
    if (!scene.field.empty()) add(std::make_unique<FarmCaster>(tree, &scene.field, beams, row));
    for (auto& caster : embree_casters(scene.mesh, beams, kRange)) add(std::move(caster));
  }
  std::erase_if(methods, [&, names = std::regex(wanted)](const Method& method) {
    return method.method != "farm" && !std::regex_search(method.method, names);
  });
  std::vector<double> ranges(beams.size());
  take_turns(methods, turns, "farm", [&](std::size_t k, std::size_t) {
    std::ranges::fill(ranges, std::nan(""));
    const Cost before = now();
    cast_all(methods[k], scene, ranges);
    const Cost cost = since(before);
    if (std::ranges::any_of(ranges, [](double r) { return std::isnan(r); })) fmt::print("{}: NaN\n", methods[k].method);
    return cost;
  });
  fmt::print("{}, {}: {} faces, tree {:.2f} s, {} beams, {} poses, {} turns\n", scene_name, sensor,
             tree.mesh.faces.size(), built.cpu_s, beams.size(), poses, turns);
  for (const Method& method : methods) {
    if (const auto* const farm = dynamic_cast<FarmCaster*>(method.caster.get()))
      fmt::print("  {:25} {:.4f} % uncertain\n", method.method, 100.0 * farm->uncertain());
    if (const auto* const colours = dynamic_cast<ColourCaster*>(method.caster.get()))
      fmt::print("  {:25} hash of the last image's colours {:016x}\n", method.method, colours->colour_hash());
  }
  // The forest has too many triangles for the reference: errors are against the farm's exact ranges.
  const scene::Instance instance{&tree, {}, true};
  std::size_t cast_pose = scene.poses.size();
  const std::vector<Sample> samples =
      samples_of(scene, beams.size(), checked, [&](std::size_t pose, std::size_t beam) -> long double {
        if (!is_forest)
          return scene::reference_scan(scene.poses[pose], beams[beam], kRange, {{&instance, 1}, false}).range;
        if (pose != cast_pose) methods[0].caster->cast(scene.poses[cast_pose = pose], ranges);
        return static_cast<long double>(ranges[beam]);
      });
  for (Method& method : methods) {
    check(method, scene, samples, ranges);
    const auto quantile = [&](double part) {
      return method.errors[static_cast<std::size_t>(part * static_cast<double>(method.errors.size() - 1))];
    };
    const auto least = [](const Method& m) { return std::accumulate(m.least.begin(), m.least.end(), 0.0); };
    const double per_beam = 1e9 / static_cast<double>(beams.size()) / poses;
    fmt::print(
        "  {:25} {:7.2f} ns/beam, {:5.2f} times the farm's; least {:7.2f}, {:5.2f}; {:.1f} % off by 1 cm, 99 % within "
        "{:.1e} m, worst {:.1e} m, hash {:016x}\n",
        method.method, per_beam * method.typical.cpu_s, 1.0 / method.cpu_ratio, per_beam * least(method),
        least(method) / least(methods[0]),
        100.0 * static_cast<double>(method.wrong) / static_cast<double>(samples.size()), quantile(0.99), quantile(1.0),
        method.hash);
  }
  return 0;
}

}  // namespace

}  // namespace sf::bench

int main(int count, char** arguments) {
  return sf::bench::run_main(
      count, arguments,
      "lidar_cost [SCENE [SENSOR [POSES [TURNS [METHODS [CHECKED]]]]]]; default: city100 lidar64x1024 20 7", [&] {
        const char* const isa = std::getenv("LIDAR_ISA");
        if (isa != nullptr && std::string(isa) == "avx2") hwy::DisableTargets(HWY_AVX2 - 1);
        const auto word = [&](int i, const char* fallback) { return std::string(i < count ? arguments[i] : fallback); };
        return sf::bench::run(word(1, "city100"), word(2, "lidar64x1024"), std::atoi(word(3, "20").c_str()),
                              static_cast<std::size_t>(std::atoi(word(4, "7").c_str())), word(5, ""),
                              std::max(1, std::atoi(word(6, "2000").c_str())));
      });
}
