#pragma once
// A Khepera II at the other end of a pseudo-terminal: reads commands line by line, moves, and answers. Written from
// K-Team's manual, without the code that it tests. It has no clock: each command takes 20 ms of its time.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "base/pose.h"
#include "tests/pseudo_terminal.h"

namespace sf {

class KheperaEmulator : public PseudoTerminal {
 public:
  static constexpr double kStep = 0.02;  ///< [s]
  static constexpr double kTrack = 0.052;

  /// Processes commands until `count` more lines have been received; false after ten seconds.
  bool obey(std::uint64_t count = 1) {
    const std::uint64_t until = lines + count;
    return awaited([&] { return lines >= until; });
  }
  /// Processes commands until both wheels are at rest.
  bool rests() {
    return awaited([&] { return left == 0 && right == 0; });
  }
  /// Switches it off and on.
  void restart() {
    left = right = 0;
    left_pulses = right_pulses = 0.0;
    command_.clear();
    say("Khepera II - BIOS 5.02, (c) 1999\r\nSerial communication protocol, mode 1\r\n");
  }
  void say(const std::string& text) { send({text.begin(), text.end()}); }

  int left = 0, right = 0;                       ///< [pulses per 10 ms]
  double left_pulses = 0.0, right_pulses = 0.0;  ///< position counters
  base::Pose X;                                  ///< pose in the world
  std::vector<int> proximity{0, 0, 100, 1023, 0, 0, 0, 50}, light{500, 499, 450, 50, 500, 500, 500, 500};
  std::uint64_t lines = 0, wrong = 0, drives = 0;  ///< received; not understood; D
  std::function<std::string(std::string)> damage;  ///< of answers; "": lost. Empty: none

 private:
  template <class Done>
  bool awaited(Done done) {
    return PseudoTerminal::awaited(done, [this](std::uint8_t byte) { take(byte); });
  }
  void take(std::uint8_t byte) {
    if (byte != '\n' && byte != '\r') return command_.push_back(static_cast<char>(byte));
    if (command_.empty()) return;
    move();
    const std::string reply = answer();
    command_.clear();
    ++lines;
    const std::string sent = damage ? damage(reply) : reply;
    if (!sent.empty()) say(sent);
  }

  std::string answer() {
    std::vector<int> numbers;
    for (std::size_t at = command_.find(','); at != std::string::npos; at = command_.find(',', at + 1))
      numbers.push_back(std::atoi(command_.c_str() + at + 1));
    const std::size_t expected = command_[0] == 'D' || command_[0] == 'G' ? 2 : 0;
    if (std::string("DGHNOE").find(command_[0]) == std::string::npos || numbers.size() != expected) {
      ++wrong;
      return "z,Protocol error\r\n";
    }
    switch (command_[0]) {
      case 'D':
        ++drives;
        left = numbers[0], right = numbers[1];
        return "d\r\n";
      case 'G':
        left_pulses = numbers[0], right_pulses = numbers[1];
        return "g\r\n";
      case 'H':
        return text('h', {static_cast<int>(left_pulses), static_cast<int>(right_pulses)});
      case 'E':
        return text('e', {left, right});
      case 'N':
        return text('n', proximity);
      default:
        return text('o', light);
    }
  }
  static std::string text(char letter, const std::vector<int>& numbers) {
    std::string line(1, letter);
    for (const int number : numbers) line += "," + std::to_string(number);
    return line + "\r\n";
  }

  void move() {
    left_pulses += left * kStep / 0.01;
    right_pulses += right * kStep / 0.01;
    const double l = left * kStep / 0.01 / 12e3, r = right * kStep / 0.01 / 12e3;  // [m]
    const double turn = (r - l) / kTrack, middle = X.yaw + 0.5 * turn;
    X.x += 0.5 * (l + r) * std::cos(middle);
    X.y += 0.5 * (l + r) * std::sin(middle);
    X.yaw += turn;
  }

  std::string command_;
};

}  // namespace sf
