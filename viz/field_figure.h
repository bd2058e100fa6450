#pragma once
// The field of a world's magnets at one height: a map of |B| from above, and |B| along a line.
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

/// The view requested by the user.
struct FieldRequest {
  double height = 0.0;                  ///< [m] in the world
  std::optional<Line> line;             ///< [m] of the profile; the ends must differ
  std::optional<world::Extent> extent;  ///< [m] of the map; not empty
  Page page;
};

/// The complete view to draw.
struct FieldView {
  double height = 0.0;   ///< [m] in the world
  Line line;             ///< [m] of the profile
  world::Extent extent;  ///< [m] of the map
  PixelBox map;          ///< position of the map on the picture, below a heading of two lines
  int right = 150;       ///< [px] right of the map, for the colour bar
  int profile = 300;     ///< [px] height of the profile
};

/// Completes a request. The default map contains all magnets of the loaded world and the surrounding area in which the
/// field decays at this height. The default line runs through the middle of their bounding box, along its longer side,
/// across the whole map. Without magnets, the box is the world's.
FieldView field_view(const world::World& world, const FieldRequest& wish);

/// The field at a point of the profile.
struct ProfilePoint {
  double along = 0.0;       ///< [m] distance from the start of the line
  glm::dvec2 p;             ///< [m]
  sensors::FieldSum field;  ///< [T] the vector sum, and the sum of magnitudes
};

struct FieldSamples {
  int columns = 0;
  int rows = 0;
  std::vector<double> map;  ///< [T] |B| at the centres of equal cells, row by row from the top (+y)
  std::vector<ProfilePoint> profile;
};

/// Sums the fields of the magnets on the device, in cells of two by two pixels, or larger ones for very many magnets.
/// @param progress called repeatedly with the finished part in (0, 1]; may be empty.
FieldSamples sample_field(const world::World& world, gpu::Device& device, const FieldView& view,
                          const std::function<void(double)>& progress);

/// @throws base::InputError naming the path if it cannot be written.
void draw_field(const world::World& world, const FieldView& view, const FieldSamples& samples, const std::string& path,
                const Page& page = {});

}  // namespace sf::viz
