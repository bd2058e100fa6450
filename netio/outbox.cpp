#include "netio/outbox.h"

#include <poll.h>

#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <thread>
#include <vector>

#include "base/elapsed.h"
#include "base/error.h"
#include "netio/posix.h"

namespace sf::netio {

namespace {

/// The datagrams of one flush.
struct Batch {
  explicit Batch(std::size_t capacity);
  void put(std::size_t place, const Endpoint& to, std::span<const std::uint8_t> bytes);
  void send(const Socket& socket, int patience_ms, OutboxCounts& counts);

  std::size_t waiting = 0;
  std::vector<std::uint8_t> slots;
  std::vector<sockaddr_in> destinations;
  std::vector<iovec> vectors;
  std::vector<mmsghdr> messages;
};

Batch::Batch(std::size_t capacity)
    : slots(capacity * kMaxHeaderlessDatagram), destinations(capacity), vectors(capacity), messages(capacity) {
  for (std::size_t i = 0; i < capacity; ++i) {
    vectors[i].iov_base = slots.data() + i * kMaxHeaderlessDatagram;
    messages[i].msg_hdr.msg_name = &destinations[i];
    messages[i].msg_hdr.msg_namelen = sizeof(sockaddr_in);
    messages[i].msg_hdr.msg_iov = &vectors[i];
    messages[i].msg_hdr.msg_iovlen = 1;
  }
}

void Batch::put(std::size_t place, const Endpoint& to, std::span<const std::uint8_t> bytes) {
  SF_CHECK(bytes.size() <= kMaxHeaderlessDatagram, std::to_string(bytes.size()) + " bytes in one datagram");
  destinations[place] = to_posix(to);
  vectors[place].iov_len = bytes.size();
  if (!bytes.empty()) std::memcpy(vectors[place].iov_base, bytes.data(), bytes.size());
}

void Batch::send(const Socket& socket, int patience_ms, OutboxCounts& counts) {
  const auto start = std::chrono::steady_clock::now();
  int patience = patience_ms;
  std::size_t i = 0;
  while (i < waiting) {
    const int n = sendmmsg(socket.descriptor(), messages.data() + i, static_cast<unsigned>(waiting - i), MSG_DONTWAIT);
    if (n > 0) {
      for (const std::size_t end = i + static_cast<std::size_t>(n); i < end; ++i)
        counts.sent_bytes += vectors[i].iov_len;
      counts.sent += static_cast<std::uint64_t>(n);
      continue;
    }
    const int error = errno;
    if (error == EINTR) continue;
    if (error != EAGAIN && error != ENOBUFS) {
      // The error concerns the first message; the other messages are retried.
      ++counts.failed;
      if (counts.first_failure.empty())
        counts.first_failure = endpoint_text(from_posix(destinations[i])) + ": " + error_text(error);
      ++i;
      continue;
    }
    if (patience-- <= 0) break;
    pollfd writable{socket.descriptor(), POLLOUT, 0};
    poll(&writable, 1, 1);
  }
  counts.dropped += waiting - i;
  waiting = 0;
  counts.busy_s += base::seconds_since(start);
}

}  // namespace

struct Outbox::Storage {
  OutboxOptions options;
  Socket socket;
  std::unique_ptr<Batch> filling;
  std::uint64_t queued = 0;
  OutboxCounts counts;  ///< excludes `queued`; the sending thread, if any, writes it while it sends

  // Used by the sending thread.
  std::mutex lock;
  std::condition_variable wake, idle;
  std::vector<std::unique_ptr<Batch>> full;
  std::vector<std::unique_ptr<Batch>> empty;
  std::uint64_t dropped = 0;  ///< the backlog was full
  bool sending = false, stop = false;
  std::thread thread;

  Storage(Socket s, const OutboxOptions& o)
      : options(o), socket(std::move(s)), filling(std::make_unique<Batch>(o.capacity)) {
    if (o.backlog > 0) thread = std::thread([this] { serve(); });
  }
  ~Storage() {
    if (!thread.joinable()) return;
    {
      const std::scoped_lock guard(lock);
      stop = true;
    }
    wake.notify_one();
    thread.join();
  }

  void serve() {
    std::unique_lock guard(lock);
    for (;;) {
      wake.wait(guard, [this] { return stop || !full.empty(); });
      if (full.empty()) return;
      std::unique_ptr<Batch> batch = std::move(full.front());
      full.erase(full.begin());
      sending = true;
      guard.unlock();
      batch->send(socket, options.patience_ms, counts);
      guard.lock();
      sending = false;
      empty.push_back(std::move(batch));
      if (full.empty()) idle.notify_all();
    }
  }

  void hand_over() {
    {
      const std::scoped_lock guard(lock);
      if (full.size() >= options.backlog) {
        dropped += filling->waiting;
        filling->waiting = 0;
        return;
      }
      full.push_back(std::move(filling));
      if (!empty.empty()) {
        filling = std::move(empty.back());
        empty.pop_back();
      }
    }
    wake.notify_one();
    if (!filling) filling = std::make_unique<Batch>(options.capacity);
  }
};

Outbox::Outbox(const OutboxOptions& options) : Outbox(open_udp(options.bind, {.send = options.send_buffer}), options) {}

Outbox::Outbox(Socket socket, const OutboxOptions& options) {
  SF_CHECK(options.capacity >= 1, "an outbox that holds nothing");
  storage_ = std::make_unique<Storage>(std::move(socket), options);
}

Outbox::~Outbox() = default;
Outbox::Outbox(Outbox&&) noexcept = default;

std::size_t Outbox::capacity() const { return storage_->options.capacity; }

std::size_t Outbox::claim(std::size_t count) {
  Storage& s = *storage_;
  SF_CHECK(count <= s.options.capacity, std::to_string(count) + " datagrams at once");
  if (s.filling->waiting + count > s.options.capacity) flush();
  s.queued += count;
  s.filling->waiting += count;
  return s.filling->waiting - count;
}

void Outbox::put(std::size_t place, const Endpoint& to, std::span<const std::uint8_t> bytes) {
  storage_->filling->put(place, to, bytes);
}

void Outbox::give_back(std::size_t count) {
  storage_->queued -= count;
  storage_->filling->waiting -= count;
}

void Outbox::queue(const Endpoint& to, std::span<const std::uint8_t> bytes) { put(claim(1), to, bytes); }

void Outbox::queue(const Endpoint& to, std::span<const std::uint8_t> bytes, const SessionToken& session_token,
                   PacketSigner* signer) {
  const std::size_t place = claim(1);
  put(place, to, bytes);
  iovec& slot = storage_->filling->vectors[place];
  if (signer != nullptr) slot.iov_len += kSignatureBytes;
  SF_CHECK(slot.iov_len <= kMaxHeaderlessDatagram, std::to_string(slot.iov_len) + " bytes in one datagram");
  const std::span<std::uint8_t> packet{static_cast<std::uint8_t*>(slot.iov_base), slot.iov_len};
  netio::write_session_token(packet, session_token);
  if (signer != nullptr) write_signature(packet, signer->key(), signer->take());
}

void Outbox::flush() {
  Storage& s = *storage_;
  if (s.filling->waiting == 0) return;
  if (s.options.backlog > 0)
    s.hand_over();
  else
    s.filling->send(s.socket, s.options.patience_ms, s.counts);
}

OutboxCounts Outbox::counts() const {
  Storage& s = *storage_;
  std::unique_lock guard(s.lock);
  s.idle.wait(guard, [&s] { return s.full.empty() && !s.sending; });
  OutboxCounts counts = s.counts;
  counts.queued = s.queued;
  counts.dropped += s.dropped;
  return counts;
}

Endpoint Outbox::endpoint() const { return bound_endpoint(storage_->socket); }

}  // namespace sf::netio
