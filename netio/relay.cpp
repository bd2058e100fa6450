#include "netio/relay.h"

#include <algorithm>
#include <variant>

namespace sf::netio {

Relay::Relay(std::span<const std::uint32_t> robots) : robots_(robots.size()) {
  for (std::size_t i = 0; i < robots.size(); ++i) robots_[i].id = robots[i];
  std::sort(robots_.begin(), robots_.end(), [](const Robot& a, const Robot& b) { return a.id < b.id; });
  spoke_.reserve(robots.size());
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
  for (std::size_t i = 0; i < robots_.size(); ++i)
    if (robots_[i].spoke) spoke_.push_back(i);

  for (const Robot& robot : robots_) {
    if (!inbox.heard(robot.id, now)) continue;
    const Endpoint where = *inbox.address(robot.id);
    const Stamp stamp = inbox.stamp_for(robot.id);
    if (robot.started) {
      outbox.queue(where, robot.start, stamp);
      ++counts_.starts;
    }
    if (inbox.asks_for_others(robot.id, now)) send_others(robot, where, stamp, outbox);
  }
  for (Robot& robot : robots_) robot.spoke = robot.started = false;
}

void Relay::send_others(const Robot& to, const Endpoint& where, const Stamp& stamp, Outbox& outbox) {
  for (const std::size_t row : spoke_) {
    if (robots_[row].id == to.id) continue;
    outbox.queue(where, robots_[row].state, stamp);
    ++counts_.states;
  }
}

}  // namespace sf::netio
