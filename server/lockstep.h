#pragma once
// Lockstep over UDP: external processes command simulated robots, and the farm simulates a tick once all of them have
// requested it. Commands are received, states and readings are sent; the caller simulates.
//
//   Lockstep lockstep(world, sensor_set, {});
//   lockstep.publish(simulation.step(), now);            // tick 0
//   lockstep.receive(now);                               // until it is ready
//   if (lockstep.ready()) simulation.command(lockstep.commands()), lockstep.publish(simulation.step(), now);
//
// A process is an address and port. It subscribes robots, and receives one answer after each tick that it requested: a
// STATE for each of its robots and the VALUES of their readings. Every packet carries its tick and may be repeated, so
// results depend neither on loss nor on order (docs/packets.md, Lockstep). STEP states how many commands a process has
// sent, and the farm waits for all of them.
//
// Algorithm: conservative synchronisation of simulations (IEEE 1516, time advance request and grant).

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/tick_record.h"
#include "netio/inbox.h"
#include "netio/outbox.h"
#include "netio/rate_limited_log.h"
#include "netio/rejection_log.h"
#include "netio/signature_trouble_log.h"
#include "sensors/sensor_set.h"
#include "server/published_tick.h"
#include "server/wire_ids.h"
#include "world/world.h"

namespace sf::server {

struct LockstepOptions {
  netio::Endpoint bind = {netio::kLoopback, netio::kInboxPort};
  std::uint32_t robots = 1;  ///< the first tick waits until this many are subscribed
  double timeout = 5.0;      ///< [s] that processes wait for another before it is dropped; 0: no limit
  int log_descriptor = 2;    ///< -1: no log
  std::vector<netio::Peer> peers;
};

struct LockstepCounts {
  std::uint64_t commands = 0;     ///< accepted rows
  std::uint64_t repeated = 0;     ///< duplicate or late rows, STEP and SUBSCRIBE
  std::uint64_t refused = 0;      ///< rows for robots of another process or with a wrong key
  std::uint64_t fetched = 0;      ///< datagrams sent on request
  std::uint64_t lost_robots = 0;  ///< robots whose process timed out
};

/// The world and the sensor set must outlive it. Not thread-safe. Times [ns] are on one monotonic clock.
class Lockstep {
 public:
  /// Datagrams of an answer that are sent immediately; the process fetches the others.
  static constexpr std::uint32_t kPushed = 64;
  /// Maximum number of datagrams sent on request in one `receive`. Further requests are dropped, and their process
  /// repeats them.
  static constexpr std::uint64_t kMaxAnswers = 16'384;

  /// @throws netio::PortInUse, base::InputError if the address cannot be bound
  Lockstep(const world::World& world, const sensors::SensorSet& sensor_set, const LockstepOptions& options);

  /// Processes all waiting datagrams, and drops processes that delay others for too long.
  void receive(std::int64_t now);
  /// Returns whether every process has requested the tick after the published one and all of its commands have arrived.
  bool ready() const;
  /// Twist per mover until the next tick. Valid until the next `receive`.
  std::span<const base::Twist> commands() const { return commands_; }
  /// Stores the results of a tick, and answers the processes that requested it.
  void publish(const base::TickRecord& record, std::int64_t now);

  void wait(int timeout_ms) const { inbox_.wait(timeout_ms); }
  std::size_t robots() const { return names_.robots.size(); }
  const netio::Inbox& inbox() const { return inbox_; }
  netio::OutboxCounts sent() const { return outbox_.counts(); }
  const LockstepCounts& counts() const { return counts_; }
  std::uint64_t lines_left_out() const { return log_.left_out(); }

 private:
  /// A datagram of an answer: a mover's state, or one part of a reading.
  struct Part {
    std::uint32_t mover = 0;
    std::uint32_t reading = 0;  ///< row of `published_`, or kState
    std::uint32_t first = 0;    ///< index of the first value
  };
  struct Process {
    netio::Endpoint endpoint;
    std::uint32_t session = 0;
    std::vector<std::uint32_t> movers;     ///< rows, by id
    std::uint64_t answered = 0;            ///< tick of `answer`
    bool built = false;                    ///< `answer` has been built for its robots
    std::vector<Part> answer;              ///< valid until the next tick is simulated
    std::optional<netio::Step> step;       ///< waiting, or being simulated
    std::uint32_t commands = 0;            ///< robots with a command of tick `answered`
    std::uint32_t states = 0, values = 0;  ///< datagrams sent
    std::int64_t renewed = 0;              ///< [ns] when its bindings in the inbox were last renewed
  };
  /// A mover, seen from the process that drives it.
  struct Seat {
    Process* driver = nullptr;               ///< null: the mover is at rest
    base::SensorTypes types = 0;             ///< type mask of its SUBSCRIBE
    std::optional<std::uint64_t> answered;   ///< tick of its newest answer
    std::optional<std::uint64_t> before;     ///< tick of the previous answer
    std::optional<std::uint64_t> commanded;  ///< tick of its last command
  };
  using Key = std::pair<std::uint32_t, std::uint16_t>;  ///< address and port
  static constexpr std::uint32_t kState = 0xFFFFFFFFu;

  void take(const netio::Packet& packet, std::int64_t now);
  void take(Process& process, const netio::Command& command, const netio::Header& header);
  void take(Process& process, const netio::Step& step, std::int64_t now);
  void take(Process& process, const netio::Fetch& fetch);
  void subscribe(const netio::Header& header, base::SensorTypes types, std::int64_t now);
  void acknowledge();
  void release(std::uint32_t mover);
  void release_all(Process& process);
  Process* find(const netio::Endpoint& endpoint);
  bool answerable(const Process& process) const { return process.answered == published_.tick(); }
  bool is_done(const Process& process) const;
  void grant(Process& process);
  void build_answer(Process& process);
  void add_readings(std::uint32_t mover, std::vector<Part>& parts);
  void send(Process& process, std::uint32_t first, std::uint32_t count);
  void encode(Process& process, std::uint32_t index);
  void answer_again(Process& process, std::uint32_t first, std::uint32_t count);
  void check_timeout(std::int64_t now);
  std::string names_of(std::span<const std::uint32_t> movers) const;

  const world::World& world_;
  LockstepOptions options_;
  WireNames names_;
  netio::Inbox inbox_;
  netio::Outbox outbox_;  ///< from the port that the processes send to
  netio::RateLimitedLog log_;
  netio::SignatureTroubleLog trouble_;
  netio::RejectionLog rejections_;
  std::map<Key, Process> processes_;
  std::vector<Seat> seats_;            ///< per mover
  std::vector<base::Twist> commands_;  ///< per mover
  PublishedTick published_;
  std::vector<std::uint32_t> rows_;            ///< scratch
  std::vector<std::uint32_t> missing_;         ///< scratch
  std::vector<std::uint32_t> unacknowledged_;  ///< movers subscribed in this `receive`
  std::size_t driven_ = 0;                     ///< movers with a process
  bool begun_ = false;                         ///< whether enough robots have subscribed
  std::int64_t changed_ = 0;                   ///< [ns] when the tick was published or a process last joined
  std::optional<std::int64_t> first_step_;     ///< [ns] since when a process has waited for the next tick
  std::optional<std::uint64_t> warned_;        ///< tick of the last warning that all processes are silent
  std::uint64_t again_ = 0;                    ///< datagrams sent on request in this `receive`
  LockstepCounts counts_;
  base::Bytes packet_;
};

}  // namespace sf::server
