#pragma once
// Measurements of an explorer as bytes, as in TEAM_MAP packets. docs/packets.md specifies them.

#include <cstdint>
#include <optional>
#include <span>

#include "base/bytes.h"
#include "control/shared_map.h"

namespace sf::server {

/// Appends the measurements. Coordinates are exact. @pre all cells are in the map, and free or occupied
void encode_changes(const control::MapChanges& changes, const maps::GridGeometry& geometry, base::Bytes& out);

/// Decodes any bytes. Allocates at most 24 times their size.
/// @return nullopt for bytes of another form, and for a cell or a node outside the map
std::optional<control::MapChanges> decode_changes(std::span<const std::uint8_t> bytes,
                                                  const maps::GridGeometry& geometry);

}  // namespace sf::server
