#pragma once
// The images of all cameras of a testbed, from devices, files or a renderer.

#include <atomic>
#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "netio/socket.h"
#include "vision/opencv.h"
#include "vision/positioning.h"
#include "vision/rendered_fleet.h"
#include "vision/rendered_robots.h"
#include "vision/rendering/renderer.h"

namespace sf::apps {

class CameraInputs {
 public:
  virtual ~CameraInputs() = default;
  /// Reads the next image of each camera. A device or pipeline that sends none within a limit is reported, and its
  /// frames are missing until it continues. @return false if a file or all live sources have ended, or at a stop
  /// @param asleep one per camera, or empty: if not 0, its image need not be read. Files and devices skip it then
  /// without decoding, and their frame is `unread`
  virtual bool next(std::vector<vision::Frame>& frames, std::span<const std::uint8_t> asleep = {}) = 0;
  virtual bool is_live() const { return false; }
};

/// @param testbed must outlive the result  @param chosen pairs of camera and source that override the file
/// @param stop ends the wait for the next image
/// @throws base::InputError for cameras without a source, sources of unknown cameras, and sources that cannot be opened
std::unique_ptr<CameraInputs> open_inputs(const vision::Testbed& testbed,
                                          const std::vector<std::pair<std::string, std::string>>& chosen,
                                          const std::atomic<bool>& stop);

/// Reads sources, one per camera. @param testbed, stop must outlive the result
/// @param limit time in which a live source must send an image; three periods of its camera if that is longer
std::unique_ptr<CameraInputs> source_inputs(const vision::Testbed& testbed,
                                            std::vector<std::unique_ptr<vision::ImageSource>> sources,
                                            std::chrono::milliseconds limit, const std::atomic<bool>& stop);

/// @param fleet must outlive the result
/// @throws base::InputError if the cameras have more than 64 Mpx in total, since a renderer needs 32 bytes per pixel
std::unique_ptr<CameraInputs> rendered_inputs(const vision::Testbed& testbed, const vision::RenderedFleet& fleet,
                                              std::uint64_t seed);

/// Counts of received packets with robots' true states.
struct TruthCounts {
  std::size_t robots = 0;
  std::uint64_t accepted = 0;
  std::uint64_t refused = 0;  ///< not V2V, or from robots for which the dictionary has no tag
};

/// Renders images in real time of robots whose true states arrive as V2V packets (`sensorfarm robot --truth`).
class RobotInputs : public CameraInputs {
 public:
  virtual TruthCounts truth() const = 0;
};

/// @param listen address at which the packets arrive
/// @param stop ends the wait for the next image
/// @throws as rendered_inputs, and base::InputError if the port is taken
std::unique_ptr<RobotInputs> robot_inputs(const vision::Testbed& testbed, const netio::Endpoint& listen,
                                          std::uint64_t seed, const std::atomic<bool>& stop);

}  // namespace sf::apps
