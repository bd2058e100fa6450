#pragma once
// From one camera's image to the poses of tags in the world.

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "vision/tag_fit.h"
#include "vision/testbed.h"

namespace sf::vision {

/// A tag as one camera saw it.
struct Sighting {
  std::uint32_t id = 0;
  double time = 0.0;  ///< [s] the middle of the exposure of the tag's rows
  TagFit fit;
};

/// Counts of images, of sightings and, by reason, of refused outlines.
struct DetectionCounts {
  std::uint64_t images = 0;
  std::uint64_t unreadable = 0;  ///< of these: without pixels, or OpenCV failed on it
  std::uint64_t sightings = 0;
  std::uint64_t unlisted = 0;   ///< `only_listed` is set, and the file has no [[tag]] with this id
  std::uint64_t unfitted = 0;   ///< fewer than three sides with an edge, or points that make no square
  std::uint64_t misfitted = 0;  ///< side or residual beyond the limits below: clutter, or a wrong height
  std::uint64_t frozen = 0;     ///< images left out: each the same as the one before, to the bit
};

/// One thread at a time; use one detector for each camera.
class TagDetector {
 public:
  /// Sightings whose side differs by more than this share from the stated one are refused.
  static constexpr double kMaxSideError = 0.15;
  /// [px] Sightings with a larger RMS distance of their edges from the square are refused.
  static constexpr double kMaxResidual = 0.5;

  /// @param testbed lives longer than the detector
  TagDetector(const Testbed& testbed, const Camera& camera);
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;

  /// Replaces the content of `out`, in ascending order of ids; of two sightings with one id the one with the smaller
  /// side error stays.
  /// @param image grey, of the camera's size; without pixels it counts as unreadable
  /// @param time [s] at which the exposure of the first row started
  void detect(const Image& image, double time, std::vector<Sighting>& out);

  const DetectionCounts& counts() const { return counts_; }

 private:
  bool measure(const Image& image, const TagOutline& outline, Sighting& out);

  const Testbed& testbed_;
  Camera camera_;
  int cells_ = 0;
  std::unique_ptr<TagFinder> finder_;
  std::vector<TagOutline> outlines_;
  std::vector<EdgePoint> edges_;
  DetectionCounts counts_;
};

}  // namespace sf::vision
