#include <algorithm>
#include <limits>

#include "base/bytes.h"
#include "base/hash.h"
#include "world/path_geometry.h"
#include "world/serialization.h"
#include "world/world.h"

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

std::uint64_t hash_of(const World& world) {
  std::vector<std::uint8_t> bytes;
  base::ByteWriter out(bytes);
  out.put(world.interval);
  out.put(static_cast<std::uint64_t>(world.models.size()));
  for (const Model& model : world.models) put(out, model, RowFields::physics);
  out.put(static_cast<std::uint64_t>(world.walls.size()));
  for (const Segment& wall : world.walls) put(out, wall);
  out.put(world.road_resolution);
  out.put(static_cast<std::uint64_t>(world.lane_markings.size()));
  for (const LaneMarking& marking : world.lane_markings) put(out, marking, RowFields::physics);
  out.put(world.magnet_cutoff);
  put(out, world.accuracy, RowFields::physics);
  out.put(static_cast<std::uint64_t>(world.magnets.size()));
  for (const Magnet& magnet : world.magnets) put(out, magnet);
  out.put(static_cast<std::uint64_t>(world.movers.size()));
  for (const Mover& mover : world.movers) put(out, mover, RowFields::physics);
  out.put(static_cast<std::uint64_t>(world.lights.size()));
  for (const Light& light : world.lights) put(out, light);
  out.put(static_cast<std::uint64_t>(world.emitters.size()));
  for (const Emitter& emitter : world.emitters) put(out, emitter);
  out.put(static_cast<std::uint64_t>(world.floor_holes.size()));
  for (const FloorHole& hole : world.floor_holes) put(out, hole);
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
