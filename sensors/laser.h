#pragma once
// The laser range finder: all lasers of all movers, a batch at a time.
//
// Ranges are exact: the nearest surface along each beam, from either side, decided in 64 bits against the segments of
// the world, within 1e-8 m of real arithmetic. A beam that meets nothing within range_max reads range_max. A surface
// that touches the sensor (within SF_TOUCH along the beam) stops beams that go into it, which read 0, not beams that
// leave it. A sensor inside a solid reads the way out of it. The mover that carries the sensor is never seen.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "base/reading.h"
#include "gpu/batch.h"
#include "sensors/scene/scene.h"
#include "world/world.h"

namespace sf::sensors {

/// One laser that is due.
struct LaserDue {
  std::uint32_t row = 0;       ///< in `Lasers::owners()`
  std::uint64_t sequence = 0;  ///< counts this laser's readings; names its noise
};

/// Which laser a row is.
struct LaserOwner {
  std::uint32_t mover = 0;
  std::uint32_t sensor = 0;
};

struct LaserOptions {
  std::uint64_t seed = 0;
  bool noise = true;  ///< false: none, whatever the world says
};

/// Tables of all lasers of a world. One thread at a time.
class Lasers {
 public:
  /// @throws base::DeviceError when the device cannot hold the tables.
  Lasers(const world::World& world, Scene& scene, gpu::Device& device, base::Workers& workers,
         const LaserOptions& options);
  ~Lasers();

  const std::vector<LaserOwner>& owners() const;
  std::uint64_t rays() const;    ///< cast since the start
  std::uint64_t doubts() const;  ///< lanes of four beams in which 32 bits did not prove the winner

  /// Host work before the batch: where sensors are and what they may meet. `poses`: one per mover, already placed in
  /// the scene.
  /// @return true when the batch must be recorded again.
  bool prepare(std::span<const LaserDue> due, std::span<const Pose> poses);
  void record(gpu::Batch& batch);
  void copies(gpu::Batch& batch);
  /// Host work after the batch: appends one block per due laser (its mover's and own poses, ranges, hits; the caller
  /// fills in time and sequence). Spans live until the next `prepare`.
  void collect(std::vector<base::ReadingBlock>& out);

 private:
  struct Tables;
  std::unique_ptr<Tables> t_;
};

}  // namespace sf::sensors
