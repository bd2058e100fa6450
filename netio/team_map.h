#pragma once
// The payload of TEAM_MAP packets, by which the robots of a team exchange maps directly (netio/direct_v2v.h): geometry
// of the sender's map, acknowledgements, the cells that it claims, and one piece of its measurements.
// docs/packets.md specifies every byte.

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/bytes.h"
#include "netio/packet_status.h"

namespace sf::netio {

inline constexpr std::size_t kTeamMapHeadBytes = 44;  ///< [byte] before the rows
inline constexpr std::size_t kMapAckBytes = 16, kClaimRunBytes = 4;
inline constexpr std::size_t kMaxMapAcks = 12;              ///< in one packet
inline constexpr std::uint32_t kTakesNoMore = 0xFFFFFFFFu;  ///< `MapAck::pieces`: the receiver has reached its limit

/// Pieces that the sender has received of one robot.
struct MapAck {
  std::uint32_t robot = 0;    ///< id in [0, kMaxId]
  std::uint32_t session = 0;  ///< of that robot
  std::uint32_t pieces = 0;   ///< number received in order, or kTakesNoMore
  std::uint32_t later = 0;    ///< bit k: piece `pieces` + 1 + k has been received, too
};

/// Part of a claim: skips cells from the end of the run before, or from cell 0, then claims cells. Cells are counted
/// row by row.
struct ClaimRun {
  std::uint16_t skip = 0;
  std::uint16_t take = 0;
};

/// Its rows and bytes are valid as long as the datagram.
struct TeamMap {
  double left = 0.0, top = 0.0;                   ///< [m] as in maps::GridGeometry
  double cell = 0.03;                             ///< [m]
  std::uint32_t word_columns = 1, word_rows = 1;  ///< as in maps::GridGeometry
  std::uint32_t piece = 0;                        ///< number of the piece, from 0; 0 without one
  bool ends = false;                              ///< the piece is the last one of some measurements
  bool states_claim = false;                      ///< `claim` replaces the sender's last claim
  bool claim_is_cut = false;                      ///< the claim has more cells than it states
  std::span<const std::uint8_t> acks;             ///< at most kMaxMapAcks rows
  std::span<const std::uint8_t> claim;            ///< rows; none unless `states_claim`
  std::span<const std::uint8_t> bytes;            ///< the piece; empty: none
};

inline std::size_t count_acks(const TeamMap& map) { return map.acks.size() / kMapAckBytes; }
inline std::size_t count_runs(const TeamMap& map) { return map.claim.size() / kClaimRunBytes; }
MapAck ack_at(const TeamMap& map, std::size_t k);
ClaimRun run_at(const TeamMap& map, std::size_t k);
/// Returns the flags as in the packet.
std::uint16_t flags_of(const TeamMap& map);

/// Appends a row.
void put(const MapAck& ack, base::Bytes& rows);
void put(const ClaimRun& run, base::Bytes& rows);

/// Reads the payload of a TEAM_MAP. Fills `map` whatever the status is.
PacketStatus read_team_map(std::span<const std::uint8_t> payload, TeamMap& map);
/// Checks that the packet is within the limits.
PacketStatus check(const TeamMap& map);
void put_team_map(const TeamMap& map, base::Bytes& out);

}  // namespace sf::netio
