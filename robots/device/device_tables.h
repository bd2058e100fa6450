#pragma once
// Tables of kernels that search walls and count the turns of their loops (shaders/lib/loop_turns.glsl).

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/box_tree.h"
#include "gpu/buffer.h"
#include "robots/device/records.h"
#include "world/world.h"

namespace sf::robots {

/// Returns a table with `records`, which are words or whole texels.
template <class Record>
gpu::Buffer table_of(gpu::Device& device, std::string_view name, gpu::Role role, const std::vector<Record>& records) {
  gpu::Buffer table(device, name, role, sizeof(Record) == 4 ? gpu::Texel::u32 : gpu::Texel::u32x4,
                    records.size() * std::max<std::size_t>(sizeof(Record) / 16, 1));
  std::ranges::copy(records, table.host<Record>().begin());
  return table;
}

/// Returns the constants of a kernel that includes loop_turns.glsl. Mesa before 25.0 ends loops of software devices
/// after 65 535 turns of all lanes of a subgroup, of at most 16 lanes.
inline std::vector<std::uint32_t> loop_constants(const gpu::Device& device) {
  return device.info().software ? std::vector<std::uint32_t>{16, 65'000} : std::vector<std::uint32_t>{1, 0};
}

/// Walls in a tree. Each table has at least one record, since devices have no empty tables.
struct WallTables {
  std::vector<FleetWall> walls;  ///< in the order of the tree's leaves
  std::vector<FleetNode> nodes;
  std::uint32_t count = 0;  ///< nodes in use
};

/// @param counts returns whether a wall belongs to the tree
template <class Counts>
WallTables wall_tables(std::span<const world::Segment> all, Counts&& counts) {
  constexpr std::size_t kLeafWalls = 8;
  WallTables tables;
  std::vector<base::Box> boxes;
  std::vector<const world::Segment*> chosen;
  for (const world::Segment& wall : all)
    if (counts(wall)) chosen.push_back(&wall), boxes.push_back(base::box_of(wall.a, wall.b));
  const base::BoxTree tree(boxes, kLeafWalls);
  for (const std::uint32_t row : tree.order()) {
    const world::Segment& w = *chosen[row];
    tables.walls.push_back({w.a.x, w.a.y, w.b.x, w.b.y, w.z_min, w.z_max});
  }
  for (const base::BoxTree::Node& n : tree.nodes())
    tables.nodes.push_back({n.box.min.x, n.box.min.y, n.box.max.x, n.box.max.y, n.end, n.first, n.count, 0});
  tables.count = static_cast<std::uint32_t>(chosen.empty() ? 0 : tables.nodes.size());
  if (tables.walls.empty()) tables.walls.emplace_back();
  if (tables.nodes.empty()) tables.nodes.emplace_back();
  return tables;
}

}  // namespace sf::robots
