// Type hashes compared with those that ROS 2 Jazzy publishes for the same types.

#include "bridges/ros_types.h"

#include <gtest/gtest.h>

#include "record/schemas.h"

namespace sf::bridges {
namespace {

std::string hash_of(std::string_view type) { return type_hash(type, record::schema_text(type)); }

TEST(TypeHash, MatchesRos2) {
  EXPECT_EQ(type_hash("std_msgs/msg/String", "string data\n"),
            "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18");
  EXPECT_EQ(hash_of("sensor_msgs/msg/LaserScan"),
            "RIHS01_64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828");
  EXPECT_EQ(hash_of("nav_msgs/msg/Odometry"),
            "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0");
  EXPECT_EQ(hash_of("geometry_msgs/msg/TwistStamped"),
            "RIHS01_5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64");
  EXPECT_EQ(hash_of("rosgraph_msgs/msg/Clock"),
            "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564");
  EXPECT_EQ(hash_of("tf2_msgs/msg/TFMessage"),
            "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087");
}

TEST(TypeHash, ReadsConstantsCommentsDefaultsAndBounds) {
  const std::string gid = "rmw_dds_common/Gid gid\nrmw_dds_common/NodeEntitiesInfo[] node_entities_info_seq\n";
  EXPECT_EQ(type_hash("rmw_dds_common/msg/ParticipantEntitiesInfo", record::with_dependencies(gid)),
            "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e")
      << "arrays and bounded strings";
  const std::string plain = type_hash("a/msg/B", "uint8 x\nfloat64 y\n");
  EXPECT_EQ(type_hash("a/msg/B", "uint8 RED=1\nuint8 GREEN = 2\n# words\nuint8 x 7  # a default\n\nfloat64 y 0\n"),
            plain);
  EXPECT_NE(type_hash("a/msg/B", "uint8 x\nfloat64[2] y\n"), plain);
  EXPECT_NE(type_hash("a/msg/B", "uint8 x\nfloat64[<=2] y\n"), type_hash("a/msg/B", "uint8 x\nfloat64[2] y\n"));
  EXPECT_NE(type_hash("a/msg/C", "uint8 x\nfloat64 y\n"), plain) << "the name counts";
}

TEST(TypeHash, EmptyMessagesHaveAMember) {
  EXPECT_EQ(type_hash("std_srvs/srv/Trigger_Request", ""),
            "RIHS01_d010825374ce8918e72bfd826c82603e60f45419e932ea976f807b74a863a199");
  EXPECT_EQ(type_hash("std_srvs/srv/Trigger_Response", "bool success\nstring message\n"),
            "RIHS01_2d946c21e2fc3f1e9ca6986a8191d85fcc70097a8bb7771a053564bc47009cdf");
}

TEST(TypeHash, IsEmptyForAnIncompleteDefinition) {
  for (const char* text : {"b/C c\n", "unknown x\n", "uint8\n", "uint8[ x\n", "uint8[a] x\n", "string<=a x\n",
                           "b/C c\n====\nMSG: b/C\nd/E e\n"})
    EXPECT_EQ(type_hash("a/msg/B", text), "") << text;
  EXPECT_EQ(type_user_data("a/msg/B", "unknown x\n"), "") << "no hash rather than a wrong one";
}

TEST(RosTypes, AreNamedAsInDds) {
  EXPECT_EQ(dds_type("sensor_msgs/msg/LaserScan"), "sensor_msgs::msg::dds_::LaserScan_");
  EXPECT_EQ(dds_type("std_srvs/srv/Trigger_Request"), "std_srvs::srv::dds_::Trigger_Request_");
}

}  // namespace
}  // namespace sf::bridges
