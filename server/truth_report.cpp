#include "server/truth_report.h"

#include <algorithm>

#include "netio/address_token.h"
#include "netio/own_end.h"

namespace sf::server {

netio::V2v v2v_of(const base::Report& report, const base::Intent& intent) {
  const auto bound = [](double value, double most) { return std::clamp(value, -most, most); };
  netio::V2v state;
  state.X_WR = {bound(report.X_WM.x, netio::kMaxPosition), bound(report.X_WM.y, netio::kMaxPosition),
                bound(report.X_WM.z, netio::kMaxPosition), base::wrap_angle(report.X_WM.yaw)};
  state.velocity = {bound(report.velocity.forward, netio::kMaxSpeed), bound(report.velocity.left, netio::kMaxSpeed),
                    bound(report.velocity.turn, netio::kMaxSpeed)};
  state.follows = intent.follows <= netio::kMaxId ? intent.follows : netio::kNone;
  state.checkpoint = intent.checkpoint;
  state.docking = intent.docking;
  state.tilt = {bound(base::wrap_angle(report.tilt.roll), netio::kMaxRoll), bound(report.tilt.pitch, netio::kMaxPitch)};
  return state;
}

TruthReport::TruthReport(const netio::Endpoint& to, std::uint32_t tag)
    : to_(to), outbox_({.bind = netio::own_end_for(to.address)}) {
  header_.robot = static_cast<std::uint16_t>(tag);
  header_.session = netio::random_session();
}

void TruthReport::send(const base::Report& state, std::int64_t now, std::int64_t epoch) {
  due_ = now + kPeriod;
  header_.time = epoch + now;
  netio::encode(header_, v2v_of(state), packet_);
  ++header_.sequence;
  outbox_.queue(to_, packet_);
  outbox_.flush();
}

}  // namespace sf::server
