// Fleets of robots with cameras of 160 x 120 px at 10 Hz: processor time of ticks with depths and with colours, and of
// Embree's packets with the same depths and labels.
//
//   build/release/camera_cost [SCENE [ROBOTS [TICKS [METHODS]]]]; default: city100 100 10
//
// METHODS: a regular expression for names of methods; depth is always measured.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "bench/cost.h"
#include "bench/spatial_embree.h"
#include "bench/usage.h"
#include "farm/farm.h"
#include "sensors/camera.h"
#include "sensors/sensor_set.h"
#include "world/stage/build_world.h"

namespace sf::bench {

namespace {

constexpr double kPeriod = 0.1;   ///< [s]
constexpr double kRange = 100.0;  ///< [m]
constexpr unsigned kThreads = 2;

/// Robots at a scene's poses, with the scene's faces as the mesh of one more model.
world::World fleet_in(const LidarScene& scene, bool colours) {
  std::string text = "floor_return 0\n";
  for (const base::RigidTransform& X : scene.poses)
    text += fmt::format(
        "position( pose [{} {} 0 {}] size [0.4 0.4 0.5] camera( resolution [160 120] fov 90 range [0 {}] rate 10 rgb "
        "{} "
        "pose6 [0 0 0.5 0 0 0] ) )\n",
        X.p.x, X.p.y, std::atan2(X.R[0].y, X.R[0].x) * 180.0 / M_PI, kRange, colours ? 1 : 0);
  world::World world = world::build_world("cameras.world", text, {.sensors = sensors::world_file_words()});
  world::Mesh mesh{.file = "scene", .vertices = scene.mesh.vertices};
  for (const scene::Face& f : scene.mesh.faces) {
    mesh.corners.insert(mesh.corners.end(), {f[0], f[1], f[2]});
    if (f[3] != f[2]) mesh.corners.insert(mesh.corners.end(), {f[0], f[2], f[3]});
  }
  world.meshes.push_back(std::move(mesh));
  world.models.emplace_back();
  world.mesh_models.push_back({0, static_cast<std::uint32_t>(world.models.size() - 1), {}});
  return world;
}

struct Method : Timing {
  std::unique_ptr<farm::Farm> farm;
  std::unique_ptr<SpatialCaster> embree;
};

/// Where Embree and the farm differ, of the pixels where the farm does not see a robot.
struct Agreement {
  std::size_t pixels = 0, labels = 0, depths = 0;
};

class Fleet {
 public:
  Fleet(const std::string& scene_name, int robots, const std::regex& wanted)
      : scene_(lidar_scene(scene_name, robots)), depth_(fleet_in(scene_, false)), colour_(fleet_in(scene_, true)) {
    std::uint32_t row = 0;
    beams_ = lidar_beams("camera160x120", row);
    for (const sensors::CameraSettings& s :
         sensors::SensorSet(depth_).settings_of<sensors::CameraSettings>(sensors::kCamera))
      mounts_.push_back(s.X_MS);
    add("depth", depth_);
    if (std::regex_search("colours", wanted)) add("colours", colour_);
    for (auto& caster : embree_casters(scene_.mesh, beams_, kRange * std::sqrt(2.0))) {
      if (caster->name() != "embree 16" || !std::regex_search(caster->name(), wanted)) continue;
      methods_.emplace_back().method = caster->name();
      methods_.back().embree = std::move(caster);
    }
    ranges_.resize(beams_.size());
  }

  void run(std::size_t ticks) {
    take_turns(methods_, ticks, "depth", [&](std::size_t k, std::size_t tick) {
      move(static_cast<double>(tick));
      return methods_[k].embree ? cast(*methods_[k].embree) : sense(*methods_[k].farm, k == 0);
    });
  }
  void print() const {
    for (const Method& m : methods_) {
      const double least = std::ranges::min(m.repeats, {}, &Cost::cpu_s).cpu_s;
      fmt::print(
          "  {:10} {:6.1f} ms of processor time per tick, {:5.1f} times real time on {} cores, {:.2f} times depth; "
          "least {:.1f} ms\n",
          m.method, 1e3 * m.typical.cpu_s, kThreads * kPeriod / m.typical.cpu_s, kThreads, 1.0 / m.cpu_ratio,
          1e3 * least);
    }
    if (agreement_.pixels > 0)
      fmt::print("  of {} pixels, {} have other labels and {} depths off by more than 1 cm in Embree\n",
                 agreement_.pixels, agreement_.labels, agreement_.depths);
  }

 private:
  void add(const char* name, const world::World& world) {
    methods_.emplace_back().method = name;
    methods_.back().farm =
        std::make_unique<farm::Farm>(world, device_, farm::FarmOptions{.noise = false, .threads = kThreads});
    methods_.back().farm->subscribe_all();
  }
  void move(double tick) {
    reports_.clear();
    const auto time = static_cast<std::int64_t>(1e9 * kPeriod * tick);
    for (std::uint32_t m = 0; m < depth_.movers.size(); ++m) {
      base::Pose X = depth_.movers[m].X_WM;
      X.x += 0.02 * tick * std::cos(X.yaw), X.y += 0.02 * tick * std::sin(X.yaw);
      reports_.push_back({m, time, X, {}});
    }
  }
  Cost sense(farm::Farm& farm, bool keep) {
    const Cost start = now();
    const auto readings = farm.tick(reports_[0].time, reports_);
    const Cost cost = since(start);
    if (readings.size() != reports_.size()) fmt::print("{} of {} readings\n", readings.size(), reports_.size());
    if (!keep) return cost;
    kept_ = reports_[0].time;
    depths_.assign(reports_.size(), {}), labels_.assign(reports_.size(), {});
    for (const base::ReadingBlock& r : readings) {
      depths_[r.mover].assign(r.values.begin(), r.values.end());
      labels_[r.mover].assign(r.hits.begin(), r.hits.end());
    }
    return cost;
  }
  Cost cast(SpatialCaster& embree) {
    Cost sum;
    for (std::size_t m = 0; m < reports_.size(); ++m) {
      std::ranges::fill(ranges_, std::nan(""));
      const auto X_WS = base::compose(base::transform_of(reports_[m].X_WM), mounts_[m]);
      const Cost start = now();
      embree.cast(X_WS, ranges_);
      const Cost cost = now() - start;
      sum.wall_s += cost.wall_s, sum.cpu_s += cost.cpu_s;
      if (kept_ == reports_[0].time) compare(embree, m);
    }
    return sum;
  }
  void compare(const SpatialCaster& embree, std::size_t m) {
    for (std::size_t i = 0; i < beams_.size(); ++i) {
      const std::uint32_t label = labels_[m][i];
      if (label != base::kNoHit && label + 1 != depth_.models.size()) continue;  // a robot
      const double depth = std::min(kRange, ranges_[i] * beams_[i].x);
      ++agreement_.pixels;
      agreement_.labels += (embree.labels()[i] != 0 || depth >= kRange) != (label == base::kNoHit);
      agreement_.depths += !(std::abs(depth - depths_[m][i]) <= 0.01);
    }
  }

  LidarScene scene_;
  world::World depth_, colour_;
  gpu::Device device_{std::string(gpu::kHostDevice)};
  std::vector<glm::dvec3> beams_;
  std::vector<base::RigidTransform> mounts_;  ///< of the cameras
  std::vector<Method> methods_;
  std::vector<base::Report> reports_;
  std::vector<double> ranges_;
  std::int64_t kept_ = -1;                   ///< [ns] the tick of these, since methods take turns
  std::vector<std::vector<double>> depths_;  ///< of the farm's depths, by mover
  std::vector<std::vector<std::uint32_t>> labels_;
  Agreement agreement_;
};

}  // namespace

}  // namespace sf::bench

int main(int count, char** arguments) {
  return sf::bench::run_main(
      count, arguments, "camera_cost [SCENE [ROBOTS [TICKS [METHODS]]]]; default: city100 100 10", [&] {
        const auto word = [&](int i, const char* fallback) { return std::string(i < count ? arguments[i] : fallback); };
        const std::string scene = word(1, "city100");
        const int robots = std::atoi(word(2, "100").c_str());
        fmt::print("{}, {} robots\n", scene, robots);
        sf::bench::Fleet fleet(scene, robots, std::regex(word(4, "")));
        fleet.run(static_cast<std::size_t>(std::atoi(word(3, "10").c_str())));
        fleet.print();
        return 0;
      });
}
