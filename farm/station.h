#pragma once
// One kind of sensor at work: its instruments, which of its sensors are due, and which of these must look.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "farm/steady.h"
#include "gpu/batch.h"
#include "sensors/sensor_set.h"

namespace sf::farm {

struct Station {
  const sensors::SensorSet::Group* group = nullptr;
  std::unique_ptr<sensors::SensorBackend> backend;
  Steady steady;
  std::vector<std::uint64_t> begun;  ///< per row: readings begun
  std::vector<std::int64_t> next;    ///< [ns] per row: when the one after these is due
  std::vector<sensors::DueSample> due;
  std::vector<sensors::DueSample> looking;  ///< of those due: whose reading cannot be given again
  bool in_use = false;                      ///< someone has looked: its kernels belong to the batch
  bool at_rest = true;                      ///< the instruments know that nothing is due
  bool told = true;                         ///< so do the tables on the device, as far as kernels are in use

  /// @param site of all kinds. @param group of the farm's roster.
  Station(const sensors::SensorContext& context, const sensors::SensorSet::Group& group);

  bool derived() const { return group->kind->derived; }
  /// What of this kind is due at `now` [ns]. @param heard per mover: bits of kinds.
  /// @return how many readings were due before, are newer ones' now and were never taken.
  std::uint64_t find_due(std::int64_t now, std::span<const std::uint32_t> heard);
  /// [ns] When the next heard sensor is due; kNever: none is heard.
  std::int64_t next_due(std::span<const std::uint32_t> heard) const;
  /// Splits what is due. @param again whether readings may be given again.
  void split(bool again);
  /// @return true when the batch must be recorded again.
  bool prepare(std::span<const base::Pose> poses);
  /// Whether the batch has something to do for this kind.
  bool needs_device() const { return !looking.empty() && backend->on_device(); }
  void add_copies(gpu::Batch& batch);
  /// Appends the readings of all that are due, in order. @return how many are given again.
  std::size_t collect(std::int64_t now, std::span<const base::Pose> poses, std::vector<base::ReadingBlock>& blocks);
  /// Takes note of what `collect` appended last: those that looked may be given again later.
  void note(std::span<const base::ReadingBlock> blocks);
};

}  // namespace sf::farm
