#include "netio/server/spat_listener.h"

#include <algorithm>
#include <variant>

#include "netio/v2x/frame.h"

namespace sf::server {

namespace {

constexpr std::size_t kBatch = 16;
constexpr std::size_t kMost = 256;  ///< datagrams per call: bounds the work under a flood

}  // namespace

SpatListener::SpatListener(const world::World& world, const world::RoadNetwork* roads, const netio::Endpoint& bind)
    : intersections_(intersections_of(world, roads)),
      signals_(world.lights.size()),
      heard_(world.lights.size(), kNever),
      socket_(netio::open_udp(bind)),
      batch_(kBatch) {}

void SpatListener::receive(std::int64_t now, std::int64_t utc) {
  batch_.drain(socket_, kMost,
               [&](std::span<const std::uint8_t> bytes, const netio::Endpoint&) { accept(bytes, now, utc); });
}

void SpatListener::accept(std::span<const std::uint8_t> bytes, std::int64_t now, std::int64_t utc) {
  v2x::Frame frame;
  if (!v2x::decode(bytes, frame).ok()) {
    ++counts_.invalid;
    return;
  }
  std::size_t states = 0;
  if (const auto* spat = std::get_if<v2x::Spat>(&frame.message)) {
    states = read_spat(*spat, intersections_, utc, [&](std::uint32_t light, const world::Signal& signal) {
      signals_[light] = signal;
      heard_[light] = now;
    });
  }
  counts_.states += states;
  ++(states > 0 ? counts_.messages : counts_.others);
}

void SpatListener::apply(std::int64_t now, std::span<world::Signal> signals) const {
  for (std::size_t i = 0; i < signals.size(); ++i) {
    if (heard_[i] == kNever) continue;
    const std::int64_t age = now - heard_[i];
    signals[i] = age < kSilence ? signals_[i] : world::Signal{};
    if (age < kSilence) signals[i].left = std::max(0.0, signals[i].left - 1e-9 * static_cast<double>(age));
  }
}

}  // namespace sf::server
