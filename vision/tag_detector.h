#pragma once
// Computes the poses of tags in the world from one camera's image.

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
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

/// An id seen at two places at one time: two tags have the same id, or one of them is false.
struct RepeatedTag {
  std::uint32_t id = 0;
  double time = 0.0;             ///< [s]
  std::array<glm::dvec2, 2> at;  ///< [m] in the world; the tag at the first place is kept
};

/// The parts of one image to search for tags.
struct Search {
  bool whole = false;           ///< the whole image; `regions` is then empty
  std::vector<Region> regions;  ///< within the image, without overlap

  bool is_needed() const { return whole || !regions.empty(); }
};

/// Counts of images, sightings and, by reason, rejected outlines.
struct DetectionCounts {
  std::uint64_t images = 0;
  std::uint64_t unreadable = 0;  ///< of the images: without pixels, or OpenCV failed on them
  std::uint64_t sightings = 0;
  std::uint64_t unwanted = 0;   ///< in images that are searched for other tags (vision/follower.h)
  std::uint64_t unlisted = 0;   ///< `only_listed` is set, and the file has no [[tag]] with this id
  std::uint64_t unfitted = 0;   ///< fewer than three sides with an edge, or points that do not form a square
  std::uint64_t misfitted = 0;  ///< side or residual beyond the limits below: clutter, or a wrong height
  std::uint64_t repeated = 0;   ///< ids seen at a second place in an image; that sighting is dropped
  std::uint64_t frozen = 0;     ///< skipped images that are identical to the one before
  std::uint64_t asleep = 0;     ///< skipped images of cameras in which no followed tag can be
};

/// Not thread-safe; use one detector per camera.
class TagDetector {
 public:
  /// Rejects sightings whose side differs from the specified one by more than this fraction.
  static constexpr double kMaxSideError = 0.15;
  /// [px] Rejects sightings with a larger RMS distance of their edges from the square.
  static constexpr double kMaxResidual = 0.5;
  /// [m] Rejects sightings with a measured height farther than this from the specified one.
  static constexpr double kMaxHeightError = 1.0;

  /// @param testbed must outlive the detector
  TagDetector(const Testbed& testbed, const Camera& camera);
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;

  /// Replaces the content of `out`, sorted by id. If two sightings have the same id, keeps the one with the smaller
  /// side error.
  /// @param image grey, of the camera's size; without pixels it counts as unreadable
  /// @param time [s] start of the exposure of the first row
  void detect(const Image& image, double time, std::vector<Sighting>& out);
  /// The same for the tags `wanted` in parts of the image, which do not overlap.
  void detect(const Image& image, double time, const Search& search, const std::set<std::uint32_t>& wanted,
              std::vector<Sighting>& out);

  /// Returns the ids seen at two places in the last image; valid until the next.
  std::span<const RepeatedTag> repeated() const { return repeated_; }
  const DetectionCounts& counts() const { return counts_; }

 private:
  /// Adds to `out`; false if the image is unreadable. @param wanted null: all
  bool search(const Image& image, const Region& region, double time, const std::set<std::uint32_t>* wanted,
              std::vector<Sighting>& out);
  void finish(bool is_readable, std::vector<Sighting>& out);
  bool measure(const Image& image, const TagOutline& outline, Sighting& out);
  bool is_plausible(const TagFit& fit, const TagMount& mount) const;
  void keep_best_of_each(std::vector<Sighting>& sightings);

  const Testbed& testbed_;
  Camera camera_;
  int cells_ = 0;
  std::unique_ptr<TagFinder> finder_;
  std::vector<TagOutline> outlines_;
  std::vector<EdgePoint> edges_;
  std::vector<RepeatedTag> repeated_;
  DetectionCounts counts_;
};

}  // namespace sf::vision
