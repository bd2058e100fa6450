#include "netio/team_map.h"

#include <cmath>

#include "netio/packets.h"

namespace sf::netio {

namespace {

constexpr std::uint16_t kEndsBit = 1, kClaimBit = 2, kCutBit = 4;
constexpr double kMinCell = 1e-4, kMaxCell = 1e3;                        // [m]
constexpr std::uint32_t kMaxMapColumns = 4096, kMaxMapWords = 1u << 20;  // as in maps/grid.h

bool is_area(const TeamMap& map) {
  const auto is_size = [](std::uint32_t words) { return words >= 1 && words <= kMaxMapColumns; };
  return std::abs(map.left) <= kMaxPosition && std::abs(map.top) <= kMaxPosition && map.cell >= kMinCell &&
         map.cell <= kMaxCell && is_size(map.word_columns) && is_size(map.word_rows) &&
         map.word_columns * map.word_rows <= kMaxMapWords;
}

bool are_acks(const TeamMap& map) {
  bool good = count_acks(map) <= kMaxMapAcks;
  for (std::size_t k = 0; k < count_acks(map); ++k) good = good && ack_at(map, k).robot <= kMaxId;
  return good;
}

bool is_claim(const TeamMap& map) {
  if (!map.states_claim) return map.claim.empty() && !map.claim_is_cut;
  std::uint64_t end = 0;
  for (std::size_t k = 0; k < count_runs(map); ++k) end += std::uint64_t{run_at(map, k).skip} + run_at(map, k).take;
  return end <= 16 * std::uint64_t{map.word_columns} * map.word_rows;
}

}  // namespace

std::uint16_t flags_of(const TeamMap& map) {
  return static_cast<std::uint16_t>((map.ends ? kEndsBit : 0) | (map.states_claim ? kClaimBit : 0) |
                                    (map.claim_is_cut ? kCutBit : 0));
}

MapAck ack_at(const TeamMap& map, std::size_t k) {
  base::ByteReader reader(map.acks.subspan(k * kMapAckBytes, kMapAckBytes));
  MapAck ack;
  ack.robot = reader.get<std::uint32_t>();
  ack.session = reader.get<std::uint32_t>();
  ack.pieces = reader.get<std::uint32_t>();
  ack.later = reader.get<std::uint32_t>();
  return ack;
}

ClaimRun run_at(const TeamMap& map, std::size_t k) {
  base::ByteReader reader(map.claim.subspan(k * kClaimRunBytes, kClaimRunBytes));
  ClaimRun run;
  run.skip = reader.get<std::uint16_t>();
  run.take = reader.get<std::uint16_t>();
  return run;
}

void put(const MapAck& ack, base::Bytes& rows) {
  base::ByteWriter writer(rows);
  writer.put(ack.robot);
  writer.put(ack.session);
  writer.put(ack.pieces);
  writer.put(ack.later);
}

void put(const ClaimRun& run, base::Bytes& rows) {
  base::ByteWriter writer(rows);
  writer.put(run.skip);
  writer.put(run.take);
}

PacketStatus read_team_map(std::span<const std::uint8_t> payload, TeamMap& map) {
  if (payload.size() < kTeamMapHeadBytes) return PacketStatus::too_short;
  base::ByteReader reader(payload);
  for (double* number : {&map.left, &map.top, &map.cell}) *number = reader.get<double>();
  for (std::uint32_t* number : {&map.word_columns, &map.word_rows, &map.piece}) *number = reader.get<std::uint32_t>();
  const std::size_t bytes = reader.get<std::uint16_t>(), acks = kMapAckBytes * reader.get<std::uint16_t>(),
                    claim = kClaimRunBytes * reader.get<std::uint16_t>();
  const auto flags = reader.get<std::uint16_t>();
  const std::size_t size = kTeamMapHeadBytes + bytes + acks + claim;
  if (payload.size() != size) return payload.size() < size ? PacketStatus::too_short : PacketStatus::too_long;
  map.ends = (flags & kEndsBit) != 0;
  map.states_claim = (flags & kClaimBit) != 0;
  map.claim_is_cut = (flags & kCutBit) != 0;
  map.acks = reader.get_bytes(acks);
  map.claim = reader.get_bytes(claim);
  map.bytes = reader.get_bytes(bytes);
  const PacketStatus status = check(map);
  return status == PacketStatus::accepted && flags != flags_of(map) ? PacketStatus::out_of_range : status;
}

PacketStatus check(const TeamMap& map) {
  const std::size_t size = kTeamMapHeadBytes + map.acks.size() + map.claim.size() + map.bytes.size();
  if (size > kMaxPayload) return PacketStatus::too_long;
  if (!std::isfinite(map.left) || !std::isfinite(map.top) || !std::isfinite(map.cell)) return PacketStatus::not_finite;
  const bool is_piece = !map.bytes.empty() || (map.piece == 0 && !map.ends);
  return is_area(map) && are_acks(map) && is_claim(map) && is_piece ? PacketStatus::accepted
                                                                    : PacketStatus::out_of_range;
}

void put_team_map(const TeamMap& map, base::Bytes& out) {
  base::ByteWriter writer(out);
  for (const double number : {map.left, map.top, map.cell}) writer.put(number);
  for (const std::uint32_t number : {map.word_columns, map.word_rows, map.piece}) writer.put(number);
  for (const std::size_t count : {map.bytes.size(), count_acks(map), count_runs(map)})
    writer.put(static_cast<std::uint16_t>(count));
  writer.put(flags_of(map));
  for (const auto rows : {map.acks, map.claim, map.bytes}) writer.put_bytes(rows.data(), rows.size());
}

}  // namespace sf::netio
