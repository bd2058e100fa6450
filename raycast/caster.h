#pragma once
// Interface of casters, which find the nearest surface along each beam of the due scans. `RayCaster` plans the scans;
// casters read its plan and beams and fill in its results. Each function is called once per tick, never per beam.
//
// Sequence of a tick: `place`, then `prepare`. Casters on the host fill in the results in `prepare`. For casters on the
// device, `add_copies` and `record` follow, into a batch, and `collect` after that batch.

#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "gpu/batch.h"
#include "raycast/cast_plan.h"
#include "raycast/cast_results.h"
#include "raycast/cast_uploads.h"
#include "raycast/sensor_context.h"
#include "raycast/viewpoint.h"
#include "world/world.h"

namespace sf::raycast {

/// The due scans of one tick.
struct DueScans {
  std::vector<DueSample> samples;  ///< rows of scanners
  std::vector<Viewpoint> views;    ///< one per sample
};

/// Arguments of a caster's constructor. The device, thread pool and states of `context`, and all other members except
/// `context` and `world`, must outlive the caster.
struct CasterInputs {
  const SensorContext& context;
  const world::World& world;  ///< the visible geometry
  const CastPlan& plan;
  CastUploads& uploads;
  CastResults& results;
};

/// Not thread-safe.
class Caster {
 public:
  virtual ~Caster() = default;
  Caster(const Caster&) = delete;
  Caster& operator=(const Caster&) = delete;

  /// Moves the movers to this tick's poses. Call before `prepare`.
  virtual void place() = 0;
  /// Replaces the outlines of the movers; lists of walls stay. Call `place` before the next `prepare`.
  /// @param world the world of construction, except for its movers' bodies and radii
  /// @return false, without changes, if the tables are too small: make another caster
  virtual bool update_outlines(const world::World& world) = 0;
  /// Casts the due scans on the host, or prepares the kernels that cast them.
  /// @param cast false skips scans on the host; the caller does not record a cast, and reads only the beams' directions
  /// @return true if kernels must be recorded again
  virtual bool prepare(const DueScans& due, bool cast) = 0;
  /// Records the kernels. The default records none.
  virtual void record(gpu::Batch& batch);
  /// Records copies of the caster's own tables and of results. The default copies all due results to the device, for
  /// kernels of other modules.
  /// @param results also copies the device's ranges and hits to the host
  virtual void add_copies(gpu::Batch& batch, const DueScans& due, bool results);
  /// Reads the device's beam flags. Called after each batch. The default does nothing.
  virtual void collect(const DueScans& due);
  /// Returns the counters since construction, except `rays`.
  virtual SensorStats stats() const = 0;

 protected:
  explicit Caster(const CasterInputs& in);

  const ScannerRow& row_of(const DueSample& due) const { return plan_.rows[due.row]; }

  base::ThreadPool& thread_pool_;
  const std::span<const base::Report> states_;  ///< of all movers, in this tick
  const CastPlan& plan_;
  CastUploads& uploads_;
  CastResults& results_;
};

}  // namespace sf::raycast
