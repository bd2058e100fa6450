#pragma once
// The field of a world's magnets at one height: a map of |B| from above, and |B| along a line through it.
//
//   const FieldView view = field_view(world, {.height = 0.075});
//   draw_field(world, view, sample_field(world, device, view, {}), "field.png");

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "sensors/magnetic_field/records.h"
#include "viz/canvas.h"
#include "viz/picture_file.h"
#include "world/world.h"

namespace sf::viz {

/// The requested view.
struct FieldRequest {
  double height = 0.0;                  ///< [m] in the world
  std::optional<Line> line;             ///< [m] of the profile; ends distinct
  std::optional<world::Extent> extent;  ///< [m] of the map; not empty
  Page page;
};

/// The view to draw.
struct FieldView {
  double height = 0.0;   ///< [m] in the world
  Line line;             ///< [m] of the profile
  world::Extent extent;  ///< [m] of the map
  PixelBox map;          ///< the map's place on the picture below a heading of two lines
  int right = 150;       ///< [px] beside the map: the bar of colours
  int profile = 300;     ///< [px] height of the profile
};

/// Completes a request. The default map contains all magnets at load and the area around them in which the field decays
/// at this height; the default line runs along the longer side of their bounding box, through its middle, over the
/// whole map.
/// Rule: the world has a magnet.
FieldView field_view(const world::World& world, const FieldRequest& wish);

/// The field along the profile's line.
struct ProfilePoint {
  double along = 0.0;       ///< [m] distance from the line's start
  glm::dvec2 p;             ///< [m]
  sensors::FieldSum field;  ///< [T] the vector sum, and the sum of magnitudes
};

struct FieldSamples {
  int columns = 0;
  int rows = 0;
  std::vector<double> map;  ///< [T] |B| in the middles of equal cells, row by row from the top (+y)
  std::vector<ProfilePoint> profile;
};

/// Sums the magnets on the device, in cells of two by two pixels, or larger ones for very many magnets.
/// @param progress called repeatedly with the finished part in (0, 1]; may be empty.
FieldSamples sample_field(const world::World& world, gpu::Device& device, const FieldView& view,
                          const std::function<void(double)>& progress);

/// @throws base::InputError naming the path when it cannot be written.
void draw_field(const world::World& world, const FieldView& view, const FieldSamples& samples, const std::string& path,
                const Page& page = {});

}  // namespace sf::viz
