// Topics of a run, and which of them a tick has something to say on.

#include "record/tick_messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "record/cdr.h"
#include "record/reading_messages.h"
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

/// Ranges of the second scan of the sample, and the first field of its first array, as a tick's messages have them.
std::pair<float, double> told_values(const RunInfo& info, const base::TickRecord& record) {
  TickMessages messages(info);
  std::pair<float, double> told{NAN, NAN};
  messages.encode(record, [&](const TopicMessage& message) {
    const std::string& topic = messages.topics()[message.topic].name;
    if (topic == "/roomba_1/front_2/scan") told.first = decode_scan(message.bytes)->ranges.at(0);
    std::int64_t time = 0;
    std::vector<double> values;
    if (topic != "/roomba_1/front_3/array" || !decode_reading(info.sensor_types[2], message.bytes, time, values))
      return;
    told.second = values.at(0);
  });
  return told;
}

/// In messages, which have no flags, surfaces that are too near are -infinity (REP 117), or `range_min` where that is
/// asked for.
TEST(TickMessages, RangesOfSurfacesThatAreTooNearAreMarked) {
  RunInfo info = named_info();
  test::SampleTick tick(0);
  const double range = tick.ranges[1][0] = 0.5, field = tick.ranges[3][0];
  EXPECT_EQ(told_values(info, tick.record), std::pair(static_cast<float>(range), field)) << "without flags";

  const base::QualityFlag near[] = {base::QualityFlag::too_near, base::QualityFlag::none};
  tick.readings[1].quality = std::span(near).first(1);
  tick.readings[3].quality = near;
  EXPECT_EQ(told_values(info, tick.record), std::pair(-HUGE_VALF, -HUGE_VAL));
  info.options.emplace_back(kTooNear, "min");
  EXPECT_EQ(told_values(info, tick.record), std::pair(static_cast<float>(range), field));
}

}  // namespace
}  // namespace sf::record
