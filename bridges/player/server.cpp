#include "bridges/player/server.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/elapsed.h"
#include "bridges/player/readings.h"
#include "netio/player/xdr.h"

namespace sf::bridges::player {

namespace {

constexpr std::uint64_t kFirstConnection = 1u << 16;  // lower keys are of ports
constexpr double kQuiet = 1.0;                        // [s] after which a connection may be closed for a new client

}  // namespace

Server::Server(const Scene& scene, const Devices& devices, Exchange& exchange, const netio::Endpoint& bind,
               double silent, int log_descriptor, const Follows& follows)
    : scene_(scene),
      devices_(devices),
      exchange_(exchange),
      requester_(scene, devices, exchange, follows),
      users_(devices.rows().size()),
      next_key_(kFirstConnection),
      silent_(silent),
      log_(log_descriptor) {
  open(bind);
  exchange_.look(snapshot_);
  thread_ = std::thread([this] { run(); });
}

Server::~Server() {
  stop_ = true;
  wait_.wake();
  thread_.join();
}

void Server::open(const netio::Endpoint& first) {
  constexpr int kAttempts = 20;  // attempts to find consecutive free ports
  for (int attempt = 1; ports_.empty(); ++attempt) {
    try {
      open_all(first);
    } catch (const netio::PortInUse&) {
      ports_.clear();
      if (first.port != 0 || attempt == kAttempts) throw;
    }
  }
  for (std::size_t i = 0; i < ports_.size(); ++i) wait_.add_listener(ports_[i].listener, i);
  endpoint_ = ports_[0].endpoint;
}

void Server::open_all(netio::Endpoint endpoint) {
  const std::span<const std::uint32_t> robots = devices_.robots();
  const std::size_t count = robots.empty() ? 1 : std::min(robots.size(), kMostRobotPorts);
  for (std::size_t i = 0; i < count; ++i) {
    netio::Socket listener = netio::listen_tcp(endpoint);
    endpoint.port = netio::bound_endpoint(listener).port;
    ports_.push_back(
        {std::move(listener), endpoint, Listing(devices_, i == 0 ? std::nullopt : std::optional(robots[i]))});
    if (++endpoint.port == 0 && i + 1 < count)
      throw netio::PortInUse("the robots' ports after TCP " + netio::endpoint_text(ports_[0].endpoint) +
                             " would end beyond 65535; choose a lower one");
  }
}

void Server::wake() {
  if (watched_) wait_.wake();
}

void Server::run() {
  while (!stop_) {
    const std::size_t before = connections_.size();
    for (const std::uint64_t key : wait_.wait()) {
      if (key == netio::SocketWait::kWoken) publish(), flush();  // before answers to requests that arrived later
      if (key < kFirstConnection) accept_all(key);
      if (key >= kFirstConnection && key != netio::SocketWait::kWoken) receive(key);
    }
    flush();
    // A descriptor is free again. Pending connections are not reported a second time, so accept them now.
    if (connections_.size() >= before) continue;
    for (std::size_t port = 0; port < ports_.size(); ++port) accept_all(port);
    flush();
  }
}

void Server::accept_all(std::size_t port) {
  for (;;) {
    netio::Endpoint peer;
    netio::Socket socket = netio::accept_tcp(ports_[port].listener, peer);
    if (socket.descriptor() < 0) return;
    if (connections_.size() >= kMostClients && !make_room(peer.address)) {
      ++refused_;
      note_full(peer);
      continue;
    }
    ++clients_;
    const std::uint64_t key = next_key_++;
    wait_.add(socket, key);
    connections_.try_emplace(key, std::move(socket), port, ports_[port].endpoint, peer.address);
    watched_ = true;
  }
}

/// Closes a connection to make room. Chooses the one that has been silent longest among those without an open device,
/// else among those of the host with most connections. If that host has no more than `host` would have, chooses among
/// all that have been silent for `silent_`. Connections active in the last second remain.
bool Server::make_room(std::uint32_t host) {
  std::map<std::uint32_t, std::size_t> counts;
  for (const auto& [key, connection] : connections_) ++counts[connection.host()];
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const bool is_greedy = most->second > counts[host] + 1;
  auto oldest = connections_.end();
  for (const bool open : {false, true}) {
    for (auto at = connections_.begin(); at != connections_.end(); ++at) {
      const bool is_open = !at->second.subscriptions().empty();
      if (is_open != open || (open && is_greedy && at->second.host() != most->first)) continue;
      if (oldest == connections_.end() || at->second.heard() < oldest->second.heard()) oldest = at;
    }
    if (oldest != connections_.end()) break;
  }
  if (oldest == connections_.end()) return false;
  const bool is_open = !oldest->second.subscriptions().empty();
  if (base::seconds_since(oldest->second.heard()) < (is_open && !is_greedy ? std::max(kQuiet, silent_) : kQuiet))
    return false;
  ++evicted_;
  end(oldest->first);
  return true;
}

/// Logs the first refused client, then every ten seconds their number while more arrive.
void Server::note_full(const netio::Endpoint& peer) {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_line_) return;
  next_line_ = now + std::chrono::seconds(10);
  const std::uint64_t count = refused_ - std::exchange(stated_, refused_.load());
  log_.write(fmt::format("Player: {} refused, the last from {}: {} are connected, which is the limit, and none has "
                         "been silent long enough ({:g} s) to be disconnected",
                         count == 1 ? "1 program" : fmt::format("{} programs", count), netio::endpoint_text(peer),
                         connections_.size(), silent_),
             std::chrono::nanoseconds(now.time_since_epoch()).count());
}

void Server::receive(std::uint64_t key) {
  const auto found = connections_.find(key);
  if (found == connections_.end()) return;
  Connection& connection = found->second;
  bool well_formed = true;
  const bool open = connection.receive([&](const Header& header, std::span<const std::uint8_t> payload) {
    return well_formed = handle(connection, header, payload);
  });
  malformed_ += !well_formed;
  if (!open) end(key);
}

void Server::end(std::uint64_t key) {
  const auto found = connections_.find(key);
  while (!found->second.subscriptions().empty())
    unsubscribe(found->second, found->second.subscriptions().begin()->first);
  connections_.erase(found);
  watched_ = !connections_.empty();
}

void Server::flush() {
  for (auto next = connections_.begin(); next != connections_.end();) {
    const auto current = next++;
    const bool was_full = current->second.is_full();
    if (!current->second.flush(time())) {
      end(current->first);
    } else if (was_full != current->second.is_full()) {
      wait_.update(current->second.socket(), current->first, !was_full);
    }
  }
}

void Server::publish() {
  exchange_.look(snapshot_);
  if (!snapshot_.is_new) return;
  for (auto& [key, connection] : connections_) publish(connection);
}

void Server::publish(Connection& connection) {
  for (auto& [address, subscription] : connection.subscriptions()) {
    const Device& device = devices_.rows()[subscription.device];
    if (device.mover == world::kNone || !requester_.is_on(subscription.device)) continue;
    const base::Report& report = snapshot_.reports[device.mover];
    if (base::is_absent(report.X_WM)) continue;
    payload_.clear();
    XdrWriter xdr(payload_);
    if (device.interf == Interface::position2d) {
      put_state(snapshot_.odometry[device.mover], report, snapshot_.contacts[device.mover] != 0, xdr);
      connection.put_data(address, subscription, position2d::state, time(), payload_);
      continue;
    }
    const LastReading& reading = snapshot_.readings[device.slot];
    if (!reading.is_new) continue;
    subscription.describes = !subscription.described;
    put_reading(device, reading, report, subscription.describes, xdr);
    connection.put_data(address, subscription, data_subtype(device, subscription.describes),
                        1e-9 * static_cast<double>(reading.time), payload_);
  }
}

void Server::subscribe(Connection& connection, const Address& address, std::uint32_t device) {
  const bool is_new = connection.subscriptions().try_emplace(address, Subscription{device}).second;
  if (!is_new) return;
  const std::uint32_t slot = devices_.rows()[device].slot;
  if (users_[device]++ == 0 && slot != world::kNone) exchange_.use(slot, true);
}

/// Stops a robot when its last driver has left.
void Server::unsubscribe(Connection& connection, const Address& address) {
  const std::uint32_t row = connection.subscriptions().at(address).device;
  connection.unsubscribe(address);
  const Device& device = devices_.rows()[row];
  if (--users_[row] > 0) return;
  if (device.slot != world::kNone) exchange_.use(device.slot, false);
  if (device.interf == Interface::position2d) exchange_.stop(device.mover);
}

bool Server::handle(Connection& connection, const Header& header, std::span<const std::uint8_t> payload) {
  if (header.address.interf == Interface::player) return handle_own(connection, header, payload);
  const auto& listing = ports_[connection.port()].listing.rows();
  const auto known = listing.find(header.address);
  if (header.type == MessageType::command && known != listing.end()) {
    if (connection.subscriptions().count(header.address) == 0) return true;
    return requester_.command(known->second, header.subtype, payload);
  }
  if (header.type != MessageType::request) return true;
  Answer answer;
  if (known != listing.end()) answer = requester_.request(known->second, header.subtype, payload);
  if (answer.kind == Answer::Kind::malformed) return false;
  const bool granted = answer.kind == Answer::Kind::granted;
  connection.answer(header, granted ? MessageType::ack : MessageType::nack, answer.payload, time());
  return true;
}

}  // namespace sf::bridges::player
