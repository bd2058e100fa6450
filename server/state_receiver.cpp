#include "server/state_receiver.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include <fmt/format.h>

#include "base/time.h"

namespace sf::server {

using estimation::ClockSource;

namespace {

/// By time of arrival, no state is late: an overtaken state would count as the newest.
bool takes_late(const StateFilterOptions& filter) {
  return filter.mode == FilterMode::on && filter.clock.source != estimation::ClockSource::arrival;
}

}  // namespace

StateReceiver::StateReceiver(const world::World& world, const StateReceiverOptions& options)
    : world_(world),
      names_(wire_names(world)),
      inbox_({.bind = options.bind,
              .robots = ids_of(names_.robots),
              .tags = ids_of(names_.tags),
              .peers = options.peers,
              .take_late = takes_late(options.filter),
              .lights = options.lights}),
      peers_(options.peers),
      answers_(inbox_.socket()),
      relay_(ids_of(names_.robots), {.range = options.radio}, options.lights),
      fleet_(world),
      filter_(world, options.filter),
      keep_heights_(options.keep_heights),
      forget_(options.forget > 0.0
                  ? std::max<std::int64_t>(0, base::nanoseconds(options.forget) - netio::kSenderTimeout)
                  : kNever),
      removed_(world.movers.size(), false),
      heard_(world.movers.size(), false),
      joining_(world.movers.size(), false),
      last_active_(world.movers.size(), kNever),
      last_state_(world.movers.size(), kNever),
      periods_(world.movers.size(), 0),
      hidden_(world.movers.size(), false),
      filter_logged_(world.movers.size(), options.filter.mode == FilterMode::on),
      log_(options.log_descriptor),
      rejections_(ids_of(names_.robots)) {
  reports_.reserve(netio::Inbox::kMaxPerReceive);
  for (const std::uint32_t row : options.joining) joining_.at(row) = true;
}

void StateReceiver::receive_pending(std::int64_t now) {
  reports_.clear();
  const auto on_notable = [&](netio::PacketStatus reason, const netio::Packet& packet, const netio::Endpoint& who) {
    if (reason == netio::PacketStatus::wrong_source) {
      trouble_.answer(reason, packet, who, now, inbox_, answers_);
      return log_wrong_source(packet, who, now);
    }
    trouble_.note(reason, packet, who, sender_name(packet.header), now, inbox_, answers_, log_);
    if (reason != netio::PacketStatus::unproven || !inbox_.challenge(packet, who, now, challenge_)) return;
    answers_.queue(who, challenge_);
  };
  inbox_.receive(
      now, [&](const netio::Packet& packet) { take(packet, now); }, on_notable,
      [&](netio::PacketStatus reason, std::span<const std::uint8_t> bytes, const netio::Endpoint& who) {
        rejections_.note(reason, bytes, who, now, log_);
      });
  answers_.flush();
  fleet_.apply(reports_);
}

void StateReceiver::take(const netio::Packet& packet, std::int64_t now) {
  if (!packet.late) relay_.take(packet);
  if (const auto* signals = std::get_if<netio::V2i>(&packet.body)) {
    if (light_handler_) light_handler_(packet.header, *signals, now);
    return place_light(packet.header, *signals, now);
  }
  if (const auto* lane = std::get_if<netio::Lane>(&packet.body)) {
    if (lane_handler_) lane_handler_(*lane);
    return;
  }
  if (const auto* own = std::get_if<netio::OwnReadings>(&packet.body)) {
    if (own_readings_handler_) own_readings_handler_(packet.header, *own, names_.robots.at(packet.header.robot), now);
    return;
  }
  if (const auto* object = std::get_if<netio::Object>(&packet.body)) {
    const std::uint32_t row = names_.tags.at(packet.header.robot);
    heard_[row] = true;
    removed_[row] = !object->present;
    return change_shape(row, *object);
  }
  base::Report report;
  if (const auto* state = std::get_if<netio::V2v>(&packet.body)) {
    report = netio::report(packet.header, *state, names_.robots.at(packet.header.robot));
  } else if (const auto* tag = std::get_if<netio::Tag>(&packet.body)) {
    const std::uint32_t row = names_.tags.at(packet.header.robot);
    report = netio::report(packet.header, *tag, row, world_.movers[row].X_MT);
  } else {
    return;
  }
  heard_[report.mover] = true;
  if (keep_heights_) report.X_WM.z = world_.movers[report.mover].X_WM.z;
  std::int64_t& last = last_state_[report.mover];
  if (last != kNever) periods_[report.mover] = std::min(now - last, kLongestPeriod);
  last = now;
  if (filter(report, packet.header, now)) return;
  // Senders' clocks are not comparable: a state is valid at its arrival.
  report.time = now;
  reports_.push_back(report);
}

void StateReceiver::change_shape(std::uint32_t row, const netio::Object& object) {
  world::ShapeChange wanted;
  if (!object.shape.empty()) wanted.shape = object.shape;
  wanted.color = object.color;
  if (object.size) wanted.size = glm::dvec3{(*object.size)[0], (*object.size)[1], (*object.size)[2]};
  change_shape(row, wanted);
}

void StateReceiver::change_shape(std::uint32_t row, const world::ShapeChange& wanted) {
  if (wanted.any()) shape_changes_[row].add(wanted);
}

/// A light that joins is where the first group of its V2I is.
void StateReceiver::place_light(const netio::Header& header, const netio::V2i& signals, std::int64_t now) {
  const auto post = names_.lights.find(header.robot);
  const auto approach = netio::find_approach(signals, 1);
  if (post == names_.lights.end() || !approach) return;
  base::Report report{post->second, now, approach->X_WL, {}};
  if (keep_heights_) report.X_WM.z = world_.movers[report.mover].X_WM.z;
  last_state_[report.mover] = now;
  reports_.push_back(report);
}

/// @return whether the state's sender is filtered
bool StateReceiver::filter(const base::Report& report, const netio::Header& header, std::int64_t now) {
  const bool before = filter_.is_filtered(report.mover);
  const bool filtered = filter_.take(report, header, now);
  if (filtered == before) return filtered;
  const netio::PeerKind kind = netio::claim_of(header).kind;
  inbox_.set_take_late(kind, header.robot, filtered && filter_.options().clock.source != ClockSource::arrival);
  if (!filtered || filter_logged_[report.mover]) return filtered;
  filter_logged_[report.mover] = true;
  log_.write(sender_text(header) + ": its states arrive late by changing amounts, so they are filtered while they do",
             now);
  return filtered;
}

void StateReceiver::place(const base::Report& report, bool present) {
  removed_[report.mover] = !present;
  last_state_[report.mover] = report.time;
  fleet_.apply({&report, 1});
}

void StateReceiver::predict(std::int64_t now) {
  if (filter_.options().mode != FilterMode::off) fleet_.apply(filter_.predict(now));
}

netio::StateQuality StateReceiver::quality(std::uint32_t row, std::int64_t now) const {
  constexpr netio::StateQuality kNone{.stated = true, .stale = true, .age = base::kNoStateYet};
  if (filter_.is_filtered(row)) {
    const netio::StateQuality predicted = filter_.quality(row);
    return predicted.stated ? predicted : kNone;
  }
  if (last_state_[row] == kNever) return kNone;
  const std::int64_t age = now - last_state_[row];
  return {.stated = true, .stale = age > filter_.options().stale_after, .age = age};
}

void StateReceiver::queue(std::uint32_t id, std::span<const std::uint8_t> packet) {
  answers_.queue(*inbox_.address(id), packet, inbox_.session_token_for(id), inbox_.signer(id));
}

void StateReceiver::relay(std::int64_t now) {
  relay_.forward(inbox_, now, answers_);
  answers_.flush();
}

bool StateReceiver::update_absent(std::uint32_t id, std::int64_t now) {
  const std::uint32_t row = names_.robots.at(id);
  std::int64_t& last = last_active_[row];
  const bool active = inbox_.is_active(id, now);
  const bool forgotten = !active && forget_ != kNever && last != kNever && now - last >= forget_;
  if (joining_[row] && !active) forget_sender({netio::PeerKind::robot, id}, row);
  const bool never = last_state_[row] == kNever && (joining_[row] || (!active && hides_stale()));
  const bool absent = forgotten || never || is_gone(row, now);
  if (active && absent && !hidden_[row] && !never)
    log_.write(fmt::format("{} (id {}) requests readings, but none of its states was accepted for {:g} s: it has left "
                           "the world until its next state (--stale freeze keeps it)",
                           world_.movers[row].name, id, 1e-9 * static_cast<double>(filter_.options().stale_after)),
               now);
  hidden_[row] = active && absent;
  if (active) last = now;
  fleet_.set_absent(row, absent);
  return absent;
}

/// A sender that joined has left: the next one with its id inherits nothing.
void StateReceiver::forget_sender(const netio::Claim& sender, std::uint32_t row) {
  removed_[row] = false;
  shape_changes_.erase(row);
  if (world_.changed_shapes.contains(row)) shape_changes_[row] = {.shape = std::string(world::kOriginalShape)};
  if (last_state_[row] == kNever) return;
  last_state_[row] = last_active_[row] = kNever;
  periods_[row] = 0;
  filter_logged_[row] = filter_.options().mode == FilterMode::on;
  filter_.reset(row);
  if (sender.kind != netio::PeerKind::light)
    inbox_.set_take_late(sender.kind, sender.id, takes_late(filter_.options()));
}

/// Tags and lights send no LEAVE.
void StateReceiver::forget_silent(const netio::Claim& sender, std::uint32_t row, std::int64_t now) {
  const std::int64_t last = last_state_[row];
  if (joining_[row] && (last == kNever || now - last >= netio::kSenderTimeout)) forget_sender(sender, row);
}

bool StateReceiver::hides_stale() const { return filter_.options().policy != estimation::StalePolicy::freeze; }

/// Returns whether the mover's state is stale and the policy removes it from the world. A slow sender does not leave
/// between two of its states.
bool StateReceiver::is_gone(std::uint32_t row, std::int64_t now) const {
  if (filter_.is_filtered(row) && filter_.quality(row).stated) return filter_.is_gone(row);
  const std::int64_t limit = std::max(filter_.options().stale_after, 2 * periods_[row]);
  return hides_stale() && last_state_[row] != kNever && now - last_state_[row] > limit;
}

bool StateReceiver::update_absent_tag(std::uint32_t id, std::int64_t now) {
  const std::uint32_t row = names_.tags.at(id);
  forget_silent({netio::PeerKind::tag, id}, row, now);
  const bool never = joining_[row] && last_state_[row] == kNever;
  const bool absent = never || removed_[row] || is_gone(row, now);
  fleet_.set_absent(row, absent);
  return absent;
}

bool StateReceiver::update_absent_light(std::uint32_t id, std::int64_t now) {
  const std::uint32_t row = names_.lights.at(id);
  forget_silent({netio::PeerKind::light, id}, row, now);
  fleet_.set_absent(row, last_state_[row] == kNever);
  return last_state_[row] == kNever;
}

/// Of the mover that a packet claims to be from; empty: it is from none.
std::string StateReceiver::sender_name(const netio::Header& header) const {
  const netio::Claim claim = netio::claim_of(header);
  if (claim.kind != netio::PeerKind::robot && claim.kind != netio::PeerKind::tag) return "";
  return world_.movers[(claim.kind == netio::PeerKind::tag ? names_.tags : names_.robots).at(claim.id)].name;
}

/// Describes the claimed sender of a packet.
std::string StateReceiver::sender_text(const netio::Header& header) const {
  const netio::Claim claim = netio::claim_of(header);
  if (claim.kind == netio::PeerKind::start) return "the sender of START";
  if (claim.kind == netio::PeerKind::centre) return "the control centre";
  if (claim.kind == netio::PeerKind::light) return fmt::format("intersection {}", claim.id);
  return fmt::format("{} ({} {})", sender_name(header), claim.kind == netio::PeerKind::tag ? "tag" : "id", claim.id);
}

/// Returns the address that its id is bound to.
std::optional<netio::Endpoint> StateReceiver::bound_address(const netio::Header& header, std::int64_t now) const {
  const netio::Claim claim = netio::claim_of(header);
  if (claim.kind == netio::PeerKind::light) return inbox_.light_address(claim.id, now);
  if (claim.kind == netio::PeerKind::centre) return inbox_.centre_address(now);
  if (claim.kind == netio::PeerKind::robot) return inbox_.address(claim.id);
  return header.type == netio::Type::object ? inbox_.object_address(claim.id) : inbox_.tag_address(claim.id);
}

/// Logs once per binding, or once for the address in the table of peers.
void StateReceiver::log_wrong_source(const netio::Packet& packet, const netio::Endpoint& who, std::int64_t now) {
  const netio::Claim claim = netio::claim_of(packet.header);
  const netio::Peer* peer = netio::find(peers_, claim.kind, claim.id);
  const bool refused = peer != nullptr && peer->address && *peer->address != who.address;
  const auto expected =
      refused ? netio::Endpoint{*peer->address, 0} : bound_address(packet.header, now).value_or(netio::Endpoint{});
  auto& logged = logged_[{claim.kind, claim.id}];
  if (logged == expected) return;
  logged = expected;
  const std::string sender = sender_text(packet.header);
  log_.write(
      refused
          ? fmt::format("{} is at {} in the table of peers; packets with its id from {} are dropped", sender,
                        netio::ipv4_text(expected.address), netio::endpoint_text(who))
          : fmt::format(
                "{} is at {}; packets with its id from {} are dropped until that sender leaves or is silent for 2 s",
                sender, netio::endpoint_text(expected), netio::endpoint_text(who)),
      now);
}

}  // namespace sf::server
