#pragma once
// The fields of a world's rows, with one table per type of row. These tables define snapshots and their bounds, the
// hash, and, for fields with a key, the known keys of Stage files and how they are read. Links between rows are checked
// in world/snapshot.cpp.
//
// The order is that of the snapshot's bytes: increment `kVersion` in world/snapshot.cpp with each change of a table.
// world/keys.cpp lists the keys that have their own readers.

#include "world/field.h"
#include "world/world.h"

namespace sf::world {

// The words of enumerations in world files, in the order of their values.

inline constexpr auto words_of(Drive) { return std::to_array<std::string_view>({"diff", "omni", "car", "skid"}); }
inline constexpr auto words_of(ActuatorModel) { return std::to_array<std::string_view>({"direct", "player_create"}); }
inline constexpr auto words_of(Emitter::Kind) { return std::to_array<std::string_view>({"virtual_wall", "dock"}); }
inline constexpr auto words_of(Fiducial::Type) {
  return std::to_array<std::string_view>({"marker", "target", "threat"});
}
inline constexpr auto words_of(TextureWrap) { return std::to_array<std::string_view>({"repeat", "clamp", "mirror"}); }
inline constexpr auto words_of(LightState) {
  return std::to_array<std::string_view>({"dark", "red", "yellow", "green", "flashing red", "flashing yellow"});
}

// clang-format off

// --- Parts of rows

template <> inline constexpr auto kFields<glm::dvec2> = std::make_tuple(field(&glm::dvec2::x), field(&glm::dvec2::y));

template <> inline constexpr auto kFields<glm::vec2> = std::make_tuple(
    field(&glm::vec2::x, Bounds{-kMostTextureCoordinate, kMostTextureCoordinate}),
    field(&glm::vec2::y, Bounds{-kMostTextureCoordinate, kMostTextureCoordinate}));

template <> inline constexpr auto kFields<glm::dvec3> = std::make_tuple(
    field(&glm::dvec3::x), field(&glm::dvec3::y), field(&glm::dvec3::z));

template <> inline constexpr auto kFields<Pose> = std::make_tuple(
    field(&Pose::x), field(&Pose::y), field(&Pose::z), field(&Pose::yaw));

template <> inline constexpr auto kFields<Accuracy> = std::make_tuple(
    field(&Accuracy::word), label(&Accuracy::line), path(&Accuracy::file));

template <> inline constexpr auto kFields<Setting> = std::make_tuple(
    field(&Setting::key), field(&Setting::numbers), field(&Setting::text), label(&Setting::line), path(&Setting::file));

template <> inline constexpr auto kFields<Sensor> = std::make_tuple(
    field(&Sensor::type), field(&Sensor::name), field(&Sensor::X_MS), field(&Sensor::height),
    field(&Sensor::metres_per_unit), field(&Sensor::radians_per_unit), field(&Sensor::settings),
    label(&Sensor::line), path(&Sensor::file), label(&Sensor::color));

template <> inline constexpr auto kFields<PathPiece> = std::make_tuple(
    field(&PathPiece::X_WP), field(&PathPiece::length, kAboveZero), field(&PathPiece::curvature),
    field(&PathPiece::width, kAboveZero));

template <> inline constexpr auto kFields<LightPhase> = std::make_tuple(
    field(&LightPhase::state), field(&LightPhase::duration, kAboveZero));

// --- Rows

template <> inline constexpr auto kFields<Segment> = std::make_tuple(
    field(&Segment::a), field(&Segment::b), field(&Segment::z_min), field(&Segment::z_max), field(&Segment::model),
    flags(field(&Segment::solid_left), field(&Segment::seen_by_laser),
          field(&Segment::stops_robots, Key{"obstacle_return"}),
          field(&Segment::seen_by_laneedge, Key{"laneedge_return"})));

template <> inline constexpr auto kFields<Model> = std::make_tuple(
    field(&Model::name), field(&Model::type), field(&Model::parent), field(&Model::mover), field(&Model::X_WM),
    field(&Model::size), label(&Model::color), field(&Model::is_bitmap), field(&Model::pixel));

template <> inline constexpr auto kFields<LaneMarking> = std::make_tuple(
    field(&LaneMarking::line), field(&LaneMarking::width), label(&LaneMarking::color));

template <> inline constexpr auto kFields<MarkingHeights> = std::make_tuple(
    field(&MarkingHeights::z_min), field(&MarkingHeights::z_max));

template <> inline constexpr auto kFields<Ramp> = std::make_tuple(
    field(&Ramp::a), field(&Ramp::b), field(&Ramp::z_a), field(&Ramp::z_b), field(&Ramp::half_width, kAboveZero));

template <> inline constexpr auto kFields<Magnet> = std::make_tuple(
    field(&Magnet::p), field(&Magnet::z), field(&Magnet::moment), field(&Magnet::radius), field(&Magnet::model));

inline constexpr std::string_view kMotionBounds = "[xmin xmax ymin ymax zmin zmax amin amax]";

template <> inline constexpr auto kFields<Mover> = std::make_tuple(
    field(&Mover::name), field(&Mover::model), field(&Mover::id), field(&Mover::is_tag),
    field(&Mover::drive, Key{"drive"}),
    field(&Mover::X_WM),
    field(&Mover::actuator_model, Key{"command_law"}),
    field(&Mover::radius),
    field(&Mover::max_forward, Key{"velocity_bounds", Unit::length, kMotionBounds, 1, 2}, kAboveZero),
    field(&Mover::max_turn, Key{"velocity_bounds", Unit::angle, kMotionBounds, 7, 2}, Bounds{0.0, 1e6, true}),
    field(&Mover::max_acceleration, Key{"acceleration_bounds", Unit::length, kMotionBounds, 1, 2}, kAboveZeroOrInfinite),
    field(&Mover::max_turn_acceleration, Key{"acceleration_bounds", Unit::angle, kMotionBounds, 7, 2}, kAboveZeroOrInfinite),
    field(&Mover::wheelbase, Key{"wheelbase", Unit::length}, kAboveZero),
    field(&Mover::track, Key{"track", Unit::length}, kAboveZero),
    field(&Mover::body), field(&Mover::sensors), field(&Mover::magnets));

template <> inline constexpr auto kFields<Path> = std::make_tuple(field(&Path::name), field(&Path::pieces));

template <> inline constexpr auto kFields<Light> = std::make_tuple(
    field(&Light::name), field(&Light::model), field(&Light::X_WL), field(&Light::single),
    field(&Light::offset, Key{"offset", Unit::seconds}, Bounds{-1e6, 1e6}),
    field(&Light::phases), field(&Light::points));

template <> inline constexpr auto kFields<Emitter> = std::make_tuple(
    field(&Emitter::kind, Key{"ir_emitter"}),
    field(&Emitter::model), field(&Emitter::X_WE),
    field(&Emitter::range, Key{"ir_range", Unit::length}, kAboveZero),
    field(&Emitter::fov, Key{"ir_fov", Unit::angle}, Bounds{0.0, 2.0 * M_PI, true}),
    field(&Emitter::halo, Key{"ir_halo", Unit::length}, kNotNegative));

template <> inline constexpr auto kFields<Lamp> = std::make_tuple(
    field(&Lamp::model), field(&Lamp::X_WL),
    field(&Lamp::intensity, Key{"lamp_intensity"}, Bounds{0.0, 1e9, true}),
    field(&Lamp::fov, Key{"lamp_fov", Unit::angle}, Bounds{0.0, 2.0 * M_PI, true}));

template <> inline constexpr auto kFields<HeatSource> = std::make_tuple(
    field(&HeatSource::model), field(&HeatSource::p),
    field(&HeatSource::rise, Key{"heat"}, Bounds{-1e6, 1e6}),
    field(&HeatSource::radius, Key{"heat_radius", Unit::length}, kAboveZero));

template <> inline constexpr auto kFields<Fiducial> = std::make_tuple(
    field(&Fiducial::model), field(&Fiducial::X_BF), field(&Fiducial::id), field(&Fiducial::key),
    field(&Fiducial::type, Key{"fiducial_type"}));

template <> inline constexpr auto kFields<FloorHole> = std::make_tuple(
    field(&FloorHole::model), field(&FloorHole::outline));

template <> inline constexpr auto kFields<Shape> = std::make_tuple(
    label(&Shape::name), field(&Shape::size), label(&Shape::color), field(&Shape::is_bitmap), field(&Shape::pixel),
    field(&Shape::outline));

template <> inline constexpr auto kFields<Mesh> = std::make_tuple(
    path(&Mesh::file), field(&Mesh::vertices), field(&Mesh::corners));

template <> inline constexpr auto kFields<Reflectance> = std::make_tuple(
    field(&Reflectance::model), field(&Reflectance::value, Bounds{0.0, kMostReflectance}));

template <> inline constexpr auto kFields<Material> = std::make_tuple(
    field(&Material::color), field(&Material::reflectance, Bounds{0.0, kMostReflectance}));

template <> inline constexpr auto kFields<MeshMaterials> = std::make_tuple(
    field(&MeshMaterials::mesh), field(&MeshMaterials::materials), field(&MeshMaterials::triangles));

template <> inline constexpr auto kFields<Texture> = std::make_tuple(
    path(&Texture::file), field(&Texture::width, Bounds{1, kMostTextureSide}),
    field(&Texture::height, Bounds{1, kMostTextureSide}), field(&Texture::rgb));

template <> inline constexpr auto kFields<TextureUse> = std::make_tuple(
    field(&TextureUse::texture), field(&TextureUse::u), field(&TextureUse::v));

template <> inline constexpr auto kFields<MeshTextures> = std::make_tuple(
    field(&MeshTextures::mesh), field(&MeshTextures::materials), field(&MeshTextures::corners));

template <> inline constexpr auto kFields<MeshModel> = std::make_tuple(
    field(&MeshModel::mesh), field(&MeshModel::model), field(&MeshModel::X_BF));

template <> inline constexpr auto kFields<Terrain> = std::make_tuple(
    path(&Terrain::file), field(&Terrain::X_WT), field(&Terrain::cell, kAboveZero), field(&Terrain::columns),
    field(&Terrain::rows), field(&Terrain::heights));

template <> inline constexpr auto kFields<Daylight> = std::make_tuple(
    field(&Daylight::azimuth, Key{"sun", Unit::angle, "[azimuth elevation]", 0, 2}, Bounds{-1e6, 1e6}),
    field(&Daylight::elevation, Key{"sun", Unit::angle, "[azimuth elevation]", 1, 2}, Bounds{-M_PI / 2 * (1.0 + 1e-12), M_PI / 2 * (1.0 + 1e-12)}),
    field(&Daylight::sun, Key{"sunlight"}, Bounds{0.0, 100.0}), field(&Daylight::sky, Key{"skylight"}, Bounds{0.0, 100.0}),
    field(&Daylight::floor));

template <> inline constexpr auto kFields<GroundReflectance> = std::make_tuple(
    field(&GroundReflectance::floor, Key{"floor_reflectance"}, Bounds{0.0, kMostReflectance}),
    field(&GroundReflectance::paint, Key{"paint_reflectance"}, Bounds{0.0, kMostReflectance}));

template <> inline constexpr auto kFields<BeamDirection> = std::make_tuple(
    field(&BeamDirection::azimuth, Bounds{-2.0 * M_PI, 2.0 * M_PI}), field(&BeamDirection::elevation, Bounds{-M_PI / 2.0, M_PI / 2.0}),
    field(&BeamDirection::time, Bounds{0.0, kLongestTable}));

template <> inline constexpr auto kFields<BeamTable> = std::make_tuple(
    path(&BeamTable::world_file), field(&BeamTable::name), field(&BeamTable::timed), field(&BeamTable::rows));

template <> inline constexpr auto kFields<Warning> = std::make_tuple(
    path(&Warning::file), label(&Warning::line), label(&Warning::message));

template <> inline constexpr auto kFields<Variation> = std::make_tuple(
    field(&Variation::slip, Bounds{0.0, kMostSlip}), field(&Variation::acceleration, Bounds{0.0, 1.0, true}),
    field(&Variation::noise, Bounds{0.0, 1.0}));

template <> inline constexpr auto kFields<World> = std::make_tuple(
    label(&World::name, Key{"name"}), path(&World::file),
    field(&World::road_resolution, Key{"road_resolution", Unit::length}, kNotNegative),
    field(&World::magnet_cutoff, Key{"magnet_cutoff", Unit::length}, kNotNegative),
    field(&World::accuracy),
    field(&World::interval, Key{"interval_sim", Unit::milliseconds}, Bounds{1e-6, 1e3}),
    field(&World::models), field(&World::walls), field(&World::lane_markings), field(&World::magnets),
    field(&World::movers), label(&World::paths), field(&World::lights), field(&World::emitters),
    field(&World::floor_holes), path(&World::road_files), label(&World::unmodelled), label(&World::warnings),
    label(&World::hash),
    // since version 6
    field(&World::earth_field), field(&World::lamps),
    field(&World::ambient_light, Key{"ambient_light"}, Bounds{0.0, 1e9}),
    // since version 7
    field(&World::ramps), field(&World::marking_heights), field(&World::fiducials),
    // since version 8
    field(&World::shapes),
    // since version 9
    field(&World::heat_sources), field(&World::temperature, Key{"temperature"}, Bounds{-273.15, 1e6}),
    // since version 10
    field(&World::variations),
    // since version 11
    field(&World::floor_unseen),
    // since version 12
    field(&World::meshes), field(&World::mesh_models),
    // since version 13
    field(&World::reflectances), field(&World::terrain),
    // since version 14
    field(&World::mesh_materials), field(&World::daylight),
    // since version 15
    field(&World::textures), field(&World::mesh_textures),
    // since version 16
    field(&World::ground), field(&World::beam_tables));

// clang-format on

}  // namespace sf::world
