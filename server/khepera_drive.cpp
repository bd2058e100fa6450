#include "server/khepera_drive.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <thread>

#include "sensors/infrared.h"
#include "sensors/lightsensor.h"

namespace sf::server {

namespace {

constexpr std::int64_t kAnswer = 150'000'000;  // [ns] for an answer: the longest takes 50 ms at 9600 baud
constexpr std::int64_t kQuiet = 50'000'000;    // [ns] after which a cleared line is empty
constexpr std::string_view kRound = "HNHNHNHO";
constexpr std::size_t kSensors = 8;
constexpr int kSlack = 40;               // [pulses per 10 ms] of motion beyond the commanded speed
constexpr double kMargin = 30.0;         // [pulses]
constexpr double kInfraredReach = 0.05;  // [m] as `infrared( )` of worlds/robots.inc
constexpr std::array<std::string_view, kSensors> kLight{"light_0", "light_1", "light_2", "light_3",
                                                        "light_4", "light_5", "light_6", "light_7"};

}  // namespace

KheperaDrive::KheperaDrive(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM,
                           double track)
    : RealRobot(type, options, X_WM), track_(track) {
  start(0);
}

void KheperaDrive::start(std::int64_t now) {
  counting_ = false;
  clear_line(now);
  ++counts_.starts;
}

/// Ends a partial command at the robot's end, and drops a partial answer.
void KheperaDrive::clear_line(std::int64_t now) {
  lines_.reset();
  ask('\n', {}, now);
}

void KheperaDrive::take(std::span<const std::uint8_t> bytes, std::int64_t now) {
  for (const std::uint8_t byte : bytes)
    if (const auto line = lines_.take(byte)) take_line(*line, now);
}

void KheperaDrive::take_line(std::string_view line, std::int64_t now) {
  const auto answer = robots::parse_khepera(line);
  // Anything else is a late answer, or the text of a restarted robot: the awaited answer may still arrive.
  const bool awaited = pending_ != 0 && line[0] == static_cast<char>(pending_ + ('a' - 'A'));
  const bool refused = line[0] == 'z' && pending_ != '\n';
  if (awaited && answer && accept(*answer, now)) {
    ++counts_.frames;
    heard(now);
  } else {
    ++counts_.wrong;
  }
  if (awaited || refused) pending_ = 0;
}

/// Returns whether the answer is complete.
bool KheperaDrive::accept(const robots::KheperaAnswer& answer, std::int64_t now) {
  const std::vector<std::int64_t>& n = answer.numbers;
  switch (answer.letter) {
    case 'd':
      if (n.empty()) drive_due_ = false;
      return n.empty();
    case 'g':
      if (!n.empty()) return false;
      pulses_ = {};
      counted_ = now;
      suspect_.reset();
      counting_ = true;
      return true;
    case 'h':
      if (n.size() != 2) return false;
      take_pulses({n[0], n[1]}, now);
      return true;
    case 'n': {
      if (n.size() != kSensors) return false;
      std::vector<double> values;
      for (const std::int64_t number : n) {
        const double response = std::clamp(static_cast<double>(number), 0.0, sensors::kMostResponse);
        values.insert(values.end(), {kInfraredReach * (1.0 - response / sensors::kMostResponse), response});
      }
      measured({.type = sensors::kInfrared, .time = now, .values = std::move(values), .limit = kInfraredReach});
      return true;
    }
    default: {
      if (n.size() != kSensors) return false;
      light_ = n;
      const sensors::LightSensor rule;
      std::vector<double> values;
      for (const std::int64_t number : n) {
        const double value = std::clamp(static_cast<double>(number), 0.0, sensors::kMostLightValue);
        values.insert(values.end(), {rule.bright * std::max(0.0, 1.0 - value / rule.dark), value});
      }
      measured(sensors::kLightSensor, std::move(values), now);
      return true;
    }
  }
}

/// Counters are totals, so a damaged one is corrected by the next. A second one after an impossible motion is that of
/// a robot whose counters restarted: the motion in between is unknown.
void KheperaDrive::take_pulses(const Pulses& pulses, std::int64_t now) {
  const bool plausible = possible(pulses_, pulses, now);
  if (!plausible && !(suspect_ && possible(*suspect_, pulses, now))) {
    suspect_ = pulses;
    return;
  }
  if (!plausible) {
    drive_due_ = true;
    ++counts_.starts;
  }
  const Pulses before = plausible ? pulses_ : *suspect_;
  suspect_.reset();
  pulses_ = pulses;
  counted_ = now;
  const double left = robots::kKheperaPulse * static_cast<double>(pulses.left - before.left);
  const double right = robots::kKheperaPulse * static_cast<double>(pulses.right - before.right);
  advance(0.5 * (left + right), (right - left) / track_);
}

bool KheperaDrive::possible(const Pulses& before, const Pulses& after, std::int64_t now) const {
  const double most =
      kMargin + 1e-7 * static_cast<double>(now - counted_) * (kSlack + std::max(fastest_, fastest_before_));
  const auto near = [&](std::int64_t a, std::int64_t b) { return std::abs(static_cast<double>(b - a)) <= most; };
  return near(before.left, after.left) && near(before.right, after.right);
}

void KheperaDrive::run(std::int64_t now) {
  if (pending_ == '\n' && now - asked_ >= kQuiet) {
    lines_.reset();
    pending_ = 0;
  }
  if (pending_ != 0 && pending_ != '\n' && now - asked_ >= kAnswer) {
    ++counts_.timeouts;
    clear_line(now);
  }
  if (pending_ == 0) ask(now);
}

void KheperaDrive::ask(std::int64_t now) {
  if (!counting_) return ask('G', {0, 0}, now);
  if (drive_due_) return ask('D', {wheels_.left, wheels_.right}, now);
  ask(kRound[round_++ % kRound.size()], {}, now);
}

void KheperaDrive::ask(char letter, std::initializer_list<int> numbers, std::int64_t now) {
  const base::Bytes bytes = letter == '\n' ? base::Bytes{'\n'} : robots::khepera_command(letter, numbers);
  if (!write(bytes)) return;
  pending_ = letter;
  stopped_ = false;
  asked_ = now;
}

void KheperaDrive::drive(const base::Twist& twist, std::int64_t now) {
  wheels_ = ready(now) ? robots::khepera_wheels(twist, track_) : robots::KheperaWheels{};
  fastest_before_ = std::exchange(fastest_, std::max(std::abs(wheels_.left), std::abs(wheels_.right)));
  drive_due_ = true;
}

void KheperaDrive::stop() {
  using std::chrono::milliseconds;
  wheels_ = {};
  for (int tries = 0; tries < 3 && !stopped_ && line() != nullptr && !line()->lost(); ++tries) {
    // The line feed ends a command that was cut.
    if (tries > 0 || pending_ != 0) line()->write(base::Bytes{'\n'});
    line()->write(robots::khepera_command('D', {0, 0}));
    line()->drain();
    std::array<std::uint8_t, 256> bytes;
    for (int waits = 0; waits < 15 && !stopped_; ++waits, std::this_thread::sleep_for(milliseconds(10))) {
      const std::size_t count = line()->read(bytes);
      for (std::size_t i = 0; i < count; ++i)
        if (const auto answer = lines_.take(bytes[i])) stopped_ = stopped_ || *answer == "d";
    }
  }
}

std::string KheperaDrive::fault() const { return counting_ ? "" : "the Khepera is starting"; }

std::vector<RobotFact> KheperaDrive::facts() const {
  std::vector<RobotFact> facts;
  for (std::size_t i = 0; i < light_.size(); ++i) facts.push_back({kLight[i], static_cast<double>(light_[i])});
  return facts;
}

RealRobotCounts KheperaDrive::counts() const {
  RealRobotCounts counts = counts_;
  counts.skipped_bytes = lines_.skipped();
  return counts;
}

}  // namespace sf::server
