#include "netio/outbox.h"

#include <poll.h>

#include <cstring>
#include <vector>

#include "base/error.h"
#include "netio/posix.h"

namespace sf::netio {

struct Outbox::Storage {
  std::size_t waiting = 0;
  std::vector<std::uint8_t> slots;
  std::vector<sockaddr_in> destinations;
  std::vector<iovec> vectors;
  std::vector<mmsghdr> messages;
};

Outbox::Outbox(const OutboxOptions& options) : Outbox(open_udp(options.bind, {.send = options.send_buffer}), options) {}

Outbox::Outbox(Socket socket, const OutboxOptions& options)
    : options_(options), socket_(std::move(socket)), storage_(std::make_unique<Storage>()) {
  SF_CHECK(options.capacity >= 1, "an outbox that holds nothing");
  Storage& s = *storage_;
  s.slots.resize(options.capacity * kMaxPlain);
  s.destinations.resize(options.capacity);
  s.vectors.resize(options.capacity);
  s.messages.resize(options.capacity);
  for (std::size_t i = 0; i < options.capacity; ++i) {
    s.vectors[i].iov_base = s.slots.data() + i * kMaxPlain;
    s.messages[i].msg_hdr.msg_name = &s.destinations[i];
    s.messages[i].msg_hdr.msg_namelen = sizeof(sockaddr_in);
    s.messages[i].msg_hdr.msg_iov = &s.vectors[i];
    s.messages[i].msg_hdr.msg_iovlen = 1;
  }
}

Outbox::~Outbox() = default;
Outbox::Outbox(Outbox&&) noexcept = default;

void Outbox::queue(const Endpoint& to, std::span<const std::uint8_t> bytes) {
  SF_CHECK(bytes.size() <= kMaxPlain, std::to_string(bytes.size()) + " bytes in one datagram");
  Storage& s = *storage_;
  if (s.waiting == options_.capacity) flush();
  const std::size_t i = s.waiting++;
  s.destinations[i] = to_posix(to);
  s.vectors[i].iov_len = bytes.size();
  if (!bytes.empty()) std::memcpy(s.vectors[i].iov_base, bytes.data(), bytes.size());
  ++counts_.queued;
}

void Outbox::queue(const Endpoint& to, std::span<const std::uint8_t> bytes, const Stamp& stamp) {
  queue(to, bytes);
  netio::stamp({static_cast<std::uint8_t*>(storage_->vectors[storage_->waiting - 1].iov_base), bytes.size()}, stamp);
}

void Outbox::flush() {
  Storage& s = *storage_;
  int patience = options_.patience_ms;
  std::size_t i = 0;
  while (i < s.waiting) {
    const int n =
        sendmmsg(socket_.descriptor(), s.messages.data() + i, static_cast<unsigned>(s.waiting - i), MSG_DONTWAIT);
    if (n > 0) {
      for (const std::size_t end = i + static_cast<std::size_t>(n); i < end; ++i)
        counts_.sent_bytes += s.vectors[i].iov_len;
      counts_.sent += static_cast<std::uint64_t>(n);
      continue;
    }
    const int error = errno;
    if (error == EINTR) continue;
    if (error != EAGAIN && error != ENOBUFS) {
      fail(i++, error);  // it names the first message; those behind it may still go
      continue;
    }
    if (patience-- <= 0) break;
    pollfd writable{socket_.descriptor(), POLLOUT, 0};
    poll(&writable, 1, 1);
  }
  counts_.dropped += s.waiting - i;
  s.waiting = 0;
}

void Outbox::fail(std::size_t i, int error) {
  ++counts_.failed;
  if (counts_.first_failure.empty())
    counts_.first_failure = text(from_posix(storage_->destinations[i])) + ": " + error_text(error);
}

}  // namespace sf::netio
