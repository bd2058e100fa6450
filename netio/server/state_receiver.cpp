#include "netio/server/state_receiver.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include <fmt/format.h>

#include "base/time.h"

namespace sf::server {

StateReceiver::StateReceiver(const world::World& world, const StateReceiverOptions& options)
    : world_(world),
      names_(wire_names(world)),
      inbox_({.bind = options.bind, .robots = ids_of(names_.robots), .tags = ids_of(names_.tags)}),
      answers_(inbox_.socket()),
      relay_(ids_of(names_.robots), {.range = options.radio}),
      fleet_(world),
      forget_(options.forget > 0.0
                  ? std::max<std::int64_t>(0, base::nanoseconds(options.forget) - netio::kClientTimeout)
                  : kNever),
      last_active_(world.movers.size(), kNever),
      log_(options.log_descriptor) {
  reports_.reserve(netio::Inbox::kMaxPerReceive);
}

void StateReceiver::receive_pending(std::int64_t now) {
  reports_.clear();
  const auto on_rejected = [&](netio::PacketStatus reason, const netio::Packet& packet, const netio::Endpoint& who) {
    if (reason == netio::PacketStatus::wrong_source) return log_wrong_source(packet, who, now);
    if (inbox_.challenge(packet, who, now, challenge_)) answers_.queue(who, challenge_);
  };
  inbox_.receive(
      now, [&](const netio::Packet& packet) { take(packet, now); }, on_rejected);
  answers_.flush();
  fleet_.apply(reports_);
}

void StateReceiver::take(const netio::Packet& packet, std::int64_t now) {
  relay_.take(packet);
  if (const auto* state = std::get_if<netio::V2v>(&packet.body)) {
    reports_.push_back(netio::report(packet.header, *state, names_.robots.at(packet.header.robot)));
  } else if (const auto* tag = std::get_if<netio::Tag>(&packet.body)) {
    const std::uint32_t row = names_.tags.at(packet.header.robot);
    reports_.push_back(netio::report(packet.header, *tag, row, world_.movers[row].X_MT));
  } else {
    return;
  }
  // Senders' clocks are their own: a state is true when it arrives.
  reports_.back().time = now;
}

void StateReceiver::relay(std::int64_t now) {
  relay_.forward(inbox_, now, answers_);
  answers_.flush();
}

bool StateReceiver::update_absent(std::uint32_t id, std::int64_t now) {
  const std::uint32_t row = names_.robots.at(id);
  std::int64_t& last = last_active_[row];
  const bool active = inbox_.is_active(id, now);
  const bool absent = !active && forget_ != kNever && last != kNever && now - last >= forget_;
  if (active) last = now;
  fleet_.set_absent(row, absent);
  return absent;
}

/// Once per binding.
void StateReceiver::log_wrong_source(const netio::Packet& packet, const netio::Endpoint& who, std::int64_t now) {
  const bool tag = std::holds_alternative<netio::Tag>(packet.body);
  const std::uint32_t id = packet.header.robot;
  const netio::Endpoint bound = *(tag ? inbox_.tag_address(id) : inbox_.address(id));
  auto& logged = (tag ? logged_tags_ : logged_robots_)[id];
  if (logged == bound) return;
  logged = bound;
  log_.write(fmt::format("{} ({} {}) is heard from {}; what {} says as the same is dropped until that one leaves or is "
                         "silent for 2 s",
                         world_.movers[(tag ? names_.tags : names_.robots).at(id)].name, tag ? "tag" : "id", id,
                         netio::text(bound), netio::text(who)),
             now);
}

}  // namespace sf::server
