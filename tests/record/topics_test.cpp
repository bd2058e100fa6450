// Topics of a run, and the topics on which a tick sends messages.

#include "record/topics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "record/cdr.h"
#include "record/reading_messages.h"
#include "record/schemas.h"
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

/// Number of messages by topic name.
using Counts = std::map<std::string, int>;

TEST(TickMessages, EncodesOnlyWantedTopics) {
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
      tick.record, [](const TopicMessage&) { ADD_FAILURE() << "no topic was requested"; }, wanted);
}

TEST(TickMessages, LatchedTopicsAreSentOnlyAtTheBeginning) {
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
  EXPECT_EQ(then["/roomba_1/array/field_0"], 1);
  EXPECT_EQ(then["/roomba_1/array/field_1"], 1);
  EXPECT_EQ(then["/clock"], 1);
}

TEST(TickMessages, ElementsHaveFramesBelowTheirSensor) {
  RunInfo info = named_info();
  const SensorInfo& laser = info.movers[0].sensors[0];
  info.movers[0].sensors[0].X_MS = {}, info.movers[0].sensors[0].tilt.pitch = 0.2;
  TickMessages messages(info);
  std::map<std::string, std::string> parents;
  double turn[4] = {};
  messages.begin([&](const TopicMessage& message) {
    if (messages.topics()[message.topic].name != "/tf_static") return;
    CdrReader cdr(message.bytes);
    std::int64_t time = 0;
    for (std::uint32_t left = cdr.get_count(60); left > 0; --left) {
      const std::string parent = get_header(cdr, time);
      const std::string child = cdr.get_string();
      parents[child] = parent;
      for (int i = 0; i < 7; ++i) {
        const auto number = cdr.get<double>();
        if (child == laser.frame && i >= 3) turn[i - 3] = number;
      }
    }
    EXPECT_TRUE(cdr.good());
  });
  EXPECT_NEAR(turn[1], std::sin(0.1), 1e-15) << "a laser with its nose down";
  EXPECT_NEAR(turn[3], std::cos(0.1), 1e-15);
  EXPECT_EQ(parents.at("roomba_1/array"), "roomba_1/base_link");
  EXPECT_EQ(parents.at("roomba_1/array/field_1"), "roomba_1/array");
  EXPECT_EQ(parents.at("roomba_1/base_footprint"), "roomba_1/base_link");
  EXPECT_EQ(parents.at("world"), "map");
  EXPECT_EQ(parents.size(), 11u) << "six sensors, two elements, two places on the ground, the world";
}

/// Frames as seen by listeners of tf, by topic.
struct Frames {
  std::map<std::string, std::string> parents;  ///< by child
  std::map<std::string, base::Pose> poses;     ///< in the parent, newest
  std::map<std::string, std::int64_t> stamps;  ///< newest
  bool sound = true;                           ///< each has one parent, and stamps increase

  void read(std::span<const std::uint8_t> message) {
    CdrReader cdr(message);
    for (std::uint32_t left = cdr.get_count(60); left > 0; --left) {
      std::int64_t time = 0;
      const std::string parent = get_header(cdr, time), child = cdr.get_string();
      double numbers[7];
      for (double& number : numbers) number = cdr.get<double>();
      sound = sound && parents.try_emplace(child, parent).first->second == parent;
      const auto [last, is_new] = stamps.try_emplace(child, time);
      sound = sound && (is_new || time > last->second);
      last->second = time;
      poses[child] = {numbers[0], numbers[1], numbers[2], 2.0 * std::atan2(numbers[5], numbers[6])};
    }
  }
  /// @return the pose in the top frame @param root out: the name of that frame
  base::Pose pose(std::string frame, std::string& root) const {
    base::Pose X;
    for (int depth = 0; parents.contains(frame) && depth < 10; ++depth) {
      X = base::compose(poses.at(frame), X);
      frame = parents.at(frame);
    }
    root = frame;
    return X;
  }
};

/// By topics of tf, without their last part.
std::map<std::string, Frames> frames_of(const RunInfo& info, int ticks) {
  TickMessages messages(info);
  std::map<std::string, Frames> trees;
  const auto read = [&](const TopicMessage& message) {
    const Topic& topic = messages.topics()[message.topic];
    if (topic.type == kTransforms) trees[topic.name.substr(0, topic.name.rfind('/'))].read(message.bytes);
  };
  messages.begin(read);
  for (int tick = 0; tick < ticks; ++tick)
    messages.encode(test::SampleTick(static_cast<std::uint64_t>(tick)).record, read);
  return trees;
}

RunInfo info_with(const Naming& naming) {
  RunInfo info = test::sample_info(true);
  put_naming(naming, info);
  info.movers[0].plain = naming.style == TopicStyle::plain;
  name_frames(info);
  return info;
}

TEST(TickMessages, EveryFrameHasOneParentAndLeadsToTheMap) {
  const test::SampleTick last(4);
  for (const auto& [word, style] : kTopicStyles)
    for (const auto& [source_word, source] : kOdometrySources) {
      const RunInfo info = info_with({style, source});
      const auto trees = frames_of(info, 5);
      EXPECT_EQ(trees.size(), style == TopicStyle::nav2 ? 2u : 1u) << word;
      for (std::size_t row = 0; row < 2; ++row) {
        const MoverInfo& mover = info.movers[row];
        const Frames& frames = trees.at(style == TopicStyle::nav2 ? mover.space : "");
        EXPECT_TRUE(frames.sound) << word << source_word;
        for (const auto& [child, parent] : frames.parents) {
          std::string root;
          frames.pose(child, root);
          EXPECT_EQ(root, style == TopicStyle::sensor ? "world" : "map") << word << child;
        }
        std::string root;
        const base::Pose X = frames.pose(mover.base_frame, root), &truth = last.reports[row].X_WM;
        EXPECT_NEAR(std::hypot(X.x - truth.x, X.y - truth.y), 0.0, 1e-9) << word << source_word;
        EXPECT_NEAR(base::wrap_angle(X.yaw - truth.yaw), 0.0, 1e-9) << word << source_word;
      }
    }
}

/// A transform that an external node publishes would add a second parent.
TEST(TickMessages, OmitsTransformsOfExternalNodes) {
  const auto children = [](const Naming& naming) {
    const RunInfo info = info_with(naming);
    std::string text;
    const auto trees = frames_of(info, 3);
    for (const auto& [child, parent] : trees.at("").parents)
      if (child == "roomba_1/odom" || child == "roomba_1/base_link" || child == "world") text += child + " ";
    const TickMessages messages(info);
    for (const Topic& topic : messages.topics())
      if (topic.name == "/map") text += topic.name;
    return text;
  };
  for (const OdometrySource source : {OdometrySource::encoders, OdometrySource::truth}) {
    EXPECT_EQ(children({.odometry = source}), "roomba_1/base_link roomba_1/odom world /map");
    EXPECT_EQ(children({.odometry = source, .localizer = true}), "roomba_1/base_link world /map");
    EXPECT_EQ(children({.odometry = source, .mapper = true}), "roomba_1/base_link ");
    EXPECT_EQ(children({.odometry = source, .filter = true}), "roomba_1/odom world /map");
    EXPECT_EQ(children({.odometry = source, .mapper = true, .filter = true}), "");
  }
}

/// A robot with encoders has the odometry of their readings, at the times of these; others have one per tick.
TEST(TickMessages, OdometryComesFromEncoders) {
  RunInfo info = test::sample_info(true);
  info.sensor_types.push_back({.id = 8, .name = "encoder", .columns = {{"left_m"}, {"right_m"}}});
  info.movers[0].sensors.push_back({.type = 8, .name = "wheels"});
  info.movers[0].encoder = EncoderInfo{8, 1e-3, 0.0, 0.5};
  name_frames(info);
  TickMessages messages(info);
  test::SampleTick tick(1);
  const double rolled[2] = {0.2, 0.2};
  tick.readings.push_back({.mover = 0, .type = 8, .time = 50'000'000, .X_WM = {3.0, 1.0, 0.0, 0.0}, .values = rolled});
  tick.record.readings = tick.readings;
  std::map<std::string, std::pair<std::string, double>> odometry;  // frame and x by topic
  std::map<std::string, std::int64_t> times;
  Frames frames;
  messages.begin([&](const TopicMessage&) {});
  messages.encode(tick.record, [&](const TopicMessage& message) {
    const Topic& topic = messages.topics()[message.topic];
    if (topic.name == "/tf") frames.read(message.bytes);
    if (topic.type != kOdometry) return;
    CdrReader cdr(message.bytes);
    const std::string frame = get_header(cdr, times[topic.name]), child = cdr.get_string();
    odometry[topic.name] = {frame + " " + child, cdr.get<double>()};
    EXPECT_EQ(message.time, times[topic.name]);
  });
  EXPECT_EQ(odometry.at("/roomba_1/odom"), std::pair(std::string("roomba_1/odom roomba_1/base_link"), 0.2));
  EXPECT_EQ(times.at("/roomba_1/odom"), 50'000'000);
  EXPECT_EQ(odometry.at("/roomba_1/ground_truth/odom"),
            std::pair(std::string("world roomba_1/base_link"), tick.reports[0].X_WM.x));
  EXPECT_EQ(times.at("/roomba_1/ground_truth/odom"), tick.record.time);
  EXPECT_EQ(odometry.at("/roomba_1_2/odom").second, 0.0) << "exact, from where it begins";
  EXPECT_EQ(frames.stamps.at("roomba_1/base_link"), 50'000'000);
  EXPECT_EQ(frames.stamps.at("roomba_1/odom"), 50'000'000);
  EXPECT_EQ(frames.stamps.at("roomba_1_2/base_link"), tick.record.time);
  std::string root;
  EXPECT_NEAR(frames.pose("roomba_1/base_link", root).x, 3.0, 1e-12) << "where it was at the reading";
}

TEST(TickMessages, RecordingsWithoutReadingsHaveTrueOdometry) {
  RunInfo info = test::sample_info(false);
  info.movers[0].encoder = EncoderInfo{};
  name_frames(info);
  const auto trees = frames_of(info, 2);
  EXPECT_EQ(trees.at("").poses.at("roomba_1/odom").x, 0.0);
  EXPECT_EQ(trees.at("").poses.at("roomba_1/base_link").x, test::SampleTick(1).reports[0].X_WM.x);
}

TEST(TickMessages, AfterAResetOdometryIsDueAtOnce) {
  const RunInfo info = named_info();
  TickMessages messages(info);
  Counts counts;
  const auto count = [&](const TopicMessage& message) { ++counts[messages.topics()[message.topic].name]; };
  messages.encode(test::SampleTick(9).record, count);
  messages.encode(test::SampleTick(0).record, count);
  EXPECT_EQ(counts["/roomba_1/odom"], 1) << "older than the last published one";
  messages.begin([](const TopicMessage&) {});
  messages.encode(test::SampleTick(0).record, count);
  EXPECT_EQ(counts["/roomba_1/odom"], 2);
}

/// Returns the range of the second scan of the sample, and the first field of its first array, in a tick's messages.
std::pair<float, double> published_values(const RunInfo& info, const base::TickRecord& record) {
  TickMessages messages(info);
  std::pair<float, double> ranges{NAN, NAN};
  messages.encode(record, [&](const TopicMessage& message) {
    const std::string& topic = messages.topics()[message.topic].name;
    if (topic == "/roomba_1/scan_1") ranges.first = decode_scan(message.bytes)->ranges.at(0);
    std::int64_t time = 0;
    std::vector<double> values;
    if (topic != "/roomba_1/array" || !decode_reading(info.sensor_types[2], message.bytes, time, values)) return;
    ranges.second = values.at(0);
  });
  return ranges;
}

/// In messages, which have no flags, surfaces that are too near are -infinity (REP 117), or `range_min` on request.
TEST(TickMessages, RangesOfSurfacesThatAreTooNearAreMarked) {
  RunInfo info = named_info();
  test::SampleTick tick(0);
  const double range = tick.ranges[1][0] = 0.5, field = tick.ranges[3][0];
  EXPECT_EQ(published_values(info, tick.record), std::pair(static_cast<float>(range), field)) << "without flags";

  const base::QualityFlag near[] = {base::QualityFlag::too_near, base::QualityFlag::none};
  tick.readings[1].quality = std::span(near).first(1);
  tick.readings[3].quality = near;
  EXPECT_EQ(published_values(info, tick.record), std::pair(-HUGE_VALF, -HUGE_VAL));
  info.options.emplace_back(kTooNear, "min");
  EXPECT_EQ(published_values(info, tick.record), std::pair(static_cast<float>(range), field));
}

}  // namespace
}  // namespace sf::record
