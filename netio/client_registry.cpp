#include "netio/client_registry.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace sf::netio {

namespace {

bool is_recent(const std::optional<std::int64_t>& last, std::int64_t now) {
  return last && now - *last < kClientTimeout;
}

}  // namespace

ClientRegistry::ClientRegistry(std::span<const std::uint32_t> ids) {
  clients_.resize(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) clients_[i].id = ids[i];
  std::sort(clients_.begin(), clients_.end(), [](const Client& a, const Client& b) { return a.id < b.id; });
}

std::optional<std::size_t> ClientRegistry::row(std::uint32_t id) const {
  const auto at =
      std::lower_bound(clients_.begin(), clients_.end(), id, [](const Client& s, std::uint32_t x) { return s.id < x; });
  if (at == clients_.end() || at->id != id) return std::nullopt;
  return static_cast<std::size_t>(at - clients_.begin());
}

PacketStatus ClientRegistry::admit(std::uint32_t id, std::size_t channel, std::uint32_t sequence,
                                   const Endpoint& source, std::int64_t now) {
  const auto at = row(id);
  SF_CHECK(at && channel < kChannels, "id " + std::to_string(id) + ", line " + std::to_string(channel));
  Client& client = clients_[*at];

  const bool bound = is_recent(client.last, now);
  if (bound && client.source != source) return PacketStatus::wrong_source;
  if (is_recent(client.departed_at, now) && client.departed == source) return PacketStatus::stale;
  if (!bound) {
    for (Channel& each : client.channels) each.last.reset();
  }
  Channel& own = client.channels[channel];
  if (is_recent(own.last, now) && !newer(sequence, own.sequence)) return PacketStatus::stale;

  client.source = source;
  client.last = now;
  own = {sequence, now};
  return PacketStatus::accepted;
}

PacketStatus ClientRegistry::renew(std::uint32_t id, const Endpoint& source, std::int64_t now) {
  const auto at = row(id);
  SF_CHECK(at, "id " + std::to_string(id));
  Client& client = clients_[*at];
  if (!client.last) return PacketStatus::stale;
  if (client.source != source) return is_recent(client.last, now) ? PacketStatus::wrong_source : PacketStatus::stale;
  client.last = now;
  return PacketStatus::accepted;
}

PacketStatus ClientRegistry::leave(std::uint32_t id, const Endpoint& source, std::int64_t now) {
  const auto at = row(id);
  SF_CHECK(at, "id " + std::to_string(id));
  Client& client = clients_[*at];
  if (!is_recent(client.last, now)) return PacketStatus::stale;
  if (client.source != source) return PacketStatus::wrong_source;
  client.last.reset();
  client.departed = source;
  client.departed_at = now;
  return PacketStatus::accepted;
}

bool ClientRegistry::is_active(std::uint32_t id, std::int64_t now) const {
  const auto at = row(id);
  return at && is_recent(clients_[*at].last, now);
}

std::optional<Endpoint> ClientRegistry::source(std::uint32_t id) const {
  const auto at = row(id);
  if (!at || !clients_[*at].last) return std::nullopt;
  return clients_[*at].source;
}

}  // namespace sf::netio
