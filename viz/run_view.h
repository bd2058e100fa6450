#pragma once
// Frames of a video of a run: the world from above with its robots, contacts and lights, readings of some robots, names
// where they are few, the simulated time and a scale bar.

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
  std::vector<std::uint8_t> contacts;     ///< one per mover: 1 where something stopped it
  std::vector<world::LightState> lights;  ///< one per light; empty: by their plans
  std::vector<RangeReading> ranges;
};

struct RunViewOptions {
  TopViewOptions view;
  std::vector<std::size_t> followed;  ///< movers that the camera follows; empty: it stays
  double around = 5.0;                ///< [m] shown at least on each side of the followed movers, > 0
  std::string note;                   ///< after the time, such as "x 4"
};

/// One thread at a time, and no other may draw.
class RunView {
 public:
  /// @param world as for TopView
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
