#include "netio/peers.h"

#include <algorithm>
#include <utility>

namespace sf::netio {

const Peer* find(std::span<const Peer> peers, PeerKind kind, std::uint32_t id) {
  const auto at = std::find_if(peers.begin(), peers.end(), [&](const Peer& p) { return p.kind == kind && p.id == id; });
  return at == peers.end() ? nullptr : &*at;
}

Claim claim_of(const Header& header) {
  if (header.type == Type::start || header.type == Type::lane) return {PeerKind::start, 0};
  const bool asks = header.type == Type::subscribe || header.type == Type::leave;
  if (asks && header.sensor == kCentre) return {PeerKind::centre, 0};
  if (header.type == Type::v2i) return {PeerKind::light, header.robot};
  const bool tag = header.type == Type::tag || header.type == Type::object;
  return {tag ? PeerKind::tag : PeerKind::robot, header.robot};
}

PeerTable::PeerTable(std::span<const Peer> peers, std::uint64_t first_counter) {
  for (const Peer& peer : peers) {
    Row& row = rows_.emplace_back(Row{peer, std::nullopt, std::nullopt});
    if (!peer.key) continue;
    row.checker.emplace(*peer.key);
    row.signer.emplace(*peer.key, first_counter);
  }
  std::sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) {
    return std::pair(a.peer.kind, a.peer.id) < std::pair(b.peer.kind, b.peer.id);
  });
}

PeerTable::Row* PeerTable::find_row(const Claim& claim) {
  const std::pair key(claim.kind, claim.id);
  const auto at = std::lower_bound(rows_.begin(), rows_.end(), key, [](const Row& row, const auto& wanted) {
    return std::pair(row.peer.kind, row.peer.id) < wanted;
  });
  return at == rows_.end() || std::pair(at->peer.kind, at->peer.id) != key ? nullptr : &*at;
}

bool PeerTable::has_key(const Claim& claim) {
  const Row* row = find_row(claim);
  return row != nullptr && row->checker;
}

PacketStatus PeerTable::check(const Claim& claim, std::span<const std::uint8_t> bytes, const Endpoint& source,
                              bool proven) {
  Row* row = find_row(claim);
  if (row == nullptr) return PacketStatus::accepted;
  if (row->peer.address && *row->peer.address != source.address) return PacketStatus::wrong_source;
  if (!row->checker) return PacketStatus::accepted;
  return proven ? row->checker->check(bytes) : row->checker->verify(bytes);
}

std::uint64_t PeerTable::lag(const Claim& claim) {
  const Row* row = find_row(claim);
  return row != nullptr && row->checker ? row->checker->lag() : 0;
}

PacketSigner* PeerTable::signer(const Claim& claim) {
  Row* row = find_row(claim);
  return row != nullptr && row->signer ? &*row->signer : nullptr;
}

}  // namespace sf::netio
