#pragma once
// Movers on a figure.

#include <cstdint>

#include "viz/axes.h"
#include "world/world.h"

namespace sf::viz {

/// [px] A body with a smaller radius is drawn as a dot.
inline constexpr double kSmallestMark = 4.0;

/// The filled outline of the mover at `X_WM`, with a line towards its front.
void draw_body(Axes& axes, const world::Mover& mover, std::uint32_t color);

}  // namespace sf::viz
