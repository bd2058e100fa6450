#include "server/map_exchange.h"

#include <algorithm>
#include <utility>

#include "netio/sender_bindings.h"
#include "server/map_changes.h"

namespace sf::server {

namespace {

constexpr std::size_t kLeastPiece = 64;  ///< [byte] bounds the number of changes

maps::GridGeometry geometry_of(const netio::TeamMap& map) {
  return {map.left, map.top, map.cell, map.word_columns, map.word_rows};
}

/// Appends the runs of a claim, at most `most`. @param keys ascending @return false if they do not suffice
bool put_claim(std::span<const std::int64_t> keys, std::size_t most, base::Bytes& runs) {
  constexpr std::int64_t kLongest = 0xFFFF;
  std::int64_t end = 0;
  for (std::size_t i = 0; i < keys.size(); --most) {
    if (most == 0) return false;
    const std::int64_t skip = std::min(keys[i] - end, kLongest);
    end += skip;
    std::int64_t take = 0;
    for (; i < keys.size() && keys[i] == end && take < kLongest; ++i, ++end) ++take;
    netio::put(netio::ClaimRun{static_cast<std::uint16_t>(skip), static_cast<std::uint16_t>(take)}, runs);
  }
  return true;
}

/// @pre the runs end within the map
std::vector<std::int64_t> claim_of(const netio::TeamMap& map) {
  std::vector<std::int64_t> keys;
  std::int64_t end = 0;
  for (std::size_t k = 0; k < netio::count_runs(map); ++k) {
    const netio::ClaimRun run = netio::run_at(map, k);
    end += run.skip;
    for (std::uint16_t i = 0; i < run.take; ++i) keys.push_back(end++);
  }
  return keys;
}

}  // namespace

void MapExchange::publish(std::shared_ptr<const control::SharedMap> map) {
  if (!map) return;
  own_ = std::move(map);
  for (; encoded_ < own_->changes.size(); ++encoded_) add_pieces(*own_->changes[encoded_]);
}

void MapExchange::add_pieces(const control::MapChanges& changes) {
  base::Bytes bytes;
  encode_changes(changes, own_->geometry, bytes);
  for (std::size_t first = 0; first < bytes.size(); first += kMaxPiece) {
    const std::size_t end = std::min(first + kMaxPiece, bytes.size());
    const auto at = [&](std::size_t i) { return bytes.begin() + static_cast<std::ptrdiff_t>(i); };
    pieces_.push_back({{at(first), at(end)}, end == bytes.size(), {}});
  }
}

bool MapExchange::is_present(const Teammate& teammate, std::int64_t now) {
  return now - teammate.last < netio::kSenderTimeout;
}

bool MapExchange::lacks_pieces(const Teammate& teammate, std::int64_t now) const {
  return is_present(teammate, now) && !teammate.takes_no_more && teammate.acked < pieces_.size();
}

bool MapExchange::is_complete(std::int64_t now) const {
  return std::ranges::none_of(teammates_, [&](const auto& each) {
    return lacks_pieces(each.second, now) && now - each.second.progress < kPatience;
  });
}

netio::TeamMap MapExchange::head() const {
  const maps::GridGeometry& geometry = own_->geometry;
  netio::TeamMap map{.left = geometry.left, .top = geometry.top, .cell = geometry.cell};
  map.word_columns = geometry.word_columns;
  map.word_rows = geometry.word_rows;
  map.acks = acks_;
  return map;
}

netio::MapAck MapExchange::ack_of(std::uint32_t id, const Teammate& teammate) {
  netio::MapAck ack{id, teammate.session, teammate.is_full ? netio::kTakesNoMore : teammate.pieces};
  for (const auto& [piece, bytes] : teammate.early)
    if (const std::uint32_t k = piece - teammate.pieces - 1; k < 32) ack.later |= 1u << k;
  return ack;
}

/// Of more robots than fit, other ones with each packet.
void MapExchange::gather_acks(std::int64_t now) {
  acks_.clear();
  std::vector<netio::MapAck> all;
  for (const auto& [id, teammate] : teammates_)
    if (is_present(teammate, now)) all.push_back(ack_of(id, teammate));
  const std::size_t count = std::min(all.size(), netio::kMaxMapAcks);
  for (std::size_t i = 0; i < count; ++i) netio::put(all[(first_ack_ + i) % all.size()], acks_);
  first_ack_ = count < all.size() ? (first_ack_ + count) % all.size() : 0;
  owes_ack_ = false;
}

void MapExchange::send(std::int64_t now, const SendMap& send) {
  if (!own_) return;
  allowed_ = std::min(kBurst, allowed_ + kRate * 1e-9 * static_cast<double>(now - last_send_));
  last_send_ = now;
  const auto counted = [&](const netio::TeamMap& map) {
    --allowed_;
    ++counts_.sent;
    send(map);
  };
  send_claim(now, counted);
  send_pieces(now, counted);
  if (!owes_ack_ || allowed_ < 1.0) return;
  gather_acks(now);
  counted(head());
}

/// Sends the claim if it changed, and else as a beat.
void MapExchange::send_claim(std::int64_t now, const SendMap& send) {
  const bool is_new = !sent_claim_ || *sent_claim_ != own_->claim;
  if ((!is_new && now - last_claim_ < kBeat) || allowed_ < 1.0) return;
  gather_acks(now);
  claim_.clear();
  netio::TeamMap map = head();
  map.states_claim = true;
  map.claim_is_cut = !put_claim(own_->claim, kMaxRuns, claim_);
  map.claim = claim_;
  counts_.cut += map.claim_is_cut ? 1 : 0;
  sent_claim_ = own_->claim;
  last_claim_ = now;
  send(map);
}

/// Teammates take turns. One that has made no progress for long, because it receives nothing, is served piece by piece
/// after the others.
void MapExchange::send_pieces(std::int64_t now, const SendMap& send) {
  std::vector<const Teammate*> moving, stalled;
  for (auto& [id, teammate] : teammates_) {
    if (!lacks_pieces(teammate, now)) {
      teammate.progress = now;
      continue;
    }
    (now - teammate.progress < kPatience ? moving : stalled).push_back(&teammate);
  }
  ++first_served_;
  for (std::size_t i = 0; i < moving.size(); ++i)
    send_lacking(*moving[(first_served_ + i) % moving.size()], kWindow, now, send);
  for (const Teammate* teammate : stalled) send_lacking(*teammate, 1, now, send);
}

/// Sends the pieces that a teammate lacks, of the next `most`, unless they were sent just now.
void MapExchange::send_lacking(const Teammate& teammate, std::size_t most, std::int64_t now, const SendMap& send) {
  const std::size_t end = std::min(teammate.acked + most, pieces_.size());
  for (std::size_t i = teammate.acked; i < end && allowed_ >= 1.0; ++i) {
    const bool has = i > teammate.acked && (teammate.later >> (i - teammate.acked - 1) & 1u) != 0;
    Piece& piece = pieces_[i];
    if (has || (piece.sent && now - *piece.sent < kAckTimeout)) continue;
    gather_acks(now);
    netio::TeamMap map = head();
    map.piece = static_cast<std::uint32_t>(i);
    map.ends = piece.ends;
    map.bytes = piece.bytes;
    ++counts_.pieces;
    counts_.repeated += piece.sent ? 1 : 0;
    piece.sent = now;
    send(map);
  }
}

/// A robot that has started again has another session: all that was known of it is void.
MapExchange::Teammate& MapExchange::teammate_of(const netio::Header& header, std::int64_t now) {
  const auto [at, is_new] = teammates_.try_emplace(header.robot);
  Teammate& teammate = at->second;
  if (!is_new && teammate.session == header.session) return teammate;
  const std::optional<std::uint32_t> before = is_new ? std::nullopt : std::optional(teammate.session);
  teammate = {.session = header.session, .session_before = before, .started = now, .progress = now};
  teammate.map.geometry = own_->geometry;
  return teammate;
}

void MapExchange::receive(const netio::Header& header, const netio::TeamMap& map, std::int64_t now) {
  if (!own_ || header.robot == options_.robot) return;
  ++counts_.received;
  if (!(geometry_of(map) == own_->geometry)) {
    ++counts_.foreign;
    counts_.last_foreign = header.robot;
    return;
  }
  if (const auto known = teammates_.find(header.robot); known != teammates_.end() &&
                                                        known->second.session_before == header.session &&
                                                        now - known->second.started < netio::kSenderTimeout)
    return;
  Teammate& teammate = teammate_of(header, now);
  if (!is_present(teammate, now)) teammate.progress = now;
  teammate.last = now;
  take_acks(header, map, now, teammate);
  if (map.states_claim && (!teammate.claim_sequence || netio::newer(header.sequence, *teammate.claim_sequence))) {
    teammate.claim_sequence = header.sequence;
    teammate.map.claim = claim_of(map);
    teammate.snapshot.reset();
  }
  if (!map.bytes.empty()) take_piece(map, teammate);
}

/// The newest packet counts. A robot that took this one for restarted acknowledges less than before.
void MapExchange::take_acks(const netio::Header& header, const netio::TeamMap& map, std::int64_t now,
                            Teammate& teammate) const {
  if (teammate.ack_sequence && !netio::newer(header.sequence, *teammate.ack_sequence)) return;
  for (std::size_t k = 0; k < netio::count_acks(map); ++k) {
    const netio::MapAck ack = netio::ack_at(map, k);
    if (ack.robot != options_.robot || ack.session != options_.session) continue;
    teammate.ack_sequence = header.sequence;
    teammate.takes_no_more = ack.pieces == netio::kTakesNoMore;
    if (ack.pieces > pieces_.size()) continue;
    if (ack.pieces > teammate.acked) teammate.progress = now;
    teammate.acked = ack.pieces;
    teammate.later = ack.later;
  }
}

void MapExchange::take_piece(const netio::TeamMap& map, Teammate& teammate) {
  owes_ack_ = true;
  const bool is_new = map.piece >= teammate.pieces && map.piece - teammate.pieces < kWindow;
  if (!is_new || teammate.is_full || teammate.early.contains(map.piece)) return;
  teammate.bytes += std::max(map.bytes.size(), kLeastPiece);
  if (teammate.bytes > options_.most_bytes) {
    teammate.is_full = true;
    teammate.partial = {};
    teammate.early.clear();
    ++counts_.full;
    return;
  }
  teammate.early[map.piece] = {{map.bytes.begin(), map.bytes.end()}, map.ends, {}};
  for (auto next = teammate.early.begin(); next != teammate.early.end() && next->first == teammate.pieces;
       next = teammate.early.erase(next)) {
    ++teammate.pieces;
    append_piece(next->second, teammate);
  }
}

void MapExchange::append_piece(const Piece& piece, Teammate& teammate) {
  teammate.partial.insert(teammate.partial.end(), piece.bytes.begin(), piece.bytes.end());
  if (!piece.ends) return;
  auto changes = decode_changes(teammate.partial, own_->geometry);
  teammate.partial.clear();
  if (!changes) return void(++counts_.malformed);
  ++counts_.changes;
  teammate.map.changes.push_back(std::make_shared<const control::MapChanges>(std::move(*changes)));
  teammate.snapshot.reset();
}

std::span<const control::TeammateMap> MapExchange::teammates(std::int64_t now) {
  present_.clear();
  for (auto& [id, teammate] : teammates_) {
    if (!is_present(teammate, now)) continue;
    if (!teammate.snapshot) teammate.snapshot = std::make_shared<const control::SharedMap>(teammate.map);
    present_.push_back({id, teammate.snapshot});
  }
  return present_;
}

}  // namespace sf::server
