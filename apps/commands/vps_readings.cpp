#include "apps/commands/vps_readings.h"

#include <chrono>
#include <cmath>

#include "apps/commands/tag_sender.h"

namespace sf::apps {

namespace {

using Color = std::array<std::uint8_t, 3>;
constexpr std::array<Color, 5> kColors{
    {{235, 200, 70}, {255, 255, 255}, {255, 110, 220}, {0, 225, 235}, {95, 110, 225}}};  // by kind
constexpr std::size_t kReceiveBuffer = 4u << 20;                                         // [byte]
constexpr std::size_t kMostAtOnce = 4096;                                                // datagrams between two images

std::int64_t now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

vision::PlaneLine drawn(const server::SightLine& line) {
  using Kind = server::SightLine::Kind;
  const bool thin = line.kind == Kind::beam || line.kind == Kind::explored;
  return {line.points, line.z, kColors[static_cast<std::size_t>(line.kind)], thin ? 1 : 2};
}

/// Returns the mover's pose from that of its tag's object, since the world may define the mount, too (`tag_pose`).
base::Pose mover_pose(const netio::Tag& object, const world::Mover& mover) {
  return netio::report({}, object, 0, mover.X_MT).X_WM;
}

}  // namespace

SeenReadings::SeenReadings(const std::string& world_file, const netio::Endpoint& bind, const vision::Testbed& testbed)
    : testbed_(testbed),
      world_(world::load_world(world_file, {.sensors = sensors::world_file_words()})),
      sensor_set_(world_),
      readings_(world_, sensor_set_),
      socket_(netio::open_udp(bind, {.receive = kReceiveBuffer})) {}

std::optional<std::uint32_t> SeenReadings::mover_of(std::uint32_t tag) const {
  const std::uint32_t robot = testbed_.mount(tag).robot.value_or(tag);
  std::optional<std::uint32_t> found;
  for (std::uint32_t m = 0; m < world_.movers.size(); ++m) {
    const world::Mover& mover = world_.movers[m];
    if (mover.id == (mover.is_tag ? tag : robot) && (!found || mover.is_tag)) found = m;
  }
  return found;
}

std::span<const vision::PlaneLine> SeenReadings::lines(std::span<const vision::TrackedTag> tags) {
  const std::int64_t time = now();
  batch_.drain(socket_, kMostAtOnce,
               [&](std::span<const std::uint8_t> bytes, const netio::Endpoint&) { readings_.accept(bytes, time); });
  sights_.clear();
  readings_.add_maps(time, sights_);
  for (const vision::TrackedTag& tag : tags)
    if (const auto mover = mover_of(tag.id))
      readings_.add_lines(*mover, mover_pose(object_state(tag, testbed_.mount(tag.id)), world_.movers[*mover]), time,
                          sights_);
  lines_.clear();
  for (const server::SightLine& sight : sights_) lines_.push_back(drawn(sight));
  return lines_;
}

}  // namespace sf::apps
