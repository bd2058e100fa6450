#include "netio/relay.h"

#include <algorithm>
#include <variant>

#include "base/error.h"

namespace sf::netio {

Relay::Relay(std::span<const std::uint32_t> robots, const RelayOptions& options)
    : options_(options), robots_(robots.size()), nearby_(robots.size()) {
  SF_CHECK(options.most >= kLeastShare && options.budget >= kLeastShare, "a relay that passes nothing on");
  for (std::size_t i = 0; i < robots.size(); ++i) robots_[i].id = robots[i];
  std::sort(robots_.begin(), robots_.end(), [](const Robot& a, const Robot& b) { return a.id < b.id; });
  spoke_.reserve(robots.size());
  askers_.reserve(robots.size());
  states_.reserve(kMaxDatagram);
  packet_.reserve(kMaxDatagram);
  encode({}, Start{}, start_);
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
  Robot* robot = find(packet.header.robot);
  if (const auto* state = std::get_if<V2v>(&packet.body)) {
    if (robot == nullptr) return;
    robot->age = 0;
    robot->p = {state->X_WR.x, state->X_WR.y};
    encode(packet.header, *state, robot->state);
  } else if (std::holds_alternative<Start>(packet.body)) {
    const bool all = packet.header.robot == kEveryone;
    if (!all && robot == nullptr) return;
    (all ? all_started_ : robot->started) = true;
    encode(packet.header, Start{}, all ? start_ : robot->start);
  }
}

void Relay::pass_on(const Inbox& inbox, std::int64_t now, Outbox& outbox) {
  send_starts(inbox, now, outbox);
  if (options_.range > 0.0) {
    find_askers(inbox, now);
    send_states(inbox, now, outbox);
  }
  for (Robot& robot : robots_)
    if (robot.age < std::numeric_limits<std::uint32_t>::max()) ++robot.age;
}

void Relay::send_starts(const Inbox& inbox, std::int64_t now, Outbox& outbox) {
  for (Robot& robot : robots_) {
    if ((robot.started || all_started_) && inbox.heard(robot.id, now)) {
      outbox.queue(*inbox.address(robot.id), robot.started ? robot.start : start_, inbox.stamp_for(robot.id));
      ++counts_.starts;
    }
    robot.started = false;
  }
  all_started_ = false;
}

/// With the places of all that spoke since the turn of the one that waits longest.
void Relay::find_askers(const Inbox& inbox, std::int64_t now) {
  askers_.clear();
  spoke_.clear();
  std::uint32_t longest = 0;
  for (std::uint32_t row = 0; row < robots_.size(); ++row) {
    Robot& robot = robots_[row];
    if (!inbox.asks_for_others(robot.id, now)) {
      robot.waits = 0;
      continue;
    }
    askers_.push_back(row);
    longest = std::max(longest, robot.waits);
  }
  for (std::uint32_t row = 0; row < robots_.size() && !askers_.empty(); ++row)
    if (robots_[row].age <= longest) spoke_.push_back({*robots_[row].p, row, robots_[row].age});
  nearby_.build(spoke_);
}

/// From the robot on that was passed over first last time, as far as the budget goes.
void Relay::send_states(const Inbox& inbox, std::int64_t now, Outbox& outbox) {
  if (spoke_.empty()) return;
  const std::size_t share = std::clamp(options_.budget / askers_.size(), kLeastShare, options_.most);
  const auto first = std::lower_bound(askers_.begin(), askers_.end(), turn_) - askers_.begin();
  std::rotate(askers_.begin(), askers_.begin() + first, askers_.end());
  std::size_t left = options_.budget, served = 0;
  for (; served < askers_.size() && left >= share; ++served)
    left -= send_others(robots_[askers_[served]], share, inbox, now, outbox);
  if (served < askers_.size()) turn_ = askers_[served];
  for (; served < askers_.size(); ++served) {
    ++robots_[askers_[served]].waits;
    ++counts_.waited;
  }
}

std::size_t Relay::send_others(Robot& to, std::size_t most, const Inbox& inbox, std::int64_t now, Outbox& outbox) {
  const Stamp stamp = inbox.stamp_for(to.id);
  const auto own = static_cast<std::uint32_t>(&to - robots_.data());
  const auto rows = nearby_.find({.p = to.p, .own = own, .range = options_.range, .most = most, .oldest = to.waits});
  for (std::size_t first = 0; first < rows.size(); first += kMostNeighbours) {
    states_.clear();
    for (const std::uint32_t row : rows.subspan(first, std::min(kMostNeighbours, rows.size() - first))) {
      states_.insert(states_.end(), robots_[row].state.begin(), robots_[row].state.end());
      netio::stamp(std::span(states_).last(kV2vBytes), stamp);
    }
    encode({.robot = static_cast<std::uint16_t>(to.id), .sequence = to.sent++, .time = now}, Neighbours{states_},
           packet_);
    outbox.queue(*inbox.address(to.id), packet_, stamp);
    ++counts_.datagrams;
  }
  to.waits = 0;
  counts_.states += rows.size();
  return rows.size();
}

}  // namespace sf::netio
