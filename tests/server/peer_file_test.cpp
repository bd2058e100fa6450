#include "server/peer_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "tests/refusal.h"

namespace sf::server {
namespace {

using netio::PeerKind;

constexpr const char* kKeyText = "000102030405060708090a0b0c0d0e0f101112131415161718191A1B1C1D1E1F";

/// Robots 1 and 2, tag 3.
world::World lab() {
  world::World world;
  for (const std::uint32_t id : {1u, 2u, 3u}) {
    world::Mover& mover = world.movers.emplace_back();
    mover.id = id;
    mover.is_tag = id == 3;
  }
  return world;
}

std::vector<netio::Peer> parse(const std::string& text) {
  const world::World world = lab();
  return parse_peers("peers.toml", text, &world);
}

/// Returns the error of a file.
std::string error_of(const std::string& text) {
  return refusal_of([&] { parse(text); });
}

TEST(PeerFile, ReadsAddressesAndKeys) {
  const auto peers =
      parse(std::string("[[peer]]\nrobot = 2\nkey = \"") + kKeyText +
            "\"\n[[peer]]\ntag = 3\naddress = \"192.168.1.7\"\n[[peer]]\nstart = true\naddress = \"10.0.0.1\"\n");
  ASSERT_EQ(peers.size(), 3u);
  EXPECT_EQ(peers[0].kind, PeerKind::robot);
  EXPECT_EQ(peers[0].id, 2u);
  ASSERT_TRUE(peers[0].key);
  for (std::size_t i = 0; i < netio::kKeyBytes; ++i) EXPECT_EQ((*peers[0].key)[i], i);
  EXPECT_FALSE(peers[0].address);
  EXPECT_EQ(peers[1].kind, PeerKind::tag);
  EXPECT_EQ(peers[1].address, 0xC0A80107u);
  EXPECT_FALSE(peers[1].key);
  EXPECT_EQ(peers[2].kind, PeerKind::start);
}

TEST(PeerFile, ReadsThePermissionOfTheControlCentre) {
  const auto peers = parse("[[peer]]\ncentre = true\naddress = \"10.0.0.9\"\n");
  ASSERT_EQ(peers.size(), 1u);
  EXPECT_EQ(peers[0].kind, PeerKind::centre);
  EXPECT_EQ(peers[0].address, 0x0A000009u);
  EXPECT_NE(error_of("[[peer]]\ncentre = true").find("requires an address, a key"), std::string::npos);
  EXPECT_NE(error_of("[[peer]]\ncentre = false").find("'centre' expects true"), std::string::npos);
}

TEST(PeerFile, ReadsTheKeyOfTheGroup) {
  const auto peers = parse(std::string("[[peer]]\ngroup = true\nkey = \"") + kKeyText + "\"\n");
  ASSERT_EQ(peers.size(), 1u);
  EXPECT_EQ(peers[0].kind, PeerKind::group);
  EXPECT_TRUE(peers[0].key);
}

TEST(PeerFile, ErrorsNameTheirLine) {
  const auto expect = [](const std::string& text, const std::string& place, const std::string& part) {
    const std::string error = error_of(text);
    EXPECT_EQ(error.rfind(place, 0), 0u) << error;
    EXPECT_NE(error.find(part), std::string::npos) << error;
  };
  expect("", "peers.toml", "has no peer");
  expect("peers = 1", "peers.toml:1", "unknown key 'peers'");
  expect("peer = 1", "peers.toml:1", "each under [[peer]]");
  expect("[[peer]]\naddress = \"10.0.0.1\"", "peers.toml:1",
         "robot = ID, tag = ID, light = ID, start = true, centre = true, or");
  expect("[[peer]]\nrobot = 1\ntag = 3", "peers.toml:3", "'robot' or 'tag', not both");
  expect("[[peer]]\nrobot = 1\nstart = true", "peers.toml:3", "not both");
  expect("[[peer]]\nrobot = 3", "peers.toml:2", "no robot with the id 3; it has 1, 2");
  expect("[[peer]]\ntag = 1", "peers.toml:2", "no tag with the id 1");
  expect("[[peer]]\ntag = 0", "peers.toml:2", "from 1 to 65535");
  expect("[[peer]]\nrobot = 65536", "peers.toml:2", "from 0 to 65535");
  expect("[[peer]]\nrobot = 1.5", "peers.toml:2", "whole number");
  expect("[[peer]]\nrobot = \"1\"", "peers.toml:2", "whole number");
  expect("[[peer]]\nstart = false", "peers.toml:2", "'start' expects true");
  expect("[[peer]]\nstart = 1", "peers.toml:2", "true or false");
  expect("[[peer]]\ngroup = false", "peers.toml:2", "'group' expects true");
  expect("[[peer]]\ngroup = true", "peers.toml:1", "requires an address, a key");
  expect("[[peer]]\ngroup = true\naddress = \"239.255.0.1\"", "peers.toml:3", "no address");
  expect("[[peer]]\nrobot = 1\n[[peer]]\ntag = 3\n[[peer]]\nrobot = 1", "peers.toml:6", "twice");
  expect("[[peer]]\nstart = true\n[[peer]]\nstart = true", "peers.toml:4", "twice");
  expect("[[peer]]\nrobot = 1\nadress = \"10.0.0.1\"", "peers.toml:3", "address");
  expect("[[peer]]\nrobot = 1\naddress = 10", "peers.toml:3", "text in quotes");
  for (const char* address : {"localhost", "10.0.0", "10.0.0.256", "10.0.0.1:9000", " 10.0.0.1"})
    expect(std::string("[[peer]]\nrobot = 1\naddress = \"") + address + "\"", "peers.toml:3", "IPv4 address");
  expect("[[peer]]\nrobot = 1\nkey = 12", "peers.toml:3", "text in quotes");
  expect("[[peer]]\nrobot = 1\nkey = \"\"", "peers.toml:3", "text in quotes");
  // Such a peer would not be checked at all, not even the last of two.
  expect("[[peer]]\nrobot = 1", "peers.toml:1", "requires an address, a key");
  expect("[[peer]]\nstart = true", "peers.toml:1", "requires an address, a key");
  expect("[[peer]]\nrobot = 1\naddress = \"10.0.0.1\"\n[[peer]]\nlight = 4", "peers.toml:4",
         "requires an address, a key");
}

/// Boundaries: one digit fewer and more, and a character that is not a digit, at either place of a byte.
TEST(PeerFile, KeysAre64HexadecimalDigitsAndNeverPrinted) {
  const std::string key = kKeyText;
  for (const std::string& bad :
       {key.substr(1), key + "0", key.substr(0, 63) + "g", "g" + key.substr(1), key.substr(0, 62) + "0x",
        "-1" + key.substr(2), "+1" + key.substr(2), " 1" + key.substr(2), "0 " + key.substr(2)}) {
    const std::string error = error_of("[[peer]]\nrobot = 1\nkey = \"" + bad + "\"");
    EXPECT_EQ(error.rfind("peers.toml:3", 0), 0u) << error;
    EXPECT_NE(error.find("64 hexadecimal digits, as `openssl rand -hex 32`"), std::string::npos) << error;
    EXPECT_EQ(error.find(key.substr(8, 8)), std::string::npos) << error;
  }
}

TEST(PeerFile, OnlyTagsShareAKey) {
  const std::string key = std::string("\nkey = \"") + kKeyText + "\"\n";
  const auto pair = [&](const std::string& one, const std::string& other) {
    return "[[peer]]\n" + one + key + "[[peer]]\n" + other + key;
  };
  for (const auto& [one, other] : {std::pair("robot = 1", "robot = 2"), std::pair("robot = 1", "start = true"),
                                   std::pair("tag = 3", "robot = 1"), std::pair("start = true", "tag = 3")})
    EXPECT_EQ(error_of(pair(one, other)).rfind("peers.toml:6: another peer has this key", 0), 0u) << one;
  EXPECT_EQ(parse_peers("peers.toml", pair("tag = 3", "tag = 4"), nullptr).size(), 2u);
}

TEST(PeerFile, IsBounded) {
  std::string text;
  for (std::size_t id = 0; id <= kMaxPeers; ++id)
    text += "[[peer]]\nrobot = " + std::to_string(id) + "\naddress = \"10.0.0.1\"\n";
  EXPECT_THROW(parse_peers("peers.toml", text, nullptr), base::InputError);
  text.resize(text.rfind("[[peer]]"));
  EXPECT_EQ(parse_peers("peers.toml", text, nullptr).size(), kMaxPeers) << "without a world any id is known";
}

TEST(PeerFile, DetectsModesOpenToOthers) {
  const std::string file = testing::TempDir() + "peers.toml";
  std::ofstream(file) << "[[peer]]\nrobot = 1\naddress = \"10.0.0.1\"\n";
  using std::filesystem::perms;
  const auto is_open = [&](perms mode) {
    std::filesystem::permissions(file, mode);
    return is_open_to_others(file);
  };
  EXPECT_FALSE(is_open(perms::owner_all));
  for (const perms one : {perms::group_read, perms::group_write, perms::others_read, perms::others_exec})
    EXPECT_TRUE(is_open(perms::owner_read | perms::owner_write | one));
  const world::World world = lab();
  EXPECT_EQ(read_peers(file, &world).size(), 1u);
  std::filesystem::remove(file);
  EXPECT_FALSE(is_open_to_others(file)) << "no such file: reading says so";
  EXPECT_THROW(read_peers(file, &world), base::InputError);
}

}  // namespace
}  // namespace sf::server
