#pragma once
// The states of traffic lights over time.

#include <span>
#include <string>
#include <vector>

#include "viz/picture_file.h"
#include "world/world.h"

namespace sf::viz {

struct LightSpan {
  double from = 0.0, to = 0.0;  ///< [s]
  world::LightState state = world::LightState::dark;
};

struct LightRow {
  std::string name;
  std::vector<LightSpan> spans;  ///< sorted by time
};

/// Draws one row per light with a bar per state, distinguished by colour, height and the mark of viz/signal_layer.h.
/// @throws base::InputError naming the path if it cannot be written.
void draw_light_states(std::span<const LightRow> rows, const std::string& subtitle, const std::string& path,
                       const Page& page = {});

}  // namespace sf::viz
