#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "world/serialization.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kMagic = 0x57574653u;  // "SFWW"
constexpr std::uint16_t kVersion = 6;
constexpr std::uint16_t kOldestVersion = 5;  // without the last fields of World; written where all of these are zero
constexpr std::size_t kSinceVersion6 = least_bytes<glm::dvec3>() + least_bytes<std::vector<Lamp>>() + sizeof(double);

bool is_version5(const World& world) {
  return world.earth_field == glm::dvec3{} && world.lamps.empty() && world.ambient_light == 0.0;
}

[[noreturn]] void refuse(const std::string& reason) { throw base::InputError("corrupt world snapshot: " + reason); }

// Checks that row numbers refer to existing rows, because users of a world rely on it.
void check_links(const World& world) {
  const auto models = world.models.size();
  const auto movers = world.movers.size();
  const auto known = [&](const auto& row) { return row.model < models; };
  bool good = std::all_of(world.walls.begin(), world.walls.end(), known);
  good &= std::all_of(world.magnets.begin(), world.magnets.end(), known);
  for (const Model& m : world.models)
    good &= (m.parent == kNone || m.parent < models) && (m.mover == kNone || m.mover < movers);
  for (const Mover& m : world.movers) {
    good &= m.model < models && std::all_of(m.body.begin(), m.body.end(), known);
    good &= std::all_of(m.magnets.begin(), m.magnets.end(), known);
  }
  good &= std::all_of(world.lights.begin(), world.lights.end(), known);
  good &= std::all_of(world.emitters.begin(), world.emitters.end(), known);
  good &= std::all_of(world.lamps.begin(), world.lamps.end(), known);
  good &= std::all_of(world.floor_holes.begin(), world.floor_holes.end(), known);
  if (!good) refuse("a row refers to a row that does not exist");
}

// Checks the invariants of rows in world.h, because users of a world do not check them again. World files are checked
// when they are read, but a recording's world is untrusted.
void check_rows(const World& world) {
  bool good = is_within(world);
  for (const Path& path : world.paths) good &= !path.pieces.empty();
  for (const Light& light : world.lights) good &= !light.phases.empty();
  for (const FloorHole& hole : world.floor_holes) good &= hole.outline.size() >= 3;
  if (!good) refuse("a row breaks the rules of its table");
}

}  // namespace

std::vector<std::uint8_t> snapshot(const World& world) {
  std::vector<std::uint8_t> bytes;
  base::ByteWriter out(bytes);
  out.put(kMagic);
  out.put(is_version5(world) ? kOldestVersion : kVersion);
  // The spelling of the world file's path is not part of the world.
  RowWriter{out, RowFields::all, std::filesystem::path(world.file).parent_path().lexically_normal()}.put(world);
  if (is_version5(world)) bytes.resize(bytes.size() - kSinceVersion6);
  return bytes;
}

World from_snapshot(const std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t kVersionAt = sizeof kMagic;
  const bool is_old = bytes.size() > kVersionAt && bytes[kVersionAt] == kOldestVersion;
  std::vector<std::uint8_t> longer;
  if (is_old) longer.assign(bytes.begin(), bytes.end()), longer.resize(bytes.size() + kSinceVersion6);
  base::ByteReader in(is_old ? longer : bytes);
  if (in.get<std::uint32_t>() != kMagic) refuse("these bytes are not a world");
  const auto version = in.get<std::uint16_t>();
  if (version < kOldestVersion || version > kVersion)
    throw base::InputError(fmt::format("this world snapshot has version {}; this sensorfarm reads versions {} to {}",
                                       version, kOldestVersion, kVersion));

  World world;
  RowReader{in}.get(world);
  if (!in.good() || in.left() != 0) refuse("truncated, or longer than declared");
  check_links(world);
  check_rows(world);
  const std::uint64_t hash = world.hash;
  update_extent_and_hash(world);
  if (world.hash != hash) refuse("its content does not match its stored hash");
  return world;
}

}  // namespace sf::world
