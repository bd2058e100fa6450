#pragma once
// Drawing of movers.

#include <cstdint>

#include "viz/axes.h"
#include "world/world.h"

namespace sf::viz {

/// [px] Bodies with a smaller radius are drawn as dots.
inline constexpr double kSmallestMark = 4.0;

/// Returns the colour of the mover's model, or a neutral one.
std::uint32_t body_color(const world::World& world, const world::Mover& mover);

/// Fills the outline of the mover at the given pose, with a line towards its front.
void draw_body(Axes& axes, const world::Mover& mover, const base::Pose& X_WM, std::uint32_t color);

}  // namespace sf::viz
