#pragma once
// A robot's inputs: the ports of its sensors, the socket that it sends from, and V2V without the farm. Packets in both
// directions pass the injected link. Readings are accepted from the robot's own farm only.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/reading.h"
#include "netio/delay_line.h"
#include "netio/direct_v2v.h"
#include "netio/farm_clock.h"
#include "netio/port_listener.h"
#include "netio/receiver.h"
#include "netio/v2v_socket.h"
#include "sensors/sensor_set.h"
#include "server/own_reading.h"
#include "server/received_camera.h"
#include "server/sensor_streams.h"
#include "server/stream_layout.h"
#include "world/world.h"

namespace sf::server {

struct LinkOptions {
  netio::Endpoint farm;
  netio::LinkModel model;                ///< injected in each direction
  std::optional<netio::SigningKey> key;  ///< of the robot; signs its packets and those of the farm
  std::vector<std::uint32_t> lights;     ///< ids of intersections whose V2I are accepted
  /// V2V without the farm; nullopt: none. The link sets the ids of robots.
  std::optional<netio::DirectV2vOptions> direct;
};

struct LinkCounts {
  netio::OutboxCounts sent;
  netio::DelayCounts out;  ///< of the injected link
  netio::DelayCounts in;
  netio::ReceiverCounts readings;
  netio::PacketCounts packets;                 ///< received at the socket that it sends from
  std::uint64_t socket_drops = 0;              ///< datagrams dropped because a socket's buffer was full
  std::map<std::string, std::uint64_t> whole;  ///< complete readings, by type
  std::uint64_t stale = 0;  ///< readings computed from a state of the robot that the farm marked as stale
  std::optional<netio::DirectV2vCounts> direct;  ///< nullopt: no V2V without the farm
  std::optional<ImageCounts> images;             ///< nullopt: no cameras with colours
};

/// Times [ns] are on the robot's own monotonic clock. The world and the sensor set must outlive it. Not thread-safe.
class RobotLink {
 public:
  /// Called with each state of another robot, relayed or direct, each TEAM_MAP, V2I, start signal and DRIVE.
  using PacketHandler = std::function<void(const netio::Packet&, std::int64_t now)>;

  /// @throws base::InputError if a port is in use or the farm's host is unknown
  RobotLink(const world::World& world, const sensors::SensorSet& sensor_set, std::uint32_t mover,
            const StreamLayout& layout, const LinkOptions& options, PacketHandler handler);

  /// States in the following subscriptions whether the robot follows DRIVE. By default it does not.
  void set_follows_drive(bool follows) { follows_drive_ = follows; }
  /// Sends its subscription every half second.
  void send_request(std::int64_t now);
  /// Sends its subscription when due, and a state. @param quality of an estimate
  void send_state(const netio::V2v& state, std::int64_t now, const netio::StateQuality& quality = {});
  /// Sends a part of the own map to the other robots. @pre V2V without the farm
  void send_map(const netio::TeamMap& map, std::int64_t now);
  /// Sends a reading of one of the robot's own sensors to the farm, in as many packets as it takes.
  void send_own_reading(const OwnReading& own, std::int64_t now);
  /// Announces that it leaves, unless it has sent nothing. Sends this at once, with all packets still delayed in the
  /// injected link.
  void leave(std::int64_t now);
  /// Sleeps until a packet arrives, a delayed packet is due, or `until`, for at most 100 ms.
  void wait(std::int64_t now, std::int64_t until) const;
  /// Processes received packets and releases delayed ones, in both directions.
  void run(std::int64_t now);

  /// The newest reading of each sensor, of cameras with colours the newest with its image, with its time on the robot's
  /// own clock. The caller sets `X_WM` and `X_WS`. Valid until the next call or `run`.
  struct Newest {
    base::ReadingBlock block;
    const sensors::SensorSpec* row = nullptr;
  };
  std::span<Newest> readings();

  /// Returns whether a state of robot `id` arrived in the last two seconds.
  bool is_active(std::uint32_t id, std::int64_t now) const {
    return direct_ ? direct_->is_active(id, now) : v2v_socket_.is_active(id, now);
  }
  /// V2V without the farm; null: none.
  const netio::DirectV2v* direct() const { return direct_ ? &*direct_ : nullptr; }
  const netio::FarmClock& clock() const { return clock_; }
  /// [ns] arrival of the last valid packet; nullopt: none yet.
  std::optional<std::int64_t> last_answer() const { return last_answer_; }
  /// [ns] arrival of the last complete reading; nullopt: none yet.
  std::optional<std::int64_t> last_reading() const { return last_reading_; }
  /// Why signed packets are refused, as far as packets have shown.
  const netio::SignatureTrouble& trouble() const { return v2v_socket_.trouble(); }
  /// Number of complete laser readings so far.
  std::uint64_t scans() const;
  /// Returns the number of complete readings of one sensor.
  std::uint64_t whole(std::uint8_t type, std::uint32_t sensor) const;
  bool listens() const { return !streams_.empty(); }  ///< whether it has any sensor
  const netio::Endpoint& farm() const { return farm_; }
  LinkCounts counts() const;

 private:
  /// The packets of one sensor, as identified in the injected link.
  struct Stream {
    SensorStream source;
    std::uint32_t sequence = 0;                 ///< of the last reading received
    std::uint64_t piece = 0;                    ///< its datagrams received before
    std::uint64_t whole = 0;                    ///< complete readings
    bool fused = false;                         ///< the newest one includes a reading of the robot's own sensor
    std::optional<ReceivedCamera> camera = {};  ///< of cameras with colours
  };
  static std::vector<Stream> streams_of(const sensors::SensorSet& sensor_set, const StreamLayout& layout,
                                        std::uint32_t mover);
  std::vector<netio::StreamSpec> specs(const StreamLayout& layout) const;
  netio::ReceiverOptions receiver_options(const StreamLayout& layout, const LinkOptions& options);
  void send(netio::Type type, std::uint32_t sequence, std::int64_t now);
  /// Sends packets due by `until`.
  void flush_due(std::int64_t until);
  netio::MessageId reading_id(Stream& stream, std::span<const std::uint8_t> bytes) const;
  /// @param low kRelayed or kDirect
  netio::MessageId packet_id(std::span<const std::uint8_t> bytes, std::uint32_t low);
  void take(std::size_t tag, std::span<const std::uint8_t> bytes, std::int64_t now);
  void handle_challenge(const netio::SessionToken& before);
  void take_packet(std::span<const std::uint8_t> bytes, std::int64_t now);
  void take_direct(std::span<const std::uint8_t> bytes, std::int64_t now);

  std::uint32_t mover_;
  std::uint32_t id_;
  std::vector<Stream> streams_;
  netio::Endpoint farm_;
  netio::V2vSocket v2v_socket_;
  std::optional<netio::DirectV2v> direct_;
  netio::PortListener port_listener_;
  netio::Receiver receiver_;
  netio::DelayLine out_;
  netio::DelayLine in_;  ///< tags are streams, plus one for all other packets, plus one for direct V2V
  netio::FarmClock clock_;
  PacketHandler handler_;
  std::uint32_t states_ = 0;        ///< number sent
  std::uint32_t maps_ = 0;          ///< number of TEAM_MAP sent
  std::uint32_t requests_ = 0;      ///< number sent
  std::uint32_t own_readings_ = 0;  ///< number sent
  bool follows_drive_ = false;
  std::int64_t next_request_ = 0;    ///< [ns]
  std::uint64_t other_packets_ = 0;  ///< received packets that are not states
  std::optional<std::int64_t> last_answer_, last_reading_;
  std::vector<Newest> newest_;
  base::Bytes packet_, words_;
  bool part_is_stale_ = false, part_is_fused_ = false;  ///< of the last part
  std::uint64_t stale_ = 0;                             ///< readings
};

}  // namespace sf::server
