#pragma once
// A Player server with one robot, on loopback: checks messages byte by byte, moves, and sends data. Written from
// Player's interface definitions, without the code that it tests. It has no clock: `run` is 100 ms of its time.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/pose.h"
#include "netio/endpoint.h"

namespace sf {

class PlayerEmulator {
 public:
  using Bytes = std::vector<std::uint8_t>;
  static constexpr double kStep = 0.1;  ///< [s]
  enum Interface : std::uint32_t { kPower = 2, kPosition = 4, kSonar = 5, kLaser = 6, kBumper = 14, kInfrared = 22 };

  PlayerEmulator() { listen_on(0); }
  ~PlayerEmulator() { hang_up(), close(listener_); }
  PlayerEmulator(const PlayerEmulator&) = delete;
  PlayerEmulator& operator=(const PlayerEmulator&) = delete;

  netio::Endpoint endpoint() const { return {netio::kLoopback, port_}; }
  /// Ends the connection.
  void hang_up() {
    if (client_ >= 0) close(std::exchange(client_, -1));
    in_.clear();
    open.clear();
    forward = left = turn = 0.0;
  }
  /// Ends the server; `start` starts it again at the same port.
  void end() { hang_up(), close(std::exchange(listener_, -1)); }
  void start() { listen_on(port_); }

  /// Accepts a waiting connection, and processes received messages.
  void serve() {
    accept_client();
    std::array<std::uint8_t, 4096> bytes;
    for (ssize_t n = 1; client_ >= 0 && n != -1;) {
      n = recv(client_, bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (n == 0) hang_up();
      for (ssize_t i = 0; i < n; ++i) in_.push_back(bytes[static_cast<std::size_t>(i)]);
    }
    while (in_.size() >= 40 && in_.size() >= 40 + word(36)) {
      const Bytes message(in_.begin(), in_.begin() + 40 + word(36));
      in_.erase(in_.begin(), in_.begin() + static_cast<std::ptrdiff_t>(message.size()));
      obey(message);
    }
  }
  /// Moves for 100 ms, and sends the data of open devices.
  void run() {
    const double way = forward * kStep, angle = turn * kStep;
    for (base::Pose* pose : {&X, &X_OM}) {
      pose->x += way * std::cos(pose->yaw + 0.5 * angle);
      pose->y += way * std::sin(pose->yaw + 0.5 * angle);
      pose->yaw += angle;
    }
    X_OM.yaw = std::remainder(X_OM.yaw, 2 * M_PI);
    send_data(kSonar, array({2.5f, 5.0f}));
    send_data(kInfrared, joined(array({2.5f, 0.0f}), array({0.01f, 0.05f})));
    Bytes pressed = numbers<std::uint32_t>({2, 2});
    pressed.insert(pressed.end(), {bumper, 0, 0, 0});
    send_data(kBumper, pressed);
    send_data(kPower,
              joined(numbers<std::uint32_t>({1 | 8}), joined(numbers<float>({12.5f, 80.0f, 0, 0}), word_of(0))));
    send_state();
  }
  void send_state() {
    send_data(kPosition, joined(numbers<double>({X_OM.x, X_OM.y, X_OM.yaw, forward, left, turn}), word_of(stall)));
  }
  void send_data(std::uint32_t interf, const Bytes& payload) {
    if (open.count(interf) > 0) send(message(interf, 1, 1, payload));
  }
  void send(const Bytes& bytes) {
    if (client_ >= 0) ::send(client_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }

  template <class Number>
  static Bytes numbers(const std::vector<Number>& values) {
    Bytes bytes;
    for (const Number value : values) {
      const std::uint64_t bits = bits_of(value);
      for (int shift = 8 * static_cast<int>(sizeof value) - 8; shift >= 0; shift -= 8)
        bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
    return bytes;
  }
  static Bytes word_of(std::uint32_t value) { return numbers<std::uint32_t>({value}); }
  static Bytes array(const std::vector<float>& values) {
    const auto count = static_cast<std::uint32_t>(values.size());
    return joined(numbers<std::uint32_t>({count, count}), numbers(values));
  }
  static Bytes joined(Bytes first, const Bytes& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
  }
  static Bytes message(std::uint32_t interf, std::uint32_t type, std::uint32_t subtype, const Bytes& payload) {
    const Bytes head =
        joined(numbers<std::uint32_t>({0x7F000001, 6665, interf, 0, type, subtype}), numbers<double>({1.0}));
    return joined(joined(head, numbers<std::uint32_t>({1, static_cast<std::uint32_t>(payload.size())})), payload);
  }

  std::string banner = "Player v.3.1.1-dev";
  std::vector<std::uint32_t> devices{kPosition, kPower, kSonar, kBumper, kInfrared, kLaser};
  bool grants = true;            ///< access to devices
  base::Pose X;                  ///< pose in the world
  base::Pose X_OM;               ///< by its odometry
  std::set<std::uint32_t> open;  ///< interfaces
  double forward = 0.0, left = 0.0, turn = 0.0;
  std::uint32_t stall = 0, motors = 0;
  std::uint8_t bumper = 0;
  std::uint64_t connections = 0, commands = 0, unknown = 0;

 private:
  static std::uint64_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value); }
  static std::uint64_t bits_of(std::uint32_t value) { return value; }
  static std::uint64_t bits_of(double value) { return std::bit_cast<std::uint64_t>(value); }

  void listen_on(std::uint16_t port) {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const int on = 1;
    setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address);
    listen(listener_, 4);
    socklen_t size = sizeof address;
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  void accept_client() {
    const int client = accept(listener_, nullptr, nullptr);
    if (client < 0) return;
    hang_up();
    client_ = client;
    ++connections;
    Bytes greeting(banner.begin(), banner.end());
    greeting.resize(32);
    send(greeting);
  }
  std::uint32_t word(std::size_t at) const { return word(in_, at); }
  static std::uint32_t word(const Bytes& bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value << 8 | bytes[i];
    return value;
  }
  static double number(const Bytes& bytes, std::size_t at) {
    return std::bit_cast<double>(std::uint64_t{word(bytes, at)} << 32 | word(bytes, at + 4));
  }
  void obey(const Bytes& m) {
    const std::uint32_t interf = word(m, 8), type = word(m, 16), subtype = word(m, 20);
    if (interf == 1 && type == 3 && subtype == 1) return list();
    if (interf == 1 && type == 3 && subtype == 3 && m.size() == 40 + 28) return access(m);
    if (interf == kPosition && type == 3 && subtype == 1 && m.size() == 40)  // the pose and the size of the base
      return send(message(kPosition, 4, 1, numbers<double>({0, 0, 0, 0, 0, 0, 0.3, 0.4, 0.2})));
    if (interf == kPosition && type == 3 && subtype == 2 && m.size() == 44) {
      motors = word(m, 40);
      return send(message(kPosition, 4, 2, {}));
    }
    if (interf != kPosition || type != 2 || subtype != 1 || m.size() != 40 + 28) return void(++unknown);
    ++commands;
    forward = number(m, 40), left = number(m, 48), turn = number(m, 56);
  }
  void list() {
    const auto count = static_cast<std::uint32_t>(devices.size());
    Bytes payload = numbers<std::uint32_t>({count, count});
    for (const std::uint32_t device : devices)
      payload = joined(payload, numbers<std::uint32_t>({0x7F000001, port_, device, 0}));
    send(message(1, 4, 1, payload));
  }
  void access(const Bytes& m) {
    const std::uint32_t device = word(m, 48);
    if (grants) open.insert(device);
    Bytes payload = numbers<std::uint32_t>({0x7F000001, port_, device, 0, grants ? 1u : 3u, 2, 2});
    payload.insert(payload.end(), {'x', 0, 0, 0});
    send(message(1, grants ? 4 : 6, 3, payload));
  }

  int listener_ = -1, client_ = -1;
  std::uint16_t port_ = 0;
  Bytes in_;
};

}  // namespace sf
