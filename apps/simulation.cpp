#include "apps/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "control/wander.h"

namespace sf::apps {

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

farm::FarmOptions farm_options(std::uint64_t seed, unsigned threads) {
  farm::FarmOptions options;
  options.seed = seed;
  options.threads = threads;
  return options;
}

}  // namespace

Simulation::Simulation(const world::World& world, gpu::Device& device, std::uint64_t seed, unsigned threads)
    : world_(world),
      farm_(world, device, farm_options(seed, threads)),
      fleet_(world),
      workers_(threads),
      commands_(world.movers.size()),
      obeyed_(world.movers.size()),
      first_(world.movers.size() + 1),
      interval_(std::llround(world.interval * 1e9)) {
  farm_.hear_all();
  for (std::uint32_t i = 0; i < world.movers.size(); ++i) {
    const world::Mover& mover = world.movers[i];
    controllers_.push_back(mover.is_tag ? nullptr : std::make_unique<control::Wander>(mover, i, seed));
  }
  sorted_.reserve(farm_.roster().count());
}

base::TickRecord Simulation::step() {
  const std::int64_t time = static_cast<std::int64_t>(tick_) * interval_;
  if (tick_ > 0) move();
  const auto readings = farm_.tick(time, fleet_.reports());
  const auto start = std::chrono::steady_clock::now();
  sort_by_mover(readings);
  decide(time);
  move_s_ += seconds_since(start);
  return {tick_++, time, fleet_.reports(), obeyed_, fleet_.contacts(), readings};
}

void Simulation::move() {
  const auto start = std::chrono::steady_clock::now();
  fleet_.move(commands_, interval_);
  obeyed_ = commands_;
  move_s_ += seconds_since(start);
}

void Simulation::sort_by_mover(std::span<const base::ReadingBlock> readings) {
  std::fill(first_.begin(), first_.end(), 0u);
  for (const base::ReadingBlock& r : readings) ++first_[r.mover + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  sorted_.resize(readings.size());
  // Fills each mover's range from its start; afterwards first_[m] is its end, which is where the next one starts.
  for (const base::ReadingBlock& r : readings) sorted_[first_[r.mover]++] = r;
}

void Simulation::decide(std::int64_t time) {
  workers_.run(controllers_.size(), 16, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t m = begin; m < end; ++m) {
      if (!controllers_[m]) continue;
      const std::uint32_t first = m == 0 ? 0 : first_[m - 1];
      const std::span<const base::ReadingBlock> own{sorted_.data() + first, first_[m] - first};
      // A controller runs at its lasers' rate: between readings the last command stands, unless the bumper speaks.
      const bool contact = fleet_.contacts()[m] != 0;
      const bool looked =
          std::any_of(own.begin(), own.end(), [](const base::ReadingBlock& r) { return r.kind == base::kLaser; });
      if (!looked && !contact && !world_.movers[m].lasers.empty()) continue;
      commands_[m] = controllers_[m]->step({time, fleet_.reports()[m], own, contact});
    }
  });
}

}  // namespace sf::apps
