#include "netio/relay.h"

#include <algorithm>
#include <variant>

#include "base/error.h"

namespace sf::netio {

Relay::Relay(std::span<const std::uint32_t> robots, const RelayOptions& options, std::span<const std::uint32_t> lights)
    : options_(options), robots_(robots.size()), neighbour_tree_(robots.size()) {
  SF_CHECK(options.most >= kMinShare && options.budget >= kMinShare, "a relay without a receiver");
  for (std::size_t i = 0; i < robots.size(); ++i) robots_[i].id = robots[i];
  std::sort(robots_.begin(), robots_.end(), [](const Robot& a, const Robot& b) { return a.id < b.id; });
  for (const std::uint32_t id : lights) lights_.push_back({.id = id});
  updated_.reserve(robots.size());
  recipients_.reserve(robots.size());
  centre_rows_.reserve(robots.size());
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
  if (const auto* signals = std::get_if<V2i>(&packet.body)) {
    const base::Pose X_WL = approach_at(*signals, 0).X_WL;
    for (Light& light : lights_)
      if (light.id == packet.header.robot) light.p = {X_WL.x, X_WL.y};
    return;
  }
  Robot* robot = find(packet.header.robot);
  if (const auto* state = std::get_if<V2v>(&packet.body)) {
    if (robot == nullptr) return;
    robot->age = 0;
    robot->p = {state->X_WR.x, state->X_WR.y};
    V2v level = *state;
    level.tilt = {};  // receivers of earlier versions would drop all states of a NEIGHBOURS of another length
    encode(packet.header, level, robot->state);
  } else if (std::holds_alternative<Start>(packet.body)) {
    const bool all = packet.header.robot == kBroadcastId;
    if (!all && robot == nullptr) return;
    (all ? start_pending_ : robot->started) = true;
    encode(packet.header, Start{}, all ? start_ : robot->start);
  }
}

void Relay::forward(Inbox& inbox, std::int64_t now, Outbox& outbox) {
  send_starts(inbox, now, outbox);
  if (options_.range > 0.0) {
    find_recipients(inbox, now);
    send_states(inbox, now, outbox);
    send_to_lights(inbox, now, outbox);
  }
  send_to_centre(inbox, now, outbox);
  for (Robot& robot : robots_)
    if (robot.age < std::numeric_limits<std::uint32_t>::max()) ++robot.age;
}

void Relay::send_starts(Inbox& inbox, std::int64_t now, Outbox& outbox) {
  for (Robot& robot : robots_) {
    if ((robot.started || start_pending_) && inbox.is_active(robot.id, now)) {
      outbox.queue(*inbox.address(robot.id), robot.started ? robot.start : start_, inbox.session_token_for(robot.id),
                   inbox.signer(robot.id));
      ++counts_.starts;
    }
    robot.started = false;
  }
  start_pending_ = false;
}

/// Finds the subscribers, and the places of all robots with a state since the turn of the subscriber that has waited
/// longest.
void Relay::find_recipients(const Inbox& inbox, std::int64_t now) {
  recipients_.clear();
  updated_.clear();
  std::uint32_t longest = 0;
  for (std::uint32_t row = 0; row < robots_.size(); ++row) {
    Robot& robot = robots_[row];
    if (!inbox.wants_neighbours(robot.id, now)) {
      robot.waits = 0;
      continue;
    }
    recipients_.push_back(row);
    longest = std::max(longest, robot.waits);
  }
  const bool needed = !recipients_.empty() || !lights_.empty();
  for (std::uint32_t row = 0; row < robots_.size() && needed; ++row)
    if (robots_[row].age <= longest) updated_.push_back({*robots_[row].p, row, robots_[row].age});
  neighbour_tree_.build(updated_);
}

/// Serves subscribers as far as the budget allows, starting with the first one that was passed over last time.
void Relay::send_states(Inbox& inbox, std::int64_t now, Outbox& outbox) {
  if (updated_.empty() || recipients_.empty()) return;
  const std::size_t share = std::clamp(options_.budget / recipients_.size(), kMinShare, options_.most);
  const auto first = std::lower_bound(recipients_.begin(), recipients_.end(), turn_) - recipients_.begin();
  std::rotate(recipients_.begin(), recipients_.begin() + first, recipients_.end());
  std::size_t left = options_.budget, served = 0;
  for (; served < recipients_.size() && left >= share; ++served)
    left -= send_others(robots_[recipients_[served]], share, inbox, now, outbox);
  if (served < recipients_.size()) turn_ = recipients_[served];
  for (; served < recipients_.size(); ++served) {
    ++robots_[recipients_[served]].waits;
    ++counts_.waited;
  }
}

std::size_t Relay::send_others(Robot& to, std::size_t most, Inbox& inbox, std::int64_t now, Outbox& outbox) {
  const auto own = static_cast<std::uint32_t>(&to - robots_.data());
  const auto rows =
      neighbour_tree_.find({.p = to.p, .own = own, .range = options_.range, .max_count = most, .max_age = to.waits});
  send_rows(rows, {to.id, *inbox.address(to.id), inbox.session_token_for(to.id), inbox.signer(to.id)}, to.sent, now,
            outbox);
  to.waits = 0;
  return rows.size();
}

/// Lights are few and do not count against the budget: each receives the nearest robots at every tick.
void Relay::send_to_lights(Inbox& inbox, std::int64_t now, Outbox& outbox) {
  const auto none = static_cast<std::uint32_t>(robots_.size());
  for (Light& light : lights_) {
    const std::optional<Endpoint> address = inbox.light_address(light.id, now);
    if (!address) continue;
    const auto rows = neighbour_tree_.find(
        {.p = light.p, .own = none, .range = options_.range, .max_count = options_.most, .max_age = 0});
    send_rows(rows, {light.id, *address, inbox.light_session_token(light.id), inbox.light_signer(light.id)}, light.sent,
              now, outbox);
  }
}

/// The control centre has a network of its own: it receives the new states of all robots, whatever the radio range, up
/// to the budget of one tick.
void Relay::send_to_centre(Inbox& inbox, std::int64_t now, Outbox& outbox) {
  const std::optional<Endpoint> address = inbox.centre_address(now);
  if (!address) return;
  const auto robots = static_cast<std::uint32_t>(robots_.size());
  centre_rows_.clear();
  std::size_t missed = 0;
  for (std::uint32_t k = 0; k < robots; ++k) {
    const std::uint32_t row = (centre_turn_ + k) % robots;
    if (robots_[row].age != 0) continue;
    if (centre_rows_.size() < options_.budget)
      centre_rows_.push_back(row);
    else if (missed++ == 0)
      centre_turn_ = row;
  }
  send_rows(centre_rows_, {kBroadcastId, *address, inbox.centre_session_token(), inbox.centre_signer()},
            sent_to_centre_, now, outbox);
  counts_.centre += centre_rows_.size();
  counts_.missed += missed;
}

void Relay::send_rows(std::span<const std::uint32_t> rows, const Recipient& to, std::uint32_t& sent, std::int64_t now,
                      Outbox& outbox) {
  for (std::size_t first = 0; first < rows.size(); first += kMaxNeighbours) {
    states_.clear();
    for (const std::uint32_t row : rows.subspan(first, std::min(kMaxNeighbours, rows.size() - first))) {
      states_.insert(states_.end(), robots_[row].state.begin(), robots_[row].state.end());
      netio::write_session_token(std::span(states_).last(kV2vBytes), to.session_token);
    }
    encode({.robot = static_cast<std::uint16_t>(to.id), .sequence = sent++, .time = now}, Neighbours{states_}, packet_);
    outbox.queue(to.address, packet_, to.session_token, to.signer);
    ++counts_.datagrams;
  }
  counts_.states += rows.size();
}

}  // namespace sf::netio
