#pragma once
// Memory limits of a scene's lists.

#include <cstddef>
#include <cstdint>

namespace sf::raycast {

struct CasterType;

/// Capacities above which the oldest lists are evicted. Worlds with few robots start with less. If a single tick needs
/// more, the capacity doubles.
struct SceneOptions {
  const CasterType* caster = nullptr;    ///< null: the default of `choose_caster`
  std::uint32_t pool_chunks = 1u << 20;  ///< 80 bytes each; memory is committed only when used
  std::uint32_t pool_cells = 1u << 14;
  /// [chunks] per sector; the device's own limit also applies. Scans with longer lists run on the host.
  std::uint32_t longest_list = 0xFFFFFFFFu;
  /// [bytes] of results; the device's own limit also applies. Larger tables are written as texels.
  std::size_t largest_buffer = 0xFFFFFFFFu;
};

}  // namespace sf::raycast
