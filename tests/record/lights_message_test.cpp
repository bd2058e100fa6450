// States of traffic lights in recordings.

#include "record/lights_message.h"

#include <gtest/gtest.h>

#include "record/recorder.h"
#include "record/recording.h"
#include "tests/record/sample.h"

namespace sf::record {
namespace {

const std::vector<std::string> kNames{"light1", "post.s"};
const std::vector<base::LightStatus> kStates{{3, 6.5}, {0, HUGE_VAL}};

TEST(LightsMessage, RoundTripsBitwise) {
  base::Bytes bytes;
  encode_lights(1'500'000'000, kNames, kStates, bytes);
  std::int64_t time = 0;
  std::vector<base::LightStatus> back;
  ASSERT_TRUE(decode_lights(bytes, time, back));
  EXPECT_EQ(time, 1'500'000'000);
  EXPECT_EQ(back, kStates);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(decode_lights(std::span(bytes).first(size), time, back)) << size << " bytes";
}

TEST(LightsMessage, RejectsUnknownStates) {
  base::Bytes bytes;
  encode_lights(0, kNames, std::vector<base::LightStatus>{{6, 0.0}, {1, 0.0}}, bytes);
  std::int64_t time = 0;
  std::vector<base::LightStatus> back;
  EXPECT_FALSE(decode_lights(bytes, time, back));
}

TEST(Recording, ContainsTheLightsOfEveryTick) {
  const std::string folder = test::fresh_directory("lights");
  RunInfo info = test::sample_info(true);
  info.lights = kNames;
  {
    Recorder recorder(folder, info);
    for (std::uint64_t tick = 0; tick < 3; ++tick) {
      test::SampleTick sample(tick);
      std::vector<base::LightStatus> states = kStates;
      states[0].left -= 0.1 * static_cast<double>(tick);
      sample.record.lights = states;
      recorder.write(sample.record);
    }
  }
  const Recording recording = open_recording(folder);
  EXPECT_TRUE(recording.damage.empty());
  ASSERT_EQ(recording.lights.size(), 3u);
  EXPECT_EQ(recording.lights[2].time, 200'000'000);
  EXPECT_EQ(recording.lights[2].lights[0], (base::LightStatus{3, 6.5 - 0.2}));
  EXPECT_EQ(recording.lights[0].lights[1], kStates[1]);
}

}  // namespace
}  // namespace sf::record
