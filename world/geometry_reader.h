#pragma once
// The common grammar of well-known text and well-known binary.

#include <fmt/format.h>

#include <optional>

#include "base/error.h"
#include "world/arc.h"
#include "world/well_known_geometry.h"

namespace sf::world {

/// Numbered as in well-known binary.
enum class GeometryType : std::uint8_t {
  point = 1,
  linestring,
  polygon,
  multipoint,
  multilinestring,
  multipolygon,
  collection,
  circularstring,
  compoundcurve,
  curvepolygon,
  multicurve,
  multisurface,
  polyhedralsurface = 15,
  tin,
  triangle,
};

/// The type tag of well-known binary, including the flags of EWKB.
struct TypeCode {
  static constexpr std::uint32_t kZ = 0x80000000u, kM = 0x40000000u, kSrid = 0x20000000u;
  std::uint32_t code = 0;
  std::uint32_t plain() const { return code & ~(kZ | kM | kSrid); }
  GeometryType type() const { return static_cast<GeometryType>(plain() % 1000); }
  bool valid() const {
    const std::uint32_t type = plain() % 1000;
    return plain() < 4000 && ((type >= 1 && type <= 12) || (type >= 15 && type <= 17));
  }
  bool has_srid() const { return (code & kSrid) != 0; }
  /// Number of coordinates beyond x and y.
  int more() const {
    const bool z = (code & kZ) != 0 || plain() / 1000 % 2 == 1, m = (code & kM) != 0 || plain() / 1000 >= 2;
    return z + m;
  }
};

/// Requirements on an encoding `In`:
///   GeometryType type(std::optional<GeometryType> implied)  reads a geometry's tag. implied: type of a member that has
///                                                           no tag in text; none: the tag is required
///   void each(F f)                                          calls f for every element of a list
///   glm::dvec2 point()                                      reads coordinates
///   void skip_points(GeometryType type)                     skips the rest of a POINT or MULTIPOINT
///   void fail(std::string_view expected)                    throws base::InputError
template <class In>
class GeometryReader {
 public:
  GeometryReader(In& in, double arc_error, WellKnownGeometry& out) : in_(in), arc_error_(arc_error), out_(out) {}

  void read(std::optional<GeometryType> implied = {}, int depth = 0) {
    using T = GeometryType;
    if (depth > kMaxDepth) throw base::InputError(fmt::format("collections within {} collections", kMaxDepth));
    const T type = in_.type(implied);
    const auto members = [&](std::optional<T> member) { in_.each([&] { read(member, depth + 1); }); };
    switch (type) {
      case T::point:
      case T::multipoint:
        in_.skip_points(type);
        return void(++out_.points_left_out);
      case T::linestring:
      case T::circularstring:
      case T::compoundcurve:
        read_curve(type);
        return end_part(WellKnownGeometry::Kind::line);
      case T::polygon:
      case T::triangle:
        return read_rings([&] { in_.each([&] { out_.points.push_back(in_.point()); }); });
      case T::curvepolygon:
        return read_rings([&] { read_curve(in_.type(T::linestring)); });
      case T::multilinestring:
      case T::multicurve:
        return members(T::linestring);
      case T::multipolygon:
      case T::multisurface:
        return members(T::polygon);
      case T::collection:
        return members({});
      case T::polyhedralsurface:
      case T::tin:
        return skip_faces([&] { members(type == T::tin ? T::triangle : T::polygon); });
    }
  }

 private:
  static constexpr int kMaxDepth = 32;
  static constexpr double kMaxPoints = 1e6;  // in a geometry with arcs

  void read_curve(GeometryType type) {
    switch (type) {
      case GeometryType::linestring:
        return in_.each([&] { out_.points.push_back(in_.point()); });
      case GeometryType::circularstring:
        return read_arcs();
      case GeometryType::compoundcurve:
        return in_.each([&] {
          const GeometryType piece = in_.type(GeometryType::linestring);
          if (piece == GeometryType::compoundcurve) in_.fail("a line or arcs in a COMPOUNDCURVE");
          read_curve(piece);
        });
      default:
        in_.fail("a line, arcs or a COMPOUNDCURVE");
    }
  }
  void read_arcs() {
    std::size_t count = 0;
    glm::dvec2 middle;
    in_.each([&] {
      const glm::dvec2 p = in_.point();
      if (count++ == 0) {
        out_.points.push_back(p);
      } else if (count % 2 == 0) {
        middle = p;
      } else {
        add_arc(middle, p);
      }
    });
    if (count > 0 && count % 2 == 0) in_.fail("an odd number of points in a CIRCULARSTRING");
  }

  void add_arc(glm::dvec2 middle, glm::dvec2 end) {
    const auto before = static_cast<double>(out_.points.size());
    if (!append_arc(out_.points, middle, end, arc_error_, std::min(kMaxPoints - before, out_.chords_left)))
      throw base::InputError(
          fmt::format("arcs of more than {:g} chords in a geometry, or too many in the file", kMaxPoints));
    out_.chords_left -= static_cast<double>(out_.points.size()) - before;
  }

  /// Reads the rings of one polygon. @param ring reads the points of one ring
  template <class Ring>
  void read_rings(const Ring& ring) {
    bool first = true, empty = false;
    in_.each([&] {
      ring();
      const bool none = out_.points.size() == begin();
      if (first) empty = none;
      if (!first && empty && !none) in_.fail("an outer ring with points before inner ones");
      end_part(first ? WellKnownGeometry::Kind::outer : WellKnownGeometry::Kind::inner);
      first = false;
    });
  }
  template <class Members>
  void skip_faces(const Members& members) {
    const std::size_t points = out_.points.size(), parts = out_.parts.size();
    members();
    if (out_.points.size() > points) ++out_.faces_left_out;
    out_.points.resize(points);
    out_.parts.resize(parts);
  }
  std::size_t begin() const { return out_.parts.empty() ? 0 : out_.parts.back().end; }
  void end_part(WellKnownGeometry::Kind kind) {
    if (out_.points.size() > begin()) out_.parts.push_back({kind, out_.points.size()});
  }

  In& in_;
  double arc_error_;
  WellKnownGeometry& out_;
};

}  // namespace sf::world
