#include <algorithm>
#include <limits>

#include "base/hash.h"
#include "world/path_geometry.h"
#include "world/serialization.h"

namespace sf::world {

namespace {

Extent extent_of(const World& world) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Extent extent{kFar, kFar, -kFar, -kFar};
  const auto include = [&](glm::dvec2 p) {
    extent = {std::min(extent.x_min, p.x), std::min(extent.y_min, p.y), std::max(extent.x_max, p.x),
              std::max(extent.y_max, p.y)};
  };
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
  for (const FloorHole& hole : world.floor_holes)
    for (const glm::dvec2& p : hole.outline) include(p);
  for (const Mover& mover : world.movers) {
    include({mover.X_WM.x, mover.X_WM.y});
    for (const Segment& segment : mover.body) {
      include(transform(mover.X_WM, segment.a));
      include(transform(mover.X_WM, segment.b));
    }
  }
  return extent.x_min <= extent.x_max ? extent : Extent{};
}

double radius_of(const Mover& mover) {
  double radius = 0.0;
  for (const Segment& segment : mover.body) radius = std::max({radius, length(segment.a), length(segment.b)});
  return radius;
}

/// The order of the hash up to the accuracy is older than the table's.
constexpr auto kFirstHashed = std::make_tuple(&World::interval, &World::models, &World::walls, &World::road_resolution,
                                              &World::lane_markings, &World::magnet_cutoff, &World::accuracy);

template <class Member>
bool is_first_hashed(Member member) {
  const auto same = [&](auto other) {
    if constexpr (std::is_same_v<Member, decltype(other)>) return other == member;
    return false;
  };
  return std::apply([&](auto... others) { return (same(others) || ...); }, kFirstHashed);
}

std::uint64_t hash_of(const World& world) {
  std::vector<std::uint8_t> bytes;
  base::ByteWriter out(bytes);
  RowWriter writer{out, RowFields::physics};
  const auto put = [&](const auto& value) {
    if constexpr (requires { value.data(); }) {
      out.put(static_cast<std::uint64_t>(value.size()));
      for (const auto& row : value) writer.put(row);
    } else {
      writer.put(value);
    }
  };
  std::apply([&](auto... member) { (put(world.*member), ...); }, kFirstHashed);
  for_each_field<World>([&](const auto& field) {
    if (field.role == Role::physics && !is_first_hashed(field.member)) put(world.*field.member);
  });
  return base::hash_bytes(bytes.data(), bytes.size());
}

}  // namespace

void update_extent_and_hash(World& world) {
  for (Mover& mover : world.movers) mover.radius = radius_of(mover);
  world.extent = extent_of(world);
  world.hash = hash_of(world);
}

void translate(World& world, double dx, double dy) {
  const auto move = [&](auto& p) {
    p.x += dx;
    p.y += dy;
  };
  for (Segment& wall : world.walls) {
    move(wall.a);
    move(wall.b);
  }
  for (LaneMarking& marking : world.lane_markings)
    for (glm::dvec2& p : marking.line) move(p);
  for (Magnet& magnet : world.magnets) move(magnet.p);
  for (Path& path : world.paths)
    for (PathPiece& piece : path.pieces) move(piece.X_WP);
  for (Light& light : world.lights) move(light.X_WL);
  for (Emitter& emitter : world.emitters) move(emitter.X_WE);
  for (FloorHole& hole : world.floor_holes)
    for (glm::dvec2& p : hole.outline) move(p);
  for (Model& model : world.models) move(model.X_WM);
  for (Mover& mover : world.movers) move(mover.X_WM);
  update_extent_and_hash(world);
}

}  // namespace sf::world
