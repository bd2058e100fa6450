#pragma once
// The other end of a run: takes every sensor's packets on its own port, counts and checks them. What a payload should
// say is for a judge to tell, who knows the sensors.
//
//   StreamMonitor monitor({.streams = streams, .inspect = inspect});  // ports are bound: start the sender now
//   monitor.run(stop, 500);                                  // or drain(), between other work
//   StreamSummary summary = monitor.summary();
//
// One farm is listened to at a time (netio/source_lock.h). One thread; only `stop` may be set by another.

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "netio/endpoint.h"
#include "netio/packet_status.h"
#include "netio/packets.h"
#include "netio/port_listener.h"

namespace sf::netio {

/// What a payload turned out to be.
struct PayloadInfo {
  PacketStatus status = PacketStatus::accepted;
  std::uint32_t elements = 0;  ///< beams, or whatever the sensor has several of, in this datagram
  std::uint32_t part = 0;      ///< which datagram of its reading
  std::uint32_t parts = 1;     ///< >= 1, the same for every reading of a stream
};

/// Judges any bytes that came for stream `stream` (a row of the plan) with a reading's header of its robot and sensor.
using PayloadInspector =
    std::function<PayloadInfo(std::size_t stream, const Header&, std::span<const std::uint8_t> payload)>;

/// What lies behind the header of `bytes`, when that is a reading's and the stream's own. Fills `header` and
/// `payload` (which lives as long as the bytes) where it is a reading's.
PacketStatus decode_reading(std::span<const std::uint8_t> bytes, const StreamSpec& plan, Header& header,
                            std::span<const std::uint8_t>& payload);

struct StreamMonitorOptions {
  std::uint32_t address = kLoopback;
  std::size_t receive_buffer = 1u << 20;  ///< [byte] per port, asked of the kernel
  bool headerless = false;                ///< datagrams are payloads; without a sequence, loss and order cannot be seen
  std::uint32_t farm = 0;                 ///< the only address that packets are taken from; 0: any
  std::vector<StreamSpec> streams;        ///< one per sensor
  PayloadInspector inspect;               ///< not empty
};

struct StreamSummary {
  std::uint64_t datagrams = 0;
  std::uint64_t bytes = 0;  ///< UDP payload
  std::uint64_t good = 0;   ///< decoded, plausible, and what their port should carry
  PacketCounts counts;      ///< the same datagrams by reason
  std::uint64_t lost = 0;   ///< by gaps in sequences from 0; see SequenceTracker
  std::uint64_t duplicates = 0;
  std::uint64_t reordered = 0;
  std::uint64_t ports = 0;
  std::uint64_t silent_ports = 0;  ///< nothing good came
  std::size_t receive_buffer = 0;  ///< [byte] granted to the first port
  std::uint64_t kernel_drops = 0;  ///< datagrams that came while a port's buffer was full

  /// Of the streams of one kind: what came of them.
  struct TypeCounts {
    std::uint64_t good = 0;      ///< datagrams
    std::uint64_t elements = 0;  ///< in these
  };
  std::map<std::string, TypeCounts> of;  ///< by `StreamSpec::kind`
};

class StreamMonitor {
 public:
  /// Binds all ports, raising the limit of open files as needed.
  /// @throws base::InputError when ports collide, are taken, or are more than the machine allows.
  explicit StreamMonitor(const StreamMonitorOptions& options);
  ~StreamMonitor();
  StreamMonitor(const StreamMonitor&) = delete;
  StreamMonitor& operator=(const StreamMonitor&) = delete;

  /// Waits at most `timeout_ms` (0: not at all) for something to come, then takes all that waits. Returns datagrams
  /// taken.
  std::size_t drain(int timeout_ms = 0);

  /// Drains until `stop` is set, until nothing came for `silence_ms` after the first datagram, or until `longest_ms`
  /// have passed (0: however long it takes); then takes what still waits.
  void run(const std::atomic<bool>& stop, int silence_ms, std::int64_t longest_ms = 0);

  /// A sequence that is farther ahead than this is believed when the next one follows on it (RFC 3550, appendix A.1).
  static constexpr std::uint32_t kMaxDropout = 65'536;

  /// One datagram for stream `i` that came from `source` at `now` [ns]: decides and counts. drain() is this for
  /// sockets.
  PacketStatus accept(std::size_t i, std::span<const std::uint8_t> bytes, const Endpoint& source, std::int64_t now);

  StreamSummary summary() const;

 private:
  struct Streams;
  std::unique_ptr<Streams> streams_;
};

}  // namespace sf::netio
