#pragma once
// A Pioneer 3-AT with ARCOS at the other end of a pseudo-terminal: checks packets byte by byte, moves, and sends SIPs.
// Written from the operations manual, without the code that it tests. It has no clock: `run` is 100 ms of its time.

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "base/pose.h"
#include "tests/pseudo_terminal.h"

namespace sf {

class PioneerEmulator : public PseudoTerminal {
 public:
  static constexpr double kStep = 0.1;  ///< [s]

  /// Processes packets until `count` more have been received; false after ten seconds.
  bool obey(std::uint64_t count = 1) {
    const std::uint64_t until = packets + count;
    return awaited([&] { return packets >= until; });
  }
  /// Processes packets until `count` rotation commands have been received.
  bool driven(std::uint64_t count) {
    return awaited([&] { return turns >= count; });
  }
  bool closes() {
    return awaited([&] { return !open; });
  }

  /// Sends SIPs, each after 100 ms of motion.
  void run(int cycles) {
    for (int k = 0; k < cycles; ++k) {
      move();
      if (open) send(sip());
    }
  }
  /// Switches it off and on.
  void restart() {
    open = motors = sonars = false;
    vel = rvel = stage = 0;
    packet_.clear();
  }
  static Bytes packet(const Bytes& payload) {
    Bytes bytes{0xFA, 0xFB, static_cast<std::uint8_t>(payload.size() + 2)};
    bytes.insert(bytes.end(), payload.begin(), payload.end());
    const unsigned sum = checksum(bytes, 3, payload.size());
    bytes.push_back(static_cast<std::uint8_t>(sum / 256));
    bytes.push_back(static_cast<std::uint8_t>(sum % 256));
    return bytes;
  }
  Bytes sip() const {
    Bytes p{static_cast<std::uint8_t>(vel != 0 || rvel != 0 ? 0x33 : 0x32)};
    put(static_cast<int>(std::floor(x / unit + 0.5)) & 0x7FFF, p);
    put(static_cast<int>(std::floor(y / unit + 0.5)) & 0x7FFF, p);
    put(static_cast<int>(std::lround(std::remainder(heading, 2 * M_PI) * 4096 / (2 * M_PI))), p);
    put(vel, p), put(vel, p);
    p.push_back(battery);
    p.push_back(rear), p.push_back(front);
    put(0, p);
    put((motors ? 1 : 0) | (sonars ? 2 : 0) | (stop_button ? 0x20 : 0), p);
    p.push_back(0);
    p.push_back(sonars ? 2 : 0);
    for (const int k : {3, 12}) {
      if (!sonars) continue;
      p.push_back(static_cast<std::uint8_t>(k));
      put(ranges[static_cast<std::size_t>(k)], p);
    }
    for (int k = 0; k < 5; ++k) p.push_back(0);
    return packet(p);
  }

  std::string subtype = "p3at-sh";
  double unit = 1.0;                 ///< [mm] of positions
  base::Pose X;                      ///< pose in the world
  double x = 0, y = 0, heading = 0;  ///< [mm], [rad] odometry
  double scale = 1.0;                ///< odometry's distances over true ones
  bool open = false, motors = false, sonars = false, stop_button = false;
  int vel = 0, rvel = 0;                            ///< [mm/s], [degree/s]
  std::uint8_t battery = 124, rear = 0, front = 0;  ///< [0.1 V]; stalls and bumpers
  std::array<int, 16> ranges{};                     ///< [mm]
  std::uint64_t packets = 0, turns = 0, pulses = 0, wrong = 0, unknown = 0, watchdog_stops = 0;
  int lose = 0;  ///< number of packets that are not received

 private:
  template <class Done>
  bool awaited(Done done) {
    return PseudoTerminal::awaited(done, [this](std::uint8_t byte) { take(byte); });
  }
  static unsigned checksum(const Bytes& bytes, std::size_t at, std::size_t n) {
    unsigned c = 0;
    for (; n > 1; n -= 2, at += 2) c = (c + 256u * bytes[at] + bytes[at + 1]) & 0xFFFF;
    return n > 0 ? c ^ bytes[at] : c;
  }
  static void put(int number, Bytes& bytes) {
    bytes.push_back(static_cast<std::uint8_t>(number & 0xFF));
    bytes.push_back(static_cast<std::uint8_t>(number >> 8 & 0xFF));
  }

  void take(std::uint8_t byte) {
    packet_.push_back(byte);
    if (packet_[0] != 0xFA || (packet_.size() > 1 && packet_[1] != 0xFB)) return packet_.clear();
    if (packet_.size() < 3 || packet_.size() < 3u + packet_[2]) return;
    const std::size_t n = packet_[2] - 2u;
    const bool good = checksum(packet_, 3, n) == 256u * packet_[3 + n] + packet_[4 + n];
    const Bytes payload(packet_.begin() + 3, packet_.end() - 2);
    packet_.clear();
    if (!good) return void(++wrong);
    ++packets;
    if (lose > 0) return void(--lose);
    quiet_ = 0.0;
    open ? obey_command(payload) : synchronize(payload);
  }
  /// Each packet is sent back; the last one with the robot's names.
  void synchronize(const Bytes& payload) {
    const std::uint8_t number = payload[0];
    if (stage == 3) {
      open = number == 1;
      if (open) x = y = heading = 0.0;
      if (number == 0) stage = 0;
    }
    if (open || number > 2 || (number != 0 && number != stage)) return;
    stage = number + 1;
    Bytes reply = payload;
    if (number == 2)
      for (const std::string& text : {std::string("Anna"), std::string("Pioneer"), subtype}) {
        reply.insert(reply.end(), text.begin(), text.end());
        reply.push_back(0);
      }
    send(packet(reply));
  }
  void obey_command(const Bytes& payload) {
    const int size = payload.size() >= 4 ? payload[2] | payload[3] << 8 : 0;
    const int value = payload.size() >= 4 && payload[1] == 0x1B ? -size : size;
    switch (payload[0]) {
      case 0:
        return void(++pulses);
      case 1:
        return;
      case 2:
        return restart();
      case 4:
        return void(motors = value == 1);
      case 11:
        return void(vel = value);
      case 21:
        ++turns;
        return void(rvel = value);
      case 28:
        return void(sonars = value == 1);
      case 29:
        return void(vel = rvel = 0);
      default:
        ++unknown;
    }
  }
  void move() {
    quiet_ += kStep;
    if (quiet_ > 2.0 && (vel != 0 || rvel != 0)) ++watchdog_stops, vel = rvel = 0;
    if (!motors || stop_button) vel = rvel = 0;
    const double way = vel * kStep, turn = rvel * M_PI / 180 * kStep;
    X.x += 1e-3 * way * std::cos(X.yaw + 0.5 * turn);
    X.y += 1e-3 * way * std::sin(X.yaw + 0.5 * turn);
    X.yaw += turn;
    x += scale * way * std::cos(heading + 0.5 * turn);
    y += scale * way * std::sin(heading + 0.5 * turn);
    heading += turn;
  }

  int stage = 0;  ///< next synchronization packet; 3: synchronized
  Bytes packet_;
  double quiet_ = 0.0;  ///< [s] since the last packet
};

}  // namespace sf
