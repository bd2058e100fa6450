#pragma once
// Views of a world from above, for pictures of a run at many frames per second: pixels without frame and texts.
//
//   TopView view(world, {.width = 640, .height = 480});
//   while (running) show(view.paint(poses, time));
//
// The static layer, ground and walls, is painted once, at construction.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "viz/axes.h"
#include "viz/picture_file.h"
#include "world/world.h"

namespace sf::viz {

struct TopViewOptions {
  static constexpr int kLongestSide = 4096;
  int width = 640, height = 480;        ///< [px] in [1, kLongestSide]
  std::optional<world::Extent> extent;  ///< [m] minimum area to show, finite and not empty; nullopt: the whole world
};

class TopView {
 public:
  /// @param world must outlive it; only the poses of movers may change
  /// @throws base::InputError for options out of range, or if Cairo is missing
  TopView(const world::World& world, const TopViewOptions& options);

  /// Paints ground, walls and traffic lights, and the body of each mover.
  /// @param X_WM one per mover, in the order of `World::movers`; fewer: of the first ones
  /// @param time [s] of the traffic lights
  PixelImage paint(std::span<const base::Pose> X_WM, double time) const;

  // For pictures with more layers: axes with ground and walls, then the bodies drawn onto them.
  Axes begin() const;
  void draw_bodies(Axes& axes, std::span<const base::Pose> X_WM) const;
  /// Moves the camera: centres the view on another area. Repaints the static layer if the view changes.
  void look_at(const world::Extent& extent);

 private:
  void paint_static_layer();

  const world::World* world_;
  TopViewOptions options_;
  FigureLayout layout_;
  std::vector<std::uint32_t> static_layer_;  ///< 0xFFRRGGBB of ground and walls, row by row
};

}  // namespace sf::viz
