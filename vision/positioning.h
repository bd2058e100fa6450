#pragma once
// The positioning system without its sources and network: converts images of all cameras to tracked tags.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "vision/follower.h"
#include "vision/tag_detector.h"
#include "vision/tracker.h"

namespace sf::vision {

/// An image of one camera.
struct Frame {
  Image image;           ///< grey, of the camera's size; empty: unreadable
  double time = 0.0;     ///< [s] start of the exposure of the first row
  bool missing = false;  ///< the camera has no image now: nothing is counted
  bool unread = false;   ///< the image was skipped, since its camera is asleep
};

/// Not thread-safe; processes cameras on several threads.
class Positioning {
 public:
  /// @param testbed must outlive this; with `follow`, only the images in which followed tags can be are searched
  /// @param threads 0: one per core
  /// @param live images come from devices, whose noise makes each image differ. An image identical to its camera's last
  /// one then counts as frozen and is not searched for tags
  explicit Positioning(const Testbed& testbed, unsigned threads = 0, bool live = false);
  ~Positioning();

  /// @param frames one per camera of the testbed file, in its order
  /// @return tags seen now; valid until the next call. If the testbed has `follow`, only those that are followed
  /// @throws base::InputError naming a camera whose image has another size
  std::span<const TrackedTag> update(std::span<const Frame> frames);

  /// Returns the sightings of the last update; valid until the next.
  std::span<const Sighting> sightings(std::size_t camera) const;
  /// Returns messages for ids seen at two places in the last update, each naming the id, the cameras and the places. An
  /// id is named at most once in `kRepeatPeriod`.
  std::vector<std::string> warnings();
  static constexpr double kRepeatPeriod = 10.0;  ///< [s] of the images' time
  DetectionCounts counts() const;                ///< over all cameras
  std::uint64_t refused() const;                 ///< by the tracker
  /// Returns the follower; null if the testbed has no `follow`.
  Follower* follower();
  /// Returns whether each camera is asleep: its next image will not be searched, even if it comes a period late, so
  /// that it need not be read. Valid until the next update.
  std::span<const std::uint8_t> asleep() const;

 private:
  void plan(std::span<const Frame> frames, std::vector<std::uint8_t>& skipped);
  void observe();

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sf::vision
