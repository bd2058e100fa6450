#include "farm/farm.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "farm/delivery.h"
#include "farm/schedule.h"
#include "gpu/batch.h"
#include "sensors/laser.h"

namespace sf::farm {

namespace {

using Clock = std::chrono::steady_clock;

/// Adds the time since the last mark to a counter: for statistics only, never for results.
class Stopwatch {
 public:
  void lap(double& total) {
    const auto now = Clock::now();
    total += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  Clock::time_point last_ = Clock::now();
};

}  // namespace

struct Farm::State {
  const world::World& world;
  base::Workers workers;
  sensors::Scene scene;
  sensors::Lasers lasers;
  gpu::Batch batch;
  Delivery delivery;
  std::vector<base::Pose> poses;     ///< per mover
  std::vector<bool> heard;           ///< per mover
  std::vector<std::uint64_t> begun;  ///< per laser row: readings begun
  std::vector<sensors::LaserDue> due;
  std::vector<base::ReadingBlock> blocks;
  std::vector<std::uint64_t> hashes;  ///< of the readings of one tick
  FarmStats stats;
  std::uint64_t hash = 0;

  State(const world::World& w, gpu::Device& device, const FarmOptions& options)
      : world(w),
        workers(options.threads),
        scene(w, device, workers, options.scene),
        lasers(w, scene, device, workers, {options.seed, options.noise}),
        batch(device),
        delivery(w),
        heard(w.movers.size(), false),
        begun(lasers.owners().size(), 0) {
    for (const world::Mover& mover : w.movers) poses.push_back(mover.X_WM);
    due.reserve(begun.size());
    blocks.reserve(begun.size());
    hashes.reserve(begun.size());
  }

  void find_due(std::int64_t now);
  void measure(std::int64_t now);
  void add_to_hash(std::span<const base::ReadingBlock> readings);
};

void Farm::State::find_due(std::int64_t now) {
  due.clear();
  for (std::uint32_t row = 0; row < begun.size(); ++row) {
    const sensors::LaserOwner owner = lasers.owners()[row];
    const world::Laser& laser = world.movers[owner.mover].lasers[owner.sensor];
    const std::uint64_t should = readings_begun(now, laser.rate, laser.phase);
    if (should <= begun[row]) continue;
    begun[row] = should;
    // A sensor's readings are numbered by when they are due: one that nobody heard leaves a gap, and its noise to
    // itself.
    if (heard[owner.mover]) due.push_back({row, should - 1});
  }
}

void Farm::State::measure(std::int64_t now) {
  blocks.clear();
  if (due.empty()) return;
  Stopwatch watch;
  scene.place(poses);
  watch.lap(stats.place_s);
  if (lasers.prepare(due, poses)) {
    batch.begin();
    lasers.record(batch);
    batch.end();
  }
  scene.upload(batch);
  lasers.copies(batch);
  watch.lap(stats.lists_s);
  batch.run();
  watch.lap(stats.device_s);
  lasers.collect(blocks);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    blocks[i].time = now;
    blocks[i].sequence = static_cast<std::uint32_t>(due[i].sequence);
    blocks[i].X_WM = poses[blocks[i].mover];
  }
  watch.lap(stats.collect_s);
}

void Farm::State::add_to_hash(std::span<const base::ReadingBlock> readings) {
  hashes.resize(readings.size());
  workers.run(readings.size(), 16, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const base::ReadingBlock& r = readings[i];
      const std::uint64_t head[] = {r.mover, r.sensor, r.sequence, static_cast<std::uint64_t>(r.time)};
      hashes[i] = base::hash_bytes(head, sizeof head);
      hashes[i] = base::hash_bytes(r.values.data(), r.values.size_bytes(), hashes[i]);
      hashes[i] = base::hash_bytes(r.hits.data(), r.hits.size_bytes(), hashes[i]);
    }
  });
  hash = base::hash_bytes(hashes.data(), hashes.size() * sizeof hashes[0], hash);
}

Farm::Farm(const world::World& world, gpu::Device& device, const FarmOptions& options)
    : s_(std::make_unique<State>(world, device, options)) {}

Farm::~Farm() = default;

void Farm::hear(std::uint32_t mover, bool heard) { s_->heard.at(mover) = heard; }
void Farm::hear_all() { std::fill(s_->heard.begin(), s_->heard.end(), true); }

std::span<const base::ReadingBlock> Farm::tick(std::int64_t now, std::span<const base::Report> reports) {
  State& s = *s_;
  for (const base::Report& report : reports) {
    const base::Pose& X = report.X_WM;
    SF_CHECK(std::isfinite(X.x + X.y + X.yaw), "the pose of mover " + std::to_string(report.mover) + " is not finite");
    s.poses.at(report.mover) = X;
  }
  s.find_due(now);
  s.measure(now);
  Stopwatch watch;
  const auto delivered = s.delivery.deliver(now, s.blocks);
  s.add_to_hash(delivered);
  watch.lap(s.stats.collect_s);
  ++s.stats.ticks;
  s.stats.readings += delivered.size();
  return delivered;
}

base::ReadingBlock Farm::sense(std::uint32_t mover, std::uint32_t sensor, const base::Pose& X_WM) {
  State& s = *s_;
  const auto& owners = s.lasers.owners();
  const auto row = std::find_if(owners.begin(), owners.end(),
                                [&](const sensors::LaserOwner& o) { return o.mover == mover && o.sensor == sensor; });
  SF_CHECK(row != owners.end(), "mover " + std::to_string(mover) + " has no sensor " + std::to_string(sensor));
  const base::Pose stands = std::exchange(s.poses[mover], X_WM);
  s.due.assign(1, {static_cast<std::uint32_t>(row - owners.begin()), 0});
  s.measure(0);
  s.poses[mover] = stands;
  return s.blocks.front();
}

std::uint64_t Farm::hash() const { return s_->hash; }

FarmStats Farm::stats() const {
  FarmStats stats = s_->stats;
  stats.rays = s_->lasers.rays();
  stats.doubts = s_->lasers.doubts();
  stats.cells_built = s_->scene.counts().cells_built;
  return stats;
}

}  // namespace sf::farm
