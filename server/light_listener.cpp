#include "server/light_listener.h"

#include <algorithm>
#include <variant>

#include "v2x/frame.h"

namespace sf::server {

namespace {

constexpr std::size_t kBatch = 16;
constexpr std::size_t kMost = 256;  ///< datagrams per call; bounds the work under a flood

}  // namespace

LightListener::LightListener(const world::World& world, const world::RoadNetwork* roads,
                             const LightListenerOptions& options)
    : intersections_(intersections_of(world, roads)),
      options_(options),
      signals_(world.lights.size()),
      heard_(world.lights.size(), kNever),
      silent_(world.lights.size(), false),
      batch_(kBatch) {
  for (const world::Light& light : world.lights) joins_.push_back(carrier_of(world, light) != world::kNone);
  if (options.spat) socket_ = netio::open_udp(*options.spat);
}

void LightListener::receive(std::int64_t now, std::int64_t utc) {
  if (!socket_) return;
  batch_.drain(*socket_, kMost, [&](std::span<const std::uint8_t> bytes, const netio::Endpoint& source) {
    accept(bytes, source, now, utc);
  });
}

void LightListener::accept(std::span<const std::uint8_t> bytes, const netio::Endpoint& source, std::int64_t now,
                           std::int64_t utc) {
  v2x::Frame frame;
  if (!v2x::decode(bytes, frame).ok()) {
    ++counts_.invalid;
    return;
  }
  const auto* spat = std::get_if<v2x::Spat>(&frame.message);
  if (spat != nullptr && is_refused(*spat, source)) {
    ++counts_.refused;
    return;
  }
  // Lights that join are last. SPaT does not state where they are.
  const auto joins = [&](const Intersection& one) { return joins_[one.lights.front()]; };
  const auto fixed = std::span(intersections_.begin(), std::ranges::find_if(intersections_, joins));
  const std::size_t states =
      spat == nullptr ? 0 : read_spat(*spat, fixed, utc, [&](std::uint32_t light, const world::Signal& signal) {
        hear(light, signal, now);
      });
  ++(states > 0 ? counts_.messages : counts_.others);
}

/// SPaT has no signature, so it is refused where a signature is required.
bool LightListener::is_refused(const v2x::Spat& spat, const netio::Endpoint& source) const {
  return std::any_of(spat.intersections.begin(), spat.intersections.end(), [&](const v2x::IntersectionState& state) {
    const netio::Peer* peer = netio::find(options_.peers, netio::PeerKind::light, state.id.id);
    return peer != nullptr && (peer->key || (peer->address && *peer->address != source.address));
  });
}

void LightListener::accept(const netio::Header& header, const netio::V2i& signals, std::int64_t now) {
  const auto found = std::find_if(intersections_.begin(), intersections_.end(),
                                  [&](const Intersection& one) { return one.id == header.robot; });
  if (found == intersections_.end()) return;
  bool any = false;
  for (std::size_t k = 0; k < netio::count(signals.approaches); ++k) {
    const netio::SignalApproach approach = netio::approach_at(signals, k);
    if (approach.group > found->lights.size()) continue;
    hear(found->lights[approach.group - 1u], {static_cast<world::LightState>(approach.state), approach.left}, now);
    any = true;
  }
  counts_.packets += any ? 1 : 0;
}

void LightListener::hear(std::uint32_t light, const world::Signal& signal, std::int64_t now) {
  signals_[light] = signal;
  heard_[light] = now;
  ++counts_.states;
}

void LightListener::apply(std::int64_t now, std::span<world::Signal> signals) {
  for (std::size_t i = 0; i < signals.size(); ++i) {
    if (!is_present(i, now)) signals[i] = {};
    if (heard_[i] == kNever) continue;
    const std::int64_t age = now - heard_[i];
    const bool silent = age >= kSilence;
    counts_.silences += silent && !silent_[i] ? 1 : 0;
    silent_[i] = silent;
    if (silent && options_.stale == StaleLights::plan) continue;
    signals[i] = silent ? world::Signal{} : signals_[i];
    if (!silent) signals[i].left = std::max(0.0, signals[i].left - 1e-9 * static_cast<double>(age));
  }
}

bool LightListener::is_present(std::size_t light, std::int64_t now) const {
  return !joins_[light] || (heard_[light] != kNever && now - heard_[light] < kSilence);
}

}  // namespace sf::server
