// The program with --ros2 together with nodes like those of Nav2, slam_toolbox and robot_localization by default (the
// table in docs/bridges.md): their subscriptions by name, type and QoS, the frames that they look up, and the tree of
// frames. The nodes are readers and writers of Fast DDS; the projects themselves do not run.

#include <gtest/gtest.h>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include "tests/apps/program.h"
#include "tests/ros2/domain.h"
#include "tests/ros2/fast_peer.h"

namespace sf::ros2 {
namespace {

constexpr const char* kScan = "sensor_msgs::msg::dds_::LaserScan_";
constexpr const char* kOdometry = "nav_msgs::msg::dds_::Odometry_";
constexpr const char* kTransforms = "tf2_msgs::msg::dds_::TFMessage_";
constexpr const char* kMap = "nav_msgs::msg::dds_::OccupancyGrid_";
constexpr const char* kTwist = "geometry_msgs::msg::dds_::Twist_";
constexpr const char* kTwistStamped = "geometry_msgs::msg::dds_::TwistStamped_";

/// A subscription of a project. Names are relative to the robot's namespace unless they begin with '/'.
struct Subscription {
  const char* project;
  const char* topic;
  const char* type;
  bool latched;       ///< transient local; else volatile
  bool reliable;      ///< else best effort
  const char* frame;  ///< of the header; without the fleet's prefix
};
constexpr Subscription kSubscriptions[] = {
    {"rclcpp", "/clock", "rosgraph_msgs::msg::dds_::Clock_", false, false, nullptr},
    {"tf2_ros", "/tf", kTransforms, false, true, nullptr},
    {"tf2_ros", "/tf_static", kTransforms, true, true, nullptr},
    {"Nav2: amcl, costmaps, collision monitor", "scan", kScan, false, false, "laser"},
    {"Nav2: controller, velocity smoother, navigator", "odom", kOdometry, false, true, "odom"},
    {"Nav2: amcl, static layer", "map", kMap, true, true, "map"},
    {"slam_toolbox", "scan", kScan, false, false, "laser"},
    {"robot_localization: ekf", "odom", kOdometry, false, false, "odom"},
    {"robot_localization: ekf, navsat", "imu", "sensor_msgs::msg::dds_::Imu_", false, false, "gyro"},
    {"robot_localization: navsat", "gps/fix", "sensor_msgs::msg::dds_::NavSatFix_", false, false, "gps"}};

/// A room with `robots` that have a laser, encoders, a gyro and GPS.
std::string world_of(const Folder& folder, const std::vector<std::string>& robots) {
  const std::string path = folder.path("room.world");
  std::ofstream out(path);
  out << "interval_sim 50\n"
         "define robot position( size [0.3 0.3 0.1] drive \"diff\" velocity_bounds [-0.5 0.5 0 0 0 0 -90 90]\n"
         "  laser( samples 61 fov 270 range_max 8 rate 20 )\n"
         "  encoder( per_count 0.001 track 0.258 slip 0.005 rate 20 ) gyro( rate 20 ) gps( noise 1 rate 5 ) )\n"
         "model( name \"wall\" pose [3 0 0 0] size [0.2 4 1] )\n";
  for (std::size_t i = 0; i < robots.size(); ++i)
    out << "robot( name \"" << robots[i] << "\" pose [" << -1.0 - static_cast<double>(i) << " 0.5 0 30] )\n";
  return path;
}

/// Published frames, as seen by listeners of tf.
struct Tree {
  std::map<std::string, std::set<std::string>> parents;  ///< by child
  std::map<std::string, std::vector<std::int64_t>> stamps;

  void read(const std::vector<base::Bytes>& messages) {
    for (const base::Bytes& message : messages) {
      const auto transforms = decode_transforms(message);
      ASSERT_TRUE(transforms);
      for (const Transform& each : *transforms) {
        parents[each.child].insert(each.frame);
        stamps[each.child].push_back(each.time);
      }
    }
  }
  /// Checks that each frame has one parent, all have one root, and stamps increase.
  void expect_sound(const std::string& root) const {
    for (const auto& [child, all] : parents) {
      EXPECT_EQ(all.size(), 1u) << child << " has several parents";
      std::string frame = child;
      for (int depth = 0; depth < 10 && parents.contains(frame); ++depth) frame = *parents.at(frame).begin();
      EXPECT_EQ(frame, root) << "above " << child;
    }
    for (const auto& [child, times] : stamps)
      for (std::size_t i = 1; i < times.size(); ++i) EXPECT_LT(times[i - 1], times[i]) << child;
  }
  std::string parent(const std::string& child) const {
    return parents.contains(child) ? *parents.at(child).begin() : std::string();
  }
};

/// The program in its own domain, and its peer.
struct Ros2Projects : testing::Test {
  void start(const std::vector<std::string>& robots, const Words& options) {
    const Words words = with({"run", world_of(folder, robots), "--ros2", std::to_string(domain)}, options);
    program.emplace(words, Environment{{"ROS_LOCALHOST_ONLY", "1"}});
    ASSERT_TRUE(program->prints("node /sensorfarm")) << program->err();
    peer.emplace(domain);
  }
  void TearDown() override {
    if (!program) return;
    EXPECT_EQ(program->stop().code, 0) << program->err();
  }
  /// @param tf prefix of /tf and /tf_static
  Tree tree(const std::string& tf, std::size_t messages = 10) {
    const std::size_t moving = peer->subscribe("rt" + tf + "/tf", kTransforms, false, true);
    const std::size_t fixed = peer->subscribe("rt" + tf + "/tf_static", kTransforms, true, true);
    EXPECT_TRUE(
        peer->wait([&] { return peer->messages(moving).size() >= messages && !peer->messages(fixed).empty(); }));
    Tree all;
    all.read(peer->messages(moving));
    all.read(peer->messages(fixed));
    return all;
  }
  bool writes(const std::string& topic) const {
    for (const Endpoint& one : peer->endpoints())
      if (one.writes && one.topic == topic) return true;
    return false;
  }
  /// Checks that every subscription of the table matches and receives messages in its frame.
  /// @param space prefix of relative names @param prefix of frames @param tf prefix of /tf and /tf_static
  void expect_subscriptions(const std::string& space, const std::string& prefix, const std::string& tf) {
    for (const Subscription& one : kSubscriptions) {
      std::string topic = one.topic[0] == '/' ? one.topic : space + "/" + one.topic;
      if (one.type == kTransforms) topic = tf + topic;
      if (one.type == kMap && tf.empty()) topic = "/map";  // of a fleet
      FastPeer node(domain);                               // a separate node: several subscribe to one topic
      const std::size_t reader = node.subscribe("rt" + topic, one.type, one.latched, one.reliable);
      ASSERT_TRUE(node.wait([&] { return !node.messages(reader).empty(); })) << one.project << " " << topic;
      if (one.frame == nullptr) continue;
      const auto header = decode_header(node.messages(reader).back());
      ASSERT_TRUE(header) << topic;
      EXPECT_EQ(header->frame, (one.type == kMap ? "" : prefix) + std::string(one.frame)) << one.project;
    }
  }

  const Folder folder;
  const std::uint32_t domain = own_domain();
  std::optional<Program> program;
  std::optional<FastPeer> peer;
};

TEST_F(Ros2Projects, OneRobotHasTheirDefaultNames) {
  ASSERT_NO_FATAL_FAILURE(start({"roomba"}, {"--topics", "plain"}));
  ASSERT_NO_FATAL_FAILURE(expect_subscriptions("", "", ""));
  const Tree frames = tree("");
  frames.expect_sound("map");
  for (const auto& [child, parent] : {std::pair{"odom", "map"},
                                      {"base_link", "odom"},
                                      {"base_footprint", "base_link"},
                                      {"laser", "base_link"},
                                      {"gyro", "base_link"},
                                      {"gps", "base_link"}})
    EXPECT_EQ(frames.parent(child), parent) << child;
  EXPECT_GE(frames.stamps.at("base_link").size(), 10u);
}

TEST_F(Ros2Projects, ScansAndOdometryMatchTheirExpectations) {
  ASSERT_NO_FATAL_FAILURE(start({"roomba"}, {"--topics", "plain"}));
  const std::size_t scans = peer->subscribe("rt/scan", kScan, false, false);
  const std::size_t odometry = peer->subscribe("rt/odom", kOdometry);
  const std::size_t truth = peer->subscribe("rt/ground_truth/odom", kOdometry);
  ASSERT_TRUE(peer->wait([&] {
    return peer->messages(scans).size() > 2 && peer->messages(odometry).size() > 5 && !peer->messages(truth).empty();
  }));
  const auto scan = decode_scan(peer->messages(scans).back());
  ASSERT_TRUE(scan);
  EXPECT_NEAR(scan->angle_max - scan->angle_min, 1.5 * M_PI, 1e-5);
  EXPECT_NEAR(scan->angle_increment * 60.0F, 1.5 * M_PI, 1e-5);
  EXPECT_EQ(scan->time_increment, 0.0F);
  EXPECT_FLOAT_EQ(scan->scan_time, 0.05F);
  for (const float range : scan->ranges)
    EXPECT_TRUE(std::isinf(range) || (range >= scan->range_min && range < scan->range_max)) << range;
  double last = 0.0;
  for (const base::Bytes& message : peer->messages(odometry)) {
    const auto odom = decode_odometry(message);
    ASSERT_TRUE(odom);
    EXPECT_EQ(odom->pose.frame, "odom");
    EXPECT_EQ(odom->pose.child, "base_link");
    for (const int i : {0, 7, 14, 21, 28, 35}) {
      EXPECT_GT(odom->pose_covariance[i], 0.0) << "filters need each variance";
      EXPECT_GT(odom->velocity_covariance[i], 0.0);
    }
    EXPECT_GE(odom->pose_covariance[35], last) << "the heading's grows";
    last = odom->pose_covariance[35];
  }
  const auto pose = decode_odometry(peer->messages(truth).back());
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->pose.frame, "world");
  EXPECT_EQ(pose->pose.child, "base_link");
}

TEST_F(Ros2Projects, BothTypesOfTwistDriveTheRobot) {
  ASSERT_NO_FATAL_FAILURE(start({"roomba"}, {"--topics", "plain"}));
  const std::size_t truth = peer->subscribe("rt/ground_truth/odom", kOdometry);
  const auto turns = [&](FastPeer& node, std::size_t writer, const base::Bytes& command, double turn) {
    return node.wait([&] {
      node.send(writer, command);
      const auto messages = peer->messages(truth);
      const auto last = messages.empty() ? std::nullopt : decode_odometry(messages.back());
      return last && std::abs(last->velocity[5] - turn) < 1e-9;
    });
  };
  FastPeer nav2(domain), humble(domain);
  EXPECT_TRUE(turns(nav2, nav2.advertise("rt/cmd_vel", kTwistStamped), encode_twist_stamped(0.0, 0.0, 0.25), 0.25))
      << "Nav2's default";
  EXPECT_TRUE(turns(humble, humble.advertise("rt/cmd_vel", kTwist), encode_twist(0.0, 0.0, -0.5), -0.5))
      << "earlier releases, or enable_stamped_cmd_vel: false";
}

TEST_F(Ros2Projects, AFleetHasNamespacesAndOneTree) {
  ASSERT_NO_FATAL_FAILURE(start({"ann", "bob"}, {}));
  for (const char* robot : {"ann", "bob"})
    ASSERT_NO_FATAL_FAILURE(expect_subscriptions(std::string("/") + robot, std::string(robot) + "/", ""));
  const Tree frames = tree("");
  frames.expect_sound("map");
  for (const std::string robot : {"ann/", "bob/"}) {
    EXPECT_EQ(frames.parent(robot + "odom"), "map");
    EXPECT_EQ(frames.parent(robot + "base_link"), robot + "odom");
    EXPECT_EQ(frames.parent(robot + "laser"), robot + "base_link");
  }
}

/// As in Nav2's launch files for several robots: /tf and /tf_static are remapped to tf and tf_static.
TEST_F(Ros2Projects, AFleetMayHaveATreePerRobot) {
  ASSERT_NO_FATAL_FAILURE(start({"ann", "bob"}, {"--topics", "nav2"}));
  for (const char* space : {"/ann", "/bob"}) {
    ASSERT_NO_FATAL_FAILURE(expect_subscriptions(space, "", space));
    const Tree frames = tree(space);
    frames.expect_sound("map");
    EXPECT_EQ(frames.parent("odom"), "map");
    EXPECT_EQ(frames.parent("base_link"), "odom");
    EXPECT_EQ(frames.parent("laser"), "base_link");
  }
  EXPECT_FALSE(writes("rt/tf") || writes("rt/map"));
}

/// amcl publishes map -> odom, and needs a map.
TEST_F(Ros2Projects, ALocalizerIsTheOnlyParentOfOdom) {
  ASSERT_NO_FATAL_FAILURE(start({"roomba"}, {"--topics", "plain", "--external", "localizer"}));
  Tree frames = tree("");
  EXPECT_EQ(frames.parent("odom"), "");
  EXPECT_EQ(frames.parent("base_link"), "odom");
  EXPECT_TRUE(peer->wait([&] { return writes("rt/map"); }));
  frames.parents["odom"].insert("map");  // published by the localizer
  frames.expect_sound("map");
}

/// slam_toolbox publishes map -> odom and /map.
TEST_F(Ros2Projects, AMapperPublishesTheOnlyMap) {
  ASSERT_NO_FATAL_FAILURE(start({"roomba"}, {"--topics", "plain", "--external", "mapper"}));
  Tree frames = tree("");
  EXPECT_EQ(frames.parent("odom"), "");
  EXPECT_TRUE(peer->wait([&] { return writes("rt/walls"); }));
  EXPECT_FALSE(writes("rt/map"));
  frames.parents["odom"].insert("map");
  frames.expect_sound("map");
}

/// ekf_node of robot_localization publishes odom -> base_link.
TEST_F(Ros2Projects, AFilterIsTheOnlyParentOfTheRobot) {
  ASSERT_NO_FATAL_FAILURE(start({"roomba"}, {"--topics", "plain", "--external", "localizer,filter"}));
  const std::size_t odometry = peer->subscribe("rt/odom", kOdometry, false, false);
  ASSERT_TRUE(peer->wait([&] { return peer->messages(odometry).size() > 2; })) << "its input";
  Tree frames = tree("", 1);
  EXPECT_EQ(frames.parent("base_link"), "");
  frames.parents["base_link"].insert("odom");
  frames.parents["odom"].insert("map");
  frames.expect_sound("map");
}

}  // namespace
}  // namespace sf::ros2
