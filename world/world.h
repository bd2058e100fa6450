#pragma once
// The world: static geometry and the descriptions of movers, from one world file. After loading, only the functions at
// the end of this header and sensors::set_accuracy change it.
//
// A world is 2.5-D: flat outlines with a range of heights. The static part is a list of wall segments; movers (robots
// and linked objects) carry their outlines. Data is stored in tables, joined by row number.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/ext/vector_float2.hpp>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/pose.h"
#include "world/material.h"

namespace sf::world {

using base::Pose;

inline constexpr std::uint32_t kNone = 0xFFFFFFFFu;

/// One straight piece of surface, visible from both sides.
/// Invariant: `a != b`. With `solid_left`, the segment is part of closed simple outlines of a bounded solid on the left
/// of a -> b: counter-clockwise around the solid, clockwise around its holes.
struct Segment {
  glm::dvec2 a;
  glm::dvec2 b;  ///< [m] world frame for walls, mover frame for bodies
  double z_min = 0.0;
  double z_max = 0.0;            ///< [m] visible to a beam at height z if z_min <= z < z_max
  std::uint32_t model = 0;       ///< row in `World::models`
  bool solid_left = true;        ///< false: a thin or self-crossing outline, whose sides are unknown
  bool seen_by_laser = true;     ///< false: `laser_return 0` or a negative `ranger_return`
  bool stops_robots = true;      ///< false: `obstacle_return 0`
  bool seen_by_laneedge = true;  ///< false: `laneedge_return 0`
};

/// A named model of the world file, static or carried by a mover.
struct Model {
  std::string name;                   ///< unique in the world; "parent.child" for nested models without a name
  std::string type;                   ///< word of the type in the world file
  std::uint32_t parent = kNone;       ///< row of the enclosing model
  std::uint32_t mover = kNone;        ///< row in `World::movers` for a moving or carried model, else kNone
  Pose X_WM;                          ///< pose at load
  glm::dvec2 size;                    ///< [m] bounding box
  std::uint32_t color = 0xFF808080u;  ///< 0xAARRGGBB
  bool is_bitmap = false;             ///< the outline was traced from a picture (a floor plan)
  double pixel = 0.0;                 ///< [m] larger side of that picture's pixels; 0: no picture
};

/// One painted lane marking: a band of constant width along a line. Each dash is a separate marking.
/// Invariant: at least two points, neighbours distinct; the line turns by less than 90 degrees at each point.
struct LaneMarking {
  std::vector<glm::dvec2> line;       ///< [m] centre line, world frame
  double width = 0.0;                 ///< [m] > 0
  std::uint32_t color = 0xFFFFFFFFu;  ///< 0xAARRGGBB
};

/// Heights of the road under a lane marking.
struct MarkingHeights {
  double z_min = 0.0, z_max = 0.0;  ///< [m]
};

/// A straight piece of road above the floor (world/ground.h).
struct Ramp {
  glm::dvec2 a, b;              ///< [m] centre line, world frame
  double z_a = 0.0, z_b = 0.0;  ///< [m] heights of its ends; linear between them
  double half_width = 0.0;      ///< [m] > 0
};

/// A permanent magnet: a point dipole at the centre of its model, with its moment along the world's +z.
struct Magnet {
  glm::dvec2 p;             ///< [m] world frame, or the mover's frame if a mover carries it
  double z = 0.0;           ///< [m] in the same frame
  double moment = 0.0;      ///< [A m^2] not 0; negative: the south pole is up
  double radius = 0.0;      ///< [m] > 0: smaller distances are clamped to this value
  std::uint32_t model = 0;  ///< row in `World::models`

  bool operator==(const Magnet&) const = default;
};

/// One property of a sensor as written in the world file, interpreted by the sensor type.
struct Setting {
  std::string key;              ///< with its index, e.g. `spose[3]`
  std::vector<double> numbers;  ///< as written, finite; empty for a text
  std::string text;             ///< as written, one line per element of a tuple; empty for numbers
  int line = 0;                 ///< 1-based, in `file`
  std::string file;
};

/// A sensor carried by a mover, as described in the world file. The sensor type interprets the settings
/// (sensors/<type>.cpp).
struct Sensor {
  std::string type;     ///< a word of the sensor type, e.g. `magnetometer`
  std::string name;     ///< name of the model; only the `sensor( )` blocks of one model share a name
  Pose X_MS;            ///< the model's frame in the mover's frame, including its origin; z is the foot of the model
  double height = 0.0;  ///< [m] height of the model; 0 for a `sensor( )` block, whose z is its centre
  double metres_per_unit = 1.0;   ///< [m] per unit of length of the file
  double radians_per_unit = 1.0;  ///< [rad] per unit of angle of the file
  std::vector<Setting> settings;
  int line = 0;  ///< 1-based, line of the model in `file`
  std::string file;
  std::uint32_t color = 0xFF0000FFu;  ///< 0xAARRGGBB, colour of the field of view in figures
};

/// A beam of a table of directions.
struct BeamDirection {
  double azimuth = 0.0, elevation = 0.0;  ///< [rad] in the sensor's frame
  double time = 0.0;                      ///< [s] in [0, 3600]
};
inline constexpr std::uint32_t kMostTableBeams = 1'000'000;
inline constexpr double kLongestTable = 3600.0;  ///< [s]

/// A table of directions that settings name (world/beam_table.h).
struct BeamTable {
  std::string world_file;           ///< that names it,
  std::string name;                 ///< and as written there
  bool timed = false;               ///< has the column of times
  std::vector<BeamDirection> rows;  ///< at least one

  /// Returns the latest time [s].
  double duration() const { return std::ranges::max(rows, {}, &BeamDirection::time).time; }
};

/// A sensor type's word in world files, and its properties in addition to those of every model and of every sensor
/// (rate, phase, latency, noise).
struct SensorKeyword {
  std::string_view type;
  std::span<const std::string_view> keys;  ///< without indices: `spose[]`
  /// Properties of its `sensor( )` blocks, each of which is a sensor of this type; empty: the type has no blocks.
  std::span<const std::string_view> block_keys = {};
  bool derived = false;             ///< written `derived( type "localization" ... )`
  std::string_view table_key = {};  ///< of a table of directions (world/beam_table.h); empty: none
};

/// The requested accuracy of one sensor or of all sensors: a word defined by the sensor type (sensors/accuracy.h).
struct Accuracy {
  std::string word;  ///< empty: no request; the sensor then uses the world's word, and the world uses `exact`
  std::string file;
  int line = 0;  ///< 1-based, in `file`
};

/// Drive types. `skid`: wheels on both sides that cannot be steered (Pioneer 3-AT); they scrub in turns.
enum class Drive { differential, omni, car, skid };

/// How a commanded twist becomes wheel motion (robots/command_law.h).
enum class ActuatorModel : std::uint8_t {
  direct,        ///< unchanged
  player_create  ///< Player's driver for the iRobot Create: whole millimetres, half the radius, at most 2 m
};

inline constexpr double kMostSlip = 0.9;
inline constexpr double kLeastAcceleration = 0.01;

/// How a seed chooses the start of a mover, and what it can do in a run (world/random_starts.h).
struct RandomStart {
  glm::dvec3 spread{};        ///< [m], [m], [rad] >= 0: largest distance of x, y and yaw from the pose in the file
  double presence = 1.0;      ///< probability in [0, 1] that it is in the world
  glm::dvec3 size_spread{};   ///< [m] >= 0: largest difference of its size from that in the file
  double slip = 0.0;          ///< in [0, kMostSlip]: largest Variation::slip
  double acceleration = 0.0;  ///< in [0, 1 - kLeastAcceleration]: largest 1 - Variation::acceleration
  double noise = 0.0;         ///< in [0, 1]: largest 1 - Variation::noise
  bool places() const { return spread != glm::dvec3{} || presence < 1.0; }
  bool varies() const { return slip > 0.0 || acceleration > 0.0 || noise > 0.0; }
  bool any() const { return places() || size_spread != glm::dvec3{} || varies(); }
};

/// How a robot of a run differs from its description.
struct Variation {
  double slip = 0.0;          ///< in [0, kMostSlip]: part of its wheels' way that it does not advance
  double acceleration = 1.0;  ///< in [kLeastAcceleration, 1]: factor of its largest accelerations
  double noise = 1.0;         ///< in [0, 1]: factor of all normally distributed errors of its sensors
  bool operator==(const Variation&) const = default;
};

/// How a robot moves in six degrees of freedom (`dynamics "NAME KEY=VALUE ..."`), in place of the kinematics of its
/// drive.
struct DynamicsChoice {
  std::string name;  ///< "car" or a plug-in's file; empty: it moves in the plane
  std::vector<std::pair<std::string, std::string>> settings;  ///< untyped values by key
  std::string at;                                             ///< "FILE:LINE: ", prefix of errors
};

/// A robot, or a linked object that follows packets.
struct Mover {
  std::string name;           ///< the model's name
  std::uint32_t model = 0;    ///< row in `World::models`
  std::uint32_t id = 0;       ///< number in packets, unique among robots (or among tags)
  bool is_tag = false;        ///< follows TAG packets (`tag<N>`); otherwise V2V packets of robot `id`
  Pose X_WM;                  ///< pose at load
  Pose X_MB;                  ///< frame of its own outline (`origin`); not in snapshots, but recorded with changes
  Pose X_MT;                  ///< pose of the mounted tag; not in snapshots, since recorded runs do not use TAG packets
  RandomStart random_start;   ///< not in snapshots
  bool absent = false;        ///< it is not in the world at the start, where only robots always are; not in snapshots
  std::vector<Segment> body;  ///< outline in the mover's frame, z above the mover's origin; includes carried models
  double radius = 0.0;        ///< [m] radius of the circle about the origin that contains the body
  Drive drive = Drive::differential;
  double max_forward = 0.5;                 ///< [m/s] > 0
  double max_turn = M_PI / 2;               ///< [rad/s] > 0
  double max_acceleration = HUGE_VAL;       ///< [m/s^2] > 0, for acceleration and deceleration
  double max_turn_acceleration = HUGE_VAL;  ///< [rad/s^2] > 0
  double wheelbase = 1.0;                   ///< [m] distance between the axles of a car
  double track = 0.3;  ///< [m] > 0, distance between left and right wheels, as measured by encoders
  ActuatorModel actuator_model = ActuatorModel::direct;
  std::string
      controller;  ///< of `ctrl`: a name, "none" (the robot stays at rest), or a file; empty: no known controller
  std::vector<std::pair<std::string, std::string>> controller_settings;  ///< of `ctrl`, untyped values by key
  std::string controller_at;    ///< "FILE:LINE: " of `ctrl`, prefix of errors. Snapshots contain none of these three
  DynamicsChoice dynamics;      ///< not in snapshots, since recordings have the states of robots
  std::vector<Sensor> sensors;  ///< in file order
  std::vector<Magnet> magnets;  ///< carried magnets, in the mover's frame
};

/// One piece of a path: a straight line or an arc.
struct PathPiece {
  Pose X_WP;               ///< the lane's centre line at the start of the piece, x along it
  double length = 0.0;     ///< [m] > 0, along the centre line
  double curvature = 0.0;  ///< [1/m] positive: to the left; 0: straight
  double width = 0.0;      ///< [m] > 0, width of the lane
};

/// A lane to follow (`path( ... )`), piece by piece.
struct Path {
  std::string name;
  std::vector<PathPiece> pieces;  ///< at least one; each starts at the end of the previous one
};

/// State of a traffic light.
enum class LightState : std::uint8_t { dark, red, yellow, green, flashing_red, flashing_yellow };

struct LightPhase {
  LightState state = LightState::red;
  double duration = 0.0;  ///< [s] > 0
};

/// A traffic light with a fixed plan. `signal_at` in world/lights.h gives its state at any time.
struct Light {
  std::string name;                 ///< unique in the world
  std::uint32_t model = 0;          ///< row in `World::models`
  Pose X_WL;                        ///< the lamps face along x, towards approaching robots
  bool single = false;              ///< true: one lamp per side; false: three lamps per side and an indicator on top
  std::vector<LightPhase> phases;   ///< at least one; repeated endlessly
  double offset = 0.0;              ///< [s] start time of the first phase
  std::vector<std::string> points;  ///< "segment.lane.point" of way-points whose stop lines the light controls
};

/// An infrared emitter for receivers on robots: a virtual wall or a dock.
struct Emitter {
  enum class Kind : std::uint8_t { virtual_wall, dock };
  Kind kind = Kind::virtual_wall;
  std::uint32_t model = 0;  ///< row in `World::models`
  Pose X_WE;                ///< the beam points along x
  double range = 0.0;       ///< [m] > 0, range of the beam (dock: of the two buoys' beams)
  double fov = 0.0;         ///< [rad] in (0, 2 pi], full angle of the beam, half to each side (dock: of each buoy)
  double halo = 0.0;        ///< [m] >= 0, radius of the halo around it (dock: of the force field)
};

/// A mark that fiducial finders detect: a model with a `fiducial_return`.
struct Fiducial {
  enum class Type : std::uint8_t { marker, target, threat };
  std::uint32_t model = 0;  ///< row in `World::models`; its own surfaces do not hide it
  Pose X_BF;                ///< middle of the model in its mover's frame, or in the world if no mover carries it;
                            ///< z: [m] above the mover's origin, or in the world
  std::uint32_t id = 0;     ///< `fiducial_return` > 0
  std::uint32_t key = 0;    ///< `fiducial_key`: finders with this key detect it
  Type type = Type::marker;
};

/// A lamp for light sensors: a point source of constant intensity within its beam, dark outside.
struct Lamp {
  std::uint32_t model = 0;  ///< row in `World::models`; its own walls do not block the light
  Pose X_WL;                ///< the beam points along x
  double intensity = 0.0;   ///< [cd] > 0
  double fov = 2.0 * M_PI;  ///< [rad] in (0, 2 pi], full angle of the beam in the plane, at all elevations
};

/// A source of heat or cold: raises the temperature around its middle (sensors/thermometer.h).
struct HeatSource {
  std::uint32_t model = 0;  ///< row in `World::models`
  glm::dvec2 p;             ///< [m] world frame
  double rise = 0.0;        ///< [K] at `p`
  double radius = 1.0;      ///< [m] > 0: the rise there is exp(-1/2) of that at `p`
};

/// A hole in the floor, for cliff sensors.
struct FloorHole {
  std::vector<glm::dvec2> outline;  ///< [m] world frame, closed, simple
  std::uint32_t model = 0;          ///< row in `World::models`
};

/// A named outline that objects can take on at run time (`shape( name "crate" ... )`, world/shapes.h).
struct Shape {
  std::string name;              ///< unique among shapes, not kOriginalShape
  glm::dvec3 size{};             ///< [m] >= 0
  std::uint32_t color = 0;       ///< 0xAARRGGBB; 0: objects keep their own
  bool is_bitmap = false;        ///< as Model::is_bitmap
  double pixel = 0.0;            ///< [m] as Model::pixel
  std::vector<Segment> outline;  ///< [m] of that size, centred in x and y, z from 0; without model and flags
};

/// A mover's own outline, size and colour, kept while it has others (world/shapes.h).
struct OriginalShape {
  std::vector<Segment> outline;  ///< the sides of the mover's own model, in the mover's frame
  Segment surface;               ///< model and flags of its sides
  glm::dvec3 size{};             ///< [m]
  std::uint32_t color = 0;       ///< 0xAARRGGBB
  bool is_bitmap = false;
  double pixel = 0.0;           ///< [m]
  std::vector<Magnet> magnets;  ///< of the mover
  double fiducial_z = 0.0;      ///< [m] of its own fiducial, in its frame; 0: none
};

/// The current shape of a mover that was changed since the world was loaded.
struct ChangedShape {
  std::uint32_t shape = kNone;  ///< row in `World::shapes`; kNone: its own outline
  glm::dvec3 size{};            ///< [m]
  std::uint32_t color = 0;      ///< 0xAARRGGBB
  OriginalShape original;
};

/// The triangles of a file (`mesh "FILE"` of a model), for spatial sensors.
struct Mesh {
  std::string file;                    ///< as opened
  std::vector<glm::dvec3> vertices;    ///< [m] in the frame of a model's body
  std::vector<std::uint32_t> corners;  ///< three rows of `vertices` per triangle, each with an area above 0
};

/// Materials of a mesh whose file states some.
struct MeshMaterials {
  std::uint32_t mesh = 0;                ///< row in `World::meshes`; at most one row of this table per mesh
  std::vector<Material> materials;       ///< at least one
  std::vector<std::uint32_t> triangles;  ///< per triangle: row in `materials`, or kNoMaterial
};

/// A picture on surfaces, for cameras with colours.
struct Texture {
  std::string file;                     ///< the picture, or the mesh that contains it
  std::uint32_t width = 0, height = 0;  ///< [px] in [1, kMostTextureSide]
  std::vector<std::uint8_t> rgb;        ///< 3 bytes of sRGB per texel, row by row from the top
};

/// Textures of a mesh with materials.
struct MeshTextures {
  std::uint32_t mesh = 0;             ///< row in `World::meshes` and of a row of MeshMaterials; at most one per mesh
  std::vector<TextureUse> materials;  ///< per row of MeshMaterials::materials: row in `World::textures`
  std::vector<glm::vec2> corners;     ///< per corner of the mesh: texture coordinates, (0, 0) at the picture's top left
                                      ///< and (1, 1) at its bottom right, within kMostTextureCoordinate
};

/// A model that spatial sensors see as a mesh. Planar sensors and contacts use its outline.
struct MeshModel {
  std::uint32_t mesh = 0;   ///< row in `World::meshes`
  std::uint32_t model = 0;  ///< row in `World::models`
  Pose X_BF;                ///< frame of its body in its mover's frame, or in the world if no mover carries it
};

/// Reflectance of a model's surfaces for the intensities of spatial scans: the part of light that an ideal diffuse
/// surface returns; above 1 for retroreflectors. Models without a row have those of their mesh's materials.
struct Reflectance {
  std::uint32_t model = 0;  ///< row in `World::models`
  double value = 0.0;       ///< in [0, kMostReflectance]
};

/// A height map of the ground (world/terrain.h), in place of the floor in its rectangle. Each cell is cut along the
/// diagonal from its corner with the smallest x and y into two triangles.
struct Terrain {
  std::string file;                     ///< as opened
  Pose X_WT;                            ///< its middle, with x along the rows; z is that of height 0
  glm::dvec2 cell{};                    ///< [m] > 0
  std::uint32_t columns = 0, rows = 0;  ///< of points, each at least 2
  std::vector<float> heights;           ///< [m] row by row from the smallest y, finite
};

/// Light and colours outside of models, for cameras (sensors/camera_light.h). Irradiances are relative: a white surface
/// with 1 is just fully exposed at a gain of 1.
struct Daylight {
  double azimuth = 0.75 * M_PI;          ///< [rad] of the sun, counter-clockwise from the x axis
  double elevation = 5.0 / 18.0 * M_PI;  ///< [rad] of the sun; 0 or less: it does not shine
  double sun = 0.8;                      ///< in [0, 100], on a surface that faces it
  double sky = 0.3;                      ///< in [0, 100], on a level surface
  std::uint32_t floor = 0xFFB0B0B0u;     ///< 0xAARRGGBB, of the floor, roads and terrain
};

/// Reflectances of the ground, as Reflectance::value.
struct GroundReflectance {
  double floor = kDefaultReflectance;  ///< of the floor, roads and terrain
  double paint = 0.8;                  ///< of lane markings
};

/// A user message about a problem that did not stop the load.
struct Warning {
  std::string file;
  int line = 0;  ///< 1-based; 0: the whole file
  std::string message;
  bool operator==(const Warning&) const = default;
};

struct Extent {
  double x_min = 0.0, y_min = 0.0, x_max = 0.0, y_max = 0.0;  ///< [m] bounds of all geometry and movers
};

/// A file of outlines (`outlines "FILE"` of a model, world/outlines.h) whose walls are not in `World::walls`.
struct OutlineFile {
  std::string file;              ///< as opened
  Pose X_WF;                     ///< frame of the file's coordinates; z is the foot of the walls
  double metres_per_unit = 1.0;  ///< [m] per unit of length of the file
  Segment surface;               ///< model, flags, and the height of outlines without a height in the file (`z_max`)
  double longest = 0.0;          ///< [m] length of the longest wall
  bool strict = false;           ///< reject rows that would be skipped or have no valid height
};

struct World {
  std::string name;
  std::string file;  ///< as given by the user
  /// YAML file of its ROS map, possibly equal to `file`; empty: none, or a world from a snapshot
  std::string ros_map;
  std::vector<Model> models;
  std::vector<Segment> walls;              ///< static segments in the world frame
  std::vector<OutlineFile> unread;         ///< walls after `walls`, part of `extent` and `hash` (leave_outlines)
  std::vector<LaneMarking> lane_markings;  ///< road paint, visible to lane edge sensors and cameras
  std::vector<Ramp> ramps;                 ///< roads with heights
  /// Of the first lane markings; those without are on the floor. Empty in worlds without ramps.
  std::vector<MarkingHeights> marking_heights;
  double road_resolution = 0.0;  ///< [m] raster step for lane edge sensors; 0: exact markings
  std::vector<Magnet> magnets;   ///< static magnets
  glm::dvec3 earth_field{};      ///< [T] homogeneous field added to that of all magnets; 0: none
  double magnet_cutoff = 0.0;    ///< [m] magnets beyond this horizontal distance are ignored; 0: none
  Accuracy accuracy;             ///< for sensors without their own word, if their type has the word
  std::vector<Mover> movers;
  std::uint32_t copies =
      1;  ///< > 0: the movers are those of so many worlds, in turn (world/copies.h); not in snapshots
  std::vector<Path> paths;
  std::vector<Light> lights;
  std::vector<Emitter> emitters;
  std::vector<Lamp> lamps;
  std::vector<HeatSource> heat_sources;
  std::vector<Fiducial> fiducials;
  std::vector<Shape> shapes;  ///< at most kMostShapes
  /// By row of the mover; not in snapshots. The first change of a mover adds its entry.
  std::map<std::uint32_t, ChangedShape> changed_shapes;
  double ambient_light = 0.0;         ///< [lx] on every surface, without shadows
  double temperature = 0.0;           ///< [degrees Celsius] far from all heat sources
  std::vector<Variation> variations;  ///< of the first movers, by row; empty: none has one
  std::vector<FloorHole> floor_holes;
  bool floor_unseen = false;  ///< spatial scans see no floor at z = 0 (`floor_return 0`)
  std::vector<Mesh> meshes;
  std::vector<MeshModel> mesh_models;
  std::vector<Reflectance> reflectances;
  std::vector<Terrain> terrain;  ///< at most one
  std::vector<MeshMaterials> mesh_materials;
  std::vector<Daylight> daylight;  ///< at most one; empty: the default (daylight_of)
  std::vector<Texture> textures;   ///< empty unless a camera of the file has colours
  std::vector<MeshTextures> mesh_textures;
  std::vector<GroundReflectance> ground;  ///< at most one; empty: the default (ground_of)
  std::vector<BeamTable> beam_tables;
  std::vector<std::string> road_files;    ///< paths of the RNDFs of the world's roads, as opened by load_roads
  std::map<std::string, int> unmodelled;  ///< entity types that become plain bodies, with their counts
  double interval = 0.1;                  ///< [s] simulated time per tick (`interval_sim`)
  Extent extent;
  std::vector<Warning> warnings;
  std::uint64_t hash = 0;  ///< of all data above that readings depend on, except colours of models and
                           ///< paint; changes of shapes do not update it

  Variation variation_of(std::uint32_t mover) const {
    return mover < variations.size() ? variations[mover] : Variation{};
  }
};

/// Options for loading.
struct LoadOptions {
  bool stage_obstacles = false;  ///< use Stage's rule that floor plans with `obstacle_return 0` do not stop robots
  bool stage_noise = false;      ///< read the first number of `noise` as a variance, as Stage does
  bool unknown_is_wall = false;  ///< ROS maps: unknown cells are walls
  bool strict = false;           ///< reject road networks and files of outlines that deviate from their format
  bool leave_outlines = false;   ///< keep the walls of outline files in their files (`World::unread`)
  std::string accuracy;          ///< word for all sensors, overrides those of the file; empty: no override
  /// Returns the names of all controllers that `ctrl` may choose; null: only "wander".
  std::vector<std::string_view> (*controllers)() = nullptr;
  /// Returns the names of all controllers that `ctrl` of models that are not robots may choose; null: only files.
  std::vector<std::string_view> (*model_controllers)() = nullptr;
  std::span<const SensorKeyword> sensors;  ///< modelled sensor types; models of other types become plain bodies
};

/// Reads a Stage world (either dialect) or a ROS map_server map (`.yaml`).
/// @throws base::InputError with file, line, expected input and advice
World load_world(const std::string& file, const LoadOptions& options = {});

/// Moves all geometry by (dx, dy), except the networks of `road_files`. For tests far from the origin.
void translate(World& world, double dx, double dy);

/// Grows or shrinks `movers` to `count` copies of one robot (a mover that is not a tag) at free poses: the first with
/// sensors, or else the first (robot_to_copy, world/free_space.h). Copy k is clear of walls and of copies 0..k-1, and
/// is drawn only from (seed, k). Copy 0 gets a new pose as well.
/// @throws base::InputError if there is no robot, or not enough room
void clone_robots(World& world, std::uint32_t count, std::uint64_t seed);

/// Replaces `movers` by the unchanged robots in rows `robots` (ascending), then a copy of the robot in row `original`
/// at each pose [m, rad], then the tags. Copies get the smallest ids from 1 that no robot in `robots` has, and names
/// with these ids. Does not check the poses for collisions.
void copy_robots(World& world, std::uint32_t original, std::span<const Pose> poses,
                 std::span<const std::uint32_t> robots);

/// Serializes the whole world, and restores it. Recordings contain a snapshot, so a run can be drawn and recomputed
/// elsewhere.
std::vector<std::uint8_t> snapshot(const World& world);
World from_snapshot(const std::vector<std::uint8_t>& bytes);

Daylight daylight_of(const World& world);
GroundReflectance ground_of(const World& world);

/// [m] Returns the radius of the circle about the mover's origin that contains its body.
double radius_of(const Mover& mover);

/// Recomputes every mover's `radius`, then `extent` and `hash`, from the tables.
void update_extent_and_hash(World& world);

}  // namespace sf::world
