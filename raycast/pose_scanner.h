#pragma once
// Scans from poses that are on the device, such as those of robots::DeviceFleet: exact, and in the same submission as
// the motion.
//
//   raycast::PoseScanner scanner(world, scanners, raycast::Episodes(world, seed), device, fleet.poses(),
//   fleet.absent()); fleet.then([&](gpu::Batch& batch) { scanner.record(batch); }, [&](gpu::Batch& batch) {
//   scanner.prepare(batch); }); fleet.move(dt); scanner.read(), scanner.ranges(0);
//
// Each beam is an invocation that searches the tree of walls and all movers of its copy in 64 bits. Unlike
// raycast::DeviceCaster it needs no lists, which the host builds around each pose. Ranges have the bytes of the other
// casters, and the noise of lasers. Suits many small worlds: its cost grows with the movers of a copy.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "raycast/cast_plan.h"
#include "raycast/episodes.h"
#include "world/world.h"

namespace sf::raycast {

/// Not thread-safe.
class PoseScanner {
 public:
  /// Returns why another caster is needed for a scanner; "" if none is: it turns beams at random, or has 32-bit ranges.
  static std::string refusal(std::span<const Scanner> scanners);

  /// @param scanners not refused  @param episodes of the world: seeds of the range noise, shared with this object
  /// @param poses one FleetPose (robots/device/records.h) per mover  @param absent one word per mover, 1: it is not
  /// seen, and its own ranges mean nothing. Both must outlive this object, as must `device`
  /// @throws base::DeviceError if a table exceeds a limit of the device
  PoseScanner(const world::World& world, std::span<const Scanner> scanners, const Episodes& episodes,
              gpu::Device& device, const gpu::Buffer& poses, const gpu::Buffer& absent);

  /// Records the cast, and lists the copies of the tables.
  void record(gpu::Batch& batch);
  /// Counts a scan. Call it before each submission.
  /// @param again draws the noise of the last scan instead
  void prepare(gpu::Batch& batch, bool again = false);
  /// Begins a copy's new episode (Episodes::begin). The n-th scan of an episode draws the noise of reading n of a farm
  /// that has measured reading 0 at its start; a scan `again` before the first draws that of reading 0.
  void restart(std::uint32_t copy);

  /// Copies the ranges of the last cast to the host.
  /// @throws base::DeviceError if a beam passed so many surfaces that the device would have ended its loops early
  /// (lavapipe before Mesa 25.0)
  void read();
  /// Returns the ranges [m] of the beams that a scanner casts (BeamPlan::samples), as of the last `read`.
  std::span<const double> ranges(std::size_t scanner);
  /// One double [m] per beam, scanner by scanner.
  const gpu::Buffer& table() const { return ranges_; }

 private:
  struct Contents;
  PoseScanner(const Contents& contents, const Episodes& episodes, gpu::Device& device, const gpu::Buffer& poses,
              const gpu::Buffer& absent);
  void write_draw(std::size_t scanner, std::uint32_t first);

  struct Noise {
    std::uint32_t mover, sensor;
  };
  Episodes episodes_;
  std::vector<Noise> noises_;          ///< per scanner
  std::vector<std::uint32_t> firsts_;  ///< first beam of each scanner, then the end
  bool drawn_ = false;                 ///< `draws_` changed since the last `prepare`
  gpu::Buffer counts_, scans_, draws_, scan_rows_, samples_, directions_, walls_, nodes_, outlines_, edges_, ranges_,
      groups_;
  gpu::Kernel kernel_;
  gpu::Batch reading_;
};

}  // namespace sf::raycast
