#include "netio/listener.h"

#include <sys/epoll.h>

#include <array>
#include <string>

#include "base/error.h"
#include "netio/posix.h"
#include "netio/socket.h"
#include "netio/track.h"

namespace sf::netio {

namespace {

constexpr std::size_t kBatch = 64;
constexpr std::size_t kSpareFiles = 64;       ///< descriptors that the rest of the process may want
constexpr std::size_t kMaxPerDrain = 65'536;  ///< so that a flood cannot keep `stop` from being seen
constexpr int kMaxLastDrains = 100;
constexpr int kLookMs = 50;  ///< how often `stop` is looked at while nothing comes

struct Stream {
  StreamPlan plan;
  Socket socket;
  Track track;
  std::uint64_t good = 0;
  std::uint64_t elements = 0;
};

std::vector<PortUse> uses_of(const std::vector<StreamPlan>& streams) {
  std::vector<PortUse> uses;
  for (const StreamPlan& plan : streams) {
    uses.push_back({plan.robot, 1, plan.rule, "", plan.sensor, plan.kind});
  }
  return uses;
}

/// What lies behind the header, when that is a reading's and this stream's own.
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

}  // namespace

struct Listener::Streams {
  bool headerless = false;
  Judge judge;
  Socket epoll;
  std::vector<Stream> rows;
  ReceiveBatch batch{kBatch};
  Counts counts;
  std::uint64_t bytes = 0;
};

Listener::Listener(const ListenerOptions& options) : streams_(std::make_unique<Streams>()) {
  SF_CHECK(options.judge != nullptr, "a listener without a judge");
  require_ports(uses_of(options.streams));
  allow_open_files(options.streams.size() + kSpareFiles);
  Streams& s = *streams_;
  s.headerless = options.headerless;
  s.judge = options.judge;
  s.epoll = Socket(epoll_create1(EPOLL_CLOEXEC));
  if (s.epoll.descriptor() < 0) throw base::InputError("no epoll set: " + error_text(errno) + "; raise `ulimit -n`");

  for (const StreamPlan& plan : options.streams) {
    const auto own_port = static_cast<std::uint16_t>(port(plan.rule, plan.robot, plan.sensor));
    s.rows.push_back({plan, open_udp({options.address, own_port}, {.receive = options.receive_buffer}), {}, 0, 0});
    epoll_event readable{};
    readable.events = EPOLLIN;
    readable.data.u64 = s.rows.size() - 1;
    const int failed = epoll_ctl(s.epoll.descriptor(), EPOLL_CTL_ADD, s.rows.back().socket.descriptor(), &readable);
    if (failed != 0) throw base::InputError("cannot watch port " + std::to_string(own_port) + ": " + error_text(errno));
  }
}

Listener::~Listener() = default;

std::size_t Listener::drain(int timeout_ms) {
  Streams& s = *streams_;
  std::array<epoll_event, 256> events;
  std::size_t taken = 0;
  int ready = epoll_wait(s.epoll.descriptor(), events.data(), events.size(), timeout_ms);
  while (ready > 0 && taken < kMaxPerDrain) {
    for (int e = 0; e < ready; ++e) {
      const std::size_t row = events[static_cast<std::size_t>(e)].data.u64;
      const std::size_t n = s.batch.fill(s.rows[row].socket);
      for (std::size_t i = 0; i < n; ++i) accept(row, s.batch.bytes(i));
      taken += n;
    }
    ready = epoll_wait(s.epoll.descriptor(), events.data(), events.size(), 0);
  }
  return taken;
}

void Listener::run(const std::atomic<bool>& stop, int silence_ms) {
  bool begun = false;
  int silent_ms = 0;
  while (!stop.load() && !(begun && silent_ms >= silence_ms)) {
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
  if (!s.rows.empty()) sum.receive_buffer = receive_buffer(s.rows.front().socket);
  return sum;
}

}  // namespace sf::netio
