#include "farm/v2v_inputs.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "sensors/derived/wiring.h"

namespace sf::farm {

void V2vInputs::add(const Farm& farm) {
  for (const Farm::ReceivedInput& input : farm.received_inputs(sensors::kV2vInput))
    if (std::ranges::find(pairs_, input, &Pair::of) == pairs_.end()) pairs_.push_back({input});
}

std::span<const base::ReadingBlock> V2vInputs::receive(const world::World& world, double range, const Newest& newest,
                                                       std::span<const base::Report> states,
                                                       const std::vector<bool>& absent) {
  values_.clear(), readings_.clear();
  for (Pair& pair : pairs_) {
    const auto [mover, receiver] = pair.of;
    if (absent[mover] || absent[receiver] || world.movers[mover].is_tag) continue;
    const base::Pose &there = states[mover].X_WM, &here = states[receiver].X_WM;
    if (base::hypot(there.x - here.x, there.y - here.y) > range) continue;
    const std::optional<Received> received = newest(mover, receiver);
    if (received && received->sent > pair.last) add_state(pair, *received);
  }
  for (std::size_t i = 0; i < readings_.size(); ++i) readings_[i].values = values_[i];
  return readings_;
}

void V2vInputs::add_state(Pair& pair, const Received& received) {
  pair.last = received.sent;
  if (received.quality.age == base::kNoStateYet) return;  // a lost robot broadcasts nothing
  const base::Pose& X = received.state.X_WM;
  const base::Twist& v = received.state.velocity;
  std::array<double, 13>& to = values_.emplace_back();
  to = {X.x, X.y, X.yaw, 1.0, NAN, NAN, NAN, NAN, NAN, NAN, v.forward, v.left, v.turn};
  if (received.quality.covariance[0] > 0.0F) std::ranges::copy(received.quality.covariance, to.begin() + 4);
  readings_.push_back({.mover = pair.of.mover,
                       .sensor = pair.of.receiver,
                       .type = sensors::kV2vInput,
                       .sequence = pair.received++,
                       .time = received.time});
}

}  // namespace sf::farm
