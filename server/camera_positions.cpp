#include "server/camera_positions.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace sf::server {

namespace {

StateFilterOptions enabled(StateFilterOptions options) {
  options.enabled = true;
  return options;
}

}  // namespace

double PositionErrors::rms() const { return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0; }

void add(PositionErrors& errors, const base::Pose& estimate, const base::Pose& truth) {
  const double error = std::hypot(estimate.x - truth.x, estimate.y - truth.y);
  ++errors.count;
  errors.squares += error * error;
  errors.largest = std::max(errors.largest, error);
  errors.largest_heading = std::max(errors.largest_heading, std::abs(base::wrap_angle(estimate.yaw - truth.yaw)));
}

CameraPositions::CameraPositions(const world::World& world, std::uint32_t mover, std::uint32_t tag,
                                 const CameraPositionsOptions& options)
    : mover_(mover),
      inbox_({.bind = options.bind,
              .receive_buffer = std::size_t{1} << 18,
              .tags = {tag},
              .peers = options.peers,
              .take_late = options.filter.clock.source != estimation::ClockSource::arrival}),
      filter_(world, enabled(options.filter)) {}

void CameraPositions::receive(std::int64_t now) {
  inbox_.receive(now, [&](const netio::Packet& packet) {
    if (const auto* tag = std::get_if<netio::Tag>(&packet.body))
      filter_.take(netio::report(packet.header, *tag, mover_), packet.header, now);
  });
}

void CameraPositions::predict(std::int64_t now) {
  for (const base::Report& report : filter_.predict(now)) {
    state_ = report;
    trail_.add(now, report.X_WM);
  }
}

}  // namespace sf::server
