#pragma once
// Fans of one mover that look from one point are scanned at once: their beams, by bearing, are one pattern.

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "raycast/ray_caster.h"
#include "raycast/scan_tables.h"

namespace sf::raycast {

/// The beams of several fans in the frame of the first.
struct SharedPattern {
  struct Source {
    std::uint32_t scanner;  ///< from the view's first
    std::uint32_t beam;     ///< of that fan's pattern
    std::uint32_t place;    ///< of it where fans' beams follow one another
  };
  ScanPattern beams;
  std::vector<Source> sources;  ///< of each beam
};

/// A run of fans, by row.
struct SharedView {
  std::uint32_t first = 0, scanners = 0;
  std::uint32_t pattern = 0;
};

/// Built once. One thread.
class SharedViews {
 public:
  /// Adds fans [first, first + fans.size()), of which each could be scanned with the first.
  /// @param plans of each fan  @return false where one pattern would serve them badly: their bearings are too uneven
  bool add(std::uint32_t first, std::span<const Scanner> scanners, std::span<const BeamPlan* const> plans);

  std::span<const SharedView> views() const { return views_; }
  const SharedPattern& pattern(const SharedView& view) const { return patterns_[view.pattern]; }

 private:
  std::vector<SharedView> views_;
  std::vector<SharedPattern> patterns_;
  std::map<std::vector<double>, std::uint32_t> known_;  ///< patterns by their fans' settings
};

/// Whether two fans of a world, without angular noise, look from one point in one way.
bool same_viewpoint(const Scanner& p, const Scanner& q);

}  // namespace sf::raycast
