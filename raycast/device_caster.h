#pragma once
// Caster on the device: Vulkan kernels that search lists (raycast/device_scene.h). Scans whose lists exceed the
// device's limits run on the host.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "gpu/kernel.h"
#include "raycast/caster.h"
#include "raycast/device_scene.h"
#include "raycast/host_caster.h"

namespace sf::raycast {

class DeviceCaster : public Caster {
 public:
  /// @throws base::DeviceError if the device is the host or lacks memory for the tables
  explicit DeviceCaster(const CasterInputs& in);

  void place() override;
  bool update_outlines(const world::World& world) override {
    return scene_.update_outlines(world) && host_.update_outlines(world);
  }
  bool prepare(const DueScans& due, bool cast) override;
  void record(gpu::Batch& batch) override;
  void add_copies(gpu::Batch& batch, const DueScans& due, bool results) override;
  void collect(const DueScans& due) override;
  SensorStats stats() const override;

 private:
  /// Two kernels over the lanes of due scanners. The first lists its uncertain lanes; the second casts those in 64
  /// bits.
  struct Pass {
    std::unique_ptr<gpu::Kernel> kernel, uncertain_kernel;
    LaneTable* lanes = nullptr;
    std::unique_ptr<gpu::Buffer> uncertain;  ///< UncertainLanes and its entries

    void begin();
  };

  void make_pass(gpu::Device& device, Pass& pass, LaneTable& lanes, bool is_single, bool texel_results);
  bool write_rows(const DueScans& due);
  void find_host_scans(const DueScans& due);
  void bind(Pass& pass);
  void begin_passes();
  void take_uncertain(const DueScans& due, Pass& pass);
  void download(gpu::Batch& batch, const DueScans& due);

  HostCaster host_;
  DeviceScene scene_;
  gpu::Buffer rows_;  ///< RayRow of each due scanner
  Pass exact_;
  std::optional<Pass> single_;             ///< present if any scanner is `single`
  std::vector<std::uint32_t> host_scans_;  ///< due scans of this tick that run on the host
  std::vector<std::uint32_t> flagged_;     ///< lanes whose flags were set by the last cast
  std::uint64_t host_scans_in_all_ = 0;
  std::uint64_t uncertain_beams_ = 0;
  bool bound_ = false;
};

}  // namespace sf::raycast
