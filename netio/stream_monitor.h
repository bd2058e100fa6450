#pragma once
// Receives, checks and counts the packets of all sensors, each on its own port. A function of the sensor types checks
// payloads.
//
//   StreamMonitor monitor({.streams = streams, .inspect = inspect});  // ports are bound: start the sender now
//   monitor.run(stop, 500);                                  // or drain(), between other work
//   StreamSummary summary = monitor.summary();
//
// Accepts one farm at a time (netio/farm_lock.h). Single-threaded, except that another thread may set `stop`.

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

/// Result of checking a payload.
struct PayloadInfo {
  PacketStatus status = PacketStatus::accepted;
  std::uint32_t elements = 0;  ///< beams or other repeated elements in this datagram
  std::uint32_t part = 0;      ///< index of the datagram in its reading
  std::uint32_t parts = 1;     ///< datagrams per reading, the same for all readings of a stream; 0: this one belongs to
                               ///< a file, and is not counted among them
};

/// Checks any bytes received for stream `stream` (an index into the options' streams) with the header of a reading of
/// its robot and sensor.
using PayloadInspector =
    std::function<PayloadInfo(std::size_t stream, const Header&, std::span<const std::uint8_t> payload)>;

/// Splits a reading of the stream `spec` into header and payload (valid as long as the bytes). Fills both for readings
/// of other streams too.
PacketStatus decode_reading(std::span<const std::uint8_t> bytes, const StreamSpec& spec, Header& header,
                            std::span<const std::uint8_t>& payload);

struct StreamMonitorOptions {
  std::uint32_t address = kLoopback;
  std::size_t receive_buffer = 1u << 20;  ///< [byte] per port, requested from the kernel
  bool headerless = false;                ///< datagrams contain only payloads; loss and order are unknown without
                                          ///< sequences
  std::uint32_t farm = 0;                 ///< the only accepted source address; 0: any
  std::vector<StreamSpec> streams;        ///< one per sensor
  PayloadInspector inspect;               ///< not empty
};

struct StreamSummary {
  std::uint64_t datagrams = 0;
  std::uint64_t bytes = 0;         ///< UDP payload
  std::uint64_t good = 0;          ///< valid, plausible, and on the right port
  PacketCounts counts;             ///< all datagrams by status
  std::uint64_t stale_states = 0;  ///< good datagrams computed from a stale state of the robot
  std::int64_t oldest_state = 0;   ///< [ns] largest age of a state behind a good datagram
  std::uint64_t lost = 0;          ///< datagrams missing after the first one of each stream; see SequenceTracker
  std::uint64_t duplicates = 0;
  std::uint64_t reordered = 0;
  std::uint64_t ports = 0;
  std::uint64_t silent_ports = 0;  ///< ports without a good datagram
  std::size_t receive_buffer = 0;  ///< [byte] granted to the first port
  std::uint64_t socket_drops = 0;  ///< datagrams lost to full receive buffers

  /// Counts of the streams of one sensor type.
  struct TypeCounts {
    std::uint64_t good = 0;      ///< datagrams
    std::uint64_t elements = 0;  ///< in the good datagrams
  };
  std::map<std::string, TypeCounts> of;  ///< keyed by `StreamSpec::type`
};

class StreamMonitor {
 public:
  /// Binds all ports and raises the limit of open files as needed.
  /// @throws base::InputError if ports collide, are in use, or exceed the machine's limits
  explicit StreamMonitor(const StreamMonitorOptions& options);
  ~StreamMonitor();
  StreamMonitor(const StreamMonitor&) = delete;
  StreamMonitor& operator=(const StreamMonitor&) = delete;

  /// Waits at most `timeout_ms` (0: no wait) for a datagram, then receives all waiting ones.
  /// @return number of datagrams
  std::size_t drain(int timeout_ms = 0);

  /// Receives until `stop` is set, `silence_ms` pass without datagrams after the first one, or `longest_ms` have passed
  /// (0: no limit). Then receives the datagrams that still wait.
  void run(const std::atomic<bool>& stop, int silence_ms, std::int64_t longest_ms = 0);

  /// Larger gaps in sequences are accepted only if the next sequence follows them (RFC 3550, appendix A.1).
  static constexpr std::uint32_t kMaxDropout = 65'536;

  /// Checks and counts one datagram for stream `i`, received from `source` at `now` [ns]. `drain` calls this for each
  /// datagram of the sockets.
  PacketStatus accept(std::size_t i, std::span<const std::uint8_t> bytes, const Endpoint& source, std::int64_t now);

  StreamSummary summary() const;

 private:
  struct Streams;
  std::unique_ptr<Streams> streams_;
};

}  // namespace sf::netio
