// Bytes and texts of Foxglove's protocol. The vectors of foxglove.sdk.v1 are the snapshots of Foxglove's own SDK
// (github.com/foxglove/foxglove-sdk at ca8a1ced, rust/foxglove/src/protocol/v1/snapshots).

#include <gtest/gtest.h>

#include <cmath>

#include "bridges/foxglove_bytes.h"
#include "bridges/foxglove_messages.h"
#include "record/cdr.h"
#include "record/ros_messages.h"

namespace sf::bridges {

namespace {

base::Bytes bytes_from_hex(std::string_view hex) {
  base::Bytes bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16)));
  return bytes;
}

base::Bytes bytes_of_text(std::string_view text) { return {text.begin(), text.end()}; }

}  // namespace

TEST(FoxgloveBytes, MatchTheSdk) {
  EXPECT_EQ(time_bytes(1234567890), bytes_from_hex("02d202964900000000"));
  EXPECT_EQ(service_response_bytes(10, 12, "json", bytes_of_text(R"({"key": "value"})")),
            bytes_from_hex("030a0000000c000000040000006a736f6e7b226b6579223a202276616c7565227d"));
  EXPECT_EQ(playback_state_bytes({.time = 12345}), bytes_from_hex("05003930000000000000"
                                                                  "0000803f"
                                                                  "00"
                                                                  "00000000"));
  EXPECT_EQ(playback_state_bytes({.time = 12345, .did_seek = true}), bytes_from_hex("05003930000000000000"
                                                                                    "0000803f"
                                                                                    "01"
                                                                                    "00000000"));
  EXPECT_EQ(playback_state_bytes({.time = 12345, .request = "i-am-a-request"}),
            bytes_from_hex("05003930000000000000"
                           "0000803f"
                           "00"
                           "0e000000"
                           "692d616d2d612d72657175657374"));
}

TEST(FoxgloveBytes, ParsesMessagesOfTheSdk) {
  const auto published = parse_client_binary(bytes_from_hex("011e0000007b226b6579223a202276616c7565227d"));
  ASSERT_TRUE(published && std::holds_alternative<ClientPublish>(*published));
  EXPECT_EQ(std::get<ClientPublish>(*published).channel, 30u);
  EXPECT_EQ(std::get<ClientPublish>(*published).payload.size(), 16u);

  const auto call =
      parse_client_binary(bytes_from_hex("020a0000000c000000040000006a736f6e7b226b6579223a202276616c7565227d"));
  ASSERT_TRUE(call && std::holds_alternative<ServiceCall>(*call));
  EXPECT_EQ(std::get<ServiceCall>(*call).service, 10u);
  EXPECT_EQ(std::get<ServiceCall>(*call).call, 12u);
  EXPECT_EQ(std::get<ServiceCall>(*call).encoding, "json");
  EXPECT_EQ(std::get<ServiceCall>(*call).payload.size(), 16u);

  const auto play = parse_client_binary(bytes_from_hex("03000000803f0115cd5b070000000007000000736f6d652d6964"));
  ASSERT_TRUE(play && std::holds_alternative<PlaybackRequest>(*play));
  EXPECT_FALSE(std::get<PlaybackRequest>(*play).pause);
  EXPECT_EQ(std::get<PlaybackRequest>(*play).speed, 1.0F);
  EXPECT_EQ(std::get<PlaybackRequest>(*play).time, 123'456'789);
  EXPECT_EQ(std::get<PlaybackRequest>(*play).id, "some-id");
  const auto pause = parse_client_binary(bytes_from_hex("03010000803f00000000000000000007000000736f6d652d6964"));
  ASSERT_TRUE(pause && std::holds_alternative<PlaybackRequest>(*pause));
  EXPECT_TRUE(std::get<PlaybackRequest>(*pause).pause);
  EXPECT_FALSE(std::get<PlaybackRequest>(*pause).time);
}

TEST(FoxgloveBytes, RejectsEveryTruncation) {
  for (const char* whole :
       {"020a0000000c000000040000006a736f6e", "03000000803f0115cd5b070000000007000000736f6d652d6964", "011e000000"}) {
    const base::Bytes bytes = bytes_from_hex(whole);
    EXPECT_TRUE(parse_client_binary(bytes)) << whole;
    for (std::size_t size = 0; size < bytes.size(); ++size)
      EXPECT_FALSE(parse_client_binary(std::span(bytes).first(size))) << whole << " cut at " << size;
  }
  EXPECT_FALSE(parse_client_binary(bytes_from_hex("ff00000000000000")));                        // unknown message
  EXPECT_FALSE(parse_client_binary(bytes_from_hex("020a0000000c000000ffffffff6a736f6e")));      // overlong name
  EXPECT_FALSE(parse_client_binary(bytes_from_hex("03020000803f00000000000000000000000000")));  // unknown command
  EXPECT_FALSE(parse_client_binary(bytes_from_hex("03000000803f01ffffffffffffffff00000000")));  // overflow
}

TEST(FoxgloveBytes, TwistsInCdr) {
  base::Bytes stamped;
  record::encode_twist(1'500'000'000, "roomba1", {0.5, -0.25, 1.5}, stamped);
  const auto twist = read_cdr_twist(stamped, true);
  ASSERT_TRUE(twist);
  EXPECT_EQ(twist->forward, 0.5);
  EXPECT_EQ(twist->left, -0.25);
  EXPECT_EQ(twist->turn, 1.5);
  for (std::size_t size = 0; size < stamped.size(); ++size)
    EXPECT_FALSE(read_cdr_twist(std::span(stamped).first(size), true)) << size;
  base::Bytes plain;
  record::CdrWriter cdr(plain);
  for (const double value : {1.0, 2.0, 0.0, 0.0, 0.0, 3.0}) cdr.put(value);
  EXPECT_EQ(read_cdr_twist(plain, false)->turn, 3.0);
  EXPECT_FALSE(read_cdr_twist(plain, true)) << "a frame of that length is not there";
}

TEST(FoxgloveMessages, TwistsInJson) {
  EXPECT_EQ(parse_json_twist(R"({"linear":{"x":0.5,"y":0,"z":0},"angular":{"x":0,"y":0,"z":-1}})")->turn, -1.0);
  EXPECT_EQ(parse_json_twist(R"({"header":{},"twist":{"linear":{"x":0.5}}})")->forward, 0.5);
  EXPECT_EQ(parse_json_twist("{}")->forward, 0.0);                                   // as for a robot that is to stop
  EXPECT_TRUE(std::isnan(parse_json_twist(R"({"linear":{"x":"fast"}})")->forward));  // and is rejected later
  for (const char* wrong : {"", "[", "7", "[1]", "{\"linear\":"}) EXPECT_FALSE(parse_json_twist(wrong)) << wrong;
}

TEST(FoxgloveMessages, ReadsEachOperation) {
  const auto subscribe =
      parse_client_text(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":7},{"id":2,"channelId":8}]})");
  ASSERT_TRUE(subscribe);
  ASSERT_EQ(subscribe->subscriptions.size(), 2u);
  EXPECT_EQ(subscribe->subscriptions[1].id, 2u);
  EXPECT_EQ(subscribe->subscriptions[1].channel, 8u);
  EXPECT_EQ(parse_client_text(R"({"op":"unsubscribe","subscriptionIds":[4294967295]})")->ids[0], 0xFFFFFFFFu);
  const auto advertise = parse_client_text(
      R"({"op":"advertise","channels":[{"id":3,"topic":"/a/cmd_vel","encoding":"cdr","schemaName":"geometry_msgs/Twist"}]})");
  ASSERT_TRUE(advertise);
  EXPECT_EQ(advertise->channels[0].topic, "/a/cmd_vel");
  const auto set = parse_client_text(
      R"({"op":"setParameters","id":"x","parameters":[{"name":"/paused","value":true},{"name":"/speed","value":2},{"name":"a"},{"name":"b","value":[1]}]})");
  ASSERT_TRUE(set);
  EXPECT_EQ(std::get<bool>(set->parameters[0].value), true);
  EXPECT_EQ(std::get<double>(set->parameters[1].value), 2.0);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(set->parameters[2].value));  // to unset it
  EXPECT_TRUE(std::holds_alternative<std::monostate>(set->parameters[3].value));  // of an unsupported type
  EXPECT_EQ(set->id, "x");
  EXPECT_EQ(parse_client_text(R"({"op":"fetchAsset","uri":"a","requestId":1})")->op, ClientText::Op::other);
}

TEST(FoxgloveMessages, RejectsOtherTexts) {
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');  // must not exhaust the stack
  for (const std::string& wrong :
       {std::string(), std::string("{"), std::string("[]"), std::string("null"), std::string("{\"op\":7}"),
        std::string(R"({"op":"fly"})"), std::string(R"({"op":"subscribe"})"),
        std::string(R"({"op":"subscribe","subscriptions":{}})"),
        std::string(R"({"op":"subscribe","subscriptions":[7]})"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":0}]})"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":0}]})"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":0.5,"channelId":0}]})"),
        std::string(R"({"op":"unsubscribe","subscriptionIds":["1"]})"),
        std::string(R"({"op":"advertise","channels":[{"topic":"/a"}]})"),
        std::string(R"({"op":"getParameters","parameterNames":[1]})"), std::string("{\"op\":\"subscribe\xff\"}"), deep,
        R"({"op":"subscribe","subscriptions":)" + deep + "}"})
    EXPECT_FALSE(parse_client_text(wrong)) << wrong.substr(0, 80);
}

TEST(FoxgloveMessages, InvalidUtf8InNamesIsReplaced) {
  const std::string text = status_text(StatusLevel::error, "robot \xff");
  EXPECT_NE(text.find("robot \xef\xbf\xbd"), std::string::npos) << text;
}

}  // namespace sf::bridges
