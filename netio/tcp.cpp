#include "netio/tcp.h"

#include <netinet/tcp.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "netio/posix.h"

namespace sf::netio {

namespace {

constexpr int kBacklog = 64;  // connections waiting to be accepted

Socket open_tcp(const Endpoint& endpoint) {
  Socket opened(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (opened.descriptor() >= 0) return opened;
  throw base::InputError("no TCP socket for " + endpoint_text(endpoint) + ": " + error_text(errno) +
                         "; raise `ulimit -n`");
}

void watch(const Socket& epoll, int operation, const Socket& socket, std::uint64_t key, std::uint32_t events) {
  epoll_event event{};
  event.events = events;
  event.data.u64 = key;
  const int failed = epoll_ctl(epoll.descriptor(), operation, socket.descriptor(), &event);
  SF_CHECK(failed == 0, "epoll_ctl: " + error_text(errno));
}

void send_at_once(const Socket& connection) {
  const int on = 1;
  setsockopt(connection.descriptor(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

std::optional<std::size_t> moved(ssize_t bytes) {
  if (bytes > 0) return static_cast<std::size_t>(bytes);
  const bool later = bytes < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
  return later ? std::optional<std::size_t>(0) : std::nullopt;
}

}  // namespace

Socket listen_tcp(const Endpoint& bind) {
  Socket listener = open_tcp(bind);
  const int on = 1;  // lingering connections of an earlier run do not block the port
  setsockopt(listener.descriptor(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  bind_socket(listener, bind, "TCP");
  if (listen(listener.descriptor(), kBacklog) == 0) return listener;
  throw PortInUse("cannot listen on TCP " + endpoint_text(bind) + ": " + error_text(errno) +
                  "; another program uses this port; stop it or choose another port");
}

Socket accept_tcp(const Socket& listener, Endpoint& peer) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  Socket connection(
      accept4(listener.descriptor(), reinterpret_cast<sockaddr*>(&address), &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
  peer = from_posix(address);
  if (connection.descriptor() >= 0) send_at_once(connection);
  return connection;
}

Socket connect_tcp(const Endpoint& server, int wait_ms) {
  Socket connection = open_tcp(server);
  const sockaddr_in address = to_posix(server);
  const int descriptor = connection.descriptor();
  int error = connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? 0 : errno;
  if (error == EINPROGRESS) {
    pollfd room{descriptor, POLLOUT, 0};
    socklen_t size = sizeof error;
    error = wait_ms > 0 ? ETIMEDOUT : 0;
    if (poll(&room, 1, wait_ms) > 0) getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size);
  }
  if (error != 0)
    throw base::InputError("cannot connect to TCP " + endpoint_text(server) + ": " + error_text(error) +
                           "; start the server there, or correct the address");
  send_at_once(connection);
  return connection;
}

std::optional<std::size_t> receive_some(const Socket& connection, std::span<std::uint8_t> bytes) {
  const auto received = moved(recv(connection.descriptor(), bytes.data(), bytes.size(), 0));
  // Disables Nagle's algorithm: when a peer sends a command and then a request, the request waits for the
  // acknowledgement of the command, which the kernel would delay by 40 ms. The option lasts until the next message.
  const int on = 1;
  if (received) setsockopt(connection.descriptor(), IPPROTO_TCP, TCP_QUICKACK, &on, sizeof on);
  return received;
}

std::optional<std::size_t> send_some(const Socket& connection, std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return 0;
  return moved(send(connection.descriptor(), bytes.data(), bytes.size(), MSG_NOSIGNAL));
}

SocketWait::SocketWait() : epoll_(epoll_create1(EPOLL_CLOEXEC)), event_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (epoll_.descriptor() < 0 || event_.descriptor() < 0)
    throw base::InputError("no descriptors are left: " + error_text(errno) + "; raise `ulimit -n`");
  watch(epoll_, EPOLL_CTL_ADD, event_, kWoken, EPOLLIN);
}

// Edge-triggered: when no descriptors are left, a waiting connection must not end every wait at once.
void SocketWait::add_listener(const Socket& listener, std::uint64_t key) {
  watch(epoll_, EPOLL_CTL_ADD, listener, key, EPOLLIN | EPOLLET);
}

void SocketWait::add(const Socket& connection, std::uint64_t key) {
  watch(epoll_, EPOLL_CTL_ADD, connection, key, EPOLLIN);
}

void SocketWait::update(const Socket& connection, std::uint64_t key, bool room) {
  watch(epoll_, EPOLL_CTL_MOD, connection, key, room ? EPOLLIN | EPOLLOUT : EPOLLIN);
}

std::span<const std::uint64_t> SocketWait::wait() {
  std::array<epoll_event, 64> events;
  ready_.clear();
  const int count = epoll_wait(epoll_.descriptor(), events.data(), static_cast<int>(events.size()), -1);
  for (int i = 0; i < count; ++i) ready_.push_back(events[static_cast<std::size_t>(i)].data.u64);
  std::uint64_t ignored = 0;
  const auto woken = std::find(ready_.begin(), ready_.end(), kWoken);
  if (woken == ready_.end()) return ready_;
  std::iter_swap(woken, ready_.begin());
  while (read(event_.descriptor(), &ignored, sizeof ignored) > 0) {
  }
  return ready_;
}

void SocketWait::wake() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(event_.descriptor(), &one, sizeof one);  // full: it is already awake
}

}  // namespace sf::netio
