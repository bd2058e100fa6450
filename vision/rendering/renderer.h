#pragma once
// Renders images of a simulated testbed as a camera takes them. Beams, samples of pixels, exposure and rolling shutter,
// and the response to light are those of the farm's cameras (sensors/camera.h).

#include <cstdint>
#include <memory>

#include "vision/camera.h"
#include "vision/image.h"
#include "vision/scene.h"

namespace sf::vision {

/// Renders the images of one camera. An image is a function of (camera, scene, imaging, seed, frame, time), independent
/// of the order of calls. Pixels near patches have eight samples, spread over the pixel and the exposure, and 32 where
/// these differ. Grey values are linear in the light. Not thread-safe.
class Renderer {
 public:
  /// Computes the ray of each pixel.
  Renderer(const Camera& camera, const Imaging& imaging, std::uint64_t seed);
  ~Renderer();
  Renderer(Renderer&&) noexcept;

  /// @param time [s] start of the exposure of the first row
  /// @param frame number of the image, for its noise
  void render(const Scene& scene, double time, std::uint32_t frame, Image& out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sf::vision
