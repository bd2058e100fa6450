#pragma once
// The interface of casters, which find the nearest surface along each beam of the scans that are due. `RayCaster` plans
// the scans; casters read its plan and its beams, and fill in its results. Every call is one per tick, none per beam.
//
// A tick: `place`, `prepare`, then, for casters on the device, `add_copies` and `record` into a batch, `collect` after
// it. Casters on the host have filled in the results when `prepare` returns.

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

/// The scans of one tick.
struct DueScans {
  std::vector<DueSample> samples;  ///< rows of scanners
  std::vector<Viewpoint> views;    ///< one per sample
};

/// What a caster is made from. All but `context` and `world` must outlive it; so must the device, thread pool and
/// states of `context`.
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

  /// Moves the movers to this tick's poses, before `prepare`.
  virtual void place() = 0;
  /// Casts the due scans on the host, or prepares the kernels that cast them.
  /// @param cast false: no scan on the host; the caller records no cast, and reads the beams' directions alone
  /// @return true when kernels must be recorded again
  virtual bool prepare(const DueScans& due, bool cast) = 0;
  /// Records the kernels. Default: none.
  virtual void record(gpu::Batch& batch);
  /// Adds copies of the caster's own tables and of results. Default: of all due results, to the device, for kernels of
  /// others.
  /// @param results copies the device's ranges and hits to the host
  virtual void add_copies(gpu::Batch& batch, const DueScans& due, bool results);
  /// Takes in the device's beam flags after each batch. Default: none.
  virtual void collect(const DueScans& due);
  /// Counters since construction, without `rays`.
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
