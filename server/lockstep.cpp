#include "server/lockstep.h"

#include <algorithm>
#include <variant>

#include <fmt/format.h>

#include "base/time.h"

namespace sf::server {

namespace {

constexpr std::int64_t kRenewal = netio::kSenderTimeout / 4;  ///< [ns] between renewals of a process's bindings
constexpr std::size_t kMostNamed = 8;                         ///< robots listed in one message

bool same_key(std::span<const netio::Peer> peers, std::uint32_t one, std::uint32_t other) {
  const auto key_of = [&](std::uint32_t id) {
    const netio::Peer* peer = netio::find(peers, netio::PeerKind::robot, id);
    return peer != nullptr ? peer->key : std::nullopt;
  };
  return one == other || peers.empty() || key_of(one) == key_of(other);
}

}  // namespace

Lockstep::Lockstep(const world::World& world, const sensors::SensorSet& sensor_set, const LockstepOptions& options)
    : world_(world),
      options_(options),
      names_(wire_names(world)),
      inbox_({.bind = options.bind, .robots = ids_of(names_.robots), .peers = options.peers, .lockstep = true}),
      outbox_(inbox_.socket()),
      log_(options.log_descriptor),
      rejections_(ids_of(names_.robots)),
      seats_(world.movers.size()),
      commands_(world.movers.size()),
      published_(sensor_set) {}

void Lockstep::receive(std::int64_t now) {
  again_ = 0;
  const auto on_notable = [&](netio::PacketStatus reason, const netio::Packet& packet, const netio::Endpoint& who) {
    trouble_.note(reason, packet, who, world_.movers[names_.robots.at(packet.header.robot)].name, now, inbox_, outbox_,
                  log_);
    if (reason != netio::PacketStatus::unproven || !inbox_.challenge(packet, who, now, packet_)) return;
    outbox_.queue(who, packet_);
  };
  inbox_.receive(
      now, [&](const netio::Packet& packet) { take(packet, now); }, on_notable,
      [&](netio::PacketStatus reason, std::span<const std::uint8_t> bytes, const netio::Endpoint& who) {
        rejections_.note(reason, bytes, who, now, log_);
      });
  acknowledge();
  outbox_.flush();
  check_timeout(now);
}

void Lockstep::take(const netio::Packet& packet, std::int64_t now) {
  const netio::Header& header = packet.header;
  if (const auto* request = std::get_if<netio::Subscribe>(&packet.body)) return subscribe(header, request->types, now);
  if (std::holds_alternative<netio::Leave>(packet.body)) return release(names_.robots.at(header.robot));
  Process* process = find(*inbox_.address(header.robot));
  if (process == nullptr || process->session != header.session) return void(++counts_.repeated);
  if (now - process->renewed >= kRenewal) {
    process->renewed = now;
    for (const std::uint32_t mover : process->movers) inbox_.renew(world_.movers[mover].id, process->endpoint, now);
  }
  if (const auto* command = std::get_if<netio::Command>(&packet.body)) take(*process, *command, header);
  if (const auto* step = std::get_if<netio::Step>(&packet.body)) take(*process, *step, now);
  if (const auto* fetch = std::get_if<netio::Fetch>(&packet.body)) take(*process, *fetch);
}

/// Only the first command for a robot and tick counts, so duplicates have no effect.
void Lockstep::take(Process& process, const netio::Command& command, const netio::Header& header) {
  for (std::size_t i = 0; i < netio::count_rows(command); ++i) {
    const netio::CommandRow row = netio::row_of(command, i);
    const auto at = names_.robots.find(row.robot);
    if (at == names_.robots.end() || seats_[at->second].driver != &process ||
        !same_key(options_.peers, header.robot, row.robot)) {
      ++counts_.refused;
    } else if (command.tick != published_.tick() || !answerable(process) ||
               seats_[at->second].commanded == published_.tick()) {
      ++counts_.repeated;
    } else {
      seats_[at->second].commanded = published_.tick();
      commands_[at->second] = row.twist;
      ++process.commands;
      ++counts_.commands;
    }
  }
}

void Lockstep::take(Process& process, const netio::Step& step, std::int64_t now) {
  if (step.tick == published_.tick() && answerable(process) && !process.step) {
    process.step = step;
    if (!first_step_) first_step_ = now;
    return;
  }
  ++counts_.repeated;
  // The answer was lost, or the farm waits for other processes. Its first datagram shows that the farm is alive.
  if (answerable(process)) answer_again(process, 0, step.tick < published_.tick() ? kPushed : 1);
}

void Lockstep::take(Process& process, const netio::Fetch& fetch) {
  if (fetch.tick == published_.tick() && answerable(process)) answer_again(process, fetch.first, fetch.count);
}

void Lockstep::subscribe(const netio::Header& header, base::SensorTypes types, std::int64_t now) {
  const std::uint32_t mover = names_.robots.at(header.robot);
  const netio::Endpoint endpoint = *inbox_.address(header.robot);
  if (Process* old = find(endpoint); old != nullptr && old->session != header.session) release_all(*old);
  if (seats_[mover].driver != nullptr && seats_[mover].driver->endpoint != endpoint) release(mover);
  Process& process = processes_[{endpoint.address, endpoint.port}];
  if (process.movers.empty()) {
    process = {
        .endpoint = endpoint, .session = header.session, .movers = {}, .answered = published_.tick(), .renewed = now};
    changed_ = now;  // other processes start waiting for this one
  }
  const bool added = seats_[mover].driver == nullptr;
  counts_.repeated += added ? 0 : 1;
  if (added) {
    seats_[mover].driver = &process;
    ++driven_;
    seats_[mover].answered = answerable(process) ? std::optional(published_.tick()) : std::nullopt;
    seats_[mover].before.reset();
    seats_[mover].commanded.reset();
    const auto by_id = [&](std::uint32_t a, std::uint32_t b) { return world_.movers[a].id < world_.movers[b].id; };
    process.movers.insert(std::lower_bound(process.movers.begin(), process.movers.end(), mover, by_id), mover);
  }
  process.built = process.built && !added && seats_[mover].types == types;
  seats_[mover].types = types;
  begun_ = begun_ || driven_ >= options_.robots;
  unacknowledged_.push_back(mover);
}

/// Sends a STATE of each new robot, which confirms its subscription.
void Lockstep::acknowledge() {
  if (unacknowledged_.empty()) return;
  std::sort(unacknowledged_.begin(), unacknowledged_.end());
  for (auto& [key, process] : processes_) {
    if (!answerable(process)) continue;
    build_answer(process);
    for (std::uint32_t i = 0; i < process.answer.size(); ++i) {
      const Part& part = process.answer[i];
      const bool asked = std::binary_search(unacknowledged_.begin(), unacknowledged_.end(), part.mover);
      if (asked && part.reading == kState && seats_[part.mover].driver == &process) send(process, i, 1);
    }
  }
  unacknowledged_.clear();
}

/// Stops the robot. Removes its process together with its last robot.
void Lockstep::release(std::uint32_t mover) {
  Process* process = std::exchange(seats_[mover].driver, nullptr);
  commands_[mover] = {};
  if (process == nullptr) return;
  --driven_;
  if (seats_[mover].commanded == published_.tick() && process->commands > 0) --process->commands;
  std::erase(process->movers, mover);
  process->built = false;
  if (process->movers.empty()) processes_.erase({process->endpoint.address, process->endpoint.port});
}

void Lockstep::release_all(Process& process) {
  for (const std::uint32_t mover : std::vector(process.movers)) release(mover);
}

Lockstep::Process* Lockstep::find(const netio::Endpoint& endpoint) {
  const auto at = processes_.find({endpoint.address, endpoint.port});
  return at == processes_.end() ? nullptr : &at->second;
}

bool Lockstep::is_done(const Process& process) const {
  return process.step && (published_.tick() > process.step->tick || process.commands >= process.step->commands);
}

bool Lockstep::ready() const {
  return begun_ && !processes_.empty() &&
         std::all_of(processes_.begin(), processes_.end(), [&](const auto& entry) { return is_done(entry.second); });
}

void Lockstep::check_timeout(std::int64_t now) {
  const std::int64_t limit = base::nanoseconds(options_.timeout);
  if (limit <= 0 || !begun_ || processes_.empty() || ready()) return;
  missing_.clear();
  bool held_up = false;  // whether a process waits for others
  for (const auto& [key, process] : processes_) {
    held_up = held_up || is_done(process);
    if (!is_done(process)) missing_.insert(missing_.end(), process.movers.begin(), process.movers.end());
  }
  if (held_up && first_step_ && now - std::max(*first_step_, changed_) >= limit) {
    log_.write(fmt::format("tick {}: no command or STEP for {:g} s from {}; it is left out and stays at rest from now "
                           "on, while the others continue",
                           published_.tick(), options_.timeout, names_of(missing_)),
               now);
    counts_.lost_robots += missing_.size();
    for (const std::uint32_t mover : std::vector(missing_)) release(mover);
  } else if (!held_up && now - changed_ >= limit && warned_ != published_.tick()) {
    warned_ = published_.tick();
    log_.write(fmt::format("tick {}: waiting for {:g} s for the commands or STEP of {}", published_.tick(),
                           options_.timeout, names_of(missing_)),
               now);
  }
}

/// "roomba1 (id 1), roomba2 (id 2) and 12 more".
std::string Lockstep::names_of(std::span<const std::uint32_t> movers) const {
  std::string text;
  for (const std::uint32_t mover : movers.first(std::min(movers.size(), kMostNamed)))
    text += fmt::format("{}{} (id {})", text.empty() ? "" : ", ", world_.movers[mover].name, world_.movers[mover].id);
  if (movers.size() > kMostNamed) text += fmt::format(" and {} more", movers.size() - kMostNamed);
  return text;
}

}  // namespace sf::server
