#include "server/v2i_messages.h"

#include <algorithm>
#include <cmath>

namespace sf::server {

namespace {

constexpr std::size_t kMaxRows = (netio::kMaxPayload - netio::kV2iHeadBytes) / netio::kV2iRowBytes;

double bounded(double value) { return std::clamp(value, -netio::kMaxPosition, netio::kMaxPosition); }

}  // namespace

V2iMessages::V2iMessages(const world::World& world, const world::RoadNetwork* roads, std::uint32_t first)
    : intersections_(intersections_of(world, roads, first)),
      stops_(intersections_.size()),
      sent_(intersections_.size(), 0) {
  for (const world::Light& light : world.lights) poses_.push_back(light.X_WL);
  for (std::size_t k = 0; k < intersections_.size() && roads != nullptr; ++k) {
    const Intersection& one = intersections_[k];
    for (std::size_t i = 0; i < one.stops.size(); ++i) {
      const world::PointId id = world::id_of(*roads, one.stops[i]);
      const glm::dvec2 p = world::position_of(*roads, one.stops[i]);
      stops_[k].push_back({static_cast<std::uint8_t>(one.groups[i]), static_cast<std::uint16_t>(id.segment),
                           static_cast<std::uint16_t>(id.lane), static_cast<std::uint16_t>(id.point), bounded(p.x),
                           bounded(p.y), world::yaw_of(*roads, one.stops[i]).value_or(0.0),
                           std::min(roads->lanes[one.stops[i].row].width, netio::kMaxPosition)});
    }
    std::stable_sort(stops_[k].begin(), stops_[k].end(),
                     [](const auto& a, const auto& b) { return a.group < b.group; });
  }
}

glm::dvec2 V2iMessages::position(std::size_t intersection) const {
  const base::Pose& X_WL = poses_[intersections_[intersection].lights.front()];
  return {X_WL.x, X_WL.y};
}

netio::SignalApproach V2iMessages::approach_of(const Intersection& one, std::size_t i,
                                               const world::SignalForecast& forecast) const {
  const base::Pose& X_WL = poses_[one.lights[i]];
  netio::SignalApproach approach;
  approach.group = static_cast<std::uint8_t>(i + 1);
  approach.state = static_cast<std::uint8_t>(forecast.now.state);
  if (forecast.next) approach.next = static_cast<std::uint8_t>(forecast.next->state);
  approach.left = forecast.now.left;
  approach.X_WL = {bounded(X_WL.x), bounded(X_WL.y), bounded(X_WL.z), base::wrap_angle(X_WL.yaw)};
  return approach;
}

/// Fills each packet with approaches and their stop lines until it is full.
void V2iMessages::for_each_packet(std::size_t intersection, std::span<const world::SignalForecast> forecasts,
                                  std::int64_t now, const std::function<void(const base::Bytes&)>& take) {
  const Intersection& one = intersections_[intersection];
  const auto send = [&] {
    netio::encode({.robot = one.id, .sequence = sent_[intersection]++, .time = now},
                  netio::V2i{approach_rows_, stop_rows_}, packet_);
    take(packet_);
    approach_rows_.clear();
    stop_rows_.clear();
  };
  approach_rows_.clear();
  stop_rows_.clear();
  const auto rows = [&] { return netio::count(approach_rows_) + netio::count(stop_rows_); };
  std::size_t stop = 0;
  for (std::size_t i = 0; i < one.lights.size(); ++i) {
    const netio::SignalApproach approach = approach_of(one, i, forecasts[one.lights[i]]);
    if (rows() == kMaxRows) send();
    netio::put(approach, approach_rows_);
    for (; stop < stops_[intersection].size() && stops_[intersection][stop].group == approach.group; ++stop) {
      if (rows() == kMaxRows) {
        send();
        netio::put(approach, approach_rows_);
      }
      netio::put(stops_[intersection][stop], stop_rows_);
    }
  }
  if (!approach_rows_.empty()) send();
}

}  // namespace sf::server
