// Lane edges at every angle, and points that do not form an edge.

#include <fmt/format.h>

#include "selftest/fixture.h"
#include "selftest/suite.h"
#include "sensors/laneedge.h"

namespace sf::selftest {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct LaneEdgeReading {
  double distance, points;
};

LaneEdgeReading read(Fixture& fixture, world::World world, const Pose& X_WM, Settings settings = {}) {
  const bool said =
      std::any_of(settings.begin(), settings.end(), [](const auto& s) { return s.first == "perpendicular"; });
  if (!said) settings.push_back({"perpendicular", {0.0}});
  world.movers[add_mover(world, X_WM)].sensors.push_back(sensor("laneedge", settings, 0.1));
  const TestFarm test = fixture.measure(std::move(world));
  return {test.readings[0].values[0], test.readings[0].values[1]};
}

/// [m] Distance between neighbouring doubles at `x`.
double grain(double x) { return std::nextafter(std::fabs(x), HUGE_VAL) - std::fabs(x); }

/// A marking 10 cm wide and 4 m long whose near face crosses the sensor's axis at `distance`, rotated by `tilt`.
world::World marking_ahead(const Pose& X_WM, double distance, double tilt) {
  const glm::dvec2 ahead = base::rotate(X_WM.yaw, {1.0, 0.0}), normal = base::rotate(X_WM.yaw + tilt, {1.0, 0.0});
  const glm::dvec2 middle = glm::dvec2{X_WM.x, X_WM.y} + distance * ahead + 0.05 * normal;
  const glm::dvec2 along{-normal.y, normal.x};
  world::World world;
  world.lane_markings.push_back({{middle - 2.0 * along, middle + 2.0 * along}, 0.1});
  return world;
}

/// [m] Exact distance along the sensor's axis to the near face of the marking with its rounded corners.
Real face_ahead(const world::LaneMarking& marking, const Pose& X_WM) {
  const glm::dvec2 a = marking.line[0], b = marking.line[1];
  const Real tx = Real{b.x} - a.x, ty = Real{b.y} - a.y, size = std::hypot(tx, ty);
  const Real nx = ty / size, ny = -tx / size;  // away from the sensor
  const Real ex = std::cos(Real{X_WM.yaw}), ey = std::sin(Real{X_WM.yaw});
  const Real height = nx * (Real{a.x} - X_WM.x) + ny * (Real{a.y} - X_WM.y);
  return (height - Real{0.05}) / (nx * ex + ny * ey);
}

/// The corners of faces are rounded to doubles: four roundings of half a grain. The pixel size of a point is stored in
/// the last bits of its x, 6e-14 of it. A tilt increases both errors.
void angles(Fixture& fixture, Checks& checks) {
  for (const double far : {0.0, 1e5, 1e7}) {
    world::World world;
    std::vector<double> tilts;
    for (const double yaw : {0.0, 0.5 * M_PI, -0.5 * M_PI, M_PI, 0.7, 1e6})
      for (const double tilt : {0.0, 0.3, -0.8, 1.2}) {
        const Pose X_WM{far + 20.0 * static_cast<double>(tilts.size()), -far, 0.0, yaw};
        world.lane_markings.push_back(marking_ahead(X_WM, 0.45, tilt).lane_markings[0]);
        world.movers[add_mover(world, X_WM)].sensors.push_back(sensor("laneedge", {{"perpendicular", {0.0}}}, 0.1));
        tilts.push_back(tilt);
      }
    const TestFarm test = fixture.measure(world);
    for (const base::ReadingBlock& r : test.readings) {
      const Pose& X_WM = world.movers[r.mover].X_WM;
      const double allowed = (1e-13 + 4.0 * grain(2.0 * far)) / std::pow(std::cos(tilts[r.mover]), 2);
      checks.near(r.values[0], face_ahead(world.lane_markings[r.mover], X_WM), allowed,
                  fmt::format("{:g} m away, heading {:g}, tilt {:g}", far, X_WM.yaw, tilts[r.mover]));
    }
  }
}

void through_the_sensor(Fixture& fixture, Checks& checks) {
  for (const double far : {0.0, 1e5})
    for (const double tilt : {0.0, 0.3, -0.9}) {
      const Pose X_WM{far, -far, 0.0, 0.0};
      world::World world = marking_ahead(X_WM, 0.0, tilt);
      checks.near(read(fixture, world, X_WM).distance, 0, 1e-9, fmt::format("{:g} m away, tilt {:g}", far, tilt));
    }
  // From a point on the paint: the distance to its end.
  checks.near(read(fixture, marking_ahead({}, -0.025, 0.0), {}).distance, 0.075L, 1e-13, "on the paint");
}

void edge_ranges(Fixture& fixture, Checks& checks) {
  for (const double range : {1e-6, 1e-4, 1.0, 100.0, 1e4}) {
    world::World world;
    world.lane_markings.push_back({{{0.55 * range, -2.0 * range}, {0.55 * range, 2.0 * range}}, 0.1 * range});
    const LaneEdgeReading said = read(fixture, world, {}, {{"range_max", {range}}});
    checks.near(said.distance / range, 0.5L, 1e-12, fmt::format("range_max {:g}", range));
  }
  for (const double range : {0.5e-6, 1.1e4})
    checks.refused(
        [&] {
          read(fixture, {}, {}, {{"range_max", {range}}});
        },
        "range_max", fmt::format("range_max {:g}", range));
}

/// One ray of three hits a dash 2 cm long. Then both of two rays hit, and the reading is the range of the first one.
void one_point(Fixture& fixture, Checks& checks) {
  world::World world;
  world.lane_markings.push_back({{{0.5, -0.01}, {0.5, 0.01}}, 0.1});
  const LaneEdgeReading one = read(fixture, world, {}, {{"samples", {3}}, {"fov", {60}}});
  checks.same(one.distance, kNone, "one point is not an edge");
  checks.same(one.points, 1.0, "it is counted");
  checks.near(read(fixture, world, {}, {{"samples", {1}}, {"fov", {0}}}).distance, 0.45L, 6e-14,
              "a single ray's range is its reading");
  checks.same(read(fixture, {}, {}).distance, kNone, "no point at all");
  checks.same(read(fixture, {}, {}).points, 0.0, "none is counted");
}

/// Rays so close together that their points coincide.
void equal_points(Fixture& fixture, Checks& checks) {
  world::World world;
  world.lane_markings.push_back({{{0.5, -1.0}, {0.5, 1.0}}, 0.1});
  for (const double samples : {3.0, 61.0}) {
    const LaneEdgeReading said = read(fixture, world, {}, {{"samples", {samples}}, {"fov", {1e-6}}});
    checks.same(said.distance, kNone, "points closer than 1e-7 of their distance are not an edge");
    checks.same(said.points, samples, "they are counted");
  }
  checks.near(read(fixture, world, {}, {{"samples", {3}}, {"fov", {1.0}}}).distance, 0.45L, 1e-13,
              "a degree apart they are an edge");
}

/// Points ahead and behind on one line through the sensor.
void collinear_with_the_sensor(Fixture& fixture, Checks& checks) {
  world::World world;
  world.lane_markings.push_back({{{0.5, -1.0}, {0.5, 1.0}}, 0.1});
  world.lane_markings.push_back({{{-0.4, -1.0}, {-0.4, 1.0}}, 0.1});
  const Settings fan{{"samples", {3}}, {"fov", {360}}};
  Settings across = fan;
  across.push_back({"perpendicular", {90.0}});
  const LaneEdgeReading along = read(fixture, world, {}, fan);
  checks.same(along.distance, kNone, "a line along the perpendicular is met nowhere");
  checks.same(along.points, 3.0, "its points are counted");
  checks.near(read(fixture, world, {}, across).distance, 0, 1e-15, "across it, the line passes through the sensor");
}

void out_of_sight(Fixture& fixture, Checks& checks) {
  world::World world;
  world.lane_markings.push_back({{{-3.0, 0.5}, {3.0, 0.5}}, 0.1});
  checks.same(read(fixture, world, {}, {{"fov", {170}}}).distance, kNone, "an edge along the perpendicular");
  checks.same(read(fixture, marking_ahead({}, 0.5, 0.0), {}, {{"perpendicular", {180}}}).distance, kNone,
              "an edge on the other side");
  checks.same(read(fixture, marking_ahead({}, 0.99, 0.0), {}).distance, kNone, "an edge near the range's end");
}

constexpr Case kLaneEdgeCases[] = {
    {"edges", "edge-angles", "m",
     "vertical, horizontal and tilted, 0 to 1e7 m away: four roundings of the paint's corners over cos^2", angles},
    {"edges", "through-the-sensor", "m", "an edge through the sensor: 0, within the touch of 1 nm", through_the_sensor},
    {"edges", "edge-ranges", "of range",
     "range_max 1 um to 10 km: half of it, rounding of 64 bits; rejected by name beyond both ends", edge_ranges},
    {"edges", "one-point", "m", "one point, or none, is not an edge; a single ray is its own reading", one_point},
    {"edges", "equal-points", "m", "points that coincide within 1e-7 are not an edge", equal_points},
    {"edges", "collinear-points", "m",
     "points in one line with the sensor: no edge along the perpendicular, 0 across it", collinear_with_the_sensor},
    {"edges", "out-of-sight", "m", "edges along the perpendicular, behind, and at the end of the range: none",
     out_of_sight},
};

}  // namespace

std::span<const Case> lane_edge_cases() { return kLaneEdgeCases; }

}  // namespace sf::selftest
