#include "bench/approximations.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/reading.h"
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

}  // namespace

std::unique_ptr<Caster> make_march_caster(const Scans& scans, double cell) {
  return std::make_unique<MarchCaster>(scans, cell);
}

std::unique_ptr<Caster> make_predicting_caster(const Scans& scans, const Caster& before, std::size_t round_before) {
  return std::make_unique<PredictingCaster>(scans, before, round_before);
}

}  // namespace sf::bench
