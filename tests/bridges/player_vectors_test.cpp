// The bytes written and expected by Player's own library (../shared/data/player).

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "bridges/player/wall_map.h"
#include "sensors/laser.h"
#include "tests/bridges/player_client.h"

namespace sf::bridges::player {

namespace {

/// Bytes by name; a name without bytes has only a size.
struct PlayerVectors {
  std::map<std::string, base::Bytes> bytes;
  std::map<std::string, std::size_t> sizes;
};

PlayerVectors read_player_vectors(const std::string& path) {
  PlayerVectors vectors;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) {
      const std::size_t blank = line.rfind(' ');
      if (blank != std::string::npos) vectors.sizes[line.substr(0, blank)] = std::stoul(line.substr(blank));
      continue;
    }
    base::Bytes& bytes = vectors.bytes[line.substr(0, line.rfind(" ("))];
    std::istringstream words(line.substr(colon + 1));
    for (std::string word; words >> word;) {
      const auto value = static_cast<std::uint32_t>(std::stoul(word, nullptr, 16));
      for (const int shift : {24, 16, 8, 0}) bytes.push_back(static_cast<std::uint8_t>(value >> shift));
    }
  }
  return vectors;
}

struct PlayerVectorsTest : testing::Test {
  void SetUp() override {
    const std::string path = SF_SOURCE_DIR "/../shared/data/player/golden_vectors.txt";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared data next to the sources";
    vectors = read_player_vectors(path);
    ASSERT_GT(vectors.bytes.size(), 15u);
  }
  base::Bytes encoded(const Device& device, const std::vector<double>& values) {
    base::Bytes out;
    XdrWriter xdr(out);
    LastReading reading;
    reading.values = values, reading.sequence = 5;
    put_reading(device, reading, {}, false, xdr);
    return out;
  }
  PlayerVectors vectors;
};

}  // namespace

TEST_F(PlayerVectorsTest, Headers) {
  base::Bytes out;
  put_header({0x7F000001, 6665, {Interface::laser, 2}, MessageType::data, 1, 1.5, 7, 60}, out);
  EXPECT_EQ(out, vectors.bytes["msghdr"]);
  const Header header = read_header(out);
  EXPECT_EQ(header.robot, 6665u);
  EXPECT_EQ(header.address, (Address{Interface::laser, 2}));
  EXPECT_EQ(header.time, 1.5);
  EXPECT_EQ(header.sequence, 7u);
  EXPECT_EQ(header.size, 60u);
}

TEST_F(PlayerVectorsTest, Readings) {
  sensors::SensorSpec spec;
  spec.elements = 3, spec.fov = 2.0, spec.limit = 8.0;
  Device device{.interf = Interface::laser, .sensor = &spec, .type = sensors::kLaser};
  for (const float value : {-1.0f, 1.0f, 1.0f, 8.0f}) XdrWriter(device.config).put(value);
  base::Bytes scan = vectors.bytes["laser_data"];
  for (const std::size_t intensity : {44, 45, 46}) scan.at(intensity) = 0;  // lasers here have none
  EXPECT_EQ(encoded(device, {1.0, 2.0, 3.0}), scan);
  device.interf = Interface::ranger;
  EXPECT_EQ(encoded(device, {1.0, 2.0}), vectors.bytes["ranger_range"]);
  device.interf = Interface::sonar;
  EXPECT_EQ(encoded(device, {1.0, 2.0}), vectors.bytes["sonar"]);
  device.interf = Interface::bumper;
  EXPECT_EQ(encoded(device, {1.0, 0.0}), vectors.bytes["bumper"]);
  device.interf = Interface::gps;
  EXPECT_EQ(encoded(device, {1.0, 0.0, 1.0, 5.0}).size(), vectors.sizes["gps"]);
}

TEST_F(PlayerVectorsTest, States) {
  base::Bytes out;
  XdrWriter xdr(out);
  put_state({1.0, 2.0, 0.0, 0.5}, {.velocity = {0.1, 0.0, 0.0}}, true, xdr);
  EXPECT_EQ(out, vectors.bytes["position2d_data"]);
}

TEST_F(PlayerVectorsTest, GeometriesHaveTheirSizes) {
  const PlayerRun run;
  const Devices devices(run.world, run.sensor_set);
  const auto find = [&](Interface interf) {
    return *std::find_if(devices.rows().begin(), devices.rows().end(),
                         [&](const Device& d) { return d.interf == interf; });
  };
  EXPECT_EQ(find(Interface::laser).geometry.size(), vectors.sizes["laser_geom"]);
  EXPECT_EQ(find(Interface::laser).config.size(), vectors.sizes["laser_config"]);
  EXPECT_EQ(find(Interface::position2d).geometry.size(), vectors.sizes["position2d_geom"]);
  EXPECT_EQ(find(Interface::ranger).config.size(), vectors.sizes["ranger_config"]);
  EXPECT_EQ(find(Interface::ranger).geometry.size(), vectors.sizes["ranger_geom empty"] + 48 + 24) << "one element";
}

/// Messages of an unmodified client are parsed and answered in its format.
TEST_F(PlayerVectorsTest, ConversationOfAClient) {
  PlayerRun run;
  TestClient client(run.port());
  client.banner();
  const auto request = [&](std::uint32_t subtype, const std::string& name) {
    return client.request({}, subtype, vectors.bytes.at(name)).header.type;
  };
  EXPECT_EQ(request(server_request::data_mode, "datamode PULL"), MessageType::ack);
  EXPECT_EQ(request(server_request::replace_rule, "replace_rule"), MessageType::ack);
  EXPECT_EQ(request(server_request::device, "device_req (REQ)"), MessageType::ack);  // laser 0
  client.open(kPosition);
  client.send(MessageType::command, kPosition, 1, vectors.bytes["cmd_vel"]);
  EXPECT_EQ(client.request(kSimulation, 2, vectors.bytes["sim pose2d"]).header.type, MessageType::nack)
      << "no robot r0";
  const Requests asked = run.asked();
  ASSERT_EQ(asked.commands.size(), 1u);
  EXPECT_EQ(asked.commands[0].twist.forward, 0.1);
}

TEST_F(PlayerVectorsTest, MapTile) {
  base::Bytes out;
  XdrWriter xdr(out);
  record::WorldShape shape{.columns = 5, .rows = 1, .occupied = std::vector<bool>(5)};
  ASSERT_TRUE(put_map_tile(shape, {0, 0, 5, 1}, xdr));
  XdrReader ours(out), theirs(vectors.bytes["map_data (uncompressed for illustration)"]);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(ours.get(), theirs.get()) << i;
  EXPECT_EQ(theirs.get(), 5u);
  const std::uint32_t packed = ours.get();
  EXPECT_EQ(ours.get(), theirs.get()) << "range of the cells";
  EXPECT_EQ(ours.get(), packed);
  shape.columns = 0;
  EXPECT_FALSE(put_map_tile(shape, {0, 0, 5, 1}, xdr)) << "no map";
}

}  // namespace sf::bridges::player
