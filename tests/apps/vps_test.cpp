// `vps`: from images to packets.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <semaphore>
#include <thread>

#include "apps/options/camera_inputs.h"
#include "base/elapsed.h"
#include "netio/outbox.h"
#include "netio/packets.h"
#include "netio/signature.h"
#include "netio/socket.h"
#include "sensors/laser.h"
#include "sensors/occupancy.h"
#include "sensors/sensor_set.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/bridges/raw_client.h"
#include "tests/viz/png.h"
#include "vision/tag_family.h"

namespace sf {

namespace {

constexpr const char* kTestbed =
    "dictionary = \"aruco_4x4_50\"\n"
    "tag_side = 0.15\n"
    "tag_height = 0.2\n"
    "[[camera]]\n"
    "name = \"a\"\n"
    "size = [320, 240]\n"
    "focal = [400, 400]\n"
    "position = [0, 0, 2.2]\n"
    "[[tag]]\n"
    "id = 1\n"
    "[[tag]]\n"
    "id = 2\n"
    "offset = [0.1, 0, 90]\n";

/// A reading of the first robot as `serve --mirror` sends it.
base::Bytes mirrored(const std::string& world_file, std::uint8_t sensor_type, const std::vector<double>& values,
                     std::uint32_t sequence) {
  const world::World world = world::load_world(world_file, {.sensors = sensors::world_file_words()});
  const sensors::SensorSet sensor_set(world);
  base::ReadingBlock block;
  block.type = sensor_type, block.values = values;
  netio::Header header;
  header.robot = static_cast<std::uint16_t>(world.movers[0].id);
  header.sequence = sequence;
  header.time = std::int64_t{100'000'000} * sequence;
  base::Bytes payload, packet;
  const auto& type = *sensor_set.group(sensor_type)->type;
  const std::uint8_t kind = type.encode(sensor_set.row(block), block, sensors::WireFormat::farm, 0, payload);
  netio::encode_reading(header, kind, payload, packet);
  return packet;
}

}  // namespace

TEST(Vps, RenderedImagesGivePosesPicturesAndPackets) {
  const Folder folder;
  const std::string testbed = folder.write("t.toml", kTestbed);
  const netio::Socket socket = netio::open_udp({netio::kLoopback, 0});
  const std::string address = netio::endpoint_text(netio::bound_endpoint(socket));
  const std::string peers = folder.write("peers.toml", "[[peer]]\ntag = 2\nkey = \"" + std::string(64, '5') + "\"\n");
  const Outcome outcome =
      run_successfully({"vps", testbed, "--rendered", "2", "--images", "4", "--send", address, "--track",
                        folder.path("track.csv"), "--overlay", folder.path("pictures"), "--peers", peers});
  EXPECT_NE(outcome.out.find("0, 0 of 8 reported"), std::string::npos) << outcome.out;  // missed, false
  EXPECT_NE(outcome.out.find("8 sent, 0 failed"), std::string::npos) << outcome.out;
  scenes::expect_painted(folder.path("pictures/a-000003.png"), {{0xFF56E078u, 20}, {0xFFFFA028u, 5}});  // tags, x axes

  // Two tags in each of four images.
  std::map<std::uint16_t, std::uint32_t> count;
  std::map<std::uint16_t, netio::Packet> last;
  netio::SigningKey key;
  key.fill(0x55);
  netio::SignatureChecker checker(key);
  netio::ReceiveBatch batch(16);
  const std::size_t received = batch.fill(socket);
  ASSERT_EQ(received, 8u);
  for (std::size_t i = 0; i < received; ++i) {
    netio::Packet packet;
    ASSERT_EQ(netio::decode(batch.bytes(i), packet), netio::PacketStatus::accepted);
    ASSERT_EQ(packet.header.type, netio::Type::tag);
    EXPECT_EQ(packet.header.sequence, count[packet.header.robot]++);
    EXPECT_NE(packet.header.session, 0u);
    EXPECT_EQ(checker.check(batch.bytes(i)),
              packet.header.robot == 2 ? netio::PacketStatus::accepted : netio::PacketStatus::not_signed);
    last[packet.header.robot] = packet;
  }
  EXPECT_EQ(count[1], 4u);
  EXPECT_EQ(count[2], 4u);
  EXPECT_NEAR(static_cast<double>(last[1].header.time - last[2].header.time), 0.0, 1e9);

  // The packet of tag 1 matches the last line of the track about it; that of tag 2 has its object's pose.
  std::istringstream lines(read_file(folder.path("track.csv")));
  std::string line;
  std::map<int, std::array<double, 3>> poses;
  while (std::getline(lines, line)) {
    double time = 0.0, x = 0.0, y = 0.0, yaw = 0.0;
    int id = 0;
    if (std::sscanf(line.c_str(), "%lf,%d,%lf,%lf,%lf", &time, &id, &x, &y, &yaw) == 5) poses[id] = {x, y, yaw};
  }
  const auto& one = std::get<netio::Tag>(last[1].body);
  EXPECT_NEAR(one.position[0], poses[1][0], 1e-6);
  EXPECT_NEAR(one.position[1], poses[1][1], 1e-6);
  EXPECT_NEAR(one.orientation[2], std::sin(0.5 * poses[1][2]), 1e-6);
  const auto& two = std::get<netio::Tag>(last[2].body);
  const double yaw = poses[2][2] - M_PI / 2.0;
  EXPECT_NEAR(two.position[0], poses[2][0] - 0.1 * std::cos(yaw), 1e-5);
  EXPECT_NEAR(two.position[1], poses[2][1] - 0.1 * std::sin(yaw), 1e-5);
  for (const netio::Tag& each : {one, two}) EXPECT_NEAR(each.position[2], 0.0, 1e-6) << "the object is on the floor";
  EXPECT_NEAR(std::abs(two.orientation[3]), std::abs(std::cos(0.5 * yaw)), 1e-5);
}

/// The second line of the testbed file, so that its other lines keep their numbers.
static std::string testbed_with(const std::string& line) {
  return std::string(kTestbed).replace(std::string(kTestbed).find("tag_side"), 0, line + "\n");
}

TEST(Vps, WaitsForTheSightingFromWhichTagsAreReported) {
  const Folder folder;
  const std::string testbed = folder.write("t.toml", testbed_with("report_from = 2"));
  const Outcome outcome = run_successfully({"vps", testbed, "--rendered", "2", "--images", "3"});
  EXPECT_NE(outcome.out.find("0, 0 of 4 reported"), std::string::npos) << outcome.out;
}

TEST(Vps, ReportsMeasuredHeightsAndTilts) {
  const Folder folder;
  const std::string testbed =
      folder.write("t.toml", testbed_with("tag_fit = \"height\"") + "[[tag]]\nid = 3\nfit = \"tilt\"\n");
  const Words words{"vps", testbed, "--rendered", "3", "--images", "2", "--track", folder.path("track.csv")};
  const Outcome text = run_successfully(words);
  EXPECT_NE(text.out.find("height error"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("roll deg"), std::string::npos) << text.out;
  Words json = words;
  json.push_back("--json");
  const Json report(run_successfully(json).out);
  EXPECT_NEAR(report.number("/tags/0/height_m/mean"), 0.2, 0.02);
  EXPECT_GT(report.number("/tags/0/height_m/sigma"), 0.0);
  EXPECT_FALSE(report.has("/tags/0/tilt_rad"));
  EXPECT_GT(report.number("/tags/2/tilt_rad/sigma"), 0.0);
  EXPECT_NE(read_file(folder.path("track.csv")).find("z_m,z_sigma_m,roll_rad,pitch_rad,tilt_sigma_rad"),
            std::string::npos);
}

/// Writes images of two tags at rest into the folder `p`.
static void write_images(const Folder& folder, const std::string& testbed, std::array<std::uint32_t, 2> ids,
                         int count) {
  vision::Scene scene;
  for (const std::size_t i : {0, 1}) {
    vision::Patch tag;
    tag.shape = vision::Patch::Shape::tag;
    tag.X_WP = {i == 0 ? -0.3 : 0.3, 0.0, 0.2, 0.0};
    tag.size = {0.15, 0.15};
    tag.pattern = vision::family_pattern("aruco_4x4_50", ids[i]);
    scene.patches.push_back(tag);
  }
  vision::Image image;
  vision::Renderer(vision::read_testbed(testbed).cameras[0].camera, vision::Imaging{}, 1).render(scene, 0.0, 0, image);
  const std::string pixels(image.pixels.begin(), image.pixels.end());
  std::filesystem::create_directory(folder.path("p"));
  for (int k = 0; k < count; ++k) folder.write(fmt::format("p/{}.pgm", k), "P5\n320 240\n255\n" + pixels);
}

TEST(Vps, WarnsOfAnIdSeenTwice) {
  const Folder folder;
  const std::string testbed = folder.write("t.toml", kTestbed);
  write_images(folder, testbed, {1, 1}, 2);
  const Outcome outcome = run_successfully({"vps", testbed, "--input", "a=" + folder.path("p")});
  EXPECT_NE(outcome.err.find("tag 1 is seen twice in one image of camera 'a', at ("), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("seen twice"), outcome.err.rfind("seen twice")) << "once in ten seconds";
  EXPECT_NE(outcome.out.find("2 dropped: their id was seen at another place"), std::string::npos) << outcome.out;
}

std::string with_dictionary(const std::string& word) {
  const std::string before = "aruco_4x4_50", text = kTestbed;
  return std::string(text).replace(text.find(before), before.size(), word);
}

TEST(Vps, NamesTheOrientationOfAprilTags) {
  const Folder folder;
  const std::string testbed = folder.write("t.toml", with_dictionary("apriltag_36h11"));
  const Outcome outcome = run_successfully({"vps", testbed, "--rendered", "1", "--images", "1"});
  EXPECT_NE(outcome.out.find("upright as AprilRobotics prints them"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("apriltag_36h11_opencv"), std::string::npos) << outcome.out;
}

TEST(Vps, ReadsMarkersOfArToolKitPlus) {
  const Folder folder;
  const std::string testbed = folder.write("t.toml", with_dictionary("artoolkitplus_bch"));
  const Outcome outcome = run_successfully({"vps", testbed, "--rendered", "2", "--images", "2"});
  EXPECT_NE(outcome.out.find("0, 0 of 4 reported"), std::string::npos) << outcome.out;
}

/// Writes three rendered pictures with marks next to the tags, as a folder of photographs. @return the testbed file
static std::string write_pictures(const Folder& folder) {
  const std::string testbed = folder.write("t.toml", kTestbed);
  EXPECT_EQ(
      run_program({"vps", testbed, "--rendered", "2", "--images", "3", "--speed", "0", "--overlay", folder.path("p")})
          .code,
      0);
  return testbed;
}

TEST(Vps, ReadsItsOwnPictures) {
  const Folder folder;
  const std::string testbed = write_pictures(folder);
  const Outcome outcome = run_program({"vps", testbed, "--input", "a=" + folder.path("p"), "--json"});
  EXPECT_NE(outcome.out.find("\"images\": 3"), std::string::npos) << outcome.out << outcome.err;
}

/// The second camera sees another place, and nothing there: it sleeps from the third image on, and its files are not
/// even read.
TEST(Vps, FollowsATagAndLetsOtherCamerasSleep) {
  const Folder folder;
  write_images(folder, folder.write("t.toml", kTestbed), {1, 2}, 3);
  std::filesystem::create_directory(folder.path("q"));
  for (const char* name : {"q/0.pgm", "q/1.pgm", "q/2.pgm"})
    folder.write(name, "P5\n320 240\n255\n" + std::string(320 * 240, 'x'));
  std::string text = kTestbed;
  text.insert(text.find("[[tag]]"),
              "[[camera]]\nname = \"b\"\nsize = [320, 240]\nfocal = [400, 400]\nposition = [10, 0, 2.2]\n");
  const std::string testbed = folder.write("two.toml", text + "[follow]\ntags = [2]\n");
  const Words words{"vps", testbed, "--input", "a=" + folder.path("p"), "--input", "b=" + folder.path("q"), "--json"};
  const auto with = [&](const std::string& follow) {
    Words all = words;
    if (!follow.empty()) all.insert(all.end(), {"--follow", follow});
    return Json(run_successfully(all).out);
  };
  const Json file = with(""), one = with("1"), off = with("off");
  EXPECT_EQ(file.number("/tags/0/id"), 2);
  EXPECT_EQ(one.number("/tags/0/id"), 1);
  EXPECT_FALSE(one.has("/tags/1"));
  EXPECT_EQ(one.number("/follow/tags/0/seen"), 3);
  EXPECT_EQ(one.number("/follow/cameras/0/asleep"), 0);
  EXPECT_EQ(one.number("/follow/cameras/1/whole"), 1);
  EXPECT_EQ(one.number("/follow/cameras/1/asleep"), 2);
  EXPECT_EQ(one.number("/follow/cameras/1/unread"), 2);
  EXPECT_EQ(one.number("/images"), 6);
  EXPECT_FALSE(off.has("/follow"));
  EXPECT_TRUE(off.has("/tags/1"));
  for (const char* number : {"/tags/0/pose/0", "/tags/0/pose/2", "/tags/0/velocity/0"})
    EXPECT_EQ(one.number(number), off.number(number)) << number;
}

TEST(Vps, RefusesTagsThatCannotBeFollowed) {
  const Folder folder;
  const std::string testbed = folder.write("t.toml", kTestbed);
  for (const char* ids : {"", "x", "1,", "70000"})
    expect_refused({"vps", testbed, "--rendered", "1", "--follow", ids}, "expected 1 to 256 ids");
  expect_refused({"vps", testbed, "--rendered", "1", "--follow", "50"}, "the ids 0 to 49");
  const std::string empty = folder.write("empty.toml", std::string(kTestbed) + "[follow]\n");
  expect_refused({"vps", empty, "--rendered", "1"}, "[follow] has no tags");
}

TEST(Vps, SaysThatATagToFollowIsNotInView) {
  const Folder folder;
  const std::string testbed = folder.write("t.toml", kTestbed);
  const Outcome outcome = run_program({"vps", testbed, "--rendered", "2", "--images", "3", "--follow", "9"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("tag 9 is in no camera's image; searching all cameras in turn"), std::string::npos);
  EXPECT_EQ(outcome.err.find("tag 9"), outcome.err.rfind("tag 9")) << "once";
}

/// Ends with the time at which it stops, since no start can follow.
TEST(Vps, EndsWhenFollowingStopsForGood) {
  const Folder folder;
  const std::string testbed = folder.write(
      "t.toml", std::string(kTestbed) + "[follow]\ntags = [1]\nstart = \"at 0.1 s\"\nstop = \"at 0.3 s\"\n");
  const Outcome outcome = run_successfully({"vps", testbed, "--rendered", "2", "--json"});
  const Json report(outcome.out);
  EXPECT_EQ(report.number("/follow/tags/0/seen"), 3);  // at 2/15, 3/15 and 4/15 s
  EXPECT_EQ(report.number("/follow/cameras/0/images"), 6);
  EXPECT_NE(outcome.err.find("following starts at 0.13 s"), std::string::npos) << outcome.err;
}

/// Boundary: 5 images, every second of which is drawn over: 0, 2 and 4.
TEST(Vps, DrawsEachSecondImage) {
  const Folder folder;
  const std::string testbed = folder.write("t.toml", kTestbed);
  const Words words{"vps", testbed, "--rendered", "2", "--images", "5", "--every", "2", "--overlay"};
  Words to_folder = words, to_video = words;
  to_folder.push_back(folder.path("p"));
  to_video.push_back(folder.path("tags.avi"));
  ASSERT_EQ(run_program(to_folder).code, 0);
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(std::filesystem::exists(folder.path(fmt::format("p/a-00000{}.png", i))), i % 2 == 0) << i;
  folder.write("p/a-000001.png", "of an earlier call");
  folder.write("p/b-000001.png", "of no camera");
  const Outcome again = run_program(to_folder);
  EXPECT_NE(again.err.find("removed 4 files of an earlier call (a-NNNNNN.png)"), std::string::npos) << again.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path("p/a-000001.png")));
  EXPECT_TRUE(std::filesystem::exists(folder.path("p/a-000004.png")));
  EXPECT_TRUE(std::filesystem::exists(folder.path("p/b-000001.png")));
  run_successfully(to_video);
  const Outcome read = run_program({"vps", testbed, "--input", "a=" + folder.path("tags.avi"), "--json"});
  EXPECT_NE(read.out.find("\"images\": 3,\n  \"unreadable\": 0"), std::string::npos) << read.out << read.err;
}

/// Photographs are not overwritten by drawings.
TEST(Vps, PicturesAreNotWrittenIntoAFolderOfImages) {
  const Folder folder;
  const std::string testbed = write_pictures(folder);
  expect_refused({"vps", testbed, "--input", "a=" + folder.path("p"), "--overlay", folder.path("p")},
                 "contains the images of camera 'a'; name another --overlay");
  EXPECT_TRUE(std::filesystem::exists(folder.path("p/a-000002.png")));
}

TEST(Vps, CountsPicturesThatCannotBeRead) {
  const Folder folder;
  const std::string testbed = write_pictures(folder);
  std::ofstream(folder.path("p/a-000001.png"), std::ios::trunc) << "no image";
  ASSERT_EQ(mkfifo(folder.path("p/a-000009.png").c_str(), 0600), 0);  // not opened, since that would block
  const Outcome outcome =
      run_program({"vps", testbed, "--input", "a=" + folder.path("p"), "--overlay", folder.path("q"), "--json"});
  EXPECT_NE(outcome.out.find("\"images\": 3,\n  \"unreadable\": 1"), std::string::npos) << outcome.out << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path("q/a-000001.png")));
  EXPECT_TRUE(std::filesystem::exists(folder.path("q/a-000002.png")));
}

/// A client gets images of the camera and the tags in them while the program runs.
TEST(Vps, ServesALiveView) {
  const Folder folder;
  Program vps({"vps", folder.write("t.toml", kTestbed), "--rendered", "2", "--view", "0"});
  ASSERT_TRUE(vps.prints("view on http://127.0.0.1:")) << vps.err();
  const std::string before = "view on http://127.0.0.1:";
  const std::string said = vps.err();
  bridges::RawClient client(static_cast<std::uint16_t>(std::stoi(said.substr(said.find(before) + before.size()))));
  client.upgrade("foxglove.websocket.v1");
  client.text(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0},{"id":2,"channelId":1}]})");
  EXPECT_NE(client.receive_with("/a/image/compressed"), "");
  std::string image;
  while (image.find("\xFF\xD8\xFF") == std::string::npos && !(image = client.receive_binary(1)).empty()) {
  }
  EXPECT_NE(image.find("jpeg"), std::string::npos);
  EXPECT_EQ(image.substr(image.size() - 2), "\xFF\xD9") << "a whole JPEG";
  EXPECT_EQ(vps.stop().code, 0) << "rendering for a view has no end of its own";
}

/// Long before the next image, which is due in ten seconds.
TEST(Vps, CtrlCEndsItAtOnce) {
  const Folder folder;
  std::string slow = kTestbed;
  slow.insert(slow.find("position"), "rate = 0.1\n");
  Program vps({"vps", folder.write("t.toml", slow), "--rendered", "1", "--real-time", "--overlay", folder.path("p")});
  while (vps.running() && !std::filesystem::exists(folder.path("p/a-000000.png")))
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const auto start = std::chrono::steady_clock::now();
  EXPECT_NE(vps.stop().code, -1);
  EXPECT_LT(base::seconds_since(start), 5.0) << "0.05 s on an idle machine";
}

/// Live images wait for their time even if rendering is fast: their interval is at least the period.
TEST(Vps, ImagesOfLiveRobotsAreAtLeastAPeriodApart) {
  std::string text = kTestbed;
  text.insert(text.find("position"), "rate = 10\n");
  const vision::Testbed testbed = vision::parse_testbed("t.toml", text);
  const std::atomic<bool> stop = false;
  const auto inputs = apps::robot_inputs(testbed, {netio::kLoopback, 0}, 1, stop);
  std::vector<vision::Frame> frames;
  ASSERT_TRUE(inputs->next(frames));
  for (int i = 0; i < 2; ++i) {
    const double before = frames.at(0).time;
    ASSERT_TRUE(inputs->next(frames));
    EXPECT_GE(frames.at(0).time, before + 0.1);
  }
}

namespace {

std::size_t times_said(const Program& program, const std::string& text) {
  const std::string message = program.err();
  std::size_t count = 0;
  for (std::size_t at = message.find(text); at != std::string::npos; at = message.find(text, at + 1)) ++count;
  return count;
}

/// Polls for up to a minute.
bool says_often(const Program& program, const std::string& text, std::size_t count) {
  for (int i = 0; i < 3000 && times_said(program, text) < count; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  return times_said(program, text) >= count;
}

}  // namespace

/// The three programs in real time, only checked for working together: a robot that determines its pose with cameras
/// alone, which stall for a while. For accuracy see ClosedLoop in tests/vision.
TEST(Vps, ARobotDrivesByItsPackets) {
  const Folder folder;
  std::string testbed = kTestbed;
  testbed.replace(testbed.find("2.2]"), 4, "6.0]").replace(testbed.find("0.15"), 4, "0.6");
  const std::string world = folder.write(
      "room.world",
      "position( name \"roomba1\" size [0.3 0.3 0.1] laser( samples 91 fov 180 range_max 8 pose [0.1 0 0 0] ) )\n");
  const std::string lasers = std::to_string(free_ports(24));
  const unsigned ports = free_ports(3);
  const std::string farm = std::to_string(ports), cameras = std::to_string(ports + 1),
                    truth = std::to_string(ports + 2);
  Program serve({"serve", world, "--port", farm, "--laser-port", lasers, "--filter", "--json"});
  Program vps({"vps", folder.write("t.toml", testbed), "--robots", truth, "--send", "127.0.0.1:" + cameras, "--json"});
  ASSERT_TRUE(serve.prints("; press Ctrl-C to stop")) << serve.err();
  ASSERT_TRUE(vps.prints("; press Ctrl-C to stop")) << vps.err();
  Program robot({"robot",        world,
                 "--name",       "roomba1",
                 "--port",       farm,
                 "--laser-port", lasers,
                 "--cameras",    cameras,
                 "--clock",      "trusted",
                 "--truth",      "127.0.0.1:" + truth,
                 "--stop-after", "2",
                 "--controller", "patrol",
                 "--set",        "points=[0 0 0.3 0]",
                 "--json"});
  ASSERT_TRUE(robot.prints("cameras detect roomba1")) << robot.err();
  vps.signal(SIGSTOP);
  EXPECT_TRUE(robot.prints("no camera detects roomba1 any more")) << robot.err();
  const std::size_t seen = times_said(robot, "cameras detect roomba1");
  vps.signal(SIGCONT);
  EXPECT_TRUE(says_often(robot, "cameras detect roomba1", seen + 1)) << robot.err();
  for (Program* each : {&robot, &vps, &serve}) each->signal(SIGINT);
  const Json drove(robot.wait().out), looked(vps.wait().out), served(serve.wait().out);
  EXPECT_GE(drove.number("/stops"), 1);
  EXPECT_GT(drove.number("/positions/by_reason/accepted"), 0);
  EXPECT_GT(drove.number("/positions/compared"), 0);
  EXPECT_GT(drove.number("/readings/laser"), 0);
  EXPECT_EQ(looked.number("/truth/robots"), 1);
  EXPECT_EQ(looked.number("/truth/refused"), 0);
  EXPECT_GT(served.number("/received/accepted"), 0);
}

/// Times count from the first image, at any speed of the machine, with at least one camera period between images.
TEST(Vps, LiveImagesHaveTimesSinceTheFirst) {
  const Folder folder;
  const vision::Testbed testbed = vision::read_testbed(
      folder.write("t.toml",
                   "dictionary = \"aruco_4x4_50\"\ntag_side = 0.15\n[[camera]]\nname = \"a\"\nrate = 200\n"
                   "size = [32, 24]\nfocal = [40, 40]\nposition = [0, 0, 2]\n"));
  std::atomic<bool> stop{false};
  const auto inputs = apps::robot_inputs(testbed, {netio::kLoopback, 0}, 1, stop);
  EXPECT_TRUE(inputs->is_live());
  std::vector<vision::Frame> frames;
  const std::int64_t begin = base::unix_time();
  ASSERT_TRUE(inputs->next(frames));
  const std::int64_t begun = base::unix_time();
  double last = frames.at(0).time;
  for (int k = 1; k <= 5; ++k) {
    const std::int64_t before = base::unix_time();
    ASSERT_TRUE(inputs->next(frames));
    EXPECT_GE(frames[0].time, 1e-9 * static_cast<double>(before - begun) - 1e-6) << k;
    EXPECT_LE(frames[0].time, 1e-9 * static_cast<double>(base::unix_time() - begin) + 1e-6) << k;
    EXPECT_GE(frames[0].time - last, 0.005 - 1e-6) << k;
    last = frames[0].time;
  }
  stop = true;
  EXPECT_FALSE(inputs->next(frames));
}

namespace {

/// Noise, so that no image equals the one before, until the test blocks it.
class NoisyCamera : public vision::ImageSource {
 public:
  explicit NoisyCamera(std::shared_ptr<std::counting_semaphore<>> images) : images_(std::move(images)) {}
  bool next(vision::Image& out) override {
    images_->acquire();
    out = {32, 24, 1, std::vector<std::uint8_t>(32 * 24, static_cast<std::uint8_t>(++count_))};
    return true;
  }
  bool is_live() const override { return true; }

 private:
  std::shared_ptr<std::counting_semaphore<>> images_;
  int count_ = 0;
};

}  // namespace

/// With limits of 0 ms, so that nothing waits: images of b arrive while a sends none, and are counted alone.
TEST(Vps, OtherCamerasGoOnWithoutOneThatStalls) {
  const Folder folder;
  const std::string camera = "[[camera]]\nsize = [32, 24]\nfocal = [40, 40]\nposition = [0, 0, 2]\nname = ";
  vision::Testbed testbed = vision::read_testbed(folder.write(
      "t.toml", "dictionary = \"aruco_4x4_50\"\ntag_side = 0.15\n" + camera + "\"a\"\n" + camera + "\"b\"\n"));
  for (vision::TestbedCamera& each : testbed.cameras) each.camera.rate = 1e6;
  const auto stalled = std::make_shared<std::counting_semaphore<>>(0);
  const auto running = std::make_shared<std::counting_semaphore<>>(3);
  std::vector<std::unique_ptr<vision::ImageSource>> sources;
  sources.push_back(std::make_unique<NoisyCamera>(stalled));
  sources.push_back(std::make_unique<NoisyCamera>(running));
  std::atomic<bool> stop{false};
  const auto inputs = apps::source_inputs(testbed, std::move(sources), std::chrono::milliseconds(0), stop);
  vision::Positioning positioning(testbed, 1, true);
  std::vector<vision::Frame> frames;
  const auto next = [&] {
    EXPECT_TRUE(inputs->next(frames));
    positioning.update(frames);
  };
  while (positioning.counts().images < 3) next();
  EXPECT_TRUE(frames.at(0).missing);
  EXPECT_FALSE(frames.at(1).missing);
  EXPECT_EQ(positioning.counts().unreadable, 0u) << "missing images are not unreadable ones";
  stalled->release();
  while (positioning.counts().images < 4) next();
  EXPECT_FALSE(frames.at(0).missing) << "it continues";
  stop = true;
  EXPECT_FALSE(inputs->next(frames));
  stalled->release();
  running->release();
}

TEST(Calibrate, ReportsErrors) {
  const Folder folder;
  const std::string testbed = folder.write("t.toml", kTestbed);
  ASSERT_EQ(run_program({"vps", testbed, "--rendered", "1", "--images", "2", "--overlay", folder.path("p")}).code, 0);
  const Outcome none = run_program({"calibrate", folder.path("p"), "--columns", "7", "--rows", "5"});
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("a chessboard with 7 x 5 inner corners was found in 0 of 2 images"), std::string::npos)
      << none.err;
  expect_refused({"calibrate", folder.path("none")}, "does not exist");
  for (const char* name : {"a/b", "-a", "a b"}) {
    const Outcome named = run_program({"calibrate", folder.path("p"), fmt::format("--name={}", name)});
    EXPECT_NE(named.code, 0) << name;
    EXPECT_NE(named.err.find("expected a name of letters, digits"), std::string::npos) << named.err;
  }
}

TEST(Vps, ReportsErrors) {
  const Folder folder;
  const std::string testbed = folder.write("t.toml", kTestbed);
  const std::string text = folder.write("text.avi", "no video");
  const std::string camera = "[[camera]]\nsize = [8192, 8192]\nfocal = [9000, 9000]\nposition = [0, 0, 6]\nname = ";
  const std::string large = folder.write("large.toml", camera + "\"a\"\n" + camera + "\"b\"\n");
  struct Case {
    Words arguments;
    std::string expected;
  };
  for (const Case& each : std::vector<Case>{
           {{testbed}, "camera 'a' has no source; expected source = \"/dev/video0\""},
           {{testbed, "--input", "b=x"}, "has no camera 'b'"},
           {{testbed, "--input", "a=" + folder.path("none")}, "does not exist"},
           {{testbed, "--input", "a=" + folder.path("")}, "has no images"},
           {{testbed, "--input", "a=" + text}, "cannot be read as a video"},
           {{testbed, "--input", "a=/dev/null"}, "cannot be opened as a camera"},
           {{testbed, "--input", "a=firewire:first"}, "firewire:first: has no number of a camera"},
           {{testbed, "--input", "a=gstreamer:"}, "names no pipeline"},
           {{testbed, "--rendered", "2", "--world", "x.world"}, "--world requires --overlay or --view"},
           {{testbed, "--rendered", "2", "--view", "192.0.2.1:0"}, "cannot listen on 192.0.2.1:0"},
           {{testbed, "--rendered", "2", "--send", "127.0.0.1"}, "'127.0.0.1' is not an address; expected HOST:PORT"},
           {{testbed, "--rendered", "2", "--overlay", folder.path("none/tags.avi")}, "cannot be written as a video"},
           {{testbed, "--rendered", "2", "--overlay", folder.path("tags.webp")},
            "expected a folder or a video (*.avi)"},
           {{testbed, "--rendered", "500"}, "500 tags do not fit"},
           {{large, "--rendered", "1"},
            "'size' of all cameras is 128 Mpx together; rendered images (--rendered, --robots) have at most "
            "64 Mpx"},
           {{folder.path("none.toml")}, "none.toml"}}) {
    expect_refused(with({"vps"}, each.arguments), each.expected);
  }
}

/// Readings are sent repeatedly while it runs, so some are available when a tag is seen.
TEST(Vps, ReadingsAreDrawnFromTheSeenTagsAndMapsInTheWorld) {
  const Folder folder;
  const std::string testbed = folder.write("t.toml", std::string(kTestbed) + "robot = 5\n");  // carries tag 2
  const std::string world =
      folder.write("w.world",
                   "position( name \"roomba5\" size [0.2 0.2 0.1] laser( samples 31 fov 180 range_max 2 ) "
                   "occupancy( cell 0.1 words [1 1] offset [0.2 -0.2] ) )\n");
  const unsigned port = free_ports(1);
  Program vps({"vps", testbed, "--rendered", "2", "--images", "6", "--overlay", folder.path("seen"), "--world", world,
               "--readings", std::to_string(port)});
  netio::Outbox outbox;
  for (std::uint32_t sequence = 0; vps.running(); ++sequence) {
    outbox.queue({netio::kLoopback, static_cast<std::uint16_t>(port)},
                 mirrored(world, sensors::kLaser, std::vector<double>(31, 0.3), sequence));
    outbox.queue({netio::kLoopback, static_cast<std::uint16_t>(port)},
                 mirrored(world, sensors::kOccupancy, {0x99999999}, sequence));
    outbox.flush();
  }
  const Outcome outcome = vps.wait();
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  scenes::expect_painted(folder.path("seen/a-000005.png"),
                         {{0xFFEBC846u, 10}, {0xFF00E1EBu, 10}});  // beams and map; lines have soft borders
}

}  // namespace sf
