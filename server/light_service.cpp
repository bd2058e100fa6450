#include "server/light_service.h"

#include "base/elapsed.h"
#include "server/state_receiver.h"
#include "world/roads/roads.h"

namespace sf::server {

LightService::LightService(const world::World& world, const LightListenerOptions& options, double radio)
    : world_(world),
      roads_(world.lights.empty() ? std::nullopt : world::roads_of(world)),
      listener_(world, roads_ ? &*roads_ : nullptr, options),
      messages_(world, roads_ ? &*roads_ : nullptr),
      radio_(radio),
      forecasts_(world.lights.size()),
      signals_(world.lights.size()),
      places_(world.movers.size()) {}

std::vector<std::uint32_t> LightService::ids() const {
  std::vector<std::uint32_t> ids;
  for (const Intersection& one : listener_.intersections()) ids.push_back(one.id);
  return ids;
}

void LightService::accept(const netio::Header& header, const netio::V2i& signals, std::int64_t now) {
  listener_.accept(header, signals, now);
  const auto approach = netio::find_approach(signals, 1);
  for (const Intersection& one : messages_.intersections())
    if (approach && one.id == header.robot && carrier_of(world_, world_.lights[one.lights.front()]) != world::kNone)
      messages_.place(one.lights.front(), approach->X_WL);
}

void LightService::update(std::int64_t now) {
  if (world_.lights.empty()) return;
  listener_.receive(now, base::unix_time() / 1'000'000);
  constexpr double kUnheard = -1.0;
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    forecasts_[i] = world::forecast_at(world_.lights[i], 1e-9 * static_cast<double>(now));
    signals_[i] = {forecasts_[i].now.state, kUnheard};
  }
  listener_.apply(now, signals_);
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    if (signals_[i].left != kUnheard) forecasts_[i] = {signals_[i], signals_[i].left, std::nullopt};
    signals_[i] = forecasts_[i].now;
  }
}

void LightService::publish(std::int64_t now, StateReceiver& receiver) {
  if (world_.lights.empty() || radio_ <= 0.0 || (published_ && now - *published_ < kPeriod)) return;
  published_ = now;
  for (const base::Report& state : receiver.states(now)) places_[state.mover] = glm::dvec2{state.X_WM.x, state.X_WM.y};
  for (std::size_t k = 0; k < messages_.intersections().size(); ++k) {
    if (!listener_.is_present(messages_.intersections()[k].lights.front(), now)) continue;
    messages_.for_each_packet(k, forecasts_, now, [&](const base::Bytes& packet) {
      for (const auto& [id, row] : receiver.robots()) {
        if (!receiver.inbox().wants_neighbours(id, now)) continue;
        if (places_[row] && glm::length(*places_[row] - messages_.position(k)) > radio_) continue;
        receiver.queue(id, packet);
        ++sent_;
      }
    });
  }
}

}  // namespace sf::server
