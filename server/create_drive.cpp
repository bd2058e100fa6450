#include "server/create_drive.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "base/error.h"

namespace sf::server {

namespace {

constexpr std::int64_t kSilence = 500'000'000;    // [ns] 33 frames
constexpr std::int64_t kRevival = 1'000'000'000;  // [ns] between attempts
constexpr std::size_t kMostBytes = 8192;          // read per update: more than one second at 57600 baud

}  // namespace

CreateDrive::CreateDrive(const CreateOptions& options, const base::Pose& X_WM, double track)
    : options_(options), track_(track), line_(std::in_place, options.device, options.baud) {
  state_.X_WM = X_WM;
  counts_.lines = 1;
  start();
}

void CreateDrive::start() {
  stream_.reset();
  lifted_ = false;
  counts_.starts += line_->write(robots::create_start());
}

void CreateDrive::update(std::int64_t now) {
  const base::Pose before = state_.X_WM;
  if (receive()) last_ = now;
  const double dt = 1e-9 * static_cast<double>(now - state_.time);
  if (dt > 0.0) {
    const glm::dvec2 way = base::rotate(-before.yaw, {state_.X_WM.x - before.x, state_.X_WM.y - before.y});
    const double turn = base::wrap_angle(state_.X_WM.yaw - before.yaw);
    state_.velocity = {std::copysign(glm::length(way), way.x) / dt, 0.0, turn / dt};
  }
  state_.time = now;
  if (line_ && line_->lost()) line_.reset();
  if (silent(now)) revive(now);
}

/// Returns whether a frame arrived.
bool CreateDrive::receive() {
  bool came = false, bumped = false, dropped = false;
  std::array<std::uint8_t, 512> bytes;
  for (std::size_t all = 0, n = 1; line_ && n > 0 && all < kMostBytes; all += n) {
    n = line_->read(bytes);
    for (std::size_t i = 0; i < n; ++i)
      if (const auto frame = stream_.take(bytes[i])) {
        take(*frame);
        came = true;
        bumped = bumped || frame->bumped;
        dropped = dropped || frame->wheel_drop;
      }
  }
  if (came) contact_ = bumped || dropped;
  return came;
}

/// Integrates the motion along an arc.
void CreateDrive::take(const robots::CreateFrame& frame) {
  frame_ = frame;
  const double way = 1e-3 * frame.distance, turn = frame.angle * M_PI / 180.0, middle = state_.X_WM.yaw + 0.5 * turn;
  state_.X_WM.x += way * std::cos(middle);
  state_.X_WM.y += way * std::sin(middle);
  state_.X_WM.yaw = base::wrap_angle(state_.X_WM.yaw + turn);
  rolled_.left += way - 0.5 * track_ * turn;
  rolled_.right += way + 0.5 * track_ * turn;
  // People put a lifted robot down where it may drive, so it resumes. At a cliff, it waits for them.
  lifted_ = (lifted_ || frame.wheel_drop) && frame.mode != robots::CreateFrame::safe;
  if (lifted_ && !frame.wheel_drop && frame.mode == robots::CreateFrame::passive && line_)
    line_->write(robots::create_safe());
}

bool CreateDrive::silent(std::int64_t now) const { return now - last_.value_or(0) > kSilence; }

void CreateDrive::revive(std::int64_t now) {
  if (revived_ && now - *revived_ < kRevival) return;
  revived_ = now;
  try {
    if (!line_) {
      line_.emplace(options_.device, options_.baud);
      ++counts_.lines;
    }
    start();
  } catch (const base::InputError&) {
    // Still unplugged: retry later.
  }
}

void CreateDrive::drive(const base::Twist& twist, std::int64_t now) {
  if (!line_) return;
  const robots::CreateWheels wheels = ready(now) ? robots::create_wheels(twist, track_) : robots::CreateWheels{};
  counts_.refused += !line_->write(robots::create_drive(wheels));
}

void CreateDrive::stop() {
  if (!line_) return;
  line_->write(robots::create_stop());
  line_->drain();
}

std::string CreateDrive::problem(std::int64_t now) const {
  if (!line_) return fmt::format("the serial line {} was disconnected", options_.device);
  if (silent(now) || !last_)
    return fmt::format("the Create on {} is silent: switched off, or not at {} baud", options_.device, options_.baud);
  if (frame_.wheel_drop) return "the Create is lifted";
  if (frame_.mode == robots::CreateFrame::passive || frame_.mode == robots::CreateFrame::off)
    return lifted_ ? "the Create was lifted"
                   : "the Create has left safe mode: at a cliff, or its charger is plugged in";
  return {};
}

CreateCounts CreateDrive::counts() const {
  CreateCounts counts = counts_;
  counts.frames = stream_.frames();
  counts.wrong_checksums = stream_.wrong_checksums();
  counts.skipped_bytes = stream_.skipped();
  return counts;
}

}  // namespace sf::server
