#pragma once
// Caster on the host: scan conversion (raycast/rasterizer.h) of all due scans, or of those that DeviceCaster passes to
// it.

#include <cstdint>
#include <span>
#include <vector>

#include "raycast/caster.h"
#include "raycast/host_scene.h"
#include "raycast/shared_views.h"

namespace sf::raycast {

class HostCaster : public Caster {
 public:
  /// @param share true: scans scanners at the same point of a mover together; false: for callers of `scan` with single
  /// scans
  explicit HostCaster(const CasterInputs& in, bool share = true);

  void place() override { placed_ = false; }
  bool update_outlines(const world::World& world) override {
    scene_.update_outlines(world);
    return true;
  }
  bool prepare(const DueScans& due, bool cast) override;
  SensorStats stats() const override;

  /// Computes the due scans with the indices `which`, which must be ascending.
  void scan(const DueScans& due, std::span<const std::uint32_t> which);

 private:
  /// Value of `shared` for scanners without a shared view.
  static constexpr std::uint32_t kNotShared = 0xFFFFFFFFu;

  /// One scan, of one scanner or of a shared view.
  struct Scan {
    std::uint32_t due = 0;              ///< its first due scanner
    std::uint32_t shared = kNotShared;  ///< index of the shared view
  };
  struct Scratch {
    ScanPattern pattern;
    std::vector<double> bearings, ranges, x, y;
    std::vector<std::uint32_t> models;
    std::vector<std::uint8_t> grazes;

    /// Makes room for the results and directions of `beams` beams.
    void make_room(std::size_t beams) {
      if (grazes.size() >= beams) return;
      grazes.resize(beams), models.resize(beams), ranges.resize(beams);
      x.resize(beams + 2 * kBlock), y.resize(beams + 2 * kBlock);
    }
  };

  void make_pattern(std::size_t i, std::span<const double> angle_noise, Scratch& own, ScanPattern& pattern);
  void find_shared_views();
  void list_scans(const DueScans& due, std::span<const std::uint32_t> which);
  void scan_one(const DueScans& due, std::size_t k, unsigned thread);
  void scan_shared(const DueScans& due, std::size_t k, unsigned thread);

  HostScene scene_;
  bool placed_ = false;                ///< the movers are at this tick's poses; set when the first scan needs them
  std::vector<ScanPattern> patterns_;  ///< of scanners without angular noise
  std::vector<Scratch> scratch_;       ///< per thread
  SharedViews shared_views_;
  std::vector<std::uint32_t> shared_of_;  ///< per scanner: the shared view that starts with it, or kNotShared
  std::vector<std::uint32_t> all_;        ///< 0, 1, ...: the due scans of a tick
  std::vector<Scan> scans_;               ///< of this tick
  std::vector<Viewpoint> views_;          ///< one per scan
};

}  // namespace sf::raycast
