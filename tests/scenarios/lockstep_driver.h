#pragma once
// A process that drives robots in lockstep over a link with seeded faults, by calls instead of a clock.

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <vector>

#include "netio/address_token.h"
#include "netio/outbox.h"
#include "netio/packets.h"
#include "netio/socket.h"
#include "tests/netio/command_rows.h"

namespace sf::scenarios {

struct Faults {
  double loss = 0.0, duplicate = 0.0, delay = 0.0;  ///< [-] fractions of the datagrams, in each direction
  unsigned seed = 1;
};

/// The datagrams of one direction. Some are lost, some are duplicated, and some arrive after later ones.
class FaultyLink {
 public:
  explicit FaultyLink(const Faults& faults, unsigned direction)
      : faults_(faults), random_(2 * faults.seed + direction) {}
  template <class Deliver>
  void pass(std::span<const std::uint8_t> bytes, Deliver&& deliver) {
    if (happens(faults_.loss)) return;
    const int copies = happens(faults_.duplicate) ? 2 : 1;
    for (int i = 0; i < copies; ++i) {
      if (happens(faults_.delay)) {
        delayed_.emplace_back(bytes.begin(), bytes.end());
      } else {
        deliver(bytes);
      }
    }
  }
  /// Delivers delayed datagrams, the last first.
  template <class Deliver>
  void release(Deliver&& deliver) {
    for (; !delayed_.empty(); delayed_.pop_back()) deliver(std::span<const std::uint8_t>(delayed_.back()));
  }

 private:
  bool happens(double share) { return static_cast<double>(random_()) < share * 4294967296.0; }

  Faults faults_;
  std::mt19937 random_;
  std::vector<base::Bytes> delayed_;
};

/// The data that a process has of one robot after a tick.
struct Driven {
  netio::State state;
  std::map<std::uint8_t, std::vector<double>> readings;  ///< newest of the first sensor of each type
  std::map<std::uint8_t, double> errors;                 ///< `error` of them in VALUES
  std::map<std::uint8_t, netio::Accuracy> accuracies;    ///< accuracy word of the header
};

class Driver {
 public:
  Driver(std::uint16_t farm, std::vector<std::uint32_t> robots, const Faults& faults = {}, std::uint32_t types = 0)
      : robots_(std::move(robots)),
        types_(types),
        socket_(netio::open_udp({netio::kLoopback, 0})),
        outbox_(netio::duplicate(socket_)),
        batch_(64),
        farm_{netio::kLoopback, farm},
        to_farm_(faults, 0),
        from_farm_(faults, 1) {}

  /// Returns whether all robots are subscribed and the answer of the last requested tick is complete.
  bool is_complete() const { return tick_ == wanted_ && !parts_.empty() && missing_ == 0 && acknowledged(); }
  std::uint64_t tick() const { return tick_; }
  const Driven& robot(std::uint32_t id) const { return driven_.at(id); }
  std::size_t datagrams() const { return parts_.size(); }

  /// Processes received datagrams.
  void receive() {
    const auto take = [this](std::span<const std::uint8_t> bytes) { accept(bytes); };
    batch_.drain(socket_, 4096,
                 [&](std::span<const std::uint8_t> bytes, const netio::Endpoint&) { from_farm_.pass(bytes, take); });
    from_farm_.release(take);
  }
  /// Repeats requests that have no answer yet.
  void repeat() {
    if (!acknowledged()) {
      for (const std::uint32_t id : robots_)
        if (!subscribed_.contains(id)) send(netio::Subscribe{types_}, id, requests_++);
    } else if (tick_ == wanted_ && missing_ > 0) {
      std::uint32_t first = 0;
      while (!parts_.empty() && parts_[first]) ++first;
      send(netio::Fetch{tick_, first, netio::kMaxFetched});
    } else if (tick_ < wanted_) {
      send_commands();
      send(step_);
    }
    flush();
  }
  /// @pre is_complete()
  void step(const std::map<std::uint32_t, base::Twist>& commands, std::uint32_t ticks = 1) {
    commands_ = commands;
    step_ = {tick_, ticks, static_cast<std::uint32_t>(commands.size())};
    wanted_ = tick_ + ticks;
    repeat();
  }
  void leave() {
    for (const std::uint32_t id : robots_) send(netio::Leave{}, id);
    flush();
  }
  template <class Body>
  void send(const Body& body, std::uint32_t robot, std::uint32_t sequence = 0) {
    netio::encode(
        {.robot = static_cast<std::uint16_t>(robot), .sequence = sequence, .session = session_, .token = token_}, body,
        bytes_);
    to_farm_.pass(bytes_, [&](std::span<const std::uint8_t> bytes) { outbox_.queue(farm_, bytes); });
  }
  template <class Body>
  void send(const Body& body) {
    send(body, robots_.front());
  }
  void send_commands() {
    base::Bytes rows;
    for (const auto& [id, twist] : commands_) {
      netio::add_row({id, twist}, rows);
      // Use several datagrams, so that some of a tick's commands can be lost.
      if (rows.size() < 2 * netio::kCommandRowBytes && id != commands_.rbegin()->first) continue;
      send(netio::Command{step_.tick, rows});
      rows.clear();
    }
  }
  void flush() {
    to_farm_.release([&](std::span<const std::uint8_t> bytes) { outbox_.queue(farm_, bytes); });
    outbox_.flush();
  }

 private:
  bool acknowledged() const { return subscribed_.size() == robots_.size(); }

  void accept(std::span<const std::uint8_t> bytes) {
    netio::Packet packet;
    ASSERT_EQ(netio::decode(bytes, packet), netio::PacketStatus::accepted);
    ASSERT_EQ(packet.header.token, session_);
    if (const auto* challenge = std::get_if<netio::Challenge>(&packet.body)) {
      token_ = challenge->token;
    } else if (const auto* state = std::get_if<netio::State>(&packet.body)) {
      if (place(state->part)) driven_[packet.header.robot].state = *state;
      if (!acknowledged()) subscribed_.insert(packet.header.robot);
    } else if (const auto* values = std::get_if<netio::Values>(&packet.body)) {
      if (!place(values->part) || packet.header.sensor != 0) return;
      std::vector<double>& all = driven_[packet.header.robot].readings[values->type];
      all.resize(values->total);
      driven_[packet.header.robot].errors[values->type] = values->bound;
      driven_[packet.header.robot].accuracies[values->type] = netio::decode_accuracy(packet.header.accuracy);
      for (std::size_t i = 0; i < values->values.size() / sizeof(double); ++i)
        all[values->first + i] = netio::value_of(*values, i);
    }
  }
  /// @return whether the datagram is new and belongs to the expected answer
  bool place(const netio::AnswerPart& part) {
    if (wanted_ == kUnknown) wanted_ = part.tick;
    if (part.tick != wanted_) return false;
    if (tick_ != part.tick || parts_.size() != part.datagrams) {
      parts_.assign(part.datagrams, false);
      missing_ = part.datagrams;
      tick_ = part.tick;
    }
    if (parts_[part.index]) return false;
    parts_[part.index] = true;
    --missing_;
    return true;
  }

  static constexpr std::uint64_t kUnknown = ~std::uint64_t{0};

  std::vector<std::uint32_t> robots_;
  std::uint32_t types_;
  netio::Socket socket_;
  netio::Outbox outbox_;
  netio::ReceiveBatch batch_;
  netio::Endpoint farm_;
  FaultyLink to_farm_, from_farm_;
  std::uint32_t session_ = netio::random_session(), token_ = 0, requests_ = 0;
  std::set<std::uint32_t> subscribed_;
  std::map<std::uint32_t, base::Twist> commands_;
  netio::Step step_;
  std::uint64_t tick_ = kUnknown - 1, wanted_ = kUnknown;
  std::vector<bool> parts_;
  std::size_t missing_ = 0;
  std::map<std::uint32_t, Driven> driven_;
  base::Bytes bytes_;
};

}  // namespace sf::scenarios
