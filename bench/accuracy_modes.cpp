#include "bench/accuracy_modes.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>

#include "base/reading.h"
#include "bench/caster.h"
#include "bench/farm_caster.h"
#include "sensors/accuracy.h"
#include "sensors/laser_modes.h"
#include "tests/sensors/scenes.h"
#include "world/wall_tree.h"

namespace sf::bench {

namespace {

/// Lower bounds of the distance [m] between a wall and any point of a cell; 0: a wall may touch the cell.
struct Clearances {
  float x = 0.0f, y = 0.0f;  ///< [m] lower corner
  float cell = 1.0f;         ///< [m]
  int columns = 1, rows = 1;
  std::vector<float> clear;
};

Clearances measure(const world::World& world, double cell, base::ThreadPool& thread_pool) {
  Clearances c;
  c.cell = static_cast<float>(cell);
  c.x = static_cast<float>(world.extent.x_min - cell);
  c.y = static_cast<float>(world.extent.y_min - cell);
  c.columns = static_cast<int>((world.extent.x_max - c.x) / cell) + 2;
  c.rows = static_cast<int>((world.extent.y_max - c.y) / cell) + 2;
  c.clear.resize(static_cast<std::size_t>(c.columns) * c.rows);
  thread_pool.parallel_for(c.clear.size(), 256, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const auto column = static_cast<double>(i % c.columns), row = static_cast<double>(i / c.columns);
      const glm::dvec2 middle{c.x + (column + 0.5) * cell, c.y + (row + 0.5) * cell};
      double nearest = HUGE_VAL;
      for (const world::Segment& s : world.walls) nearest = std::min(nearest, world::distance(middle, s.a, s.b));
      c.clear[i] = static_cast<float>(std::max(0.0, nearest - M_SQRT1_2 * cell));
    }
  });
  return c;
}

float march(const Clearances& c, float x, float y, float dx, float dy, float range_max) {
  const float inverse = 1.0f / c.cell;
  const float least = 0.25f * c.cell;
  for (float t = 0.0f; t < range_max;) {
    const int column = static_cast<int>((x + t * dx - c.x) * inverse);
    const int row = static_cast<int>((y + t * dy - c.y) * inverse);
    if (column < 0 || row < 0 || column >= c.columns || row >= c.rows) return range_max;
    const float clear = c.clear[static_cast<std::size_t>(row) * c.columns + column];
    if (clear <= 0.0f) return t;
    t += std::max(clear, least);
  }
  return range_max;
}

/// Common base: computes on the host, with robots in chunks on all cores.
class HostCaster : public Caster {
 public:
  HostCaster(const Scans& scans, std::string name) : scans_(scans), results_(scans), name_(std::move(name)) {}
  std::string name() const override { return name_; }
  void poison() override { results_.poison(); }
  std::size_t unwritten() const override { return results_.unwritten(); }
  double range(std::size_t robot, std::size_t beam) const override { return results_.range(robot, beam); }
  std::uint64_t hash() const override { return results_.hash(); }

 protected:
  template <class One>
  void each(One one) {
    thread_pool_.parallel_for(scans_.robots(), kRobotsPerPiece, [&](std::size_t first, std::size_t last, unsigned) {
      for (std::size_t i = first; i < last; ++i) one(i);
    });
  }
  const Scans& scans_;
  Results<float> results_;
  base::ThreadPool thread_pool_;

 private:
  std::string name_;
};

class MarchCaster final : public HostCaster {
 public:
  MarchCaster(const Scans& scans, double cell)
      : HostCaster(scans, fmt::format("distance field, {:g} mm", 1e3 * cell)),
        clear_(measure(scans.world, cell, thread_pool_)) {}

  void cast(std::size_t round) override {
    const auto range_max = static_cast<float>(scans_.laser.range_max);
    each([&](std::size_t i) {
      const base::Pose X = scans_.X_WS(round, i);
      const auto c = static_cast<float>(std::cos(X.yaw)), s = static_cast<float>(std::sin(X.yaw));
      const auto x = static_cast<float>(X.x), y = static_cast<float>(X.y);
      for (std::size_t k = 0; k < scans_.beams.size(); ++k) {
        const auto bx = static_cast<float>(scans_.beams[k].x), by = static_cast<float>(scans_.beams[k].y);
        results_.ranges(i)[k] = march(clear_, x, y, c * bx - s * by, s * bx + c * by, range_max);
        results_.hits(i)[k] = 0;
      }
    });
  }

 private:
  Clearances clear_;
};

class PredictingCaster final : public HostCaster {
 public:
  PredictingCaster(const Scans& scans, const Caster& before, std::size_t round)
      : HostCaster(scans, "predicted from the scan before") {
    for (std::size_t i = 0; i < scans.robots(); ++i) {
      poses_.push_back(scans.X_WS(round, i));
      for (std::size_t k = 0; k < scans.beams.size(); ++k) ranges_.push_back(static_cast<float>(before.range(i, k)));
    }
  }

  void cast(std::size_t round) override {
    each([&](std::size_t i) { predict(i, scans_.X_WS(round, i)); });
  }

 private:
  void predict(std::size_t robot, const base::Pose& now) {
    const std::size_t beams = scans_.beams.size();
    const auto per_radian = static_cast<float>(static_cast<double>(beams - 1) / scans_.laser.fov);
    const auto half = static_cast<float>(0.5 * scans_.laser.fov);
    float* const out = results_.ranges(robot);
    std::fill(out, out + beams, HUGE_VALF);
    const base::Pose then = poses_[robot];
    const glm::dvec2 moved = base::rotate(-now.yaw, {then.x - now.x, then.y - now.y});
    const glm::dvec2 repeat = base::rotate(then.yaw - now.yaw, {1.0, 0.0});
    const auto c = static_cast<float>(repeat.x), s = static_cast<float>(repeat.y);
    for (std::size_t k = 0; k < beams; ++k) {
      const float r = ranges_[robot * beams + k];
      const float bx = r * static_cast<float>(scans_.beams[k].x), by = r * static_cast<float>(scans_.beams[k].y);
      const float x = static_cast<float>(moved.x) + c * bx - s * by, y = static_cast<float>(moved.y) + s * bx + c * by;
      const long beam = std::lround((std::atan2(y, x) + half) * per_radian);
      if (beam >= 0 && beam < static_cast<long>(beams)) out[beam] = std::min(out[beam], std::sqrt(x * x + y * y));
    }
    fill_gaps(out, beams);
    std::fill_n(results_.hits(robot), beams, 0u);
  }

  static void fill_gaps(float* out, std::size_t beams) {
    std::size_t last = beams;
    for (std::size_t k = 0; k < beams; ++k) {
      if (std::isinf(out[k])) continue;
      for (std::size_t j = last == beams ? 0 : last + 1; j < k; ++j) {
        const float part = last == beams ? 1.0f : static_cast<float>(j - last) / static_cast<float>(k - last);
        out[j] = last == beams ? out[k] : out[last] + part * (out[k] - out[last]);
      }
      last = k;
    }
    for (std::size_t j = last == beams ? 0 : last + 1; j < beams; ++j) out[j] = last == beams ? 0.0f : out[last];
  }

  std::vector<base::Pose> poses_;
  std::vector<float> ranges_;
};

/// Creates a caster with 32-bit sphere tracing through a grid of distances to the nearest wall: a ray ends in the first
/// cell that a wall touches (J. C. Hart, "Sphere tracing", The Visual Computer 12, 1996). `scans` must outlive it.
/// @param cell [m]
std::unique_ptr<Caster> make_march_caster(const Scans& scans, double cell) {
  return std::make_unique<MarchCaster>(scans, cell);
}

/// Creates a caster that predicts without casting: it transforms the previous, error-free scan to the robot's new pose
/// and connects its points with straight lines. `before` provides that scan and must outlive it.
std::unique_ptr<Caster> make_predicting_caster(const Scans& scans, const Caster& before, std::size_t round_before) {
  return std::make_unique<PredictingCaster>(scans, before, round_before);
}

constexpr double kCells[] = {0.03, 0.1};  // [m] of distance grids

struct AccuracyModeResult : Timing {
  double median = 0.0, p99 = 0.0, max = 0.0;  ///< [m] errors
};

AccuracyModeResult entry_of(const MethodResult& method_result, const Caster& caster, const Caster& exact,
                            const Scans& scans) {
  AccuracyModeResult entry{method_result};
  std::vector<double> errors;
  for (std::size_t i = 0; i < scans.robots(); ++i)
    for (std::size_t k = 0; k < scans.beams.size(); ++k)
      errors.push_back(std::abs(caster.range(i, k) - exact.range(i, k)));
  std::sort(errors.begin(), errors.end());
  entry.median = errors[errors.size() / 2];
  entry.p99 = errors[errors.size() * 99 / 100];
  entry.max = errors.back();
  return entry;
}

}  // namespace

Report compare_accuracy_modes(gpu::Device& device, std::uint32_t robots, double range, std::size_t repeats) {
  std::deque<Scans> scans;
  std::vector<std::unique_ptr<Caster>> casters;
  for (const sensors::AccuracyMode& mode : sensors::kLaserModes) {
    scans.push_back(make_scans("cave", load_cave(), robots, scenes::laser(361, M_PI, range)));
    sensors::set_accuracy(scans.back().world, std::string(mode.word));
    casters.push_back(make_farm_caster(scans.back(), device, std::string(mode.word)));
  }
  for (const double cell : kCells) casters.push_back(make_march_caster(scans.front(), cell));
  const std::size_t last = (repeats - 1) % scans.front().rounds.size();
  const auto before = make_farm_caster(scans.front(), device, "before");
  before->cast((last + scans.front().rounds.size() - 1) % scans.front().rounds.size());
  casters.push_back(make_predicting_caster(scans.front(), *before,
                                           (last + scans.front().rounds.size() - 1) % scans.front().rounds.size()));

  const Comparison comparison = compare(scans.front(), casters, "exact", repeats);
  std::vector<AccuracyModeResult> results;
  for (std::size_t i = 0; i < casters.size(); ++i)
    results.push_back(entry_of(comparison.method_results[i], *casters[i], *casters.front(), scans.front()));
  Report report{"accuracy_modes", "",
                "robots,range_m,method,cpu_ms,wall_ms,cpu_ratio,ratio,median_error_m,p99_error_m,max_error_m"};
  report.text = fmt::format(
      "\n{} robots, {:g} m\n\n| | cpu ms | clock ms | exact / it, by cpu and clock | median error | 99 % | largest |\n"
      "|---|---|---|---|---|---|---|\n",
      robots, range);
  const auto csv = [&](const AccuracyModeResult& e) {
    return fmt::format("{},{:g},\"{}\",{:.3f},{:.3f},{:.3f},{:.3f},{:.3g},{:.3g},{:.3g}\n", robots, range, e.method,
                       1e3 * e.typical.cpu_s, 1e3 * e.typical.wall_s, e.cpu_ratio, e.ratio, e.median, e.p99, e.max);
  };
  add_methods(report, results, csv, [](const AccuracyModeResult& e) {
    return fmt::format("| {} | {:.1f} | {:.1f} | {:.2f}, {:.2f} | {:.2g} m | {:.2g} m | {:.2g} m |\n", e.method,
                       1e3 * e.typical.cpu_s, 1e3 * e.typical.wall_s, e.cpu_ratio, e.ratio, e.median, e.p99, e.max);
  });
  return report;
}

}  // namespace sf::bench
