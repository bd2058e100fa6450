// Topics of a run, and which of them a tick has something to say on.

#include "record/tick_messages.h"

#include <gtest/gtest.h>

#include <map>

#include "record/cdr.h"
#include "tests/record/sample.h"

namespace sf::record {
namespace {

RunInfo named_info() {
  RunInfo info = test::sample_info(true);
  info.movers[0].sensors[2].standard = {{.message = StandardTopic::Message::magnetic_field, .element = 0},
                                        {.message = StandardTopic::Message::magnetic_field, .element = 1}};
  info.movers[0].body = {{"hull", 0x80FF0000u, {{0.0, 0.0, 0.1}, {1.0, 0.0, 0.1}}}};
  info.shape.walls = {{"wall", 0xFF00FF00u, {{0.0, 0.0, 1.0}, {2.0, 0.0, 1.0}}}};
  info.shape.columns = 3, info.shape.rows = 1;
  info.shape.occupied = {true, false, true};
  name_frames(info);
  return info;
}

/// Messages per topic's name.
using Counts = std::map<std::string, int>;

TEST(TickMessages, ATickSpeaksOnTopicsThatAreWanted) {
  const RunInfo info = named_info();
  TickMessages messages(info);
  const test::SampleTick tick(0);
  std::vector<bool> wanted(messages.topics().size(), false);
  for (std::size_t row = 0; row < wanted.size(); ++row) {
    wanted[row] = true;
    messages.begin([](const TopicMessage&) {});
    messages.encode(
        tick.record, [&](const TopicMessage& message) { EXPECT_EQ(message.topic, row); }, wanted);
    wanted[row] = false;
  }
  messages.encode(
      tick.record, [](const TopicMessage&) { ADD_FAILURE() << "nothing was wanted"; }, wanted);
}

TEST(TickMessages, LatchedTopicsComeAtTheBeginningAlone) {
  const RunInfo info = named_info();
  TickMessages messages(info);
  Counts first, then;
  const auto count_in = [&](Counts& counts) {
    return [&](const TopicMessage& message) { ++counts[messages.topics()[message.topic].name]; };
  };
  messages.begin(count_in(first));
  messages.encode(test::SampleTick(0).record, count_in(then));
  EXPECT_EQ(first, (Counts{{"/run", 1}, {"/tf_static", 1}, {"/map", 1}, {"/walls", 1}, {"/bodies", 1}}));
  for (const Topic& topic : messages.topics()) EXPECT_EQ(topic.latched, first.contains(topic.name)) << topic.name;
  EXPECT_EQ(then["/roomba_1/front_3/field_0"], 1);
  EXPECT_EQ(then["/roomba_1/front_3/field_1"], 1);
  EXPECT_EQ(then["/clock"], 1);
}

TEST(TickMessages, ElementsHaveFramesBelowTheirSensor) {
  const RunInfo info = named_info();
  TickMessages messages(info);
  std::map<std::string, std::string> parents;
  messages.begin([&](const TopicMessage& message) {
    if (messages.topics()[message.topic].name != "/tf_static") return;
    CdrReader cdr(message.bytes);
    std::int64_t time = 0;
    for (std::uint32_t left = cdr.get_count(60); left > 0; --left) {
      const std::string parent = get_header(cdr, time);
      parents[cdr.get_string()] = parent;
      for (int i = 0; i < 7; ++i) cdr.get<double>();
    }
    EXPECT_TRUE(cdr.good());
  });
  EXPECT_EQ(parents.at("roomba_1/front_3"), "roomba_1");
  EXPECT_EQ(parents.at("roomba_1/front_3/field_1"), "roomba_1/front_3");
  EXPECT_EQ(parents.size(), 8u) << "six sensors, two elements";
}

TEST(TickMessages, AfterAResetOdometryIsDueAtOnce) {
  const RunInfo info = named_info();
  TickMessages messages(info);
  Counts counts;
  const auto count = [&](const TopicMessage& message) { ++counts[messages.topics()[message.topic].name]; };
  messages.encode(test::SampleTick(9).record, count);
  messages.encode(test::SampleTick(0).record, count);
  EXPECT_EQ(counts["/roomba_1/odom"], 1) << "earlier than what was told";
  messages.begin([](const TopicMessage&) {});
  messages.encode(test::SampleTick(0).record, count);
  EXPECT_EQ(counts["/roomba_1/odom"], 2);
}

}  // namespace
}  // namespace sf::record
