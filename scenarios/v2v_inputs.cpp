#include "scenarios/v2v_inputs.h"

#include <algorithm>
#include <cmath>

#include "netio/packets.h"
#include "sensors/derived/wiring.h"

namespace sf::scenarios {

void V2vInputs::add(const farm::Farm& farm) {
  for (const farm::Farm::ReceivedInput& input : farm.received_inputs(sensors::kV2vInput))
    if (std::ranges::find(links_, input, &Pair::of) == links_.end()) links_.push_back({input});
}

std::span<const base::ReadingBlock> V2vInputs::receive(std::int64_t time, const world::World& world,
                                                       const V2vLink* link,
                                                       const std::function<Broadcast(std::uint32_t)>& current,
                                                       std::span<const base::Report> states,
                                                       const std::vector<bool>& absent) {
  values_.clear(), readings_.clear();
  for (Pair& pair : links_) {
    const auto [mover, receiver] = pair.of;
    if (absent[mover] || absent[receiver] || world.movers[mover].is_tag) continue;
    const base::Pose &there = states[mover].X_WM, &here = states[receiver].X_WM;
    if (std::hypot(there.x - here.x, there.y - here.y) > netio::kV2vRange) continue;
    if (link == nullptr) {
      add_state(pair, time, current(mover));
    } else if (const auto arrived = link->newest(time, mover, {world.movers[receiver].id, world.movers[mover].id})) {
      if (arrived->sent > pair.last) add_state(pair, arrived->sent, arrived->broadcast);
    }
  }
  for (std::size_t i = 0; i < readings_.size(); ++i) readings_[i].values = values_[i];
  return readings_;
}

void V2vInputs::add_state(Pair& pair, std::int64_t time, const Broadcast& broadcast) {
  pair.last = time;
  if (broadcast.quality.age == base::kNoStateYet) return;  // a lost robot broadcasts nothing
  const base::Pose& X = broadcast.state.X_WM;
  const base::Twist& v = broadcast.state.velocity;
  std::array<double, 13>& to = values_.emplace_back();
  to = {X.x, X.y, X.yaw, 1.0, NAN, NAN, NAN, NAN, NAN, NAN, v.forward, v.left, v.turn};
  if (broadcast.quality.covariance[0] > 0.0F) std::ranges::copy(broadcast.quality.covariance, to.begin() + 4);
  readings_.push_back({.mover = pair.of.mover,
                       .sensor = pair.of.receiver,
                       .type = sensors::kV2vInput,
                       .sequence = pair.received++,
                       .time = time});
}

}  // namespace sf::scenarios
