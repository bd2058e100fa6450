#include "bench/grid.h"

#include <algorithm>

namespace sf::bench {

namespace {

constexpr double kPad = 1e-7;  ///< [m] larger than the rounding error of the traversal

class GridCaster final : public Caster {
 public:
  GridCaster(const Scans& scans, std::string name, Walk walk)
      : scans_(scans), name_(std::move(name)), walk_(walk), results_(scans) {
    // The fastest of 1/16, 1/8, 1/4, 1/2 and 1 m in the cave: small cells need more steps, large ones more intersection
    // tests.
    grid_ = make_grid(scans.world, scans.world.movers[0].X_WM.z + scans.laser.X_MS.z, 0.5);
  }

  std::string name() const override { return name_; }
  void poison() override { results_.poison(); }
  void cast(std::size_t round) override {
    thread_pool_.parallel_for(scans_.robots(), kRobotsPerPiece, [&](std::size_t first, std::size_t last, unsigned) {
      for (std::size_t i = first; i < last; ++i)
        walk_(grid_, scans_.X_WS(round, i), scans_.beams, scans_.laser.range_max, results_.ranges(i), results_.hits(i));
    });
  }
  std::size_t unwritten() const override { return results_.unwritten(); }
  double range(std::size_t robot, std::size_t beam) const override { return results_.range(robot, beam); }
  std::uint64_t hash() const override { return results_.hash(); }

 private:
  const Scans& scans_;
  std::string name_;
  Walk walk_;
  Results<double> results_;
  SegmentGrid grid_;
  base::ThreadPool thread_pool_;
};

}  // namespace

SegmentGrid make_grid(const world::World& world, double z, double cell) {
  SegmentGrid grid;
  grid.x = world.extent.x_min - cell;
  grid.y = world.extent.y_min - cell;
  grid.cell = cell;
  grid.columns = static_cast<int>((world.extent.x_max - grid.x) / cell) + 2;
  grid.rows = static_cast<int>((world.extent.y_max - grid.y) / cell) + 2;

  // Two passes: the first counts, the second fills.
  std::vector<std::uint32_t> next(static_cast<std::size_t>(grid.columns) * grid.rows + 1, 0);
  const auto each = [&](auto put) {
    for (const world::Segment& s : world.walls) {
      if (!s.seen_by_laser || z < s.z_min || z >= s.z_max) continue;
      const auto index = [&](double value, int count) {
        return std::clamp(static_cast<int>(std::floor(value / cell)), 0, count - 1);
      };
      const int x1 = index(std::max(s.a.x, s.b.x) + kPad - grid.x, grid.columns);
      const int y1 = index(std::max(s.a.y, s.b.y) + kPad - grid.y, grid.rows);
      for (int y = index(std::min(s.a.y, s.b.y) - kPad - grid.y, grid.rows); y <= y1; ++y)
        for (int x = index(std::min(s.a.x, s.b.x) - kPad - grid.x, grid.columns); x <= x1; ++x)
          put(static_cast<std::size_t>(y) * grid.columns + x, s);
    }
  };
  each([&](std::size_t at, const world::Segment&) { ++next[at + 1]; });
  for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
  grid.first = next;
  grid.items.resize(next.back());
  each([&](std::size_t at, const world::Segment& s) {
    grid.items[next[at]++] = {s.a.x, s.a.y, s.b.x - s.a.x, s.b.y - s.a.y, s.model};
  });
  return grid;
}

std::unique_ptr<Caster> make_grid_caster(const Scans& scans, const std::string& name, Walk walk) {
  return std::make_unique<GridCaster>(scans, name, walk);
}

}  // namespace sf::bench
