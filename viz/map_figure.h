#pragma once
// A map built by a robot, in the colours of viz/occupancy_figure.h. The colours of the thesis also use its style
// (figure 45): cells of 4 x 4 pixels with a grid of one pixel between them.

#include <string>
#include <vector>

#include "base/pose.h"
#include "maps/grid.h"
#include "viz/picture_file.h"

namespace sf::viz {

/// A robot's pose to mark on the map.
struct PoseMarker {
  std::string name;
  base::Pose X_WR;  ///< poses outside the map are not drawn
};

struct MapFigure {
  std::string title;
  std::string subtitle;            ///< precedes the generated text: the number of cells and the known part of them
  std::vector<PoseMarker> places;  ///< at most seven are named next to the map
};

/// Maps of more than 1600 cells along a side are drawn without a grid and scaled down as needed.
Drawing map_drawing(const maps::OccupancyGrid& grid, const MapFigure& figure, const Page& page = {});
/// @throws base::InputError naming the path if it cannot be written.
void draw_map(const maps::OccupancyGrid& grid, const MapFigure& figure, const std::string& path, const Page& page = {});

}  // namespace sf::viz
