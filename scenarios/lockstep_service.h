#pragma once
// `serve --lockstep` without its command line: a simulation whose robots are driven by other processes.
//
//   LockstepService service(world, device, {});
//   service.run(stop, 0.0);        // by the system clock; or, by any clock:
//   service.advance(now);

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "base/contact_onset.h"
#include "base/tick_record.h"
#include "scenarios/simulation.h"
#include "server/lockstep.h"
#include "server/no_return_filter.h"

namespace sf::scenarios {

struct LockstepServiceOptions {
  server::LockstepOptions lockstep;
  std::uint64_t seed = 1;  ///< of noise
  unsigned threads = 0;    ///< 0: all. Does not affect results
  bool no_return_inf = false;
};

/// `world` and `device` must outlive it. One thread at a time. Times [ns] are on one monotonic clock; no result depends
/// on it.
class LockstepService {
 public:
  /// Simulates tick 0.
  /// @throws netio::PortInUse, base::InputError if the address cannot be bound
  LockstepService(const world::World& world, gpu::Device& device, const LockstepServiceOptions& options);

  /// Writes each tick to `sink`, starting with the current one. `sink` must outlive the service. If it throws
  /// base::InputError, it receives no more ticks; robots are still served.
  void record_to(base::Sink& sink);

  /// Serves until `stop` is set or `duration` [s] have passed (0: no limit).
  void run(const std::atomic<bool>& stop, double duration);

  /// Processes received packets, and simulates one tick if all processes have requested it.
  /// @return whether it did
  bool advance(std::int64_t now);

  const Simulation& simulation() const { return simulation_; }
  server::Lockstep& lockstep() { return lockstep_; }
  std::uint64_t ticks() const { return record_.tick + 1; }  ///< simulated, tick 0 included
  double wall_seconds() const { return wall_s_; }           ///< [s] spent in `run`
  std::uint64_t contacts() const { return contacts_; }      ///< number of robot contacts that began
  const std::string& recording_error() const { return recording_error_; }

 private:
  void simulate(std::int64_t now);
  void record();

  const world::World& world_;
  Simulation simulation_;
  server::NoReturnFilter no_return_filter_;
  server::Lockstep lockstep_;
  base::TickRecord record_;  ///< of the current tick
  base::Sink* sink_ = nullptr;
  std::string recording_error_;
  std::vector<base::ContactOnset> onsets_;  ///< per mover
  std::uint64_t contacts_ = 0;
  double wall_s_ = 0.0;
};

}  // namespace sf::scenarios
