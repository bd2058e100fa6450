// Marks of faulty readings in recordings.

#include "record/faults_message.h"

#include <gtest/gtest.h>

#include "record/recorder.h"
#include "record/recording.h"
#include "tests/record/sample.h"

namespace sf::record {
namespace {

const std::vector<base::FaultMark> kMarks{{1, 2, 3, 40, 5'000'000'006, 7}, {0, 0, 63, 0xFFFFFFFF, 0, 1u << 9}};

TEST(FaultsMessage, RoundTrips) {
  base::Bytes bytes;
  encode_faults(6'000'000'000, kMarks, bytes);
  std::vector<base::FaultMark> back;
  ASSERT_TRUE(decode_faults(bytes, back));
  EXPECT_EQ(back, kMarks);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(decode_faults(std::span(bytes).first(size), back)) << size << " bytes";
  EXPECT_EQ(back, kMarks) << "unchanged by malformed messages";
}

TEST(FaultsMessage, RejectsUnknownKinds) {
  for (const int kinds : {0, 1 << 10}) {
    base::Bytes bytes;
    encode_faults(0, std::vector<base::FaultMark>{{0, 0, 1, 0, 0, static_cast<std::uint16_t>(kinds)}}, bytes);
    std::vector<base::FaultMark> back;
    EXPECT_FALSE(decode_faults(bytes, back)) << kinds;
  }
}

/// Runs without faults have no such topic.
TEST(Recording, ContainsTheMarksOfFaultyReadings) {
  for (const bool faulty : {false, true}) {
    const std::string folder = test::fresh_directory("faults");
    RunInfo info = test::sample_info(true);
    if (faulty) info.options.emplace_back(kFaultsOption, "[[fault]]");
    {
      Recorder recorder(folder, info);
      for (std::uint64_t tick = 0; tick < 3; ++tick) {
        test::SampleTick sample(tick);
        if (tick != 1) sample.record.faults = kMarks;
        recorder.write(sample.record);
      }
    }
    const Recording recording = open_recording(folder);
    EXPECT_TRUE(recording.damage.empty());
    EXPECT_EQ(recording.faults.size(), faulty ? 4u : 0u);
    EXPECT_TRUE(!faulty || recording.faults.at(3) == kMarks[1]);
    EXPECT_EQ(option_of(recording.info, kFaultsOption), faulty ? "[[fault]]" : "");
  }
}

}  // namespace
}  // namespace sf::record
