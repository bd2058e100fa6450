#include "netio/stream_monitor.h"

#include <chrono>
#include <utility>

#include "base/error.h"
#include "netio/farm_lock.h"
#include "netio/sequence_guard.h"
#include "netio/sequence_tracker.h"

namespace sf::netio {

namespace {

constexpr int kMaxLastDrains = 100;
constexpr int kPollMs = 50;  ///< [ms] interval of polling `stop` while no datagram arrives

/// Sums over sequence trackers.
struct SequenceCounts {
  std::uint64_t lost = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t reordered = 0;
};

void add(SequenceCounts& gaps, const SequenceTracker& tracker) {
  gaps.lost += lost(tracker);
  gaps.duplicates += tracker.duplicates;
  gaps.reordered += tracker.reordered;
}

struct Stream {
  StreamSpec spec;
  SequenceTracker tracker;
  std::uint64_t farm = 0;  ///< index of the farm to which the tracker belongs
  SequenceGuard sequences{StreamMonitor::kMaxDropout};
  std::uint64_t good = 0;
  std::uint64_t elements = 0;
};

std::int64_t steady_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

PacketStatus decode_reading(std::span<const std::uint8_t> bytes, const StreamSpec& spec, Header& header,
                            std::span<const std::uint8_t>& payload) {
  Packet packet;
  const PacketStatus status = decode(bytes, packet);
  if (status != PacketStatus::accepted) return status;
  const auto* reading = std::get_if<Reading>(&packet.body);
  if (reading == nullptr) return PacketStatus::wrong_direction;
  header = packet.header;
  payload = reading->payload;
  return header.robot == spec.robot && header.sensor == spec.sensor ? PacketStatus::accepted
                                                                    : PacketStatus::wrong_source;
}

struct StreamMonitor::Streams {
  explicit Streams(const StreamMonitorOptions& options)
      : port_listener(options.address, options.receive_buffer, options.streams),
        headerless(options.headerless),
        farm(options.farm),
        inspect(options.inspect) {
    for (const StreamSpec& spec : options.streams) rows.push_back({.spec = spec});
  }

  PortListener port_listener;
  bool headerless;
  /// Checks that a valid packet is from the selected farm and has a plausible sequence.
  PacketStatus check_source(Stream& stream, const Header& header, const Endpoint& source, std::int64_t now);

  FarmLock farm;
  PayloadInspector inspect;
  std::vector<Stream> rows;
  SequenceCounts before;  ///< of previously selected farms
  PacketCounts counts;
  std::uint64_t bytes = 0;
  std::uint64_t stale_states = 0;
  std::int64_t oldest_state = 0;  ///< [ns]
};

StreamMonitor::StreamMonitor(const StreamMonitorOptions& options) {
  SF_CHECK(options.inspect != nullptr, "a listener without a judge");
  streams_ = std::make_unique<Streams>(options);
}

StreamMonitor::~StreamMonitor() = default;

std::size_t StreamMonitor::drain(int timeout_ms) {
  const auto take = [this](std::size_t i, std::span<const std::uint8_t> bytes, const Endpoint& source) {
    accept(i, bytes, source, steady_now());
  };
  return streams_->port_listener.drain(timeout_ms, take);
}

void StreamMonitor::run(const std::atomic<bool>& stop, int silence_ms, std::int64_t longest_ms) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto timed_out = [&] {
    return longest_ms > 0 && Clock::now() - start >= std::chrono::milliseconds(longest_ms);
  };
  bool started = false;
  int silent_ms = 0;
  while (!stop.load() && !(started && silent_ms >= silence_ms) && !timed_out()) {
    const bool came = drain(kPollMs) > 0;
    started = started || came;
    silent_ms = came ? 0 : silent_ms + kPollMs;
  }
  for (int i = 0; i < kMaxLastDrains && drain(kPollMs) > 0; ++i) {
  }
}

PacketStatus StreamMonitor::accept(std::size_t i, std::span<const std::uint8_t> bytes, const Endpoint& source,
                                   std::int64_t now) {
  Streams& s = *streams_;
  Stream& stream = s.rows[i];
  Header header;
  std::span<const std::uint8_t> payload = bytes;
  PayloadInfo info;
  if (!s.farm.allows(source)) info.status = PacketStatus::wrong_source;
  if (info.status == PacketStatus::accepted && !s.headerless)
    info.status = decode_reading(bytes, stream.spec, header, payload);
  if (info.status == PacketStatus::accepted) info = s.inspect(i, header, payload);
  if (info.status == PacketStatus::accepted) info.status = s.check_source(stream, header, source, now);
  s.counts.add(info.status);
  s.bytes += bytes.size();
  if (info.status != PacketStatus::accepted) return info.status;

  ++stream.good;
  if (!s.headerless && header.state.stale) ++s.stale_states;
  if (!s.headerless) s.oldest_state = std::max(s.oldest_state, header.state.age);
  stream.elements += info.elements;
  if (!s.headerless && info.parts > 0)
    count_arrival(stream.tracker, std::uint64_t{header.sequence} * info.parts + info.part);
  return PacketStatus::accepted;
}

PacketStatus StreamMonitor::Streams::check_source(Stream& stream, const Header& header, const Endpoint& source,
                                                  std::int64_t now) {
  if (!farm.admit(source, header.session, now)) return PacketStatus::wrong_source;
  if (headerless) return PacketStatus::accepted;
  if (stream.farm != farm.changes()) {
    stream.farm = farm.changes();
    add(before, stream.tracker);
    stream.tracker = {};
    stream.sequences = SequenceGuard(StreamMonitor::kMaxDropout);
  }
  return stream.sequences.rejects(header.sequence) ? PacketStatus::out_of_range : PacketStatus::accepted;
}

StreamSummary StreamMonitor::summary() const {
  const Streams& s = *streams_;
  StreamSummary sum;
  sum.datagrams = s.counts.total();
  sum.bytes = s.bytes;
  sum.good = s.counts[PacketStatus::accepted];
  sum.counts = s.counts;
  sum.stale_states = s.stale_states;
  sum.oldest_state = s.oldest_state;
  sum.ports = s.rows.size();
  SequenceCounts gaps = s.before;
  for (const Stream& stream : s.rows) {
    add(gaps, stream.tracker);
    sum.silent_ports += stream.good == 0 ? 1 : 0;
    StreamSummary::TypeCounts& share = sum.of[stream.spec.type];
    share.good += stream.good;
    share.elements += stream.elements;
  }
  sum.lost = gaps.lost;
  sum.duplicates = gaps.duplicates;
  sum.reordered = gaps.reordered;
  sum.receive_buffer = s.port_listener.receive_buffer_size();
  sum.socket_drops = s.port_listener.socket_drops();
  return sum;
}

}  // namespace sf::netio
