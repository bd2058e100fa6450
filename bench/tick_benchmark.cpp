#include "bench/tick_benchmark.h"

#include "base/error.h"
#include "bench/poison.h"
#include "control/wander.h"
#include "sensors/laser.h"

namespace sf::bench {

namespace {

constexpr std::uint64_t kSeed = 7;
constexpr std::size_t kJudgedRobots = 12;

farm::FarmStats operator-(const farm::FarmStats& p, const farm::FarmStats& q) {
  farm::FarmStats d;
  d.ticks = p.ticks - q.ticks;
  d.readings = p.readings - q.readings;
  d.work = p.work - q.work;
  d.place_s = p.place_s - q.place_s;
  d.lists_s = p.lists_s - q.lists_s;
  d.device_s = p.device_s - q.device_s;
  d.collect_s = p.collect_s - q.collect_s;
  return d;
}

}  // namespace

TickBenchmark::TickBenchmark(const world::World& world, gpu::Device& device)
    : world_(world),
      farm_(world, device, {.reuse_unchanged = false}),
      fleet_(world, &thread_pool_),
      commands_(world.movers.size()),
      interval_(std::llround(1e9 / farm_.sensor_set().of(sensors::kLaser, 0)[0].rate)) {
  farm_.subscribe_all();
  for (std::uint32_t row = 0; row < world.movers.size(); ++row)
    controllers_.push_back(
        std::make_unique<control::Wander>(world.movers[row], farm_.sensor_set().of(sensors::kLaser, row), row, kSeed));
}

void TickBenchmark::tick(bool wander) {
  const double start = now().wall_s;
  if (wander) {
    decide();
    decide_s_ += now().wall_s - start;
    const double decided = now().wall_s;
    fleet_.move(commands_, interval_);
    move_s_ += now().wall_s - decided;
  }
  readings_ = farm_.tick(time_, fleet_.reports());
  time_ += interval_;
}

/// Every robot has one laser, so the index of its reading is its row.
void TickBenchmark::decide() {
  thread_pool_.parallel_for(readings_.size(), 16, [this](std::size_t first, std::size_t end, unsigned) {
    for (const base::ReadingBlock& reading : readings_.subspan(first, end - first)) {
      const std::uint32_t row = reading.mover;
      const control::ControllerInput input{time_, fleet_.reports()[row], {&reading, 1}, fleet_.contacts()[row] != 0};
      commands_[row] = controllers_[row]->step(input);
    }
  });
}

std::vector<base::Pose> TickBenchmark::poses() const {
  std::vector<base::Pose> poses;
  for (const base::Report& report : fleet_.reports()) poses.push_back(report.X_WM);
  return poses;
}

TickResult run_ticks(const std::string& scene, const world::World& world, gpu::Device& device, bool wander,
                     std::size_t warm_up, std::size_t ticks) {
  TickBenchmark fleet(world, device);
  const sensors::SensorSpec& laser = fleet.farm().sensor_set().of(sensors::kLaser, 0)[0];
  TickResult result{scene, wander ? "wandering" : "standing", world.movers.size(), world.movers.size() * laser.elements,
                    laser.limit};
  result.interval_s = 1e-9 * static_cast<double>(fleet.interval());
  for (std::size_t k = 0; k < warm_up; ++k) fleet.tick(wander);
  const farm::FarmStats before = fleet.farm().stats();
  const double move_before = fleet.move_s();
  const double decide_before = fleet.decide_s();

  for (std::size_t k = 0; k < ticks; ++k) {
    // Wandering robots need their readings; those of robots at rest are poisoned in every tick.
    if (!wander) poison(fleet.readings());
    const Cost start = now();
    fleet.tick(wander);
    result.ticks.push_back(since(start));
    SF_CHECK(unwritten(fleet.readings()) == 0, "the farm left rays unanswered");
  }
  const auto n = static_cast<double>(ticks);
  result.typical = median(result.ticks);
  result.stages = fleet.farm().stats() - before;
  result.move_s = (fleet.move_s() - move_before) / n;
  result.decide_s = (fleet.decide_s() - decide_before) / n;
  result.hash = hash_ranges(fleet.readings());
  result.accuracy = check_accuracy(fleet.readings(), world, fleet.poses(), kJudgedRobots);
  return result;
}

}  // namespace sf::bench
