#pragma once
// Computes learners' observations on the device, in the submission of the motion and the scans. The bytes are those of
// sensorfarm::Observations.

#include <cstdint>
#include <span>
#include <vector>

#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "robots/device/device_fleet.h"
#include "robots/device/observer_records.h"

namespace sf::robots {

/// Not thread-safe.
class DeviceObserver {
 public:
  struct Settings {
    std::vector<ObservedAgent> agents;    ///< at least one
    std::vector<ObservedSensor> sensors;  ///< as many of each agent, agent by agent
    std::uint32_t beams = 0;              ///< of each sensor
    std::uint32_t every = 1;              ///< > 0: beams 0, `every`, 2 `every`, ... are observed
    bool speeds = true;
    double goal_reach = 0.0;  ///< [m] 0: goals are measured, but not observed
    std::uint32_t stack = 1;  ///< > 0: observations of a row, the newest first
  };

  /// @param fleet moves the agents  @param ranges [m] of all sensors, as raycast::PoseScanner::table; NaN: failed. Both
  /// must outlive this object, as must `device`
  /// @throws base::DeviceError if a table exceeds a limit of the device
  DeviceObserver(const Settings& settings, gpu::Device& device, const DeviceFleet& fleet, const gpu::Buffer& ranges);

  /// Records the kernel, after those that write the ranges, and lists the copies of the tables.
  void record(gpu::Batch& batch);
  /// Call it before each submission. @param again nothing moves in it: only agents that have restarted are measured
  void prepare(gpu::Batch& batch, bool again);
  /// Sets x and y [m] of all goals; NaN: none. The next submission must be `again`. @param goals two per agent, NaN or
  /// finite
  void set_goals(std::span<const double> goals);
  /// The agents from `first` to before `end` have been placed; the next submission must be `again`.
  void restart(std::size_t first, std::size_t end);

  /// Copies the results to the host.
  /// @throws base::DeviceError if the device ended loops early (DeviceFleet::reports)
  void read();
  // As of the last `read`: rows of `columns` numbers, and [m] per agent, as in sensorfarm::Observations.
  std::span<const float> values() { return values_.host<float>().first(value_count_); }
  std::span<const double> distances() const { return distances_; }
  std::span<const double> progress() const { return progress_; }

  /// The tables: the rows of `values`, and an ObservedMeasure per agent. Submissions write them; their host views are
  /// up to date after `read` or, on a unified device, after each submission.
  gpu::Buffer& table() { return values_; }
  gpu::Buffer& measures() { return measures_; }

 private:
  std::size_t value_count_;
  std::vector<double> distances_, progress_;
  gpu::Buffer tick_, agents_, sensors_, goals_, fresh_, measures_, values_, groups_;
  gpu::Kernel kernel_;
  gpu::Batch reading_;
};

}  // namespace sf::robots
