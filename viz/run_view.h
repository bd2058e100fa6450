#pragma once
// Frames of a video of a run: the world from above with its robots, contacts and lights, readings of some robots, names
// if there are few robots, the simulated time and a scale bar.

#include <cstdint>
#include <string>
#include <vector>

#include "viz/range_layer.h"
#include "viz/top_view.h"

namespace sf::viz {

/// Contents of one frame.
struct RunFrame {
  double time = 0.0;                      ///< [s] simulated
  std::vector<base::Pose> X_WM;           ///< one per mover; absent ones are not drawn
  std::vector<std::uint8_t> contacts;     ///< one per mover: 1 if something stopped it
  std::vector<world::LightState> lights;  ///< one per light; empty: computed from their plans
  std::vector<RangeReading> ranges;
};

struct RunViewOptions {
  TopViewOptions view;
  std::vector<std::size_t> followed;  ///< movers that the camera follows; empty: the camera does not move
  double around = 5.0;                ///< [m] minimum margin on each side of the followed movers, > 0
  std::string note;                   ///< after the time, such as "x 4"
};

/// Not thread-safe; no other thread may draw at the same time.
class RunView {
 public:
  /// @param world see TopView
  RunView(const world::World& world, const RunViewOptions& options);

  PixelImage paint(const RunFrame& frame);

 private:
  void follow(const RunFrame& frame);
  void draw_contacts(Axes& axes, const RunFrame& frame) const;
  void draw_names(Axes& axes, const RunFrame& frame) const;
  void draw_texts(Axes& axes, const RunFrame& frame) const;

  const world::World& world_;
  RunViewOptions options_;
  TopView view_;
};

}  // namespace sf::viz
