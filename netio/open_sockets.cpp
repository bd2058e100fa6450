#include "netio/open_sockets.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/filter.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <system_error>

#include "base/error.h"

namespace sf::netio {

namespace {

std::set<int> descriptors() {
  std::set<int> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error))
    found.insert(std::atoi(entry.path().filename().c_str()));
  std::erase_if(found, [](int descriptor) { return fcntl(descriptor, F_GETFD) < 0; });  // the descriptor of the folder
                                                                                        // itself
  return found;
}

/// Returns the address that a UDP socket over IPv4 is bound to; nullopt if the descriptor is not such a socket or is
/// not bound.
std::optional<sockaddr_in> bound_udp(int descriptor) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  int type = 0;
  socklen_t type_size = sizeof type;
  const bool found = getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &type_size) == 0 && type == SOCK_DGRAM &&
                     getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) == 0 &&
                     address.sin_family == AF_INET && address.sin_port != 0;
  return found ? std::optional(address) : std::nullopt;
}

bool is_open_to_all(int descriptor) {
  const auto bound = bound_udp(descriptor);
  return bound && bound->sin_addr.s_addr == htonl(INADDR_ANY);
}

/// Attaches a kernel filter that drops datagrams not sent to 127.0.0.0/8, as a socket bound to loopback would.
bool take_loopback_only(int descriptor) {
  constexpr auto kTo = static_cast<std::uint32_t>(SKF_NET_OFF + 16);  // in the header of IPv4
  sock_filter steps[] = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kTo), BPF_STMT(BPF_ALU | BPF_AND | BPF_K, 0xFF000000u),
                         BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0x7F000000u, 0, 1), BPF_STMT(BPF_RET | BPF_K, 0xFFFFFFFFu),
                         BPF_STMT(BPF_RET | BPF_K, 0)};
  const sock_fprog program{sizeof steps / sizeof *steps, steps};
  return setsockopt(descriptor, SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof program) == 0;
}

}  // namespace

OpenSockets::OpenSockets() : before_(descriptors()) {}

void OpenSockets::keep_new_ones_to_loopback() const {
  for (const int descriptor : descriptors()) {
    if (before_.count(descriptor) > 0 || !is_open_to_all(descriptor)) continue;
    constexpr char kInterface[] = "lo";  // older kernels allow this only for root; the filter is enough
    setsockopt(descriptor, SOL_SOCKET, SO_BINDTODEVICE, kInterface, sizeof kInterface);
    if (!take_loopback_only(descriptor))
      throw base::InputError("sockets cannot be restricted to this machine: the kernel rejects filters");
  }
}

std::set<std::string> OpenSockets::addresses() const {
  std::set<std::string> found;
  for (const int descriptor : descriptors()) {
    const auto bound = before_.count(descriptor) > 0 ? std::nullopt : bound_udp(descriptor);
    const bool is_one =
        bound && bound->sin_addr.s_addr != htonl(INADDR_ANY) && !IN_MULTICAST(ntohl(bound->sin_addr.s_addr));
    char text[INET_ADDRSTRLEN] = {};
    if (is_one && inet_ntop(AF_INET, &bound->sin_addr, text, sizeof text) != nullptr) found.insert(text);
  }
  return found;
}

}  // namespace sf::netio
