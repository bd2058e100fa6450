#include "bench/cone_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "base/error.h"
#include "base/hash.h"
#include "base/thread_pool.h"
#include "bench/farm_rounds.h"
#include "bench/grid.h"
#include "bench/scans.h"
#include "sensors/cones/cone_array.h"
#include "sensors/sonar.h"
#include "tests/sensors/cone_trial.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/scenes.h"

namespace sf::bench {

namespace {

class ConeMethod {
 public:
  virtual ~ConeMethod() = default;
  virtual std::string name() const = 0;
  /// Overwrites the results of the last turn.
  virtual void poison() = 0;
  /// The timed part: from poses to ranges.
  virtual void measure(std::size_t round) = 0;
  /// [m] NaN if it was not written.
  virtual double range(std::size_t robot, std::size_t transducer) const = 0;
};

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class FarmCones final : public ConeMethod {
 public:
  FarmCones(const ConeScene& scene, gpu::Device& device) : farm_(scene.world, device, scene.rounds, 40'000'000) {}
  std::string name() const override { return "farm"; }
  void poison() override { farm_.poison(); }
  void measure(std::size_t round) override { farm_.tick(round); }
  double range(std::size_t robot, std::size_t transducer) const override {
    return farm_.readings()[robot].values[transducer];
  }

 private:
  FarmRounds farm_;
};

class PlainCones final : public ConeMethod {
 public:
  PlainCones(const ConeScene& scene, const std::vector<sensors::ConeArray>& arrays, std::string name, Walk walk)
      : scene_(scene), arrays_(arrays), name_(std::move(name)), walk_(walk), transducers_(arrays[0].X_SC.size()) {
    const sensors::ConeArray& array = arrays_[0];
    grid_ = make_grid(scene.world, scene.world.movers[0].X_WM.z + array.row.X_MS.z, 0.5);
    raycast::ScanSettings fan;
    fan.fov = array.fov;
    fan.samples = array.rays;
    for (std::uint32_t i = 0; i < array.rays; ++i) {
      const double bearing = bearing_of(fan, i);
      beams_.push_back({std::cos(bearing), std::sin(bearing)});
    }
    values_.assign(arrays_.size() * transducers_, kNaN);
    ranges_.resize(thread_pool_.threads(), std::vector<double>(array.rays));
    hits_.resize(thread_pool_.threads(), std::vector<std::uint32_t>(array.rays));
  }
  std::string name() const override { return name_; }
  void poison() override { std::fill(values_.begin(), values_.end(), kNaN); }
  void measure(std::size_t round) override {
    thread_pool_.parallel_for(arrays_.size(), kRobotsPerPiece,
                              [&](std::size_t first, std::size_t last, unsigned thread) {
                                for (std::size_t i = first; i < last; ++i)
                                  hear_ring(i, scene_.rounds[round][i], thread);
                              });
  }
  double range(std::size_t robot, std::size_t transducer) const override {
    return values_[robot * transducers_ + transducer];
  }

 private:
  void hear_ring(std::size_t robot, const base::Pose& X_WM, unsigned thread) {
    const sensors::ConeArray& array = arrays_[robot];
    const base::Pose X_WS = base::compose(X_WM, array.row.X_MS);
    std::vector<double>& ranges = ranges_[thread];
    for (std::size_t k = 0; k < transducers_; ++k) {
      walk_(grid_, base::compose(X_WS, array.X_SC[k]), beams_, array.range_max, ranges.data(), hits_[thread].data());
      values_[robot * transducers_ + k] = std::max(array.range_min, *std::min_element(ranges.begin(), ranges.end()));
    }
  }

  const ConeScene& scene_;
  const std::vector<sensors::ConeArray>& arrays_;
  std::string name_;
  Walk walk_;
  std::size_t transducers_;
  SegmentGrid grid_;
  std::vector<glm::dvec2> beams_;
  base::ThreadPool thread_pool_;
  std::vector<double> values_;
  std::vector<std::vector<double>> ranges_;  ///< scratch per thread
  std::vector<std::vector<std::uint32_t>> hits_;
};

constexpr std::size_t kRounds = 4;
constexpr std::size_t kJudgedRobots = 25;  // per round
constexpr std::size_t kPlain = 1;          // index of the method that ratios refer to

/// Result of one method.
struct ConeMethodResult : Timing {
  double worst = 0.0;      ///< [m] largest error relative to the nearest ray, over a sample of all rounds
  std::uint64_t hash = 0;  ///< of all ranges of round 0
};

/// Returns the Pioneer's sonar ring from worlds/robots.inc without its firing order.
world::Sensor pioneers_ring() {
  const world::World pioneer =
      world::load_world(SF_SOURCE_DIR "/bench/pioneer.world", {.sensors = sensors::world_file_words()});
  world::Sensor ring = pioneer.movers.at(0).sensors.at(0);
  std::erase_if(ring.settings, [](const world::Setting& s) { return s.key == "firing"; });
  ring.settings.push_back({"firing", {}, "all", 0, ring.file});
  return ring;
}

Cost measure_once(ConeMethod& method, std::size_t round, std::size_t robots, std::size_t cones) {
  method.poison();
  const Cost start = now();
  method.measure(round);
  const Cost cost = since(start);
  for (std::size_t i = 0; i < cones; ++i)
    SF_CHECK(!std::isnan(method.range(i % robots, i / robots)), method.name() + " left cones unanswered");
  return cost;
}

std::uint64_t hash_of(const ConeMethod& method, std::size_t robots, std::size_t transducers) {
  std::vector<double> all;
  for (std::size_t r = 0; r < robots; ++r)
    for (std::size_t k = 0; k < transducers; ++k) all.push_back(method.range(r, k));
  return base::hash_bytes(all.data(), all.size() * sizeof all[0]);
}

/// Checks a sample of one round by testing every ray against every segment.
void check_accuracy(const ConeScene& scene, const std::vector<sensors::ConeArray>& arrays, const ConeMethod& method,
                    std::size_t round, ConeMethodResult& method_result) {
  const sensors::ConeArray& array = arrays[0];
  const double z = scene.world.movers[0].X_WM.z + array.row.X_MS.z;
  const auto all = oracle::surfaces(scene.world, scene.rounds[round], 0, z);
  for (std::size_t k = 0; k < kJudgedRobots; ++k) {
    const std::size_t robot = (k * arrays.size() / kJudgedRobots + 17 * round) % arrays.size();
    for (std::size_t i = 0; i < array.X_SC.size(); ++i) {
      const base::Pose X_MC = base::compose(array.row.X_MS, array.X_SC[i]);
      const trial::ConeTruth truth =
          trial::cone_truth(all, base::compose(scene.rounds[round][robot], X_MC), arrays[robot]);
      const double said = method.range(robot, i);
      method_result.worst = std::max({method_result.worst, truth.low - said, said - truth.high});
    }
  }
}

}  // namespace

ConeScene make_cone_scene(std::uint32_t robots) {
  ConeScene scene;
  scene.world = load_cave();
  scenes::add_robots(scene.world, robots, scenes::laser(), 1);
  const world::Sensor ring = pioneers_ring();
  for (world::Mover& mover : scene.world.movers) {
    mover.body.clear();
    scenes::remove_lasers(mover);
    mover.sensors.push_back(ring);
  }
  for (std::size_t round = 0; round < kRounds; ++round) {
    const auto k = static_cast<double>(round);
    std::vector<base::Pose>& poses = scene.rounds.emplace_back();
    for (const world::Mover& mover : scene.world.movers)
      poses.push_back(base::compose(mover.X_WM, {0.002 * k, 0.001 * k, 0.0, 0.1 * k}));
  }
  return scene;
}

Report compare_cones(gpu::Device& device, const ConeScene& scene, std::size_t repeats) {
  const auto arrays = sensors::cone_arrays_of(scene.world, "sonar", sensors::read_sonar);
  std::vector<std::unique_ptr<ConeMethod>> methods;
  methods.push_back(std::make_unique<FarmCones>(scene, device));
  methods.push_back(std::make_unique<PlainCones>(scene, arrays, "plain C++ grid, -O3", walk_portable));
  methods.push_back(std::make_unique<PlainCones>(scene, arrays, "plain C++ grid, -O3 -march=native", walk_native));
  const std::size_t robots = arrays.size(), cones = robots * arrays[0].X_SC.size(), rays = cones * arrays[0].rays;
  std::vector<ConeMethodResult> results;
  for (const auto& method : methods) {
    results.emplace_back().method = method->name();
    for (std::size_t round = kRounds; round-- > 0;) {
      measure_once(*method, round, robots, cones);
      check_accuracy(scene, arrays, *method, round, results.back());
    }
    results.back().hash = hash_of(*method, arrays.size(), arrays[0].X_SC.size());
  }
  take_turns(results, repeats, methods[kPlain]->name(),
             [&](std::size_t k, std::size_t turn) { return measure_once(*methods[k], turn % kRounds, robots, cones); });

  Report report{"cones", "",
                "method,robots,cones,rays,turns,wall_ms_median,cpu_ms_median,mrays_per_s,ratio_to_plain,"
                "cpu_ratio_to_plain,max_error_m,judged,hash"};
  report.text = fmt::format("\nsonar rings: {} robots, {} cones, {} rays\n{}  max err m\n", robots, cones, rays,
                            heading("Mrays/s"));
  const auto csv = [&](const ConeMethodResult& e) {
    return fmt::format("\"{}\",{},{},{},{},{:.3f},{:.3f},{:.2f},{:.3f},{:.3f},{:.3g},{},{}\n", e.method, robots, cones,
                       rays, e.repeats.size(), 1e3 * e.typical.wall_s, 1e3 * e.typical.cpu_s,
                       mrays_per_s(rays, e.typical), e.ratio, e.cpu_ratio, e.worst,
                       kRounds * kJudgedRobots * arrays[0].X_SC.size(), base::hash_hex(e.hash));
  };
  add_methods(report, results, csv, [&](const ConeMethodResult& e) {
    return row(e, static_cast<double>(rays)) + fmt::format(" {:>10.1e}\n", e.worst);
  });
  return report;
}

}  // namespace sf::bench
