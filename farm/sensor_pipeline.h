#pragma once
// One kind of sensor at work: its instruments, which of its sensors are due, and which of these must look.

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
  std::unique_ptr<sensors::SensorBackend> backend;
  ReadingCache cache;
  std::vector<std::uint64_t> started;  ///< per row: readings begun
  std::vector<std::int64_t> next;      ///< [ns] per row: when the one after these is due
  std::vector<sensors::DueSample> due;
  std::vector<sensors::DueSample> to_measure;  ///< of those due: whose reading cannot be given again
  bool active = false;                         ///< someone has looked: its kernels belong to the batch
  bool idle = true;                            ///< the instruments know that nothing is due
  bool uploaded = true;                        ///< so do the tables on the device, as far as kernels are in use

  /// @param site of all kinds. @param group of the farm's roster.
  SensorPipeline(const sensors::SensorContext& context, const sensors::SensorSet::Group& group);

  bool derived() const { return group->kind->derived; }
  /// What of this kind is due at `now` [ns]. @param heard per mover: bits of kinds.
  /// @return how many readings were due before, are newer ones' now and were never taken.
  std::uint64_t find_due(std::int64_t now, std::span<const std::uint32_t> subscribed);
  /// [ns] When the next heard sensor is due; kNever: none is heard.
  std::int64_t next_due(std::span<const std::uint32_t> subscribed) const;
  /// Splits what is due. @param again whether readings may be given again.
  void split(bool reuse);
  /// @return true when the batch must be recorded again.
  bool prepare(std::span<const base::Pose> poses);
  /// Whether the batch has something to do for this kind.
  bool needs_device() const { return !to_measure.empty() && backend->on_device(); }
  void add_copies(gpu::Batch& batch);
  /// Appends the readings of all that are due, in order. @return how many are given again.
  std::size_t collect(std::int64_t now, std::span<const base::Pose> poses, std::vector<base::ReadingBlock>& blocks);
  /// Takes note of what `collect` appended last: those that looked may be given again later.
  void store(std::span<const base::ReadingBlock> blocks);
};

}  // namespace sf::farm
