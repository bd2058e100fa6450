// Images of cameras in packets: whole readings, lost, late and invalid parts, and a robot that drives by them.

#include "server/received_camera.h"

#include "sensors/image_packets.h"
#include "tests/server/fixture.h"
#include "world/stage/build_world.h"

namespace sf::server {
namespace {

world::World world_of(const std::string& text) {
  return world::build_world("camera.world", text, {.sensors = sensors::world_file_words()});
}

/// A camera of 40 x 40 pixels, whose images of noise take several parts.
struct PlayedCamera {
  /// Each pixel's colour depends on its place and the reading.
  static double color_of(std::size_t pixel, std::uint32_t sequence) {
    std::uint32_t x = 2654435761u * static_cast<std::uint32_t>(pixel + 1) + sequence;
    x = (x ^ x >> 15) * 2246822519u;  // noise, which PNG cannot compress
    return static_cast<double>((x ^ x >> 13) & 0xFFFFFFu);
  }
  std::string file(std::uint32_t sequence) const {
    std::vector<double> values;
    for (std::size_t i = 0; i < 1600; ++i) values.insert(values.end(), {1.0, color_of(i, sequence)});
    const base::ReadingBlock reading{.type = sensors::kCamera, .values = values};
    return sensors::image_file(sensor_set, reading).bytes;
  }
  void take_part(std::uint32_t sequence, std::uint32_t part, const std::string& of) {
    base::Bytes payload;
    sensors::encode_image({of}, part, payload);
    camera.take_part(sequence, payload);
  }
  /// @param without one part, or none
  void take_image(std::uint32_t sequence, std::uint32_t without = UINT32_MAX) {
    const std::string all = file(sequence);
    for (std::uint32_t part = sensors::image_parts(all.size()); part-- > 0;)
      if (part != without) take_part(sequence, part, all);
  }
  void take_depths(std::uint32_t sequence) {
    const std::vector<double> values(3200, 0.25 * sequence);
    camera.take_depths({.sequence = sequence, .time = 10 * sequence, .values = values});
  }
  /// Checks that this is the newest reading, with each colour at its place.
  void expect_newest(std::uint32_t sequence) const {
    const auto newest = camera.newest();
    ASSERT_TRUE(newest);
    EXPECT_EQ(newest->sequence, sequence);
    EXPECT_EQ(newest->time, 10 * sequence);
    ASSERT_EQ(newest->values.size(), 3200u);
    for (std::size_t i = 0; i < 1600; ++i) {
      ASSERT_EQ(newest->values[2 * i], 0.25 * sequence);
      ASSERT_EQ(newest->values[2 * i + 1], color_of(i, sequence)) << i;
    }
  }

  world::World world = world_of("position( camera( resolution [40 40] rgb 1 ) )");
  sensors::SensorSet sensor_set{world};
  ReceivedCamera camera{sensor_set.settings_of<sensors::CameraSettings>(sensors::kCamera, 0)[0]};
};

TEST(ReceivedCamera, ReadingsHaveDepthsAndImage) {
  PlayedCamera p;
  ASSERT_GT(sensors::image_parts(p.file(1).size()), 2u);
  p.take_depths(1);
  EXPECT_FALSE(p.camera.newest()) << "no image";
  p.take_image(1);
  p.expect_newest(1);
  p.take_image(2);
  p.expect_newest(1);  // no depths of 2
  p.take_depths(2);
  p.expect_newest(2);
}

TEST(ReceivedCamera, ImagesWithALostPartAreReplaced) {
  PlayedCamera p;
  p.take_depths(1), p.take_image(1);
  p.take_depths(2), p.take_image(2, 1);
  p.expect_newest(1);
  p.take_depths(3), p.take_image(3);
  p.expect_newest(3);
  p.take_part(2, 1, p.file(2));  // late
  p.take_part(3, 1, p.file(3));  // again
  p.expect_newest(3);
  EXPECT_EQ(p.camera.counts().whole, 2u);
}

TEST(ReceivedCamera, SendersMayRestart) {
  PlayedCamera p;
  p.take_depths(5000), p.take_image(5000);
  p.take_depths(3), p.take_image(3);
  p.expect_newest(3);  // far behind, without a new session
  p.camera.restart();
  EXPECT_FALSE(p.camera.newest());
  p.take_depths(1), p.take_image(1);
  p.expect_newest(1);
}

TEST(ReceivedCamera, InvalidFilesAreCounted) {
  PlayedCamera p;
  const std::string good = p.file(1);
  std::string cut = good, flipped = good;
  cut.resize(good.size() / 2);
  flipped[good.size() / 2] = static_cast<char>(~flipped[good.size() / 2]);
  std::uint32_t sequence = 0;
  for (const std::string& bad : {cut, flipped, std::string("no picture")}) {
    p.take_depths(++sequence);
    for (std::uint32_t part = 0; part < sensors::image_parts(bad.size()); ++part) p.take_part(sequence, part, bad);
    EXPECT_EQ(p.camera.counts().invalid, sequence);
  }
  p.camera.take_part(9, {});
  EXPECT_FALSE(p.camera.newest());
  p.take_depths(10);
  p.take_part(10, 0, p.file(10) + "longer");  // two files with one number: the first one counts
  p.take_image(10);
  EXPECT_FALSE(p.camera.newest());
  p.take_depths(11), p.take_image(11);
  p.expect_newest(11);
}

TEST(ReceivedCamera, ImagesMayBeGreyOrJpeg) {
  for (const char* format : {"mono 1", "rgb 1 jpeg 95", "mono 1 jpeg 95"}) {
    const world::World world = world_of("position( camera( resolution [40 40] " + std::string(format) + " ) )");
    const sensors::SensorSet sensor_set(world);
    std::vector<double> values;
    for (int i = 0; i < 1600; ++i) values.insert(values.end(), {1.0, 0x606060});
    const base::ReadingBlock reading{.type = sensors::kCamera, .values = values};
    const sensors::ImageFile file = sensors::image_file(sensor_set, reading);
    ASSERT_LE(file.bytes.size(), sensors::kImagePartBytes);
    base::Bytes payload;
    sensors::encode_image(file, 0, payload);
    ReceivedCamera camera(sensor_set.settings_of<sensors::CameraSettings>(sensors::kCamera, 0)[0]);
    camera.take_depths({.values = values});
    camera.take_part(0, payload);
    ASSERT_TRUE(camera.newest()) << format;
    EXPECT_EQ(camera.newest()->values[1], 0x606060) << format;
  }
}

// The world of `lane-camera`: without the images it stands still.
TEST(RobotClient, KeepsItsLaneByTheImagesOfPackets) {
  Settings settings;
  settings.controller = "lane-camera";
  settings.world = world_of(
      "path( name \"street\" pose [0 0 0 0] pieces 1 straight[0] [20 0.5] left \"double_yellow\" right \"solid_white\" "
      ")"
      "position( name \"r0\" size [0.3 0.3 0.1] pose [1 0.03 0 2] velocity_bounds [-1 1 -1 1 0 0 -120 120]\n"
      "camera( resolution [160 120] fov 90 range [0 8] rgb 1 rate 10 size [0.03 0.03 0.03] "
      "pose6 [0.1 0 0.185 0 32 0] ) )");
  Fixture f(settings);
  f.run(40);
  const RobotClientStats stats = f.client->stats();
  ASSERT_TRUE(stats.link.images);
  EXPECT_GE(stats.link.images->whole, 35u);
  EXPECT_EQ(stats.link.images->invalid, 0u);
  EXPECT_GT(stats.distance_m, 0.2);
  EXPECT_LT(std::abs(stats.pose.y), 0.05);
  EXPECT_EQ(stats.stop_reason, "");
}

TEST(RobotClient, StatesWhyItStandsStill) {
  Settings settings;
  settings.controller = "lane-camera";
  settings.world = world_of("position( name \"r0\" camera( resolution [40 30] rgb 1 rate 10 ) )");
  Fixture f(settings);
  f.run(5);
  EXPECT_EQ(f.client->stats().stop_reason, "its camera sees no lane");
}

}  // namespace
}  // namespace sf::server
