#pragma once
// Geometries in well-known text (OGC 06-103r4, section 7).

#include <string_view>
#include <vector>

#include "base/pose.h"

namespace sf::world {

/// Lines, or the rings of one polygon.
struct TextGeometry {
  bool closed = false;  ///< rings, the first one outer, all others holes; else lines
  std::vector<std::vector<glm::dvec2>> lines;
};

/// The parts of a POLYGON, MULTIPOLYGON, LINESTRING or MULTILINESTRING, in order; coordinates beyond x and y are
/// ignored. EMPTY has no parts.
/// @throws base::InputError with the reason alone: the caller knows file and line
std::vector<TextGeometry> read_geometry(std::string_view text);

}  // namespace sf::world
