#pragma once
// An iRobot Create at the other end of a pseudo-terminal: parses the Open Interface byte by byte, moves, and answers.
// Written from the specification, without the code that it tests. It has no clock: `run` is 15 ms of its time.

#include <cmath>
#include <cstdint>
#include <random>
#include <string>

#include "base/pose.h"
#include "tests/pseudo_terminal.h"

namespace sf {

class CreateSimulator : public PseudoTerminal {
 public:
  enum Mode { off, passive, safe, full };
  static constexpr double kStep = 0.015;  ///< [s]

  /// Processes commands until `count` drive commands have been received; false after ten seconds.
  bool driven(std::uint64_t count) {
    return awaited([&] { return drives >= count; });
  }
  /// Processes commands until it is in that mode.
  bool reaches(Mode wanted) {
    return awaited([&] { return mode == wanted; });
  }

  /// Processes commands until its stream is requested.
  bool streaming() {
    return awaited([&] { return !streams.empty(); });
  }

  /// Sends frames of its stream, each after 15 ms of motion.
  void run(int frames) {
    for (int k = 0; k < frames; ++k) {
      move();
      if (!streams.empty()) send(frame());
    }
  }
  /// Returns a frame of its state and the motion since the previous frame.
  Bytes frame() {
    Bytes bytes{19, 0};
    for (const std::uint8_t id : streams) {
      bytes.push_back(id);
      if (id == 7) bytes.push_back(static_cast<std::uint8_t>(bumps | drops << 2));
      if (id == 8) bytes.push_back(wall);
      if (id >= 9 && id <= 12) bytes.push_back(static_cast<std::uint8_t>(cliffs >> (id - 9) & 1));
      if (id == 13) bytes.push_back(virtual_wall);
      if (id == 14) bytes.push_back(overcurrents);
      if (id == 17) bytes.push_back(infrared);
      if (id == 18) bytes.push_back(buttons);
      if (id == 19) put(take_whole(distance_), bytes);
      if (id == 20) put(take_whole(angle_), bytes);
      if (id == 43) put(static_cast<int>(std::floor(left_counts)) & 0xFFFF, bytes);
      if (id == 44) put(static_cast<int>(std::floor(right_counts)) & 0xFFFF, bytes);
      if (id == 21) bytes.push_back(charging);
      if (id == 22) put(voltage, bytes);
      if (id == 23) put(current, bytes);
      if (id == 24) bytes.push_back(static_cast<std::uint8_t>(temperature));
      if (id == 25) put(charge, bytes);
      if (id == 26) put(capacity, bytes);
      if (id == 32) bytes.push_back(inputs);
      if (id == 33) put(analog, bytes);
      if (id == 35) bytes.push_back(static_cast<std::uint8_t>(mode));
    }
    bytes[1] = static_cast<std::uint8_t>(bytes.size() - 2);
    std::uint8_t sum = 0;
    for (const std::uint8_t byte : bytes) sum = static_cast<std::uint8_t>(sum + byte);
    bytes.push_back(static_cast<std::uint8_t>(256 - sum));
    return bytes;
  }
  /// Seeds the slip and draws the initial remainders of distance and angle.
  void seed(std::uint64_t seed) {
    random_.seed(seed);
    distance_ = std::uniform_real_distribution<double>{}(random_);
    angle_ = std::uniform_real_distribution<double>{}(random_);
  }
  /// Switches it off and on.
  void restart() {
    mode = off;
    streams.clear();
    right = left = 0;
    left_counts = right_counts = 0.0;
  }

  double left_counts = 0.0, right_counts = 0.0;  ///< of the wheels of a Create 2, 508.8 to a turn of 72 mm
  double scale = 1.0;                            ///< reported distance and angle over the true ones
  double slip = 0.0;                             ///< [m^(1/2)] standard deviation of a wheel's slip after one metre
  Mode mode = off;
  base::Pose X;              ///< pose in the world
  int right = 0, left = 0;   ///< [mm/s]
  int bumps = 0, drops = 0;  ///< bits as in packet 7
  std::uint64_t drives = 0;  ///< commands, refused ones too
  std::uint64_t unknown = 0;
  Bytes streams;  ///< ids
  // As in the packets of these names.
  std::uint8_t wall = 0, virtual_wall = 0, overcurrents = 0, infrared = 255, buttons = 0, charging = 0;
  unsigned cliffs = 0;  ///< bits 0 to 3: left, front left, front right, right
  int voltage = 15'700, current = -240, temperature = 24, charge = 2300, capacity = 2700, analog = 0;
  std::uint8_t inputs = 0;                         ///< as in packet 32
  std::uint8_t outputs = 0, low_side_drivers = 0;  ///< as in commands 147 and 138

 private:
  template <class Done>
  bool awaited(Done done) {
    return PseudoTerminal::awaited(done, [this](std::uint8_t byte) { take(byte); });
  }

  void take(std::uint8_t byte) {
    command_.push_back(byte);
    const std::uint8_t code = command_[0];
    const std::size_t count = command_.size();
    if (code == 148 && (count < 2 || count < 2u + command_[1])) return;
    if ((code == 145 && count < 5) || ((code == 150 || code == 147 || code == 138) && count < 2)) return;
    obey(code);
    command_.clear();
  }
  void obey(std::uint8_t code) {
    if (code == 128) return set_mode(passive);
    if (mode == off) return;
    if (code == 131) return drops == 0 ? set_mode(safe) : void();
    if (code == 148) return streams.assign(command_.begin() + 2, command_.end());
    if (code == 150) return command_[1] == 0 ? streams.clear() : void();
    if (code == 147 || code == 138) return set_outputs(code == 147 ? outputs : low_side_drivers);
    if (code != 145) return void(++unknown);
    ++drives;
    if (mode < safe) return;
    right = speed(1);
    left = speed(3);
  }
  void set_outputs(std::uint8_t& which) const {
    if (mode >= safe) which = command_[1];
  }
  void set_mode(Mode next) {
    mode = next;
    if (next == passive) right = left = 0;
  }
  int speed(std::size_t at) const { return static_cast<std::int16_t>(command_[at] << 8 | command_[at + 1]); }

  void move() {
    if (drops != 0 && mode == safe) set_mode(passive);
    const double way = 0.5e-3 * (right + left) * kStep, turn = 1e-3 * (right - left) / 0.258 * kStep;
    X.x += way * std::cos(X.yaw + 0.5 * turn);
    X.y += way * std::sin(X.yaw + 0.5 * turn);
    X.yaw += turn;
    left_counts += left * kStep * 508.8 / (M_PI * 72.0);
    right_counts += right * kStep * 508.8 / (M_PI * 72.0);
    const double slip_left = slip_of(left), slip_right = slip_of(right);
    distance_ += scale * 1e3 * (way + 0.5 * (slip_left + slip_right));
    angle_ += scale * (turn + (slip_right - slip_left) / 0.258) * 180.0 / M_PI;
  }
  /// Returns the slip [m] of a wheel in one step.
  double slip_of(int speed) {
    return slip * std::sqrt(1e-3 * std::abs(speed) * kStep) * std::normal_distribution<double>{}(random_);
  }
  static int take_whole(double& sum) {
    const double whole = std::trunc(sum);
    sum -= whole;
    return static_cast<int>(whole);
  }
  static void put(int number, Bytes& bytes) {
    bytes.push_back(static_cast<std::uint8_t>(number >> 8 & 0xFF));
    bytes.push_back(static_cast<std::uint8_t>(number & 0xFF));
  }

  Bytes command_;
  double distance_ = 0.0, angle_ = 0.0;  ///< [mm], [degree] not sent yet
  std::mt19937_64 random_{1};
};

}  // namespace sf
