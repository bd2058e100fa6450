#include "netio/relay.h"

#include <algorithm>
#include <variant>

namespace sf::netio {

Relay::Relay(std::span<const std::uint32_t> robots, const RelayOptions& options)
    : options_(options), robots_(robots.size()), nearby_(robots.size()) {
  for (std::size_t i = 0; i < robots.size(); ++i) robots_[i].id = robots[i];
  std::sort(robots_.begin(), robots_.end(), [](const Robot& a, const Robot& b) { return a.id < b.id; });
  spoke_.reserve(robots.size());
  askers_.reserve(robots.size());
  states_.reserve(kMaxDatagram);
  packet_.reserve(kMaxDatagram);
  for (Robot& robot : robots_) {
    encode({}, V2v{}, robot.state);
    encode({}, Start{}, robot.start);
  }
}

Relay::Robot* Relay::find(std::uint32_t id) {
  const auto at =
      std::lower_bound(robots_.begin(), robots_.end(), id, [](const Robot& r, std::uint32_t x) { return r.id < x; });
  return at == robots_.end() || at->id != id ? nullptr : &*at;
}

void Relay::take(const Packet& packet) {
  if (const auto* state = std::get_if<V2v>(&packet.body)) {
    Robot* robot = find(packet.header.robot);
    if (robot == nullptr) return;
    robot->spoke = true;
    robot->p = {state->X_WR.x, state->X_WR.y};
    encode(packet.header, *state, robot->state);
  } else if (std::holds_alternative<Start>(packet.body)) {
    for (Robot& robot : robots_) {
      if (packet.header.robot != kEveryone && packet.header.robot != robot.id) continue;
      robot.started = true;
      encode(packet.header, Start{}, robot.start);
    }
  }
}

void Relay::pass_on(const Inbox& inbox, std::int64_t now, Outbox& outbox) {
  spoke_.clear();
  askers_.clear();
  for (std::uint32_t row = 0; row < robots_.size(); ++row) {
    if (robots_[row].spoke) spoke_.push_back({*robots_[row].p, row});
    if (inbox.asks_for_others(robots_[row].id, now)) askers_.push_back(row);
  }
  nearby_.build(spoke_);
  send_starts(inbox, now, outbox);

  // From where the last pass left off, as far as the budget goes.
  const std::size_t fair = options_.budget / std::max<std::size_t>(askers_.size(), 1);
  const std::size_t share = std::max(kLeastShare, std::min(fair, options_.most));
  const auto first = std::lower_bound(askers_.begin(), askers_.end(), turn_) - askers_.begin();
  const std::uint64_t before = counts_.states;
  for (std::size_t i = 0; i < askers_.size() && !spoke_.empty(); ++i) {
    const std::uint32_t row = askers_[(static_cast<std::size_t>(first) + i) % askers_.size()];
    if (counts_.states - before + share > options_.budget) {
      turn_ = row;
      counts_.waited += askers_.size() - i;
      break;
    }
    send_others(row, share, *inbox.address(robots_[row].id), now, outbox);
  }
  for (Robot& robot : robots_) robot.spoke = robot.started = false;
}

void Relay::send_starts(const Inbox& inbox, std::int64_t now, Outbox& outbox) {
  for (const Robot& robot : robots_) {
    if (!robot.started || !inbox.heard(robot.id, now)) continue;
    outbox.queue(*inbox.address(robot.id), robot.start);
    ++counts_.starts;
  }
}

void Relay::send_others(std::uint32_t row, std::size_t most, const Endpoint& where, std::int64_t now, Outbox& outbox) {
  Robot& to = robots_[row];
  const auto rows = nearby_.find(to.p, row, options_.range, most);
  for (std::size_t first = 0; first < rows.size(); first += kMostNeighbours) {
    states_.clear();
    for (const std::uint32_t other : rows.subspan(first, std::min(kMostNeighbours, rows.size() - first)))
      states_.insert(states_.end(), robots_[other].state.begin(), robots_[other].state.end());
    const Header header{.robot = static_cast<std::uint16_t>(to.id), .sequence = to.sent++, .time = now};
    encode(header, Neighbours{states_}, packet_);
    outbox.queue(where, packet_);
    ++counts_.datagrams;
  }
  counts_.states += rows.size();
}

}  // namespace sf::netio
