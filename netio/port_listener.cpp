#include "netio/port_listener.h"

#include <sys/epoll.h>

#include <array>
#include <string>

#include "base/error.h"
#include "netio/posix.h"

namespace sf::netio {

namespace {

constexpr std::size_t kPortBatch = 64;
constexpr std::size_t kSpareFiles = 64;  ///< descriptors reserved for the rest of the process
constexpr std::size_t kEvents = 256;

std::vector<SensorPorts> uses_of(std::span<const StreamSpec> streams) {
  std::vector<SensorPorts> uses;
  for (const StreamSpec& spec : streams) uses.push_back({spec.robot, 1, spec.rule, "", spec.sensor, spec.type});
  return uses;
}

}  // namespace

PortListener::PortListener(std::uint32_t address, std::size_t receive_buffer, std::span<const StreamSpec> streams)
    : batch_(kPortBatch) {
  require_ports(uses_of(streams));
  raise_open_file_limit(streams.size() + kSpareFiles);
  epoll_ = Socket(epoll_create1(EPOLL_CLOEXEC));
  if (epoll_.descriptor() < 0) throw base::InputError("no epoll set: " + error_text(errno) + "; raise `ulimit -n`");

  for (const StreamSpec& spec : streams) {
    const auto own_port = static_cast<std::uint16_t>(port(spec.rule, spec.robot, spec.sensor));
    sockets_.push_back(open_udp({address, own_port}, {.receive = receive_buffer}));
    epoll_event readable{};
    readable.events = EPOLLIN;
    readable.data.u64 = sockets_.size() - 1;
    const int failed = epoll_ctl(epoll_.descriptor(), EPOLL_CTL_ADD, sockets_.back().descriptor(), &readable);
    if (failed != 0) throw base::InputError("cannot watch port " + std::to_string(own_port) + ": " + error_text(errno));
  }
  ready_.reserve(kEvents);
}

void PortListener::wait(int timeout_ms) {
  std::array<epoll_event, kEvents> events;
  const int ready = epoll_wait(epoll_.descriptor(), events.data(), events.size(), timeout_ms);
  ready_.clear();
  for (int e = 0; e < ready; ++e) ready_.push_back(events[static_cast<std::size_t>(e)].data.u64);
}

std::uint64_t PortListener::socket_drops() const {
  std::uint64_t drops = 0;
  for (const Socket& socket : sockets_) drops += netio::socket_drops(socket);
  return drops;
}

std::size_t PortListener::receive_buffer_size() const {
  return sockets_.empty() ? 0 : receive_buffer(sockets_.front());
}

}  // namespace sf::netio
