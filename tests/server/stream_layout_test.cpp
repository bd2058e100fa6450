#include "server/stream_layout.h"

#include <gtest/gtest.h>

#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "tests/robots/scenes.h"

namespace sf::server {
namespace {

/// Returns notes on a robot with a laser that the thesis' wire format carries, and some with too many rays for it.
std::vector<std::string> notes_of(int wide) {
  world::World world = scenes::empty_world();
  std::vector<world::Sensor>& mounted = scenes::add_create(world, {}).sensors;
  mounted.push_back(sensors::laser_sensor({{.name = "narrow", .samples = 361}}));
  for (int i = 0; i < wide; ++i)
    mounted.push_back(sensors::laser_sensor({{.name = "wide" + std::to_string(i), .samples = 362}}));
  const sensors::SensorSet sensor_set(world);
  return stream_layout(
             world, sensor_set,
             {.base_ports = {{sensors::kLaser, 10'000}}, .ports_per_robot = 64, .wire = sensors::WireFormat::thesis})
      .notes;
}

TEST(StreamLayout, OmittedSensorsAreNamedUpToTwenty) {
  EXPECT_TRUE(notes_of(0).empty());
  for (const int wide : {1, 20, 21, 25}) {
    const std::vector<std::string> notes = notes_of(wide);
    ASSERT_EQ(notes.size(), static_cast<std::size_t>(std::min(wide, 21))) << wide;
    for (int i = 0; i < std::min(wide, 20); ++i)
      EXPECT_EQ(notes[i].find("left out: robot1.wide" + std::to_string(i) + ":"), 0u) << notes[i];
    const std::string more = "left out: " + std::to_string(wide - 20) + " more sensors";
    EXPECT_EQ(notes.back() == more, wide > 20) << notes.back();
  }
}

}  // namespace
}  // namespace sf::server
