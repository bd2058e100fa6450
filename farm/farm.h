#pragma once
// The tick: reports in, one batch on the device, readings out.
//
//   farm.hear_all();
//   while (running) {
//     readings = farm.tick(now, reports);   // in, up, run, down, out
//     for (reading : readings) send(reading);
//   }
//
// No sockets, no clock, no window: the same calls in the same order give the same bytes, on one device.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "base/reading.h"
#include "base/report.h"
#include "gpu/device.h"
#include "sensors/scene/scene.h"
#include "world/world.h"

namespace sf::farm {

struct FarmOptions {
  std::uint64_t seed = 0;  ///< of all noise
  bool noise = true;       ///< false: none, whatever the world says
  unsigned threads = 0;    ///< for the host's part; 0: as many as the machine has. Never changes a reading
  sensors::SceneOptions scene;
};

/// What the ticks so far cost and did.
struct FarmStats {
  std::uint64_t ticks = 0;
  std::uint64_t rays = 0;
  std::uint64_t readings = 0;
  std::uint64_t doubts = 0;       ///< lanes of four beams that 32 bits could not prove
  std::uint64_t cells_built = 0;  ///< lists made
  double place_s = 0.0;           ///< [s] host: movers' outlines
  double lists_s = 0.0;           ///< [s] host: what each sensor may meet
  double device_s = 0.0;          ///< [s] submit to done
  double collect_s = 0.0;         ///< [s] host: noise, interpolation, delivery
};

/// Not thread-safe. `world` and `device` must outlive it.
class Farm {
 public:
  Farm(const world::World& world, gpu::Device& device, const FarmOptions& options = {});
  ~Farm();

  /// Which movers' sensors are computed: nobody's at first.
  void hear(std::uint32_t mover, bool heard);
  void hear_all();

  /// Computes every heard sensor that is due at `now` and returns what is delivered at `now` (latency may delay a
  /// reading). Movers without a report stay where they were. A sensor is due at phase + k / rate for k = 0, 1, ...: at
  /// most once a tick, at the first tick not before that time.
  /// @param now [ns] simulated time; does not go back.
  /// @return blocks that live until the next tick.
  std::span<const base::ReadingBlock> tick(std::int64_t now, std::span<const base::Report> reports);

  /// Computes one laser at once, due or not, as if its mover stood at `X_WM`; noise off unless the options say so.
  base::ReadingBlock sense(std::uint32_t mover, std::uint32_t sensor, const base::Pose& X_WM);

  /// Hash of all readings delivered so far, in order.
  std::uint64_t hash() const;
  FarmStats stats() const;

 private:
  struct State;
  std::unique_ptr<State> s_;
};

}  // namespace sf::farm
