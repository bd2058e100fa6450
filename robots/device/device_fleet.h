#pragma once
// The motion and the contacts of all movers on a Vulkan device: robots::Fleet as kernels, to the same bytes.
//
//   if (DeviceFleet::refusal(world, dt).empty()) {
//     DeviceFleet fleet(world, device);
//     fleet.set_commands(commands);
//     fleet.move(dt);                            // as often as needed
//     farm.tick(now, fleet.reports());           // reads the states back
//   }
//
// A tick is one submission without a copy to the host: start, four rounds of propose, yield and commit, and two passes
// over contacts (`robots::Fleet` explains the rounds). Each kernel has one invocation per mover. Movers that have
// finished return at once, so the host needs no counts. States stay on the device between ticks.
//
// Kernels compute the host's operations in 64 bits, in the host's order and without fused operations. Devices must
// round sums, products, quotients and roots as IEEE 754 does, which the self-check ensures
// (gpu/self_check_arithmetic.h), and keep signs of zeros.
//
// robots::Fleet moves the worlds that `refusal` names: those with roads above the floor, paths of more than a thousand
// substeps per tick, or turns of more than 1e5 rad. Reports from outside, changes of outlines and new movers need it as
// well.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/pose.h"
#include "base/report.h"
#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/device.h"
#include "world/world.h"

namespace sf::robots {

/// Not thread-safe.
class DeviceFleet {
 public:
  /// Returns why ticks of `dt` [ns] > 0 of this world need a robots::Fleet; "" if they do not.
  static std::string refusal(const world::World& world, std::int64_t dt);

  /// All movers start at rest at their load poses at time 0. `device` must outlive the fleet and must not be the host.
  /// @param world copied, as far as it is needed; not refused
  /// @throws base::DeviceError if a table exceeds a limit of the device
  DeviceFleet(const world::World& world, gpu::Device& device);
  ~DeviceFleet();
  DeviceFleet(const DeviceFleet&) = delete;
  DeviceFleet& operator=(const DeviceFleet&) = delete;

  /// Sets the commands of all following ticks; 0 at first. @param commands one per mover; NaN and infinity count as 0
  void set_commands(std::span<const base::Twist> commands);

  /// Records more kernels after the motion, in the same submission, in place of earlier ones. Kernels and tables must
  /// outlive the last `move` or `stay`.
  /// @param record is called now, for each of them  @param prepare is called before each submission and may list copies
  void then(const std::function<void(gpu::Batch&)>& record, std::function<void(gpu::Batch&)> prepare = {});
  /// Table of commands, a FleetCommand (robots/device/records.h) per mover.
  gpu::Buffer& commands();
  /// The next `move` uploads the host's commands of `count` movers.
  void upload_commands(std::size_t first, std::size_t count);
  /// Tables on the device, per mover: a FleetPose, FleetMotion and FleetOwn (robots/device/records.h), and a word, 1:
  /// absent.
  const gpu::Buffer& poses() const;
  const gpu::Buffer& motions() const;
  const gpu::Buffer& own_states() const;
  const gpu::Buffer& absent() const;

  /// Simulates `dt` [ns] > 0, as Fleet::move. @pre `refusal` is "" for this `dt`
  void move(std::int64_t dt);
  /// Runs the kernels of `then` alone, at the present states.
  void stay();

  /// As Fleet::set_absent.
  void set_absent(std::uint32_t row, bool gone);

  /// Sets the state of a mover, e.g. when its world restarts. @param report its time is ignored: movers share one
  /// @param contact its entry in `contacts`
  void set_state(const base::Report& report, bool contact = false);

  /// Reads back the states, one per mover in order of rows. Valid until the next call.
  /// @throws base::DeviceError if a mover met so many others that the device would have ended its loops early (lavapipe
  /// before Mesa 25.0): states are then lost, and the run must be repeated with a robots::Fleet
  std::span<const base::Report> reports();
  /// Returns one value per mover, as Fleet::contacts. Valid after `reports`.
  std::span<const std::uint8_t> contacts() const { return contacts_; }

 private:
  struct Tables;
  std::unique_ptr<Tables> tables_;
  std::function<void(gpu::Batch&)> prepare_;  ///< of `then`
  std::vector<base::Report> reports_;
  std::vector<std::uint8_t> contacts_;
};

}  // namespace sf::robots
