#include "netio/bindings.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace sf::netio {

namespace {

bool alive(const std::optional<std::int64_t>& last, std::int64_t now) { return last && now - *last < kSilence; }

}  // namespace

Bindings::Bindings(std::span<const std::uint32_t> ids) {
  speakers_.resize(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) speakers_[i].id = ids[i];
  std::sort(speakers_.begin(), speakers_.end(), [](const Speaker& a, const Speaker& b) { return a.id < b.id; });
}

std::optional<std::size_t> Bindings::row(std::uint32_t id) const {
  const auto at = std::lower_bound(speakers_.begin(), speakers_.end(), id,
                                   [](const Speaker& s, std::uint32_t x) { return s.id < x; });
  if (at == speakers_.end() || at->id != id) return std::nullopt;
  return static_cast<std::size_t>(at - speakers_.begin());
}

Reason Bindings::admit(std::uint32_t id, std::size_t line, std::uint32_t sequence, const Endpoint& source,
                       std::int64_t now) {
  const auto at = row(id);
  SF_CHECK(at && line < kLines, "id " + std::to_string(id) + ", line " + std::to_string(line));
  Speaker& speaker = speakers_[*at];

  const bool bound = alive(speaker.last, now);
  if (bound && speaker.source != source) return Reason::wrong_source;
  if (alive(speaker.left, now) && speaker.gone == source) return Reason::stale;
  if (!bound) {
    for (Line& each : speaker.lines) each.last.reset();
  }
  Line& own = speaker.lines[line];
  if (alive(own.last, now) && !newer(sequence, own.sequence)) return Reason::stale;

  speaker.source = source;
  speaker.last = now;
  own = {sequence, now};
  return Reason::accepted;
}

Reason Bindings::leave(std::uint32_t id, const Endpoint& source, std::int64_t now) {
  const auto at = row(id);
  SF_CHECK(at, "id " + std::to_string(id));
  Speaker& speaker = speakers_[*at];
  if (!alive(speaker.last, now)) return Reason::stale;
  if (speaker.source != source) return Reason::wrong_source;
  speaker.last.reset();
  speaker.gone = source;
  speaker.left = now;
  return Reason::accepted;
}

bool Bindings::heard(std::uint32_t id, std::int64_t now) const {
  const auto at = row(id);
  return at && alive(speakers_[*at].last, now);
}

std::optional<Endpoint> Bindings::source(std::uint32_t id) const {
  const auto at = row(id);
  if (!at || !speakers_[*at].last) return std::nullopt;
  return speakers_[*at].source;
}

}  // namespace sf::netio
