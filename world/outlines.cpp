#include "world/outlines.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "base/box.h"
#include "base/error.h"
#include "base/printable.h"
#include "world/arc.h"
#include "world/outline_faults.h"
#include "world/outline_rows.h"
#include "world/outline_walls.h"
#include "world/stage/properties.h"
#include "world/well_known_geometry.h"

namespace sf::world {

namespace {

constexpr std::size_t kShownHeight = 24;  // characters of a field in messages
constexpr double kMaxInDegrees = 0.01;    // largest outline whose small numbers are taken as degrees; 1 km on Earth

/// Detects coordinates that are not in the world's unit: the file states another unit, or all coordinates are small and
/// all outlines tiny, as in degrees.
class UnitCheck {
 public:
  void add(const WellKnownGeometry& geometry, const OutlineRow& row) {
    if (geometry.srid != 0 && srid_ == 0) {
      srid_ = geometry.srid;
      const SystemUnits units = units_of_epsg(srid_);
      metres_per_unit_ = units.metres_per_unit;
      if (units.is_degrees) degrees_ = "the SRID states that the coordinates are in degrees";
    }
    if (!row.degrees.empty()) degrees_ = row.degrees;
    if (row.metres_per_unit > 0.0) metres_per_unit_ = row.metres_per_unit;
    std::size_t begin = 0;
    for (const WellKnownGeometry::Part& part : geometry.parts) {
      base::Box box = base::empty_box();
      for (; begin < part.end; ++begin) box = base::united(box, {geometry.points[begin], geometry.points[begin]});
      largest_ = std::max({largest_, box.max.x - box.min.x, box.max.y - box.min.y});
      in_range_ = in_range_ && box.min.x >= -180.0 && box.max.x <= 360.0 && box.min.y >= -90.0 && box.max.y <= 90.0;
    }
  }
  /// Returns a warning; empty: none.
  std::string remark(double metres_per_unit) const {
    const bool is_small = largest_ < kMaxInDegrees && metres_per_unit_ == 0.0;
    if (in_range_ && (is_small || !degrees_.empty()))
      return fmt::format(
          "{}, but they are read as lengths; project them first, for example with ogr2ogr -t_srs EPSG:32632",
          degrees_.empty() ? "the coordinates appear to be in degrees" : degrees_);
    if (metres_per_unit_ == 0.0 || std::abs(metres_per_unit_ / metres_per_unit - 1.0) < 1e-9) return {};
    return fmt::format(
        "the file's coordinate system has a unit of {:.8g} m, but its coordinates are read in the world's, {:g} m; "
        "project them first, for example with ogr2ogr -t_srs EPSG:32632 for metres",
        metres_per_unit_, metres_per_unit);
  }

 private:
  std::string degrees_;           ///< why coordinates are degrees; empty: not stated
  double metres_per_unit_ = 0.0;  ///< stated in the file; 0: not stated
  std::uint32_t srid_ = 0;        ///< the first in the file
  bool in_range_ = true;
  double largest_ = 0.0;  ///< largest extent of a ring or line along x or y
};

/// Returns the height [m] of a row's walls. @throws base::InputError with only the reason
double height_of(const OutlineFile& file, std::string_view text) {
  if (text.empty()) return file.surface.z_max;
  double value = NAN;
  const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  const double height = value * file.metres_per_unit;
  if (error == std::errc() && end == text.data() + text.size() && height >= 0.0 && height <= kMaxLength) return height;
  throw base::InputError(fmt::format("the height is '{}'; expected a number alone, such as 3.5, from 0 to {:g}",
                                     base::one_line(text.substr(0, kShownHeight)), kMaxLength / file.metres_per_unit));
}

/// Reads rows one by one into walls and faults.
class OutlineReader {
 public:
  OutlineReader(const OutlineFile& file, const TakeOutline& take)
      : file_(file), walls_(file, take), faults_(file.file) {}

  void read(const OutlineRow& row) {
    bool built = false;
    if (!row.behind_quote.empty())
      faults_.add(OutlineFault::quote, row,
                  fmt::format("text after a closing quote: '{}'; expected a separator or the end of the line",
                              base::one_line(row.behind_quote.substr(0, kShownHeight))));
    try {
      built = build(row);
    } catch (const base::InputError& error) {
      faults_.add(OutlineFault::unreadable, row, error.what());
    }
    if (file_.strict) faults_.refuse();
    if (built) walls_.finish();
  }

  std::vector<Warning> finish(const OutlineRows& rows) {
    if (walls_.count() == 0.0) faults_.fail(rows.columns());
    faults_.note(rows.remark());
    faults_.note(units_.remark(file_.metres_per_unit));
    return faults_.warnings();
  }

 private:
  /// @return false if the row has no walls @throws base::InputError with only the reason
  bool build(const OutlineRow& row) {
    if (row.geometry.empty()) return faults_.add(OutlineFault::empty, row, "has no geometry"), false;
    const double arc_error = kArcError / file_.metres_per_unit;
    if (row.is_binary) {
      read_binary_geometry(row.geometry, arc_error, geometry_);
    } else {
      read_geometry(row.geometry, arc_error, geometry_);
    }
    if (geometry_.points_left_out > 0) faults_.add(OutlineFault::points, row, "points have no walls");
    if (geometry_.faces_left_out > 0)
      faults_.add(OutlineFault::faces, row,
                  "faces in three dimensions have no outline; expected the polygons that they cover");
    if (geometry_.parts.empty() && geometry_.points_left_out == 0 && geometry_.faces_left_out == 0)
      faults_.add(OutlineFault::empty, row, "the geometry is EMPTY");
    if (geometry_.parts.empty()) return false;
    double height = file_.surface.z_max;
    try {
      height = height_of(file_, row.height);
    } catch (const base::InputError& error) {
      faults_.add(OutlineFault::height, row, error.what());
    }
    if (!walls_.build(geometry_, height)) faults_.add(OutlineFault::empty, row, "the geometry has no extent");
    if (walls_.holes_outside() > 0) faults_.add(OutlineFault::hole, row, "an inner ring leaves its outer ring");
    units_.add(geometry_, row);
    return true;
  }

  const OutlineFile& file_;
  OutlineWalls walls_;
  UnitCheck units_;
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
