#pragma once
// How much room a scene's lists are given.

#include <cstddef>
#include <cstdint>

#include "raycast/caster_choice.h"

namespace sf::raycast {

/// How much room the lists may have before the oldest make way; a few robots get less. When one tick alone needs more,
/// the room doubles.
struct SceneOptions {
  CasterChoice caster = CasterChoice::automatic;
  std::uint32_t pool_chunks = 1u << 20;  ///< 80 bytes each; memory is touched only as far as used
  std::uint32_t pool_cells = 1u << 14;
  /// [chunks] of one sector: what has longer lists is cast on the host, where this is not above what the device bears.
  std::uint32_t longest_list = 0xFFFFFFFFu;
  /// [bytes] of results: larger tables are written as texels, where this is not above what the device's buffers bear.
  std::size_t largest_buffer = 0xFFFFFFFFu;
};

}  // namespace sf::raycast
