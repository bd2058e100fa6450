#pragma once
// Movers on a figure.

#include <cstdint>

#include "viz/axes.h"
#include "world/world.h"

namespace sf::viz {

/// [px] A body with a smaller radius is drawn as a dot.
inline constexpr double kSmallestMark = 4.0;

/// The outline of the mover where `X_WM` has it, filled, with a line towards its front.
void draw_body(Axes& axes, const world::Mover& mover, std::uint32_t color);

}  // namespace sf::viz
