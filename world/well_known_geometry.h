#pragma once
// Geometries in well-known text and binary (OGC 06-103r4, sections 7 and 8, with the curves of ISO 13249-3), including
// PostGIS variants: `SRID=n;` before a text, flags of EWKB, and binary in hexadecimal digits.

#include <cstdint>
#include <string_view>
#include <vector>

#include "base/pose.h"

namespace sf::world {

/// The lines and rings of one geometry, in its unit of length. Reuses its memory for further geometries.
struct WellKnownGeometry {
  enum class Kind : std::uint8_t { line, outer, inner };  ///< inner: a hole in the last outer ring
  struct Part {
    Kind kind;
    std::size_t end;  ///< end of its points, which start at the end of the previous part
  };
  std::vector<glm::dvec2> points;
  std::vector<Part> parts;
  std::uint32_t points_left_out = 0;  ///< members of the types POINT and MULTIPOINT
  std::uint32_t faces_left_out = 0;   ///< members of the types TIN and POLYHEDRALSURFACE
  std::uint32_t srid = 0;             ///< 0: not stated
  double chords_left = 2e7;  ///< chords left for the arcs of this and further geometries; bounds the work per file

  void clear();  ///< for the next geometry
};

/// Classifies a text by its first characters: a geometry type, then a number, a member or the end after parentheses.
struct GeometryGuess {
  enum class Content : std::uint8_t { none, points, walls } content = Content::none;
  std::size_t length = 0;  ///< characters up to the last parenthesis; 0 if it is missing or the text is malformed
  bool is_open = false;    ///< the text ends before the last parenthesis and is well-formed so far
};
GeometryGuess guess_geometry(std::string_view text);

/// Reads POLYGON, TRIANGLE, LINESTRING, their MULTI forms and collections. Ignores coordinates beyond x and y. Points
/// and three-dimensional faces (TIN, POLYHEDRALSURFACE) have no walls and are only counted. Arcs (CIRCULARSTRING,
/// COMPOUNDCURVE, CURVEPOLYGON, MULTICURVE, MULTISURFACE) become chords.
/// @param text well-known text, or binary in hexadecimal digits
/// @param arc_error largest distance between an arc and its chords, in the geometry's unit
/// @throws base::InputError with only the reason: the caller adds file and line
void read_geometry(std::string_view text, double arc_error, WellKnownGeometry& geometry);

/// Same, for well-known binary. @param bytes ISO WKB or EWKB, either byte order
void read_binary_geometry(std::string_view bytes, double arc_error, WellKnownGeometry& geometry);

}  // namespace sf::world
