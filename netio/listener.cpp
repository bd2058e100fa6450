#include "netio/listener.h"

#include <chrono>
#include <utility>

#include "base/error.h"
#include "netio/track.h"

namespace sf::netio {

namespace {

constexpr int kMaxLastDrains = 100;
constexpr int kLookMs = 50;  ///< how often `stop` is looked at while nothing comes

struct Stream {
  StreamPlan plan;
  Track track;
  std::uint64_t good = 0;
  std::uint64_t elements = 0;
};

}  // namespace

Reason unframe(std::span<const std::uint8_t> bytes, const StreamPlan& plan, Header& header,
               std::span<const std::uint8_t>& payload) {
  Packet packet;
  const Reason reason = decode(bytes, packet);
  if (reason != Reason::accepted) return reason;
  const auto* reading = std::get_if<Reading>(&packet.body);
  if (reading == nullptr) return Reason::wrong_direction;
  header = packet.header;
  payload = reading->payload;
  return header.robot == plan.robot && header.sensor == plan.sensor ? Reason::accepted : Reason::wrong_source;
}

struct Listener::Streams {
  explicit Streams(const ListenerOptions& options)
      : ears(options.address, options.receive_buffer, options.streams),
        headerless(options.headerless),
        judge(options.judge) {
    for (const StreamPlan& plan : options.streams) rows.push_back({plan, {}, 0, 0});
  }

  Ears ears;
  bool headerless;
  Judge judge;
  std::vector<Stream> rows;
  Counts counts;
  std::uint64_t bytes = 0;
};

Listener::Listener(const ListenerOptions& options) {
  SF_CHECK(options.judge != nullptr, "a listener without a judge");
  streams_ = std::make_unique<Streams>(options);
}

Listener::~Listener() = default;

std::size_t Listener::drain(int timeout_ms) {
  return streams_->ears.drain(timeout_ms,
                              [this](std::size_t i, std::span<const std::uint8_t> bytes) { accept(i, bytes); });
}

void Listener::run(const std::atomic<bool>& stop, int silence_ms, std::int64_t longest_ms) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto over = [&] { return longest_ms > 0 && Clock::now() - start >= std::chrono::milliseconds(longest_ms); };
  bool begun = false;
  int silent_ms = 0;
  while (!stop.load() && !(begun && silent_ms >= silence_ms) && !over()) {
    const bool came = drain(kLookMs) > 0;
    begun = begun || came;
    silent_ms = came ? 0 : silent_ms + kLookMs;
  }
  for (int i = 0; i < kMaxLastDrains && drain(kLookMs) > 0; ++i) {
  }
}

Reason Listener::accept(std::size_t i, std::span<const std::uint8_t> bytes) {
  Streams& s = *streams_;
  Stream& stream = s.rows[i];
  Header header;
  std::span<const std::uint8_t> payload = bytes;
  Verdict verdict;
  if (!s.headerless) verdict.reason = unframe(bytes, stream.plan, header, payload);
  if (verdict.reason == Reason::accepted) verdict = s.judge(i, header, payload);
  s.counts.add(verdict.reason);
  s.bytes += bytes.size();
  if (verdict.reason != Reason::accepted) return verdict.reason;

  ++stream.good;
  stream.elements += verdict.elements;
  if (!s.headerless) see(stream.track, std::uint64_t{header.sequence} * verdict.parts + verdict.part);
  return Reason::accepted;
}

Summary Listener::summary() const {
  const Streams& s = *streams_;
  Summary sum;
  sum.datagrams = s.counts.total();
  sum.bytes = s.bytes;
  sum.good = s.counts[Reason::accepted];
  sum.counts = s.counts;
  sum.ports = s.rows.size();
  for (const Stream& stream : s.rows) {
    sum.lost += lost(stream.track);
    sum.duplicates += stream.track.duplicates;
    sum.reordered += stream.track.reordered;
    sum.silent_ports += stream.good == 0 ? 1 : 0;
    Summary::Share& share = sum.of[stream.plan.kind];
    share.good += stream.good;
    share.elements += stream.elements;
  }
  sum.receive_buffer = s.ears.granted();
  return sum;
}

}  // namespace sf::netio
