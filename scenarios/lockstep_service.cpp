#include "scenarios/lockstep_service.h"

#include <algorithm>
#include <chrono>

#include "base/elapsed.h"
#include "base/error.h"

namespace sf::scenarios {

namespace {

constexpr int kLongestWait = 100;  ///< [ms] interval at which stop requests and timeouts are checked

SimulationOptions lockstep_simulation(const LockstepServiceOptions& options) {
  return {.seed = options.seed,
          .threads = options.threads,
          .actor = {.controller = {.name = ""}},
          .no_return_inf = options.no_return_inf};
}

}  // namespace

LockstepService::LockstepService(const world::World& world, gpu::Device& device, const LockstepServiceOptions& options)
    : world_(world),
      simulation_(world, device, lockstep_simulation(options)),
      no_return_filter_(simulation_.farm().sensor_set(), options.no_return_inf),
      lockstep_(world, simulation_.farm().sensor_set(), options.lockstep),
      onsets_(world.movers.size()) {
  simulate(0);
}

void LockstepService::simulate(std::int64_t now) {
  record_ = simulation_.step();
  record_.readings = no_return_filter_.apply(record_.readings);
  for (std::size_t m = 0; m < onsets_.size(); ++m)
    contacts_ += !world_.movers[m].is_tag && onsets_[m].begins(record_.contacts[m] != 0) ? 1 : 0;
  lockstep_.publish(record_, now);
  record();
}

void LockstepService::record() {
  if (sink_ == nullptr) return;
  try {
    sink_->write(record_);
  } catch (const base::InputError& error) {
    sink_ = nullptr;
    recording_error_ = error.what();
  }
}

void LockstepService::record_to(base::Sink& sink) {
  sink_ = &sink;
  record();
}

bool LockstepService::advance(std::int64_t now) {
  lockstep_.receive(now);
  if (!lockstep_.ready()) return false;
  simulation_.command(lockstep_.commands());
  simulate(now);
  return true;
}

void LockstepService::run(const std::atomic<bool>& stop, double duration) {
  const auto start = std::chrono::steady_clock::now();
  simulation_.interrupt_on([&stop] { return stop.load(); });
  try {
    for (wall_s_ = 0.0; !stop && (duration <= 0.0 || wall_s_ < duration); wall_s_ = base::seconds_since(start)) {
      if (advance(static_cast<std::int64_t>(1e9 * wall_s_))) continue;
      const double left = duration > 0.0 ? 1e3 * (duration - wall_s_) : kLongestWait;
      lockstep_.wait(static_cast<int>(std::clamp(left, 1.0, double{kLongestWait})));
    }
  } catch (const base::Interrupted&) {
    // The tick takes too long: abandon it.
  }
  simulation_.interrupt_on({});
}

}  // namespace sf::scenarios
