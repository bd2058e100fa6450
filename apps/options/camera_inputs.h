#pragma once
// The images of all cameras of a testbed: from devices and files, or rendered.

#include <atomic>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "netio/socket.h"
#include "vision/positioning.h"
#include "vision/rendered_fleet.h"
#include "vision/rendered_robots.h"
#include "vision/renderer.h"

namespace sf::apps {

class CameraInputs {
 public:
  virtual ~CameraInputs() = default;
  /// The next image of each camera, waiting for devices. @return false when any source has ended
  virtual bool next(std::vector<vision::Frame>& frames) = 0;
  virtual bool is_live() const { return false; }
};

/// @param chosen camera and source, in place of the file's
/// @throws base::InputError for cameras without a source, sources of no camera, and sources that cannot be opened
std::unique_ptr<CameraInputs> open_inputs(const vision::Testbed& testbed,
                                          const std::vector<std::pair<std::string, std::string>>& chosen);

/// @param fleet lives longer
/// @throws base::InputError for cameras of more than 64 Mpx together, since a renderer has 32 bytes for each
std::unique_ptr<CameraInputs> rendered_inputs(const vision::Testbed& testbed, const vision::RenderedFleet& fleet,
                                              std::uint64_t seed);

/// Counts of the packets with robots' true states.
struct TruthCounts {
  std::size_t robots = 0;
  std::uint64_t accepted = 0;
  std::uint64_t refused = 0;  ///< no V2V, or of robots that the dictionary has no tag for
};

/// Images in real time of robots whose true states come as V2V packets (`sensorfarm robot --truth`).
class RobotInputs : public CameraInputs {
 public:
  virtual TruthCounts truth() const = 0;
};

/// @param listen where the packets come
/// @param stop ends the wait for the next image
/// @throws as rendered_inputs, and base::InputError where the port is taken
std::unique_ptr<RobotInputs> robot_inputs(const vision::Testbed& testbed, const netio::Endpoint& listen,
                                          std::uint64_t seed, const std::atomic<bool>& stop);

}  // namespace sf::apps
