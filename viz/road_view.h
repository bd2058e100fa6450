#pragma once
// Draws a part of a road network on a part of a picture.

#include <cstdint>
#include <string>
#include <vector>

#include "viz/canvas.h"
#include "viz/labels.h"
#include "world/roads/network.h"

namespace sf::viz {

/// Maps a part of the world to the canvas, north up.
struct RoadView {
  Canvas& canvas;      ///< the caller clips it to `box`
  PixelBox box;        ///< [px]
  glm::dvec2 corner;   ///< [m] world point at the lower left corner of the box
  double scale = 1.0;  ///< [px/m]

  glm::dvec2 pixel(glm::dvec2 p_W) const {
    return {box.x_min + (p_W.x - corner.x) * scale, box.y_max - (p_W.y - corner.y) * scale};
  }
};

std::vector<glm::dvec2> pixels(const RoadView& view, const std::vector<glm::dvec2>& line);

/// Draws lanes, lane markings, directions, zones, spots, exits, stop lines and checkpoints, without texts.
void draw_network(const RoadView& view, const world::RoadNetwork& network);

/// Returns at most `most` characters of a name for a figure; the name may contain any bytes.
std::string printable(const std::string& name, std::size_t most);

/// Marks the areas that texts should avoid if possible.
void avoid_network(const RoadView& view, const world::RoadNetwork& network, Labels& labels);

/// Areas of the world [m] that another view enlarges; empty: none.
using DetailViews = std::vector<world::Extent>;

/// Draws names of zones and segments and checkpoint ids, except those within `elsewhere`.
void draw_texts(const RoadView& view, const world::RoadNetwork& network, Labels& labels, const DetailViews& elsewhere);

}  // namespace sf::viz
