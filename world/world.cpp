#include "world/world.h"

#include <algorithm>
#include <concepts>
#include <filesystem>
#include <limits>

#include "base/error.h"
#include "base/files.h"
#include "base/hash.h"
#include "world/outlines.h"
#include "world/path_geometry.h"
#include "world/ros_map.h"
#include "world/serialization.h"
#include "world/stage/build_world.h"
#include "world/terrain.h"

namespace sf::world {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr Extent kNowhere{kFar, kFar, -kFar, -kFar};

void include(Extent& extent, glm::dvec2 p) {
  extent = {std::min(extent.x_min, p.x), std::min(extent.y_min, p.y), std::max(extent.x_max, p.x),
            std::max(extent.y_max, p.y)};
}

/// Number and extent of the walls in files.
struct UnreadWalls {
  std::uint64_t count = 0;
  Extent extent = kNowhere;
};

/// Sets the longest wall of each file, and adds warnings.
UnreadWalls measure_unread(World& world) {
  UnreadWalls unread;
  for (OutlineFile& file : world.unread) {
    file.longest = 0.0;
    const auto measure = [&](std::span<const Segment> walls) {
      unread.count += walls.size();
      for (const Segment& wall : walls) {
        sf::world::include(unread.extent, wall.a);
        sf::world::include(unread.extent, wall.b);
        file.longest = std::max(file.longest, glm::length(wall.b - wall.a));
      }
    };
    read_outlines(file, measure, &world.warnings);
  }
  return unread;
}

Extent extent_of(const World& world, Extent extent) {
  const auto include = [&](glm::dvec2 p) { sf::world::include(extent, p); };
  for (const Segment& wall : world.walls) {
    include(wall.a);
    include(wall.b);
  }
  for (const LaneMarking& marking : world.lane_markings)
    for (const glm::dvec2& p : marking.line) include(p);
  for (const Magnet& magnet : world.magnets) include(magnet.p);
  for (const Path& path : world.paths)
    for (const PathPiece& piece : path.pieces) {
      include({piece.X_WP.x, piece.X_WP.y});
      const Pose end = pose_at(piece, piece.length);
      include({end.x, end.y});
    }
  for (const Light& light : world.lights) include({light.X_WL.x, light.X_WL.y});
  for (const Emitter& emitter : world.emitters) include({emitter.X_WE.x, emitter.X_WE.y});
  for (const Lamp& lamp : world.lamps) include({lamp.X_WL.x, lamp.X_WL.y});
  for (const HeatSource& source : world.heat_sources) include(source.p);
  for (const FloorHole& hole : world.floor_holes)
    for (const glm::dvec2& p : hole.outline) include(p);
  for (const Terrain& terrain : world.terrain)
    for (const glm::dvec2& p : outline_of(terrain)) include(p);
  for (const Mover& mover : world.movers) {
    include({mover.X_WM.x, mover.X_WM.y});
    for (const Segment& segment : mover.body) {
      include(transform(mover.X_WM, segment.a));
      include(transform(mover.X_WM, segment.b));
    }
  }
  return extent.x_min <= extent.x_max ? extent : Extent{};
}

/// Fields up to the accuracy keep the hash order from before the table of fields existed.
constexpr auto kFirstHashed = std::make_tuple(&World::interval, &World::models, &World::walls, &World::road_resolution,
                                              &World::lane_markings, &World::magnet_cutoff, &World::accuracy);

/// Worlds without these keep the hash that they had before the fields existed.
constexpr auto kHashedIfSet =
    std::make_tuple(&World::earth_field, &World::lamps, &World::ambient_light, &World::ramps, &World::marking_heights,
                    &World::fiducials, &World::shapes, &World::heat_sources, &World::temperature, &World::variations,
                    &World::floor_unseen, &World::meshes, &World::mesh_models, &World::reflectances, &World::terrain,
                    &World::mesh_materials, &World::daylight, &World::textures, &World::mesh_textures, &World::ground,
                    &World::beam_tables);

template <class Members, class Member>
bool is_among(const Members& members, Member member) {
  const auto same = [&](auto other) {
    if constexpr (std::is_same_v<Member, decltype(other)>) return other == member;
    return false;
  };
  return std::apply([&](auto... others) { return (same(others) || ...); }, members);
}

template <class T>
bool is_set(const T& value) {
  if constexpr (requires { value.empty(); }) {
    return !value.empty();
  } else if constexpr (std::equality_comparable<T>) {
    return !(value == T{});
  } else {
    return true;
  }
}

/// Hashes values as bytes without storing the bytes.
class FieldHash {
 public:
  template <class T>
  void put_rows(const T& rows) {
    for (const auto& row : rows) put(row);
  }
  template <class T>
  void put(const T& value) {
    writer_.put(value);
    if (bytes_.size() > kBlock) flush();
  }
  std::uint64_t value() {
    flush();
    return hash_.value();
  }

 private:
  static constexpr std::size_t kBlock = 1u << 16;
  void flush() {
    hash_.add(bytes_.data(), bytes_.size());
    bytes_.clear();
  }
  base::StreamingHash hash_;
  base::Bytes bytes_;
  base::ByteWriter out_{bytes_};
  RowWriter writer_{out_, RowFields::physics};
};

/// @param unread number of walls in files, which follow the others
std::uint64_t hash_of(const World& world, std::uint64_t unread) {
  FieldHash hash;
  const auto put = [&](auto member) {
    const auto& value = world.*member;
    constexpr bool is_walls = std::is_same_v<decltype(member), decltype(&World::walls)>;
    if constexpr (requires { value.data(); }) {
      hash.put(static_cast<std::uint64_t>(value.size()) + (is_walls ? unread : 0));
      hash.put_rows(value);
    } else {
      hash.put(value);
    }
    if constexpr (is_walls)
      for (const OutlineFile& file : world.unread)
        read_outlines(file, [&](std::span<const Segment> walls) { hash.put_rows(walls); });
  };
  std::apply([&](auto... member) { (put(member), ...); }, kFirstHashed);
  for_each_field<World>([&](const auto& field) {
    if (field.role != Role::physics || is_among(kFirstHashed, field.member)) return;
    if (is_among(kHashedIfSet, field.member) && !is_set(world.*field.member)) return;
    put(field.member);
  });
  return hash.value();
}

}  // namespace

double radius_of(const Mover& mover) {
  double radius = 0.0;
  for (const Segment& segment : mover.body) radius = std::max({radius, length(segment.a), length(segment.b)});
  return radius;
}

void update_extent_and_hash(World& world) {
  for (Mover& mover : world.movers) mover.radius = radius_of(mover);
  const UnreadWalls unread = measure_unread(world);
  world.extent = extent_of(world, unread.extent);
  world.hash = hash_of(world, unread.count);
}

Daylight daylight_of(const World& world) { return world.daylight.empty() ? Daylight{} : world.daylight[0]; }

GroundReflectance ground_of(const World& world) { return world.ground.empty() ? GroundReflectance{} : world.ground[0]; }

void translate(World& world, double dx, double dy) {
  const auto move = [&](auto& p) {
    p.x += dx;
    p.y += dy;
  };
  for (Segment& wall : world.walls) {
    move(wall.a);
    move(wall.b);
  }
  for (OutlineFile& file : world.unread) move(file.X_WF);
  for (LaneMarking& marking : world.lane_markings)
    for (glm::dvec2& p : marking.line) move(p);
  for (Ramp& ramp : world.ramps) move(ramp.a), move(ramp.b);
  for (Magnet& magnet : world.magnets) move(magnet.p);
  for (Path& path : world.paths)
    for (PathPiece& piece : path.pieces) move(piece.X_WP);
  for (Light& light : world.lights) move(light.X_WL);
  for (Emitter& emitter : world.emitters) move(emitter.X_WE);
  for (Lamp& lamp : world.lamps) move(lamp.X_WL);
  for (HeatSource& source : world.heat_sources) move(source.p);
  for (Fiducial& fiducial : world.fiducials)
    if (world.models[fiducial.model].mover == kNone) move(fiducial.X_BF);
  for (MeshModel& row : world.mesh_models)
    if (world.models[row.model].mover == kNone) move(row.X_BF);
  for (FloorHole& hole : world.floor_holes)
    for (glm::dvec2& p : hole.outline) move(p);
  for (Terrain& terrain : world.terrain) move(terrain.X_WT);
  for (Model& model : world.models) move(model.X_WM);
  for (Mover& mover : world.movers) move(mover.X_WM);
  update_extent_and_hash(world);
}

World load_world(const std::string& file, const LoadOptions& options) {
  const std::string ending = base::ending_of(file);
  if (is_ros_map(file)) return load_ros_map(file, options);
  if (ending == ".rndf" || ending == ".rdf" || ending == ".mdf")
    throw base::InputError(file, 0, "is not a world, but a world file can include it with road( rndf \"FILE\" )");
  if (ending == ".toml")
    throw base::InputError(file, 0,
                           "is not a world: use `run` or `test` for scenarios, `sweep` for sweeps, `vps` for testbeds; "
                           "expected a world file (.world) or a ROS map (.yaml)");
  return build_world(file, base::read_text(file), options);
}

}  // namespace sf::world
