// Names of topics and frames that ROS 2 allows, in each style.

#include "record/topic_names.h"

#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "tests/record/sample.h"

namespace sf::record {
namespace {

RunInfo named(Naming naming, std::vector<MoverInfo> movers, std::vector<std::string>* notes = nullptr,
              bool record_readings = true) {
  RunInfo info;
  info.record_readings = record_readings;
  info.sensor_types = {
      test::scan_type(),       {.id = 2, .name = "sonar"}, {.id = 3, .name = "gyro"},      {.id = 4, .name = "odom"},
      {.id = 5, .name = "3d"}, {.id = 6, .name = "gps"},   {.id = 7, .name = "occupancy"}, {.id = 8, .name = "imu"}};
  info.movers = std::move(movers);
  put_naming(naming, info);
  const std::vector<std::string> lines = name_frames(info);
  if (notes != nullptr) *notes = lines;
  return info;
}

std::vector<std::string> topics_of(const MoverInfo& mover) {
  std::vector<std::string> topics;
  for (const SensorInfo& sensor : mover.sensors) {
    topics.push_back(sensor.topic);
    for (const StandardTopic& each : sensor.standard) topics.push_back(each.topic);
  }
  return topics;
}

using Message = StandardTopic::Message;
const MoverInfo kRobot{.name = "roomba2",
                       .sensors = {{.type = 1, .name = "ranger:0 (1)"},
                                   {.type = 1, .name = "ranger:1 (1)"},
                                   {.type = 2, .name = "ring", .standard = {{.element = 0}, {.element = 1}}},
                                   {.type = 2, .name = "bow", .standard = {{}}},
                                   {.type = 3, .name = "g", .standard = {{.message = Message::imu}}},
                                   {.type = 6, .name = "r", .standard = {{.message = Message::fix}}},
                                   {.type = 7, .name = "m", .standard = {{.message = Message::map}}}}};

using Names = std::vector<std::string>;

TEST(TopicNames, FollowTheSensorsTypes) {
  const RunInfo info = named({}, {kRobot});
  const MoverInfo& robot = info.movers[0];
  EXPECT_EQ(topics_of(robot), (Names{"/roomba2/scan", "/roomba2/scan_1", "/roomba2/sonar", "/roomba2/sonar/range_0",
                                     "/roomba2/sonar/range_1", "/roomba2/sonar_1", "/roomba2/sonar_1/range",
                                     "/roomba2/gyro", "/roomba2/imu", "/roomba2/gps", "/roomba2/gps/fix",
                                     "/roomba2/occupancy", "/roomba2/occupancy/map"}));
  EXPECT_EQ(robot.base_frame, "roomba2/base_link");
  EXPECT_EQ(robot.odom_frame, "roomba2/odom");
  EXPECT_EQ(robot.sensors[0].frame, "roomba2/laser");
  EXPECT_EQ(robot.sensors[1].frame, "roomba2/laser_1");
  EXPECT_EQ(robot.sensors[2].standard[1].frame, "roomba2/sonar/range_1");
  EXPECT_EQ(robot.sensors[3].standard[0].frame, "roomba2/sonar_1") << "one element is its sensor";
  EXPECT_EQ(robot.sensors[6].standard[0].frame, "world") << "maps do not move with their robot";
}

/// A sensor type may be called as its standard message, which has the short name.
TEST(TopicNames, StandardMessagesOfTheirTypesNameComeFirst) {
  const MoverInfo robot{.name = "r", .sensors = {{.type = 8, .name = "i", .standard = {{.message = Message::imu}}}}};
  EXPECT_EQ(topics_of(named({}, {robot}).movers[0]), (Names{"/r/imu_reading", "/r/imu"}));
  EXPECT_EQ(topics_of(named({.style = TopicStyle::sensor}, {robot}).movers[0]),
            (Names{"/r/i/imu_reading", "/r/i/imu"}));
}

TEST(TopicNames, Nav2FramesHaveNoRobotPrefix) {
  const RunInfo info = named({.style = TopicStyle::nav2}, {kRobot});
  EXPECT_EQ(info.movers[0].sensors[0].topic, "/roomba2/scan");
  EXPECT_EQ(info.movers[0].sensors[0].frame, "laser");
  EXPECT_EQ(info.movers[0].base_frame, "base_link");
  EXPECT_EQ(info.movers[0].odom_frame, "odom");
}

TEST(TopicNames, PlainNamesAreForOneRobot) {
  MoverInfo robot = kRobot;
  robot.plain = true;
  const RunInfo info = named({.style = TopicStyle::plain}, {kRobot, robot});
  EXPECT_EQ(info.movers[0].space, "/roomba2");
  EXPECT_EQ(info.movers[0].base_frame, "roomba2/base_link");
  EXPECT_EQ(info.movers[1].space, "");
  EXPECT_EQ(info.movers[1].base_frame, "base_link");
  EXPECT_EQ(info.movers[1].sensors[0].topic, "/scan");
  EXPECT_EQ(info.movers[1].sensors[4].standard[0].topic, "/imu");
  EXPECT_EQ(info.movers[1].sensors[6].standard[0].topic, "/occupancy/map") << "/map is the world's";
}

/// The names of earlier versions.
TEST(TopicNames, SensorStyleUsesSensorNames) {
  const RunInfo info =
      named({.style = TopicStyle::sensor}, {kRobot, {.name = "3at"}, {.name = "a.b"}, {.name = "a b"}});
  const MoverInfo& robot = info.movers[0];
  EXPECT_EQ(robot.sensors[0].topic, "/roomba2/ranger_0__1_/scan");
  EXPECT_EQ(robot.sensors[2].standard[1].topic, "/roomba2/ring/range_1");
  EXPECT_EQ(robot.sensors[2].standard[1].frame, "roomba2/ring/range_1");
  EXPECT_EQ(robot.sensors[5].standard[0].topic, "/roomba2/r/fix");
  EXPECT_EQ(robot.sensors[5].standard[0].frame, "roomba2/r");
  EXPECT_EQ(robot.base_frame, "roomba2");
  EXPECT_EQ(robot.odom_frame, "world");
  EXPECT_EQ(info.movers[1].frame, "_3at");
  EXPECT_EQ(info.movers[3].frame, "a_b_2");
}

/// ROS 2 allows no empty part, no part that begins with a digit, and no two '_' in a row; a part that begins with '_'
/// is hidden.
TEST(TopicNames, AreValidForAnyNamesInTheWorld) {
  std::vector<MoverInfo> movers;
  for (const char* name : {"", "3at", "f\xC3\xBC", "\xC3\xBC", "_x_", "a__b", "a b", "a.b", "map", "tf", "world",
                           "odom", "sensorfarm", "ends_", "1", "robot", "robot_2"}) {
    movers.push_back(kRobot);
    movers.back().name = name;
  }
  movers.push_back(kRobot);
  movers.back().name = std::string(300, 'n');
  movers.push_back(movers.back());
  movers.back().sensors.push_back({.type = 4, .name = "a plug-in's"});
  movers.back().sensors.push_back({.type = 5, .name = ""});
  const RunInfo info = named({}, movers);
  const std::regex valid("(/[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*)+");
  std::set<std::string> names{"/map", "/tf", "/tf_static", "/clock", "/run", "/fleet", "/walls", "/bodies"};
  for (const MoverInfo& mover : info.movers) {
    EXPECT_TRUE(names.insert(mover.space).second) << mover.space;
    for (const std::string& own : {mover.space + "/odom", mover.space + "/cmd_vel"}) names.insert(own);
    for (const std::string& topic : topics_of(mover)) {
      EXPECT_TRUE(std::regex_match(topic, valid)) << topic;
      EXPECT_TRUE(names.insert(topic).second) << topic;
      EXPECT_LT(topic.size(), 200u);
    }
  }
  EXPECT_EQ(info.movers.back().sensors[7].topic.substr(info.movers.back().space.size()), "/odom_1");
  EXPECT_EQ(info.movers.back().sensors[8].topic.substr(info.movers.back().space.size()), "/sensor_3d");
  EXPECT_EQ(info.movers[1].frame, "robot_3at");
  EXPECT_EQ(info.movers[2].frame, "f");
}

TEST(TopicNames, ReportsTakenNames) {
  std::vector<std::string> notes;
  named({}, {{.name = "a b"}, {.name = "a.b"}, {.name = "c", .sensors = {{.type = 4, .name = "x"}}}}, &notes);
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_EQ(notes[0], "robot 'a.b' is /a_b_2, since /a_b is taken");
  EXPECT_NE(notes[1].find("/c/odom_1"), std::string::npos) << notes[1];
  named({}, {{.name = "c", .sensors = {{.type = 4, .name = "x"}}}}, &notes, false);
  EXPECT_TRUE(notes.empty()) << "no readings, no topic";
  named({}, {kRobot}, &notes);
  EXPECT_TRUE(notes.empty()) << "no note for a second sensor of a type";
}

/// A robot that joins a fleet does not take the name of another robot.
TEST(TopicNames, DoNotDependOnLaterMovers) {
  RunInfo info = named({}, {{.name = "a b"}, {.name = "c"}});
  info.movers.push_back({.name = "a.b"});
  name_frames(info);
  EXPECT_EQ(info.movers[0].frame, "a_b");
  EXPECT_EQ(info.movers[1].frame, "c");
  EXPECT_EQ(info.movers[2].frame, "a_b_2");
}

TEST(TopicNames, NamingRoundTripsThroughARecording) {
  for (const auto& [style_word, style] : kTopicStyles)
    for (const auto& [source_word, source] : kOdometrySources)
      for (int nodes = 0; nodes < 8; ++nodes) {
        const Naming naming{style, source, (nodes & 1) != 0, (nodes & 2) != 0, (nodes & 4) != 0};
        RunInfo info;
        put_naming(naming, info);
        Naming expected = naming;
        if (style == TopicStyle::sensor) expected.odometry = OdometrySource::truth;
        EXPECT_EQ(naming_of(info), expected) << style_word << source_word << nodes;
      }
  RunInfo info;
  put_naming({}, info);
  EXPECT_TRUE(info.options.empty()) << "a run by default has none of them";
}

}  // namespace
}  // namespace sf::record
