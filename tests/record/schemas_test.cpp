#include "record/schemas.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace sf::record {
namespace {

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(Schemas, ContainsEachRequiredTypeOnce) {
  const std::string text = schema_text(kOdometry);
  EXPECT_EQ(text.rfind("std_msgs/Header header\nstring child_frame_id\n", 0), 0u);
  EXPECT_EQ(count(text, "\n" + std::string(80, '=') + "\nMSG: "), 9u);
  for (const char* name : {"std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/PoseWithCovariance",
                           "geometry_msgs/Pose", "geometry_msgs/Point", "geometry_msgs/Quaternion",
                           "geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist", "geometry_msgs/Vector3"}) {
    EXPECT_EQ(count(text, "MSG: " + std::string(name) + "\n"), 1u) << name;
  }
}

TEST(Schemas, EveryLineIsAFieldOrAHeading) {
  for (const auto type :
       {kOdometry, kLaserScan, kTwistStamped, kTransforms, kFleet, kRunInfo, kTags, kCompressedImage}) {
    std::istringstream lines(schema_text(type));
    for (std::string line; std::getline(lines, line);) {
      const bool rule = line == std::string(80, '=');
      EXPECT_TRUE(rule || line.find(' ') != std::string::npos) << line;
    }
  }
}

TEST(Schemas, UndefinedTypeAborts) {
  EXPECT_DEATH(schema_text("std_msgs/msg/Strng"), "no message type std_msgs/Strng");
  EXPECT_DEATH(schema_text("Odometry"), "not a message type");
}

}  // namespace
}  // namespace sf::record
