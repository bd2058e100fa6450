#include "world/outlines.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "base/box.h"
#include "base/error.h"
#include "world/arc.h"
#include "world/outline_faults.h"
#include "world/outline_rows.h"
#include "world/stage/polygon.h"
#include "world/stage/properties.h"
#include "world/wall_tree.h"
#include "world/well_known_geometry.h"

namespace sf::world {

namespace {

constexpr double kMaxCornerPairs = 1e9;   // of edges of all rings that are compared; the check for crossings
constexpr double kTouching = 1e-6;        // [m] to an outer ring, from a corner of an inner one that may be on it
constexpr std::size_t kShownHeight = 24;  // characters of a field in messages
constexpr double kMaxWalls = 5e7;         // of a file
constexpr double kMaxInDegrees = 0.01;    // largest outline where small numbers are taken for degrees; 1 km on Earth

/// The walls of a file's geometries, in the world frame.
class WallBuilder {
 public:
  WallBuilder(const OutlineFile& file, const TakeOutline& take) : file_(file), take_(take) {}

  /// Builds the walls of one row. @throws base::InputError for a row that cannot be built
  void build(const WellKnownGeometry& geometry, double height) {
    walls_.clear();
    ends_.clear();
    outer_.solid = false;
    holes_outside_ = 0;
    std::size_t begin = 0;
    for (const WellKnownGeometry::Part& part : geometry.parts) {
      const auto points = std::span(geometry.points).subspan(begin, part.end - begin);
      begin = part.end;
      if (part.kind == WellKnownGeometry::Kind::line) {
        for (std::size_t k = 1; k < points.size(); ++k) add_wall(points[k - 1], points[k], false);
      } else if (part.kind == WellKnownGeometry::Kind::outer) {
        add_outer_ring(points);
      } else {
        add_hole(points);
      }
      if (walls_.size() > (ends_.empty() ? 0 : ends_.back())) ends_.push_back(walls_.size());
    }
    for (Segment& wall : walls_) {
      wall.z_min = file_.X_WF.z;
      wall.z_max = file_.X_WF.z + height;
    }
  }

  /// Hands on the walls of the row that was built.
  void finish() {
    count_ += static_cast<double>(walls_.size());
    if (count_ > kMaxWalls)
      throw base::InputError(file_.file, 0, fmt::format("has more than {:g} walls, the limit for a file", kMaxWalls));
    std::size_t begin = 0;
    for (const std::size_t end : ends_) {
      take_(std::span(walls_).subspan(begin, end - begin));
      begin = end;
    }
  }
  double count() const { return count_; }               ///< of walls handed on
  int holes_outside() const { return holes_outside_; }  ///< inner rings of the row that leave their outer ring

 private:
  [[noreturn]] static void refuse_pairs(std::size_t corners) {
    throw base::InputError(
        fmt::format("a ring of {} corners: its check for crossings takes the file beyond {:g} pairs of edges; simplify "
                    "it (ST_Simplify, ogr2ogr -simplify)",
                    corners, kMaxCornerPairs));
  }
  Polygon polygon_of(std::span<const glm::dvec2> points) {
    auto polygon = make_polygon({points.begin(), points.end()}, pairs_);
    if (!polygon) refuse_pairs(points.size());
    return *std::move(polygon);
  }
  void add_outer_ring(std::span<const glm::dvec2> points) {
    const Polygon ring = polygon_of(points);
    outer_.begin = walls_.size();
    outer_.solid = ring.solid_left;
    for (const PolygonEdge& edge : ring.edges) add_wall(edge.a, edge.b, ring.solid_left);
    outer_.end = walls_.size();
  }
  /// Without a solid round it, a hole would turn inside and outside.
  void add_hole(std::span<const glm::dvec2> points) {
    const Polygon ring = polygon_of(points);
    const bool outside = outer_.solid && is_outside(ring);
    holes_outside_ += outside;
    const bool solid = ring.solid_left && outer_.solid && !outside;
    for (auto edge = ring.edges.rbegin(); edge != ring.edges.rend(); ++edge) add_wall(edge->b, edge->a, solid);
  }
  bool is_outside(const Polygon& hole) {
    pairs_ -= static_cast<double>(hole.edges.size()) * static_cast<double>(outer_.end - outer_.begin);
    if (pairs_ < 0.0) refuse_pairs(hole.edges.size());
    const auto outer = std::span(walls_).subspan(outer_.begin, outer_.end - outer_.begin);
    return std::any_of(hole.edges.begin(), hole.edges.end(), [&](const PolygonEdge& edge) {
      const glm::dvec2 p = placed(edge.a);
      const auto touches = [&](const Segment& wall) { return distance_to(wall, p) <= kTouching; };
      return winding_number(outer, p) == 0 && std::none_of(outer.begin(), outer.end(), touches);
    });
  }
  static double distance_to(const Segment& wall, glm::dvec2 p) {
    const glm::dvec2 along = wall.b - wall.a;
    return length(p - wall.a - std::clamp(dot(p - wall.a, along) / dot(along, along), 0.0, 1.0) * along);
  }
  glm::dvec2 placed(glm::dvec2 p) const { return transform(file_.X_WF, file_.metres_per_unit * p); }
  void add_wall(glm::dvec2 a, glm::dvec2 b, bool solid) {
    Segment wall = file_.surface;
    wall.a = placed(a);
    wall.b = placed(b);
    wall.solid_left = solid;
    const double farthest = std::max({std::abs(wall.a.x), std::abs(wall.a.y), std::abs(wall.b.x), std::abs(wall.b.y)});
    if (!(farthest <= kMaxLength))
      throw base::InputError(
          fmt::format("a corner is {:g} m from the origin of the world; expected at most {:g} m: shift "
                      "the outlines by the model's 'pose'",
                      farthest, kMaxLength));
    if (wall.a != wall.b) walls_.push_back(wall);
  }

  const OutlineFile& file_;
  const TakeOutline& take_;
  std::vector<Segment> walls_;     ///< of the row in work
  std::vector<std::size_t> ends_;  ///< of its rings and lines in `walls_`
  struct {
    std::size_t begin = 0, end = 0;
    bool solid = false;
  } outer_;  ///< the last outer ring, in `walls_`
  int holes_outside_ = 0;
  double count_ = 0.0;  ///< of all rows
  double pairs_ = kMaxCornerPairs;
};

/// Finds coordinates in degrees: by the file's own words, or since all are small and no outline has any size.
class DegreeCheck {
 public:
  void add(const WellKnownGeometry& geometry, bool is_geographic) {
    constexpr std::uint32_t kFirst = 4001, kLast = 4999;  // EPSG's range of geographic systems
    stated_ = stated_ || is_geographic || (geometry.srid >= kFirst && geometry.srid <= kLast);
    std::size_t begin = 0;
    for (const WellKnownGeometry::Part& part : geometry.parts) {
      base::Box box = base::empty_box();
      for (; begin < part.end; ++begin) box = base::united(box, {geometry.points[begin], geometry.points[begin]});
      largest_ = std::max({largest_, box.max.x - box.min.x, box.max.y - box.min.y});
      in_range_ = in_range_ && box.min.x >= -180.0 && box.max.x <= 360.0 && box.min.y >= -90.0 && box.max.y <= 90.0;
    }
  }
  bool finds() const { return in_range_ && (stated_ || largest_ < kMaxInDegrees); }

 private:
  bool stated_ = false;
  bool in_range_ = true;
  double largest_ = 0.0;  ///< extent of a ring or line along x or y
};

/// [m] of a row's walls. @throws base::InputError with the reason alone
double height_of(const OutlineFile& file, std::string_view text) {
  if (text.empty()) return file.surface.z_max;
  double value = NAN;
  const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  const double height = value * file.metres_per_unit;
  if (error == std::errc() && end == text.data() + text.size() && height >= 0.0 && height <= kMaxLength) return height;
  throw base::InputError(fmt::format("the height is '{}'; expected a number alone, such as 3.5, from 0 to {:g}",
                                     text.substr(0, kShownHeight), kMaxLength / file.metres_per_unit));
}

/// Reads rows one by one into walls and faults.
class OutlineReader {
 public:
  OutlineReader(const OutlineFile& file, const TakeOutline& take)
      : file_(file), builder_(file, take), faults_(file.file) {}

  void read(const OutlineRow& row) {
    bool built = false;
    try {
      built = build(row);
    } catch (const base::InputError& error) {
      faults_.add(OutlineFault::unreadable, row, error.what());
    }
    if (file_.strict) faults_.refuse();
    if (built) builder_.finish();
  }

  std::vector<Warning> finish(const OutlineRows& rows) {
    if (builder_.count() == 0.0) faults_.fail(rows.columns());
    faults_.note(rows.remark());
    if (degrees_.finds())
      faults_.note(
          "the coordinates are degrees, as it seems, but count as lengths; project them first, such as by "
          "ogr2ogr -t_srs EPSG:32632");
    return faults_.warnings();
  }

 private:
  /// @return false: the row has no walls. @throws base::InputError with the reason alone
  bool build(const OutlineRow& row) {
    if (row.geometry.empty()) return faults_.add(OutlineFault::empty, row, "has no geometry"), false;
    const double arc_error = kArcError / file_.metres_per_unit;
    if (row.is_binary) {
      read_binary_geometry(row.geometry, arc_error, geometry_);
    } else {
      read_geometry(row.geometry, arc_error, geometry_);
    }
    if (geometry_.points_left_out > 0) faults_.add(OutlineFault::points, row, "points have no walls");
    if (geometry_.parts.empty() && geometry_.points_left_out == 0)
      faults_.add(OutlineFault::empty, row, "the geometry is EMPTY");
    if (geometry_.parts.empty()) return false;
    double height = file_.surface.z_max;
    try {
      height = height_of(file_, row.height);
    } catch (const base::InputError& error) {
      faults_.add(OutlineFault::height, row, error.what());
    }
    builder_.build(geometry_, height);
    if (builder_.holes_outside() > 0) faults_.add(OutlineFault::hole, row, "an inner ring leaves its outer ring");
    degrees_.add(geometry_, row.is_geographic);
    return true;
  }

  const OutlineFile& file_;
  WallBuilder builder_;
  DegreeCheck degrees_;
  OutlineFaults faults_;
  WellKnownGeometry geometry_;
};

}  // namespace

void read_outlines(const OutlineFile& file, const TakeOutline& take, std::vector<Warning>* warnings) {
  const auto rows = open_outline_rows(file.file);
  OutlineReader reader(file, take);
  for (OutlineRow row; rows->next(row);) reader.read(row);
  const std::vector<Warning> found = reader.finish(*rows);
  if (warnings == nullptr) return;
  for (const Warning& warning : found)  // a file may be read several times
    if (std::find(warnings->begin(), warnings->end(), warning) == warnings->end()) warnings->push_back(warning);
}

void read_unread(World& world) {
  for (const OutlineFile& file : world.unread)
    read_outlines(
        file,
        [&](std::span<const Segment> walls) { world.walls.insert(world.walls.end(), walls.begin(), walls.end()); },
        &world.warnings);
  world.unread.clear();
}

}  // namespace sf::world
