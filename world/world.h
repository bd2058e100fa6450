#pragma once
// What stands still, and what the movers are made of: the whole of a world file, understood once and immutable after
// load.
//
// A world is 2.5-D: flat outlines with a range of heights. The static part is a list of wall segments; movers (robots
// and linked objects) carry their outlines with them. Tables of rows, joined by row number.

#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/pose.h"

namespace sf::world {

using base::Pose;

inline constexpr std::uint32_t kNone = 0xFFFFFFFFu;

/// One straight piece of surface, visible from both sides.
/// Rule: `a != b`. Where `solid_left`, it belongs to closed simple outlines of a bounded solid, which lies on the left
/// of a -> b: counter-clockwise around it, clockwise around its holes.
struct Segment {
  glm::dvec2 a;
  glm::dvec2 b;  ///< [m] world frame for walls, mover frame for bodies
  double z_min = 0.0;
  double z_max = 0.0;            ///< [m] a beam at height z sees it when z_min <= z < z_max
  std::uint32_t model = 0;       ///< row in `World::models`
  bool solid_left = true;        ///< false: a thin or self-crossing outline; nothing is known about sides
  bool seen_by_laser = true;     ///< false: `laser_return 0` or a negative `ranger_return`
  bool stops_robots = true;      ///< false: `obstacle_return 0`
  bool seen_by_laneedge = true;  ///< false: `laneedge_return 0`
};

/// A named thing of the world file, static or carried by a mover.
struct Model {
  std::string name;              ///< unique in the world; "parent.child" for nested models without a name of their own
  std::string type;              ///< the world file's word for it
  std::uint32_t parent = kNone;  ///< row of the enclosing model
  std::uint32_t mover = kNone;   ///< row in `World::movers` when it moves (or is carried), else kNone
  Pose X_WM;                     ///< at load
  glm::dvec2 size;               ///< [m] bounding box
  std::uint32_t color = 0xFF808080u;  ///< 0xAARRGGBB
  bool is_bitmap = false;             ///< its outline came from a picture (a floor plan)
  double pixel = 0.0;                 ///< [m] larger side of that picture's pixels; 0: no picture
};

/// One painted stripe: a band of constant width along a line. Every dash is a stripe of its own.
/// Rule: at least two points, neighbours distinct; the line turns by less than 90 degrees at each.
struct LaneMarking {
  std::vector<glm::dvec2> line;       ///< [m] its middle, world frame
  double width = 0.0;                 ///< [m] > 0
  std::uint32_t color = 0xFFFFFFFFu;  ///< 0xAARRGGBB
};

/// A permanent magnet: a point dipole at the middle of its model, its moment along the world's +z.
struct Magnet {
  glm::dvec2 p;             ///< [m] world frame, or the mover's frame where a mover carries it
  double z = 0.0;           ///< [m] likewise
  double moment = 0.0;      ///< [A m^2] not 0; negative: the south pole is up
  double radius = 0.0;      ///< [m] > 0: nearer than this the field stays what it is at this distance
  std::uint32_t model = 0;  ///< row in `World::models`
};

/// One property of a sensor as the world file has it, for the kind that reads it.
struct Setting {
  std::string key;              ///< with its index, e.g. `spose[3]`
  std::vector<double> numbers;  ///< as written, finite; empty where it is a text
  std::string text;             ///< as written; empty where it is numbers
  int line = 0;                 ///< 1-based, in `file`
  std::string file;
};

/// A sensor that a mover carries, as the world file describes it. What its settings mean is its kind's business
/// (sensors/<type>.cpp).
struct Sensor {
  std::string type;               ///< the kind's word, e.g. `magnetometer`
  std::string name;               ///< unique among the mover's sensors
  Pose X_MS;                      ///< the model's frame in the mover's, its origin included; z is its foot
  double height = 0.0;            ///< [m] of the model
  double metres_per_unit = 1.0;   ///< [m] per unit of length of the file
  double radians_per_unit = 1.0;  ///< [rad] per unit of angle of the file
  std::vector<Setting> settings;
  int line = 0;  ///< 1-based, of the model in `file`
  std::string file;
};

/// A word that a world file may use for a sensor, and the properties it may have beside those of every model and of
/// every sensor (rate, phase, latency, noise).
struct SensorKeyword {
  std::string_view type;
  std::span<const std::string_view> keys;  ///< indices left empty: `spose[]`
};

/// Noise of a laser. All zero: none. Ranges are disturbed only where a beam met something.
struct LaserNoise {
  double range_sigma = 0.0;         ///< [m] constant part of the range's standard deviation
  double range_proportional = 0.0;  ///< [-] part of the standard deviation per metre of range
  double angle_sigma = 0.0;  ///< [rad] standard deviation of each beam's bearing; turns the beam before it is cast

  bool has_range() const { return range_sigma > 0.0 || range_proportional > 0.0; }
};

/// How accurate a sensor, or all of them, are asked to be: a word that the sensor's kind knows (sensors/accuracy.h).
struct Accuracy {
  std::string word;  ///< empty: nobody asked; a sensor then is as accurate as its world says, a world exact
  std::string file;
  int line = 0;  ///< 1-based, in `file`
};

/// A scanning range finder. Bearings run from -fov/2 to +fov/2, both ends cast exactly; one sample looks at bearing 0.
struct Laser {
  std::string name;              ///< unique among the mover's sensors
  Pose X_MS;                     ///< sensor in the mover's frame; z is the height above the mover's origin
  double fov = M_PI;             ///< [rad] in [0, 2 pi]
  std::uint32_t samples = 180;   ///< in [1, 1'000'000]
  double range_min = 0.0;        ///< [m] echoes nearer than this read range_min
  double range_max = 8.0;        ///< [m] > 0; what a beam reads that meets nothing
  std::uint32_t resolution = 1;  ///< cast every n-th beam (and the last), interpolate the rest
  double rate = 10.0;            ///< [Hz] > 0
  double phase = 0.0;            ///< [s] time of the first reading
  double latency = 0.0;          ///< [s] from measurement to delivery
  LaserNoise noise;
  Accuracy accuracy;
  std::uint32_t color = 0xFF0000FFu;  ///< 0xAARRGGBB, of the drawn field of view
};

/// Bearing of sample `i` in the sensor's frame [rad]; both ends of the field of view exactly, and -b for every b.
inline double bearing_of(const Laser& laser, std::uint32_t i) {
  if (laser.samples < 2) return 0.0;
  const double last = laser.samples - 1;
  const double step = laser.fov / last;
  return 2.0 * i <= last ? -0.5 * laser.fov + i * step : 0.5 * laser.fov - (last - i) * step;
}

/// Skid: wheels on both sides that cannot be steered (Pioneer 3-AT), which scrub when they turn.
enum class Drive { differential, omni, car, skid };

/// What stands between a commanded twist and the wheels (robots/driver_model.h).
enum class DriverModel : std::uint8_t {
  direct,        ///< nothing
  player_create  ///< Player's driver for the iRobot Create: whole millimetres, half the radius, at most 2 m of it
};

/// Something that moves: a robot, or a linked object that follows its packets.
struct Mover {
  std::string name;           ///< the model's name
  std::uint32_t model = 0;    ///< row in `World::models`
  std::uint32_t id = 0;       ///< number on the wire, unique among robots (or among tags)
  bool is_tag = false;        ///< follows tag packets (`tag<N>`); else V2V packets of robot `id`
  Pose X_WM;                  ///< at load
  Pose X_MT;                  ///< where a tag is mounted; not in snapshots, since runs take no tag packets
  std::vector<Segment> body;  ///< outline in its own frame, z above its own origin; carried models included
  double radius = 0.0;        ///< [m] of the circle about its origin that holds the body
  Drive drive = Drive::differential;
  double max_forward = 0.5;                 ///< [m/s] > 0
  double max_turn = M_PI / 2;               ///< [rad/s] > 0
  double max_acceleration = HUGE_VAL;       ///< [m/s^2] > 0, speeding up and slowing down
  double max_turn_acceleration = HUGE_VAL;  ///< [rad/s^2] > 0
  double wheelbase = 1.0;                   ///< [m] between the axles of a car
  double track = 0.3;                       ///< [m] > 0, between left and right wheels, as encoders see it
  DriverModel driver_model = DriverModel::direct;
  std::string controller;  ///< that drives it where nobody says otherwise; empty: the file names none of ours
  std::vector<Laser> lasers;
  std::vector<Sensor> sensors;  ///< of all other kinds, in file order
  std::vector<Magnet> magnets;  ///< that it carries
};

/// One piece of a path: a straight, or an arc.
struct PathPiece {
  Pose X_WP;               ///< the middle of the lane at its start, x along it
  double length = 0.0;     ///< [m] > 0, along the middle
  double curvature = 0.0;  ///< [1/m] positive: to the left; 0: straight
  double width = 0.0;      ///< [m] > 0, of the lane
};

/// A lane to be followed (`path( ... )`), piece after piece.
struct Path {
  std::string name;
  std::vector<PathPiece> pieces;  ///< at least one, each beginning where the one before ends
};

/// What a traffic light shows.
enum class LightState : std::uint8_t { dark, red, yellow, green, flashing_red, flashing_yellow };

struct LightPhase {
  LightState state = LightState::red;
  double duration = 0.0;  ///< [s] > 0
};

/// A traffic light with a fixed plan (world/lights.h says what it shows when).
struct Light {
  std::string name;                ///< unique in the world
  std::uint32_t model = 0;         ///< row in `World::models`
  Pose X_WL;                       ///< its lamps face along x, towards who comes
  bool single = false;             ///< one lamp a side; else three and an indicator on top
  std::vector<LightPhase> phases;  ///< at least one; over and over
  double offset = 0.0;             ///< [s] time at which the first phase begins
  std::vector<std::string>
      points;  ///< way-points of the road network whose stop lines it governs, "segment.lane.point"
};

/// What sends infrared light to be seen by receivers: a virtual wall, or a dock.
struct Emitter {
  enum class Kind : std::uint8_t { virtual_wall, dock };
  Kind kind = Kind::virtual_wall;
  std::uint32_t model = 0;  ///< row in `World::models`
  Pose X_WE;                ///< its beam looks along x
  double range = 0.0;       ///< [m] > 0, of the beam (dock: of the two buoys' beams)
  double fov = 0.0;         ///< [rad] in (0, 2 pi], of the beam, half to each side (dock: of each buoy)
  double halo = 0.0;        ///< [m] >= 0, around it (dock: of the force field)
};

/// An edge in the floor: within its outline there is none.
struct FloorHole {
  std::vector<glm::dvec2> outline;  ///< [m] world frame, closed, simple
  std::uint32_t model = 0;          ///< row in `World::models`
};

/// Something to tell the user that did not stop the load.
struct Warning {
  std::string file;
  int line = 0;  ///< 1-based
  std::string message;
};

struct Extent {
  double x_min = 0.0, y_min = 0.0, x_max = 0.0, y_max = 0.0;  ///< [m] of walls and movers at load
};

struct World {
  std::string name;
  std::string file;  ///< as given by the user
  std::vector<Model> models;
  std::vector<Segment> walls;              ///< static segments in the world frame
  std::vector<LaneMarking> lane_markings;  ///< road paint: seen by lane edge sensors only
  double road_resolution = 0.0;            ///< [m] of the raster that stripes are seen in; 0: they are seen exactly
  std::vector<Magnet> magnets;             ///< that stand still
  double magnet_cutoff = 0.0;              ///< [m] magnets farther away along the ground are left out; 0: none is
  Accuracy accuracy;                       ///< of sensors that say nothing of it and know the word
  std::vector<Mover> movers;
  std::vector<Path> paths;
  std::vector<Light> lights;
  std::vector<Emitter> emitters;
  std::vector<FloorHole> floor_holes;
  std::vector<std::string> road_files;    ///< RNDFs that the world is painted from, as load_roads opens them
  std::map<std::string, int> unmodelled;  ///< entity types that we do not model but keep as bodies, with their count
  double interval = 0.1;                  ///< [s] simulated time per tick (`interval_sim`)
  Extent extent;
  std::vector<Warning> warnings;
  std::uint64_t hash = 0;  ///< of everything above that a reading depends on
};

/// How to read.
struct LoadOptions {
  bool stage_obstacles = false;  ///< keep Stage's rule that `obstacle_return 0` floor plans do not stop robots
  bool stage_noise = false;      ///< read `noise`'s first number as Stage does, as a variance
  bool unknown_is_wall = false;  ///< ROS maps: unknown cells are walls
  bool strict_roads = false;     ///< refuse road networks that do not keep to the letter of their format
  std::string accuracy;          ///< of all sensors, whatever the file says; empty: as it says
  std::span<const SensorKeyword> sensors;  ///< kinds that are modelled; others are kept as bodies that do nothing
};

/// Reads a Stage world (either dialect) or a ROS map_server map (`.yaml`).
/// @throws base::InputError with file, line, what was expected and what to do.
World load_world(const std::string& file, const LoadOptions& options = {});

/// Moves everything by (dx, dy), but not what `road_files` have: for tests far from the origin.
void translate(World& world, double dx, double dy);

/// Grows or shrinks `movers` to `count` copies of the first robot (a mover that is not a tag) at free poses: copy k
/// stands clear of walls and of copies 0..k-1, drawn from (seed, k) alone. Copy 0 is drawn as well.
/// @throws base::InputError when there is no robot, or no room.
void clone_robots(World& world, std::uint32_t count, std::uint64_t seed);

/// Makes `movers` the robots in rows `robots` (ascending) as they are, then a copy of the robot in row `original` at
/// each pose [m, rad], then the tags. Copies have the smallest numbers from 1 that no robot of `robots` has, and are
/// named by them. Nobody looks whether the poses are free.
void copy_robots(World& world, std::uint32_t original, std::span<const Pose> poses,
                 std::span<const std::uint32_t> robots);

/// The whole world as bytes, and back: what a recording carries so that it can be drawn and recomputed elsewhere.
std::vector<std::uint8_t> snapshot(const World& world);
World from_snapshot(const std::vector<std::uint8_t>& bytes);

/// Recomputes `extent` and `hash` from the tables.
void update_extent_and_hash(World& world);

}  // namespace sf::world
