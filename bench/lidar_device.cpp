// Rate of spatial scans in kernels: all robots' scans in one submission. Compares every result with the host's.
//
//   lidar_device [SCENE] [SENSOR] [ROBOTS] [TURNS]      as lidar_cost; default: city100 lidar64x1024 100 7

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "base/hash.h"
#include "base/thread_pool.h"
#include "bench/lidar_scenes.h"
#include "bench/usage.h"
#include "scene/device/device_rasterizer.h"

namespace sf::bench {

namespace {

constexpr double kRange = 100.0;  // [m]

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Ranges and models of all scans.
struct Results {
  std::vector<double> ranges;
  std::vector<std::uint32_t> hits;
  std::vector<base::QualityFlag> quality;
  explicit Results(std::size_t beams) : ranges(beams, std::nan("")), hits(beams, 0xDEADu), quality(beams) {}
  std::uint64_t hash() const {
    return base::hash_bytes(hits.data(), hits.size() * sizeof hits[0],
                            base::hash_bytes(ranges.data(), ranges.size() * sizeof ranges[0], 0));
  }
};

/// Casts all poses on all threads. @param cast kTileBeams per tile of each pose; empty: the host casts alone
void cast(const LidarScene& scene, const scene::BeamPattern& pattern, const scene::SceneView& view,
          std::span<const scene::CastBeam> cast, base::ThreadPool& pool, std::vector<scene::Rasterizer>& rasterizers,
          Results& out) {
  const std::size_t beams = out.ranges.size() / scene.poses.size(), tiles = pattern.size() * scene::kTileBeams;
  pool.parallel_for_each(scene.poses.size(), 1, [&](std::size_t i, unsigned thread) {
    const auto part = [&](auto& all) { return std::span(all).subspan(i * beams, beams); };
    rasterizers[thread].scan(scene.poses[i], pattern, kRange, view,
                             {part(out.ranges), part(out.hits), part(out.quality)},
                             cast.empty() ? cast : cast.subspan(i * tiles, tiles));
  });
}

int run(const std::string& scene_name, const std::string& sensor, int robots, int turns) {
  const LidarScene scene = lidar_scene(scene_name, robots);
  std::uint32_t row = 0;
  const std::vector<glm::dvec3> beams = lidar_beams(sensor, row);
  const scene::SurfaceTree tree = scene::build_tree(scene.mesh);
  const scene::Instance instance{&tree, {}, true};
  const scene::SceneView view{{&instance, 1}, false};
  const scene::BeamPattern pattern = lidar_pattern(beams, row);
  gpu::Device device;
  scene::DeviceRasterizer kernel(device);
  gpu::Batch batch(device);
  base::ThreadPool pool(0);
  std::vector<scene::Rasterizer> rasterizers(pool.threads());
  Results by_host(beams.size() * scene.poses.size()), by_device(by_host.ranges.size());
  std::vector<double> kernels, finishes, hosts;  // [s]
  for (int turn = 0; turn < turns; ++turn) {
    kernel.begin();
    for (const base::RigidTransform& X_WS : scene.poses)
      if (!kernel.add(X_WS, pattern, kRange, view)) return fmt::print("the tables exceed the device's limits\n"), 1;
    if (kernel.prepare()) batch.begin(), kernel.record(batch), batch.end();
    kernel.add_copies(batch);
    const double start = seconds();
    batch.run();
    const double ran = seconds();
    cast(scene, pattern, view, kernel.results(0, pattern.size() * scene.poses.size()), pool, rasterizers, by_device);
    const double finished = seconds();
    cast(scene, pattern, view, {}, pool, rasterizers, by_host);
    kernels.push_back(ran - start), finishes.push_back(finished - ran), hosts.push_back(seconds() - finished);
  }
  const auto cast_beams = kernel.results(0, pattern.size() * scene.poses.size());
  const auto doubts = std::ranges::count_if(cast_beams, [](const auto& beam) { return beam.flags & 1; });
  const auto rate = [&](std::vector<double>& times) {
    std::ranges::sort(times);
    return static_cast<double>(by_host.ranges.size()) / times[times.size() / 2] / 1e6;
  };
  fmt::print("{}, {}, {} robots, {} ({}), {} threads, {} turns: million beams/s, medians\n", scene_name, sensor, robots,
             device.info().name, device.info().driver, pool.threads(), turns);
  fmt::print(
      "  kernels with copies {:.0f}, host's part after them {:.0f}, host alone {:.0f}; {:.4f} % of beams uncertain\n",
      rate(kernels), rate(finishes), rate(hosts),
      100.0 * static_cast<double>(doubts) / static_cast<double>(cast_beams.size()));
  fmt::print("  hash {:016x} with kernels, {:016x} without\n", by_device.hash(), by_host.hash());
  return by_device.hash() == by_host.hash() ? 0 : 1;
}

}  // namespace

}  // namespace sf::bench

int main(int count, char** arguments) {
  return sf::bench::run_main(
      count, arguments, "lidar_device [SCENE [SENSOR [ROBOTS [TURNS]]]]; default: city100 lidar64x1024 100 7", [&] {
        const auto word = [&](int i, const char* fallback) { return std::string(i < count ? arguments[i] : fallback); };
        return sf::bench::run(word(1, "city100"), word(2, "lidar64x1024"), std::atoi(word(3, "100").c_str()),
                              std::atoi(word(4, "7").c_str()));
      });
}
