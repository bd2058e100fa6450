#include "server/real_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"
#include "base/suggest.h"
#include "netio/serial_line.h"
#include "netio/tcp.h"
#include "server/create_drive.h"
#include "server/emulated_drive.h"
#include "server/khepera_drive.h"
#include "server/pioneer_drive.h"
#include "server/player_drive.h"

namespace sf::server {

namespace {

constexpr std::int64_t kSilence = 500'000'000;    // [ns] 33 frames of a Create, 5 of a Pioneer
constexpr std::int64_t kRevival = 1'000'000'000;  // [ns] between attempts to open a lost line
constexpr int kConnectIn = 3000;                  // [ms] at the start

template <class Robot>
std::unique_ptr<RealRobot> make(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM,
                                double track) {
  return std::make_unique<Robot>(type, options, X_WM, track);
}

// A Create truncates angles to degrees. A Pioneer's are 4096 to a turn; its wheels scrub.
constexpr RealRobotType kTypes[] = {
    {.word = "create", .title = "Create", .angle = M_PI / 180.0, .make = make<CreateDrive>},
    {.word = "create2",
     .title = "Create 2",
     .baud = 115200,
     .distance = robots::kCreate2Count,
     .make = make<CreateDrive>},
    {.word = "pioneer",
     .title = "Pioneer",
     .baud = 9600,
     .angle = robots::kArcosAngle,
     .slip = 0.02,
     .poll = 100'000'000,
     .make = make<PioneerDrive>},
    {.word = "khepera",
     .title = "Khepera",
     .baud = 9600,
     .stop_bits = 2,
     .distance = robots::kKheperaPulse,
     .slip = 0.002,
     .poll = 10'000'000,
     .make = make<KheperaDrive>},
    // An unknown robot, so the largest slip of the others. Drivers may take seconds to start their robot.
    {.word = "player",
     .title = "robot behind Player",
     .behind_server = true,
     .slip = 0.02,
     .most_bytes = 256u << 10,
     .restart = 10'000'000'000,
     .poll = 10'000'000,
     .make = make<PlayerDrive>},
    {.word = "emulated",
     .title = "emulated robot",
     .emulated = true,
     .distance = 1e-4,
     .poll = 10'000'000,
     .make = make<EmulatedDrive>}};

/// The line of a robot without one.
class NoLine final : public netio::ByteLine {
 public:
  NoLine() : ByteLine({}, 0) {}

 private:
  std::optional<std::size_t> receive(std::span<std::uint8_t>) override { return 0; }
  std::optional<std::size_t> send(std::span<const std::uint8_t> bytes) override { return bytes.size(); }
};

}  // namespace

std::span<const RealRobotType> real_robot_types() { return kTypes; }

const RealRobotType& real_robot_type(std::string_view word) {
  std::vector<std::string_view> words;
  for (const RealRobotType& type : kTypes) {
    if (type.word == word) return type;
    words.push_back(type.word);
  }
  throw base::InputError(fmt::format("unknown type of robot '{}'{}", word, base::expected_one_of(word, words)));
}

std::unique_ptr<RealRobot> make_real_robot(const RealRobotOptions& options, const base::Pose& X_WM, double track) {
  const RealRobotType& type = real_robot_type(options.type);
  return type.make(type, options, X_WM, track);
}

RealRobot::RealRobot(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM)
    : type_(type), options_(options) {
  if (options_.baud == 0) options_.baud = type.baud;
  line_ = open(kConnectIn);
  state_.X_WM = X_WM;
  counts_.lines = 1;
  if (type.behind_server) revived_ = 0;
  if (type.poll > 0) due_ = 0;
}

std::unique_ptr<netio::ByteLine> RealRobot::open(int wait_ms) const {
  if (type_.emulated) return std::make_unique<NoLine>();
  if (type_.behind_server) return std::make_unique<netio::TcpLine>(options_.server, wait_ms);
  return std::make_unique<netio::SerialLine>(options_.device, options_.baud, type_.stop_bits);
}

void RealRobot::update(std::int64_t now) {
  const double way = way_, turn = turn_;
  const std::uint64_t odometry = odometry_;
  receive(now);
  const double dt = 1e-9 * static_cast<double>(now - odometry_time_);
  if (odometry_ > odometry && dt > 0.0) {
    state_.velocity = {(way_ - way) / dt, 0.0, (turn_ - turn) / dt};
    odometry_time_ = now;
  }
  state_.time = now;
  if (line_ && line_->lost()) line_.reset();
  if (silent(now)) {
    state_.velocity = {};
    revive(now);
  }
  if (line_) run(now);
  if (type_.poll > 0) due_ = now + type_.poll;
}

void RealRobot::receive(std::int64_t now) {
  touched_.reset();
  std::array<std::uint8_t, 512> bytes;
  for (std::size_t all = 0, n = 1; line_ && n > 0 && all < type_.most_bytes; all += n) {
    n = line_->read(bytes);
    if (n > 0) take(std::span(bytes).first(n), now);
  }
  if (touched_) contact_ = *touched_;
}

bool RealRobot::silent(std::int64_t now) const { return now - last_.value_or(0) > kSilence; }

void RealRobot::revive(std::int64_t now) {
  const bool waits = line_ && type_.behind_server;  // for its driver
  if (waits && now - last_.value_or(0) < type_.restart) return;
  if (revived_ && now - *revived_ < (waits ? type_.restart : kRevival)) return;
  revived_ = now;
  if (type_.behind_server) line_.reset();
  try {
    if (!line_) {
      line_ = open(0);
      ++counts_.lines;
    }
    start(now);
  } catch (const base::InputError&) {
    // Still unplugged, or no server: retry later.
  }
}

bool RealRobot::write(std::span<const std::uint8_t> bytes) {
  const bool written = line_ && line_->write(bytes);
  counts_.refused += line_ && !written;
  return written;
}

void RealRobot::advance(double way, double turn) {
  const double middle = state_.X_WM.yaw + 0.5 * turn;
  state_.X_WM.x += way * base::cos(middle);
  state_.X_WM.y += way * base::sin(middle);
  state_.X_WM.yaw = base::wrap_angle(state_.X_WM.yaw + turn);
  way_ += way;
  turn_ += turn;
  ++odometry_;
}

sensors::Rolled RealRobot::rolled(double track) const {
  return {way_ - 0.5 * track * turn_, way_ + 0.5 * track * turn_};
}

void RealRobot::measured(OwnReading own) {
  const auto found = std::find_if(readings_.begin(), readings_.end(), [&](const OwnReading& each) {
    return each.type == own.type && each.sensor == own.sensor;
  });
  own.sequence = found == readings_.end() ? 0 : found->sequence + 1;
  if (found == readings_.end())
    readings_.push_back(std::move(own));
  else
    *found = std::move(own);
}

std::string RealRobot::problem(std::int64_t now) const {
  return !line_ || silent(now) || !last_ ? silence(line_ != nullptr) : fault();
}

std::string RealRobot::silence(bool connected) const {
  if (!connected) return fmt::format("the serial line {} was disconnected", options_.device);
  return fmt::format("the {} on {} is silent: switched off, or not at {} baud", type_.title, options_.device,
                     options_.baud);
}

}  // namespace sf::server
