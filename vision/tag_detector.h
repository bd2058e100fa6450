#pragma once
// Computes the poses of tags in the world from one camera's image.

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "vision/tag_fit.h"
#include "vision/testbed.h"

namespace sf::vision {

/// A tag seen by one camera.
struct Sighting {
  std::uint32_t id = 0;
  double time = 0.0;  ///< [s] middle of the exposure of the tag's rows
  TagFit fit;
};

/// Counts of images, sightings and, by reason, rejected outlines.
struct DetectionCounts {
  std::uint64_t images = 0;
  std::uint64_t unreadable = 0;  ///< of the images: without pixels, or OpenCV failed on them
  std::uint64_t sightings = 0;
  std::uint64_t unlisted = 0;   ///< `only_listed` is set, and the file has no [[tag]] with this id
  std::uint64_t unfitted = 0;   ///< fewer than three sides with an edge, or points that do not form a square
  std::uint64_t misfitted = 0;  ///< side or residual beyond the limits below: clutter, or a wrong height
  std::uint64_t frozen = 0;     ///< skipped images that are identical to the one before
};

/// Not thread-safe; use one detector per camera.
class TagDetector {
 public:
  /// Rejects sightings whose side differs from the specified one by more than this fraction.
  static constexpr double kMaxSideError = 0.15;
  /// [px] Rejects sightings with a larger RMS distance of their edges from the square.
  static constexpr double kMaxResidual = 0.5;

  /// @param testbed must outlive the detector
  TagDetector(const Testbed& testbed, const Camera& camera);
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;

  /// Replaces the content of `out`, sorted by id. If two sightings have the same id, keeps the one with the smaller
  /// side error.
  /// @param image grey, of the camera's size; without pixels it counts as unreadable
  /// @param time [s] start of the exposure of the first row
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
