#pragma once
// A robot's sensors as they come to it: datagrams in, the newest whole reading of each sensor out. What a payload says
// is for a judge and a reader to tell, who know the sensors.
//
//   Receiver receiver({.streams = streams, .inspect = inspect, .read = read});
//   port_listener.drain(0, [&](std::size_t i, auto bytes) { receiver.accept(i, bytes, now); });
//   if (const auto scan = receiver.newest(0)) use(scan->values);
//
// One thread.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "netio/packet_status.h"
#include "netio/port_listener.h"
#include "netio/reading_assembler.h"
#include "netio/stream_monitor.h"

namespace sf::netio {

/// Writes what a payload that the judge accepted says into its whole reading's numbers.
using PayloadReader = std::function<void(std::size_t stream, const Header&, std::span<const std::uint8_t> payload,
                                         std::span<double> values)>;

struct ReceiverStream {
  StreamSpec plan;
  std::size_t value_count = 1;  ///< of a whole reading
};

struct ReceiverOptions {
  std::vector<ReceiverStream> streams;  ///< one per sensor
  bool headerless = false;   ///< datagrams are payloads; a part that is not after the one before begins a new reading
  PayloadInspector inspect;  ///< not empty; judges payloads only, of the stream's own robot and sensor
  PayloadReader read;        ///< not empty
};

struct ReceiverCounts {
  PacketCounts packets;          ///< datagrams
  std::uint64_t late = 0;        ///< datagrams of readings that newer ones had overtaken
  std::uint64_t duplicates = 0;  ///< datagrams
  std::uint64_t jumps = 0;       ///< datagrams too far ahead to be believed
  std::uint64_t lost = 0;        ///< datagrams that never came, by gaps; see ReadingAssembler
  std::uint64_t restarts = 0;    ///< of streams
};

class Receiver {
 public:
  explicit Receiver(const ReceiverOptions& options);

  /// Takes what carries this stamp, and from now on nothing else; where the session is another than one before, all
  /// streams begin anew. Without headers there is no stamp.
  void set_session(const SessionToken& farm);
  /// A datagram that does not come from the farm's address is counted, and not looked at.
  void reject_source() { counts_.packets.add(PacketStatus::wrong_source); }

  /// Any bytes for stream `i`, which came at `now` [ns] of a clock that does not go back.
  PartStatus accept(std::size_t i, std::span<const std::uint8_t> bytes, std::int64_t now);

  /// Lives until the stream's next datagram.
  std::optional<CompleteReading> newest(std::size_t i) const { return streams_[i].assembler.newest(); }
  ReceiverCounts counts() const;

 private:
  struct Stream {
    StreamSpec plan;
    ReadingAssembler assembler;
    // Without headers, of the reading that came last:
    std::uint32_t readings = 0;  ///< begun, it included
    std::uint32_t part = 0;
    std::int64_t started = 0;  ///< [ns]
  };
  /// Makes up what a header would say.
  static void synthesise_header(Stream& stream, std::uint32_t part, std::int64_t now, Header& header);

  std::vector<Stream> streams_;
  bool headerless_;
  std::optional<SessionToken> farm_;
  PayloadInspector inspect_;
  PayloadReader read_;
  ReceiverCounts counts_;
};

}  // namespace sf::netio
