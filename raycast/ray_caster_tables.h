#pragma once
// Tables that the sources of raycast::RayCaster share: one row per scanner, and the device's buffers.

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "raycast/cast_plan.h"
#include "raycast/cast_results.h"
#include "raycast/cast_uploads.h"
#include "raycast/device_scene.h"
#include "raycast/host_scene.h"
#include "raycast/ray_caster.h"
#include "raycast/shared_views.h"

namespace sf::raycast {

/// Value of `shared` for scanners without a shared view.
inline constexpr std::uint32_t kNotShared = 0xFFFFFFFFu;

/// One host scan, for one scanner or a shared view.
struct HostScan {
  std::uint32_t due = 0;              ///< its first due scanner
  std::uint32_t shared = kNotShared;  ///< index of the shared view
};

/// Lanes with beams that 32 bits could not certify, as the first kernel lists them for the second.
struct UncertainLanes {
  struct Entry {
    std::uint32_t lane;   ///< row in `CastDispatch::lanes`
    std::uint32_t flags;  ///< SF_UNCERTAIN, SF_GRAZING
  };
  std::uint32_t across = 0, down = 0, one = 1;  ///< groups of the second dispatch
  std::uint32_t count = 0;
};

/// Two kernels over the lanes of their due scanners: the second casts the listed ones in 64 bits.
struct CastDispatch {
  std::unique_ptr<gpu::Kernel> kernel, uncertain_kernel;
  LaneTable* lanes = nullptr;
  std::unique_ptr<gpu::Buffer> uncertain;

  /// Empties the list of uncertain lanes.
  void begin_uncertain() { *reinterpret_cast<UncertainLanes*>(uncertain->host<std::uint32_t>().data()) = {}; }
};

struct RayCaster::Tables {
  base::ThreadPool& thread_pool;
  std::span<const base::Report> states;  ///< of all movers, in this tick
  CastPlan plan;
  CastUploads uploads;
  CastResults results;
  std::unique_ptr<DeviceScene> scene;  ///< null where the host computes all scans
  std::unique_ptr<HostScene> host;     ///< for all scans, or for scans that exceed the device's lists
  bool host_has_movers = false;        ///< placed in this tick
  CastDispatch exact;
  std::optional<CastDispatch> single;  ///< present where a scanner is `single`
  std::unique_ptr<gpu::Buffer> rows;   ///< of due scanners, for kernels
  std::vector<std::uint32_t> flagged;  ///< lanes whose flags the device's last cast set
  std::vector<DueSample> due;
  std::vector<Viewpoint> views, host_views;
  std::vector<ScanPattern> patterns;  ///< of scanners without angular noise, on the host
  struct Scratch {
    ScanPattern pattern;
    std::vector<double> bearings, ranges, x, y;
    std::vector<std::uint32_t> models;
    std::vector<std::uint8_t> grazes;

    /// Room for the results and directions of `beams` beams.
    void make_room(std::size_t beams) {
      if (grazes.size() >= beams) return;
      grazes.resize(beams), models.resize(beams), ranges.resize(beams);
      x.resize(beams + 2 * kBlock), y.resize(beams + 2 * kBlock);
    }
  };
  std::vector<Scratch> scratch;          ///< per thread
  std::vector<std::uint32_t> host_due;   ///< due scanners of host scans
  SharedViews shared_views;              ///< used only where the device casts nothing
  std::vector<std::uint32_t> shared_of;  ///< per scanner: the shared view that begins with it, or kNotShared
  std::vector<HostScan> scans;           ///< of this tick
  std::uint64_t host_scans = 0;
  std::atomic<std::uint64_t> rays{0};
  std::uint64_t uncertain_beams = 0;
  bool bound = false;
  bool texel_results = false;  ///< the tables exceed the limit of storage buffers

  Tables(const SensorContext& context, const world::World& world, std::vector<Scanner> scanners);
  void make_passes(gpu::Device& device, std::size_t largest_buffer);
  void make_pass(gpu::Device& device, CastDispatch& pass, bool is_single);
  void bind(CastDispatch& pass);
  void begin_uncertain();
  void take_uncertain(CastDispatch& pass);
  void make_pattern(std::size_t i, std::span<const double> angle_noise, Scratch& own, ScanPattern& pattern);
  void find_shared_views();
  void compute_viewpoints(std::size_t first, std::size_t last);
  bool prepare();
  void scan_on_host();
  void list_scans();
  void scan_one(std::size_t k, unsigned thread);
  void scan_shared(std::size_t k, unsigned thread);
  void find_host_due();
  void bind();
};

}  // namespace sf::raycast
