#pragma once
// Scanners at the same point of a mover are scanned together: their beams, sorted by bearing, form one pattern.

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "raycast/cast_plan.h"
#include "raycast/scan_tables.h"

namespace sf::raycast {

/// Beams of several scanners, in the frame of the first one.
struct SharedPattern {
  struct Source {
    std::uint32_t scanner;  ///< relative to the first of the view
    std::uint32_t place;    ///< its first place in the view's lanes
    std::uint32_t places;   ///< number of its places; unused ones repeat a beam
  };
  ScanPattern beams;            ///< 64-bit directions are in the frame of each beam's own scanner
  std::vector<Source> sources;  ///< one per beam
  std::uint32_t lanes = 0;
};

/// A range of scanner rows.
struct SharedView {
  std::uint32_t first = 0, scanners = 0;
  std::uint32_t pattern = 0;
};

/// Built at load. Not thread-safe.
class SharedViews {
 public:
  /// Adds scanners [first, first + scanners.size()), which all satisfy `same_viewpoint` with the first.
  /// @param plans one per scanner  @return false if their bearings are too uneven for one pattern
  bool add(std::uint32_t first, std::span<const Scanner> scanners, std::span<const BeamPlan* const> plans);

  std::span<const SharedView> views() const { return views_; }
  const SharedPattern& pattern(const SharedView& view) const { return patterns_[view.pattern]; }

 private:
  std::vector<SharedView> views_;
  std::vector<SharedPattern> patterns_;
  std::map<std::vector<double>, std::uint32_t> known_;  ///< patterns, keyed by the settings of their scanners
};

/// Returns whether both scanners lack angular noise and have the same position, height, range and mover.
bool same_viewpoint(const Scanner& p, const Scanner& q);

}  // namespace sf::raycast
