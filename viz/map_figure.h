#pragma once
// A robot's own map as the thesis draws it (figure 45): cells of 4 x 4 pixels with a grid of one pixel between them,
// unexplored dark grey, occupied blue, free white.

#include <string>
#include <vector>

#include "base/pose.h"
#include "maps/grid.h"

namespace sf::viz {

/// Who stood where, to be marked.
struct PoseMarker {
  std::string name;
  base::Pose X_WR;  ///< beside the map: left out
};

struct MapFigure {
  std::string title;
  std::string subtitle;            ///< before what the figure says itself: how many cells, how much of them is known
  std::vector<PoseMarker> places;  ///< at most seven have a name beside the map
};

/// Maps of more than 1600 cells along a side are drawn without a grid, and smaller, as far as they must be.
/// @throws base::InputError naming the path when it cannot be written.
void draw_map(const maps::OccupancyGrid& grid, const MapFigure& figure, const std::string& png_path);

}  // namespace sf::viz
