#pragma once
// A robot's two ways of hearing: its sensors' ports, and the socket it speaks from. What is sent and what comes passes
// the injected link. Only the farm that it speaks to is heard.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/reading.h"
#include "netio/delay_line.h"
#include "netio/farm_clock.h"
#include "netio/port_listener.h"
#include "netio/receiver.h"
#include "netio/v2v_socket.h"
#include "sensors/sensor_set.h"
#include "server/sensor_streams.h"
#include "server/stream_layout.h"
#include "world/world.h"

namespace sf::server {

struct LinkOptions {
  netio::Endpoint farm;
  netio::LinkModel model;                ///< injected, in each direction
  std::optional<netio::SigningKey> key;  ///< the robot's own; signs its packets and the farm's
  std::vector<std::uint32_t> lights;     ///< ids of intersections whose V2I is heard
};

struct LinkCounts {
  netio::OutboxCounts sent;
  netio::DelayCounts out;  ///< of the injected link
  netio::DelayCounts in;
  netio::ReceiverCounts readings;
  netio::PacketCounts packets;                 ///< what came to the socket it speaks from
  std::uint64_t socket_drops = 0;              ///< datagrams that came while a socket's buffer was full
  std::map<std::string, std::uint64_t> whole;  ///< readings, by type
  std::uint64_t stale = 0;                     ///< readings of a state of the robot that is stale, as the farm says
};

/// Times are of the robot's own clock [ns], which does not go back. World and sensor set must outlive it. One thread.
class RobotLink {
 public:
  /// Is given each relayed state, V2I and start signal.
  using PacketHandler = std::function<void(const netio::Packet&, std::int64_t now)>;

  /// @throws base::InputError when a port is taken or the farm's host is unknown.
  RobotLink(const world::World& world, const sensors::SensorSet& sensor_set, std::uint32_t mover,
            const StreamLayout& layout, const LinkOptions& options, PacketHandler handler);

  /// Every half a second, sends what it wants to be sent.
  void send_request(std::int64_t now);
  /// The same, and a state.
  void send_state(const netio::V2v& state, std::int64_t now);
  /// Says that it said its last, unless it said nothing: at once, and what still waits in the injected link with it.
  void leave(std::int64_t now);
  /// Sleeps until something comes, is due, or it is `until`, but 100 ms at most.
  void wait(std::int64_t now, std::int64_t until) const;
  /// Takes all that waits, and lets go what is due in both directions.
  void run(std::int64_t now);

  /// The newest of each sensor, with its time in the robot's own clock. `X_WM` and `X_WS` are left to the caller. Lives
  /// until the next call, or `run`.
  struct Newest {
    base::ReadingBlock block;
    const sensors::SensorSpec* row = nullptr;
  };
  std::span<Newest> readings();

  /// A state of robot `id` came in the last two seconds.
  bool is_active(std::uint32_t id, std::int64_t now) const { return v2v_socket_.is_active(id, now); }
  const netio::FarmClock& clock() const { return clock_; }
  /// [ns] when anything good came last; nothing where nothing did yet.
  std::optional<std::int64_t> last_answer() const { return last_answer_; }
  /// [ns] when a whole reading came last; nothing where none did yet.
  std::optional<std::int64_t> last_reading() const { return last_reading_; }
  /// Why nothing signed passes, as far as packets have shown.
  const netio::SignatureTrouble& trouble() const { return v2v_socket_.trouble(); }
  /// Whole readings of lasers that came so far.
  std::uint64_t scans() const;
  bool listens() const { return !streams_.empty(); }  ///< to any sensor
  const netio::Endpoint& farm() const { return farm_; }
  LinkCounts counts() const;

 private:
  /// One sensor's packets, as the injected link names them.
  struct Stream {
    SensorStream source;
    std::uint32_t sequence = 0;  ///< of the reading that came last
    std::uint64_t piece = 0;     ///< datagrams of it that came before
    std::uint64_t whole = 0;     ///< readings
  };
  static std::vector<Stream> streams_of(const sensors::SensorSet& sensor_set, const StreamLayout& layout,
                                        std::uint32_t mover);
  std::vector<netio::StreamSpec> specs(const StreamLayout& layout) const;
  netio::ReceiverOptions receiver_options(const StreamLayout& layout, const LinkOptions& options);
  void send(netio::Type type, std::uint32_t sequence, std::int64_t now);
  /// Sends what is due by then.
  void flush_due(std::int64_t until);
  netio::MessageId reading_id(Stream& stream, std::span<const std::uint8_t> bytes) const;
  netio::MessageId packet_id(std::span<const std::uint8_t> bytes);
  void take(std::size_t tag, std::span<const std::uint8_t> bytes, std::int64_t now);
  void handle_challenge(const netio::SessionToken& before);
  void take_packet(std::span<const std::uint8_t> bytes, std::int64_t now);

  std::uint32_t mover_;
  std::uint32_t id_;
  std::vector<Stream> streams_;
  netio::Endpoint farm_;
  netio::V2vSocket v2v_socket_;
  netio::PortListener port_listener_;
  netio::Receiver receiver_;
  netio::DelayLine out_;
  netio::DelayLine in_;  ///< tags are streams, and one more for words
  netio::FarmClock clock_;
  PacketHandler handler_;
  std::uint32_t states_ = 0;         ///< sent
  std::uint32_t requests_ = 0;       ///< sent
  std::int64_t next_request_ = 0;    ///< [ns]
  std::uint64_t other_packets_ = 0;  ///< that came and are no states
  std::optional<std::int64_t> last_answer_, last_reading_;
  std::vector<Newest> newest_;
  base::Bytes packet_;
  bool part_is_stale_ = false;  ///< of the last part
  std::uint64_t stale_ = 0;     ///< readings
};

}  // namespace sf::server
