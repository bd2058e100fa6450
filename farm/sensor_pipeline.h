#pragma once
// State of one sensor type: its backend, its due sensors, and the sensors to measure.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "farm/reading_cache.h"
#include "gpu/batch.h"
#include "sensors/sensor_set.h"

namespace sf::farm {

struct SensorPipeline {
  const sensors::SensorSet::Group* group = nullptr;
  std::unique_ptr<sensors::SensorBackend> backend;  ///< null: a derived type
  ReadingCache cache;
  raycast::Episodes episodes;
  std::vector<double> sigmas;  ///< SensorSpec::sigma per row; empty: no sensor is noisy
  /// The due times of consecutive sensors of one copy of the world with the same rate and phase.
  struct Timing {
    double rate, phase;        ///< [Hz], [s]
    std::uint64_t started;     ///< readings of each sensor
    std::int64_t next;         ///< [ns] due time of the next reading
    std::uint32_t first, end;  ///< rows
    std::uint32_t mover;       ///< the first
  };
  std::vector<Timing> timings;
  std::vector<std::uint32_t> movers;     ///< per row
  std::span<const std::uint8_t> needed;  ///< per row: due without a subscription, as an input of a derived sensor; may
                                         ///< be empty
  std::vector<sensors::DueSample> due;
  std::vector<sensors::DueSample> to_measure;  ///< due sensors without a reusable reading
  std::vector<base::ReadingBlock> blocks;      ///< readings of all due sensors, in order
  bool active = false;                         ///< its kernels are recorded in the batch; true from its first
                                               ///< measurement on
  bool idle = true;                            ///< no sensor was due when the backend was last prepared
  bool uploaded = true;                        ///< the device's tables match that preparation, as far as the kernels
                                               ///< are recorded

  /// @param group must outlive it @param measures false: there is no backend, only due times
  SensorPipeline(const sensors::SensorContext& context, const sensors::SensorSet::Group& group, bool measures = true);

  /// Rows are in order of movers.
  template <class Visit>
  void for_rows_of(std::uint32_t mover, Visit&& visit) const {
    const auto before = [](const sensors::SensorSpec& row, std::uint32_t m) { return row.mover < m; };
    auto row = std::lower_bound(group->rows.begin(), group->rows.end(), mover, before);
    for (; row != group->rows.end() && row->mover == mover; ++row)
      visit(static_cast<std::uint32_t>(row - group->rows.begin()));
  }
  /// Continues from the pipeline before a new mover: its sensors are the first rows of this one.
  /// @param before its backend must not be used afterwards, but its readings may; null: there was none
  /// @param last_tick, last_call [ns] of the farm's last tick, and of that or a later sample; -1: there was none
  void go_on(SensorPipeline* before, std::int64_t last_tick, std::int64_t last_call);
  /// Restarts the due times of a copy of the world at the start of its episode. @param first, end its movers
  void restart(std::uint32_t first, std::uint32_t end);
  bool derived() const { return group->type->derived_from != 0; }
  bool computed() const { return backend == nullptr; }
  bool is_wanted(std::uint32_t row, std::span<const base::SensorTypes> subscribed) const {
    return (subscribed[movers[row]] & base::only(group->type->id)) != 0 || (!needed.empty() && needed[row] != 0);
  }
  /// Finds the sensors of this type that are due at `now` [ns].
  /// @param subscribed per mover
  /// @return number of readings of subscribed sensors that were due before, are superseded at `now` and were never
  /// measured
  std::uint64_t find_due(std::int64_t now, std::span<const base::SensorTypes> subscribed);
  /// Returns the due time [ns] of the next subscribed sensor; kNever: none.
  std::int64_t next_due(std::span<const base::SensorTypes> subscribed) const;
  /// Splits the due sensors. @param reuse whether cached readings may be used
  void split(bool reuse);
  /// @return true if the batch must be recorded again
  bool prepare();
  /// Returns whether the batch has work for this sensor type.
  bool needs_device() const { return !to_measure.empty() && backend->on_device(); }
  void add_copies(gpu::Batch& batch);
  /// Fills `blocks`. @return number of reused readings
  std::size_t collect(std::int64_t now, std::span<const base::Report> states, base::ThreadPool& thread_pool);
  /// Offers the measured readings of `blocks` to the cache.
  void store();
};

}  // namespace sf::farm
