#pragma once
// The whole system but for its sources and its network: images of all cameras in, tracked tags out.

#include <memory>
#include <span>
#include <vector>

#include "vision/tag_detector.h"
#include "vision/tracker.h"

namespace sf::vision {

/// The image of one camera at one moment.
struct Frame {
  Image image;        ///< grey, of the camera's size; empty: unreadable
  double time = 0.0;  ///< [s] at which the exposure of the first row started
};

/// One thread at a time; cameras are processed on several.
class Positioning {
 public:
  /// @param testbed lives longer
  /// @param threads 0: one for each core
  /// @param live from devices, whose noise makes each image differ: one that is the same as the last of its camera is
  /// counted as frozen, and no tag is sought in it
  explicit Positioning(const Testbed& testbed, unsigned threads = 0, bool live = false);
  ~Positioning();

  /// @param frames one of each camera of the testbed file, in its order
  /// @return tags seen now; live until the next call
  /// @throws base::InputError naming the camera whose image has another size
  std::span<const TrackedTag> update(std::span<const Frame> frames);

  /// Of the last update; live until the next.
  std::span<const Sighting> sightings(std::size_t camera) const;
  DetectionCounts counts() const;  ///< of all cameras
  std::uint64_t refused() const;   ///< by the tracker

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sf::vision
