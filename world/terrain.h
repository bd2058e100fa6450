#pragma once
// Height maps of the ground (`terrain( file "FILE" ... )`, World::terrain), in place of the floor in their rectangle.

#include <array>
#include <optional>
#include <string>

#include "world/world.h"

namespace sf::world {

inline constexpr std::uint32_t kMostSide = 16'384;  ///< points along each side of a height map, at least 2
inline constexpr std::size_t kMostHeights = std::size_t{1} << 26;  ///< points of a height map

/// Heights of a file.
struct HeightMap {
  std::uint32_t columns = 0, rows = 0;
  std::vector<float> heights;  ///< [m] row by row from the smallest y: the picture's last row is the first
  glm::dvec2 cell{};           ///< [m] distances of points as the file states them; 0: it does not
};

/// Returns true for names of GeoTIFF files, which state heights and possibly distances themselves.
bool is_geotiff(const std::string& file);
/// Reads a GeoTIFF by the GDAL plug-in.
/// @throws base::InputError also for a height that is missing or not finite, and if the plug-in cannot be loaded
HeightMap read_geotiff(const std::string& file);
/// Reads a greyscale PNG of 16 bits, whose values from 0 to 65535 become heights from `lowest` to `highest` [m].
/// Checks sizes before allocating memory.
/// @throws base::InputError if the file is missing, broken, of another format or too large
HeightMap read_height_map(const std::string& file, double lowest, double highest);
/// Same, from memory. @param file name for errors
HeightMap decode_height_map(const std::string& file, const std::string& bytes, double lowest, double highest);

/// Throws base::InputError unless a height map of this size is within the limits.
void require_height_map_size(const std::string& file, std::uint64_t columns, std::uint64_t rows);

/// Returns the lengths of its sides [m], along the rows and the columns.
glm::dvec2 size_of(const Terrain& terrain);
/// Returns the frame of the first point, with x along the rows. z is that of height 0.
Pose corner_of(const Terrain& terrain);
/// Returns the corners of its rectangle [m], counter-clockwise in the world.
std::array<glm::dvec2, 4> outline_of(const Terrain& terrain);

/// A point of the ground.
struct GroundPoint {
  double z = 0.0;    ///< [m]
  glm::dvec2 slope;  ///< rise of the surface along the world's x and y
};

/// The surface of a terrain, with its frame computed once.
class TerrainSurface {
 public:
  /// @param terrain must outlive it
  explicit TerrainSurface(const Terrain& terrain);
  /// Returns the surface at `p` in the world; nullopt outside.
  std::optional<GroundPoint> at(glm::dvec2 p) const;
  /// Returns the point of the rectangle's border next to `p`, in the world; within rounding errors.
  glm::dvec2 border(glm::dvec2 p) const;

 private:
  glm::dvec2 in_frame(glm::dvec2 p) const;

  const Terrain& terrain_;
  Pose X_FW_;
  base::SinCos turn_;  ///< of X_FW_
};

/// Returns the height [m] of the surface at `p` in the world; nullopt outside.
std::optional<double> height_at(const Terrain& terrain, glm::dvec2 p);

}  // namespace sf::world
