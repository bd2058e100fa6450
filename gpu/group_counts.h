#pragma once
// Workgroups of a dispatch whose size changes every tick: along x up to a limit, then in rows along y. The size of a
// group is `local_size_x` of the kernel in shaders/.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "gpu/buffer.h"

namespace sf::gpu {

/// Largest number of groups along x; Vulkan guarantees 65 535.
inline constexpr std::uint32_t kMostGroupsAcross = 32'768;

struct GroupCounts {
  std::uint32_t across = 0;
  std::uint32_t down = 0;

  std::size_t all() const { return std::size_t{across} * down; }
};

/// Returns whole rows of groups for a number of invocations.
inline GroupCounts groups_for(std::size_t invocations, std::size_t group_size) {
  const auto needed = static_cast<std::uint32_t>((invocations + group_size - 1) / group_size);
  const std::uint32_t across = std::min(needed, kMostGroupsAcross);
  return {across, across > 0 ? (needed + across - 1) / across : 0};
}

/// Returns the largest number of groups needed for up to `most` invocations.
inline std::size_t most_groups_for(std::size_t most, std::size_t group_size) {
  const std::size_t groups = most / group_size + 1;
  return groups > kMostGroupsAcross ? groups + kMostGroupsAcross : groups;
}

/// Writes the three words that `Batch::dispatch` reads.
inline void write_counts(GroupCounts groups, Buffer& table) {
  const auto counts = table.host<std::uint32_t>();
  counts[0] = groups.across;
  counts[1] = groups.down;
  counts[2] = groups.across > 0 ? 1 : 0;
}

}  // namespace sf::gpu
