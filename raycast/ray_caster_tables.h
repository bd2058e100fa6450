#pragma once
// Tables that the sources of raycast::RayCaster share: one row per scanner, and the device's buffers.

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/kernel.h"
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

/// One scanner, planned at load.
struct ScannerRow {
  base::Pose mount;        ///< in the mover's frame; z: world height of the beams, fixed at load (2.5-D world)
  double range_min = 0.0;  ///< [m]
  std::uint32_t mover = 0;
  std::uint32_t config = 0;
  std::uint32_t beams = 0;  ///< first lane of its beam tables
  std::uint32_t pattern = 0;
  std::uint32_t out = 0;     ///< first lane of its results
  bool angle_noise = false;  ///< has angular noise: its beam tables are its own and change
  bool single = false;       ///< as Scanner::single
  BeamPlan plan;
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
  std::unique_ptr<gpu::Buffer> lanes, groups, uncertain;

  /// Empties the list of uncertain lanes.
  void begin_uncertain() { *reinterpret_cast<UncertainLanes*>(uncertain->host<std::uint32_t>().data()) = {}; }
};

struct RayCaster::Tables {
  base::ThreadPool& thread_pool;
  std::span<const base::Report> states;  ///< of all movers, in this tick
  std::uint64_t seed;
  bool noise;
  ListConfigs configs;
  std::unique_ptr<DeviceScene> scene;  ///< null where the host computes all scans
  std::unique_ptr<HostScene> host;     ///< for all scans, or for scans that exceed the device's lists
  bool host_has_movers = false;        ///< placed in this tick
  std::vector<Scanner> scanners;
  std::vector<ScannerRow> scanner_rows;
  CastDispatch exact;
  std::optional<CastDispatch> single;  ///< present where a scanner is `single`
  std::unique_ptr<gpu::Buffer> rows, mid_bearings, directions64, ranges, hits;
  std::vector<std::uint32_t> beam_flags;  ///< per lane of the results
  std::vector<std::uint32_t> flagged;     ///< lanes whose flags the device's last cast set
  std::vector<DueSample> due;
  std::vector<std::uint32_t> lanes_written;  ///< due rows, in order, in the current lane tables
  std::vector<Viewpoint> views, host_views;
  std::vector<std::vector<double>> angle_offsets;  ///< scratch per thread
  std::vector<ScanPattern> patterns;               ///< of scanners without angular noise, on the host
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
  std::uint32_t out_lanes = 0;
  std::uint32_t spare_lanes = 0;  ///< behind all results: device output of host scans
  std::uint64_t host_scans = 0;
  std::atomic<std::uint64_t> rays{0};
  std::uint64_t uncertain_beams = 0;
  bool bound = false;
  bool beams_changed = true;
  bool lanes_changed = true;
  bool any_angle_noise = false;
  bool texel_results = false;  ///< the tables exceed the limit of storage buffers

  Tables(const SensorContext& context, const world::World& world, std::vector<Scanner> f);
  void plan(const world::World& world);
  void make_tables(gpu::Device& device, std::size_t largest_buffer, std::uint32_t beam_lanes);
  void write_all_beams();
  void make_pass(gpu::Device& device, CastDispatch& pass, bool is_single);
  void write_lanes();
  void write_lanes(CastDispatch& pass, bool is_single);
  void bind(CastDispatch& pass);
  void begin_uncertain();
  void take_uncertain(CastDispatch& pass);
  void apply_angle_noise(const DueSample& d, unsigned thread);
  void make_pattern(std::size_t i, std::span<const double> angle_noise, Scratch& own, ScanPattern& pattern);
  void find_shared_views();
  void compute_viewpoints(std::size_t first, std::size_t last);
  bool prepare();
  void scan_on_host();
  void list_scans();
  void scan_one(std::size_t k, unsigned thread);
  void scan_shared(std::size_t k, unsigned thread);
  void write_results(const ScannerRow& row, const double* own_ranges, const std::uint32_t* own_models,
                     const std::uint8_t* grazes);
  void find_host_due();
  void bind();
  BeamTables beam_tables(std::uint32_t lane) const {
    return {mid_bearings->host<float>().data() + lane, directions64->host<double>().data() + 8 * std::size_t{lane}};
  }
};

}  // namespace sf::raycast
