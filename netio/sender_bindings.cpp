#include "netio/sender_bindings.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace sf::netio {

namespace {

bool is_recent(const std::optional<std::int64_t>& last, std::int64_t now) {
  return last && now - *last < kSenderTimeout;
}

}  // namespace

SenderBindings::SenderBindings(std::span<const std::uint32_t> ids, bool take_late) {
  bindings_.resize(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) bindings_[i].id = ids[i], bindings_[i].takes_late = take_late;
  std::sort(bindings_.begin(), bindings_.end(), [](const Binding& a, const Binding& b) { return a.id < b.id; });
}

std::optional<std::size_t> SenderBindings::row(std::uint32_t id) const {
  const auto at = std::lower_bound(bindings_.begin(), bindings_.end(), id,
                                   [](const Binding& s, std::uint32_t x) { return s.id < x; });
  if (at == bindings_.end() || at->id != id) return std::nullopt;
  return static_cast<std::size_t>(at - bindings_.begin());
}

PacketStatus SenderBindings::admit(std::uint32_t id, std::size_t channel, std::uint32_t sequence,
                                   const Endpoint& source, std::int64_t now) {
  const auto at = row(id);
  SF_CHECK(at && channel < kChannels, "id " + std::to_string(id) + ", line " + std::to_string(channel));
  Binding& binding = bindings_[*at];

  const bool bound = is_recent(binding.last, now);
  if (bound && binding.source != source) return PacketStatus::wrong_source;
  if (is_recent(binding.departed_at, now) && binding.departed == source) return PacketStatus::stale;
  if (!bound) {
    for (Channel& each : binding.channels) each.last.reset();
  }
  Channel& own = binding.channels[channel];
  if (is_recent(own.last, now) && !newer(sequence, own.sequence)) return PacketStatus::stale;

  binding.source = source;
  binding.last = now;
  own = {sequence, now};
  return PacketStatus::accepted;
}

PacketStatus SenderBindings::renew(std::uint32_t id, const Endpoint& source, std::int64_t now) {
  const auto at = row(id);
  SF_CHECK(at, "id " + std::to_string(id));
  Binding& binding = bindings_[*at];
  if (!binding.last) return PacketStatus::stale;
  if (binding.source != source) return is_recent(binding.last, now) ? PacketStatus::wrong_source : PacketStatus::stale;
  binding.last = now;
  return PacketStatus::accepted;
}

PacketStatus SenderBindings::leave(std::uint32_t id, const Endpoint& source, std::int64_t now) {
  const auto at = row(id);
  SF_CHECK(at, "id " + std::to_string(id));
  Binding& binding = bindings_[*at];
  if (!is_recent(binding.last, now)) return PacketStatus::stale;
  if (binding.source != source) return PacketStatus::wrong_source;
  binding.last.reset();
  binding.departed = source;
  binding.departed_at = now;
  return PacketStatus::accepted;
}

void SenderBindings::forget(std::uint32_t id) {
  const auto at = row(id);
  SF_CHECK(at, "id " + std::to_string(id));
  bindings_[*at] = {.id = id, .source = {}, .last = {}, .takes_late = bindings_[*at].takes_late, .departed = {}};
}

bool SenderBindings::is_active(std::uint32_t id, std::int64_t now) const {
  const auto at = row(id);
  return at && is_recent(bindings_[*at].last, now);
}

std::optional<Endpoint> SenderBindings::source(std::uint32_t id) const {
  const auto at = row(id);
  if (!at || !bindings_[*at].last) return std::nullopt;
  return bindings_[*at].source;
}

}  // namespace sf::netio
