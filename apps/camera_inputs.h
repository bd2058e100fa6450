#pragma once
// The images of all cameras of a testbed: from devices and files, or rendered.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "vision/positioning.h"
#include "vision/rendered_fleet.h"
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

}  // namespace sf::apps
