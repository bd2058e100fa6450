#include "netio/socket.h"

#include <fcntl.h>
#include <linux/sock_diag.h>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <string>
#include <vector>

#include "netio/posix.h"

namespace sf::netio {

namespace {

std::string remedy(int error) {
  switch (error) {
    case EADDRINUSE:
      return "another program uses this port; stop it or choose another port";
    case EADDRNOTAVAIL:
      return "this machine does not have that address; use an address that `ip address` lists, or 0.0.0.0 for all";
    case EACCES:
      return "ports below 1024 require root; choose a higher port";
    default:
      return "check the address and the port";
  }
}

/// The kernel's limit applies to ordinary users; root may exceed it.
void ask_buffer(int descriptor, int force_option, int option, std::size_t size) {
  if (size == 0) return;
  const int bytes = static_cast<int>(size);
  if (setsockopt(descriptor, SOL_SOCKET, force_option, &bytes, sizeof bytes) == 0) return;
  setsockopt(descriptor, SOL_SOCKET, option, &bytes, sizeof bytes);
}

}  // namespace

Socket::~Socket() {
  if (descriptor_ >= 0) close(descriptor_);
}

void bind_socket(const Socket& socket, const Endpoint& endpoint, const char* protocol) {
  const sockaddr_in address = to_posix(endpoint);
  if (bind(socket.descriptor(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return;
  const int error = errno;
  const std::string what = std::string("cannot bind ") + protocol + " " + endpoint_text(endpoint) + ": " +
                           error_text(error) + "; " + remedy(error);
  if (error == EADDRINUSE) throw PortInUse(what);
  throw base::InputError(what);
}

Socket open_udp(const Endpoint& endpoint, const SocketBuffers& buffers) {
  Socket opened(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (opened.descriptor() < 0) {
    throw base::InputError("no UDP socket for " + endpoint_text(endpoint) + ": " + error_text(errno) +
                           "; raise `ulimit -n`, or use fewer ports");
  }
  bind_socket(opened, endpoint, "UDP");
  ask_buffer(opened.descriptor(), SO_RCVBUFFORCE, SO_RCVBUF, buffers.receive);
  ask_buffer(opened.descriptor(), SO_SNDBUFFORCE, SO_SNDBUF, buffers.send);
  return opened;
}

Socket duplicate(const Socket& socket) {
  Socket second(fcntl(socket.descriptor(), F_DUPFD_CLOEXEC, 0));
  if (second.descriptor() < 0)
    throw base::InputError("no second descriptor for a socket: " + error_text(errno) + "; raise `ulimit -n`");
  return second;
}

void wait_readable(const Socket& one, const Socket& other, int timeout_ms) {
  pollfd readable[] = {{one.descriptor(), POLLIN, 0}, {other.descriptor(), POLLIN, 0}};
  poll(readable, 2, timeout_ms);
}

Endpoint bound_endpoint(const Socket& socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  const int failed = getsockname(socket.descriptor(), reinterpret_cast<sockaddr*>(&address), &size);
  SF_CHECK(failed == 0, "getsockname: " + error_text(errno));
  return from_posix(address);
}

std::size_t receive_buffer(const Socket& socket) {
  int bytes = 0;
  socklen_t size = sizeof bytes;
  const int failed = getsockopt(socket.descriptor(), SOL_SOCKET, SO_RCVBUF, &bytes, &size);
  SF_CHECK(failed == 0, "getsockopt: " + error_text(errno));
  return static_cast<std::size_t>(bytes);
}

std::uint64_t socket_drops(const Socket& socket) {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  if (getsockopt(socket.descriptor(), SOL_SOCKET, SO_MEMINFO, memory.data(), &size) != 0) return 0;
  return memory[SK_MEMINFO_DROPS];
}

void raise_open_file_limit(std::size_t count) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= count) return;
  if (limit.rlim_max >= count) {
    limit.rlim_cur = count;
    if (setrlimit(RLIMIT_NOFILE, &limit) == 0) return;
  }
  throw base::InputError(std::to_string(count) + " open files are required, but this machine allows " +
                         std::to_string(limit.rlim_max) + ": raise the hard limit (`ulimit -Hn`), or use fewer robots");
}

struct ReceiveBatch::Storage {
  std::vector<std::uint8_t> slots;
  std::vector<sockaddr_in> sources;
  std::vector<iovec> vectors;
  std::vector<mmsghdr> messages;
};

ReceiveBatch::ReceiveBatch(std::size_t capacity) : storage_(std::make_unique<Storage>()) {
  Storage& s = *storage_;
  s.slots.resize(capacity * kSlotBytes);
  s.sources.resize(capacity);
  s.vectors.resize(capacity);
  s.messages.resize(capacity);
  for (std::size_t i = 0; i < capacity; ++i) {
    s.vectors[i] = {s.slots.data() + i * kSlotBytes, kSlotBytes};
    s.messages[i].msg_hdr.msg_name = &s.sources[i];
    s.messages[i].msg_hdr.msg_iov = &s.vectors[i];
    s.messages[i].msg_hdr.msg_iovlen = 1;
  }
}

ReceiveBatch::~ReceiveBatch() = default;

std::size_t ReceiveBatch::fill(const Socket& socket) {
  Storage& s = *storage_;
  for (mmsghdr& message : s.messages) message.msg_hdr.msg_namelen = sizeof(sockaddr_in);
  int taken = -1;
  do {
    taken = recvmmsg(socket.descriptor(), s.messages.data(), static_cast<unsigned>(s.messages.size()), MSG_DONTWAIT,
                     nullptr);
  } while (taken < 0 && errno == EINTR);
  return taken < 0 ? 0 : static_cast<std::size_t>(taken);
}

std::span<const std::uint8_t> ReceiveBatch::bytes(std::size_t i) const {
  return {storage_->slots.data() + i * kSlotBytes, storage_->messages[i].msg_len};
}

Endpoint ReceiveBatch::source(std::size_t i) const { return from_posix(storage_->sources[i]); }

}  // namespace sf::netio
