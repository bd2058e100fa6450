#pragma once
// Scanners of one mover at one point are scanned together: their beams, sorted by bearing, form one pattern.

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "raycast/cast_plan.h"
#include "raycast/scan_tables.h"

namespace sf::raycast {

/// The beams of several scanners in the frame of the first.
struct SharedPattern {
  struct Source {
    std::uint32_t scanner;  ///< relative to the first of the view
    std::uint32_t place;    ///< its first place among those of the view's lanes
    std::uint32_t places;   ///< number of its places: unused ones repeat a beam
  };
  ScanPattern beams;            ///< its 64-bit directions are in the frame of each beam's own scanner
  std::vector<Source> sources;  ///< of each beam
  std::uint32_t lanes = 0;
};

/// A run of scanner rows.
struct SharedView {
  std::uint32_t first = 0, scanners = 0;
  std::uint32_t pattern = 0;
};

/// Built once. Not thread-safe.
class SharedViews {
 public:
  /// Adds scanners [first, first + scanners.size()), which all satisfy `same_viewpoint` with the first.
  /// @param plans of each scanner  @return false when their bearings are too uneven for one pattern
  bool add(std::uint32_t first, std::span<const Scanner> scanners, std::span<const BeamPlan* const> plans);

  std::span<const SharedView> views() const { return views_; }
  const SharedPattern& pattern(const SharedView& view) const { return patterns_[view.pattern]; }

 private:
  std::vector<SharedView> views_;
  std::vector<SharedPattern> patterns_;
  std::map<std::vector<double>, std::uint32_t> known_;  ///< patterns by the settings of their scanners
};

/// True when two scanners without angular noise share position, height, range and mover.
bool same_viewpoint(const Scanner& p, const Scanner& q);

}  // namespace sf::raycast
