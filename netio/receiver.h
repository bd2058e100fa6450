#pragma once
// Receives a robot's readings: datagrams in, the newest complete reading of each sensor out. Two functions of the
// sensor types check and decode payloads.
//
//   Receiver receiver({.streams = streams, .inspect = inspect, .read = read});
//   port_listener.drain(0, [&](std::size_t i, auto bytes, const Endpoint&) { receiver.accept(i, bytes, now); });
//   if (const auto scan = receiver.newest(0)) use(scan->values);
//
// Single-threaded.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "netio/packet_status.h"
#include "netio/port_listener.h"
#include "netio/reading_assembler.h"
#include "netio/signature.h"
#include "netio/stream_monitor.h"

namespace sf::netio {

/// Decodes a payload that the inspector has accepted into the values of its complete reading.
using PayloadReader = std::function<void(std::size_t stream, const Header&, std::span<const std::uint8_t> payload,
                                         std::span<double> values)>;

/// Receives a part of a file, a payload that the inspector has accepted with `parts` 0.
using FilePartReader = std::function<void(std::size_t stream, const Header&, std::span<const std::uint8_t> payload)>;

struct ReceiverStream {
  StreamSpec spec;
  std::size_t value_count = 1;  ///< number of values in a complete reading
};

struct ReceiverOptions {
  std::vector<ReceiverStream> streams;  ///< one per sensor
  bool headerless = false;              ///< datagrams contain only payloads; a part out of order begins a new reading
  PayloadInspector inspect;             ///< not empty; receives only payloads of the stream's robot and sensor
  PayloadReader read;                   ///< not empty
  FilePartReader read_file;             ///< empty: parts of files are dropped
  std::optional<SigningKey> key;        ///< must sign all packets; not available without headers
};

struct ReceiverCounts {
  PacketCounts packets;          ///< datagrams
  std::uint64_t late = 0;        ///< datagrams of readings superseded by newer ones
  std::uint64_t duplicates = 0;  ///< datagrams
  std::uint64_t jumps = 0;       ///< datagrams implausibly far ahead
  std::uint64_t lost = 0;        ///< missing datagrams, found by gaps; see ReadingAssembler
  std::uint64_t restarts = 0;    ///< number of restarts of streams
};

class Receiver {
 public:
  explicit Receiver(const ReceiverOptions& options);

  /// Accepts only packets with this session and token from now on. A change of session restarts all streams. Has no
  /// effect on packets without headers.
  void set_session(const SessionToken& farm);
  /// Counts a datagram from an address other than the farm's.
  void reject_source() { counts_.packets.add(PacketStatus::wrong_source); }

  /// Receives any bytes for stream `i` at `now` [ns], from a clock that does not decrease.
  PartStatus accept(std::size_t i, std::span<const std::uint8_t> bytes, std::int64_t now);

  /// Returns the newest complete reading. Valid until the stream's next datagram.
  std::optional<CompleteReading> newest(std::size_t i) const { return streams_[i].assembler.newest(); }
  ReceiverCounts counts() const;

 private:
  struct Stream {
    StreamSpec spec;
    ReadingAssembler assembler;
    std::optional<SignatureChecker> checker;  ///< one per port, because packets of different ports overtake each other
    // Without headers, for the last reading:
    std::uint32_t readings = 0;  ///< readings begun, including the last one
    std::uint32_t part = 0;
    std::int64_t started = 0;  ///< [ns]
  };
  /// Creates a header for a datagram without one.
  static void synthesise_header(Stream& stream, std::uint32_t part, std::int64_t now, Header& header);

  std::vector<Stream> streams_;
  bool headerless_;
  std::optional<SessionToken> farm_;
  PayloadInspector inspect_;
  PayloadReader read_;
  FilePartReader read_file_;
  ReceiverCounts counts_;
};

}  // namespace sf::netio
