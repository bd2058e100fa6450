#include "record/recorder.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <map>
#include <tuple>

#include "base/error.h"
#include "record/mcap_reader.h"
#include "record/recording.h"
#include "record/ros_messages.h"
#include "tests/record/sample.h"
#include "tests/refusal.h"

namespace sf::record {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::fresh_directory;
using test::sample_info;
using test::SampleTick;

void write_ticks(Recorder& recorder, std::uint64_t first, std::uint64_t count) {
  for (std::uint64_t tick = first; tick < first + count; ++tick) recorder.write(SampleTick(tick).record);
}

constexpr RecordingPart kUncompressed{.compression = Compression::none};

std::map<std::string, std::size_t> topics_of(const base::Bytes& file) {
  const McapContents contents = read_mcap(file, "run.mcap");
  std::map<std::string, std::size_t> topics;
  for (const McapMessage& message : contents.messages) ++topics[contents.channels.at(message.channel).topic];
  return topics;
}

/// log_time is the time of delivery, publish_time the time of the measurement.
TEST(Recorder, ReadingsHaveBothOfTheirTimes) {
  const std::string directory = fresh_directory("times");
  Recorder recorder(directory, sample_info(true));
  write_ticks(recorder, 4, 1);
  recorder.finish();
  const base::Bytes file = bytes_of(directory + "/run.mcap");
  std::map<std::uint32_t, std::pair<std::uint64_t, std::uint64_t>> times;  // by sequence
  for (const McapMessage& m : read_mcap(file, "run.mcap").messages) times[m.sequence] = {m.log_time, m.publish_time};
  for (const std::uint32_t scan_and_array : {5u, 8u})
    EXPECT_EQ(times[scan_and_array], (std::pair<std::uint64_t, std::uint64_t>{400'000'000, 200'000'000}));
}

TEST(Recorder, WritesTheWorldBeforeTheFirstTick) {
  const std::string directory = fresh_directory("first");
  const Recorder recorder(directory, sample_info(false));
  const Recording recording = open_recording(directory);
  EXPECT_TRUE(recording.truncated);
  EXPECT_EQ(recording.ticks, 0u);
  EXPECT_EQ(recording.info.snapshot, sample_info(false).snapshot);
  EXPECT_FALSE(fs::exists(directory + "/run.mcap.new"));
}

TEST(Recorder, UncompressedTicksAreReadableWhenWriteReturns) {
  const std::string directory = fresh_directory("live");
  Recorder recorder(directory, sample_info(false), kUncompressed);
  for (std::uint64_t tick = 0; tick < 4; ++tick) {
    write_ticks(recorder, tick, 1);
    EXPECT_EQ(open_recording(directory).ticks, tick + 1);
    EXPECT_EQ(recorder.size(), fs::file_size(recorder.path()));
  }
}

// Kept below the build directory, as a sample for other readers of MCAP.
TEST(Recorder, TopicsMatchTheDocumentation) {
  const std::string directory = fresh_directory("sample");
  Recorder recorder(directory, sample_info(true));
  write_ticks(recorder, 0, 10);
  recorder.finish();
  const auto topics = topics_of(bytes_of(recorder.path()));
  const std::map<std::string, std::size_t> expected = {
      {"/run", 1},
      {"/tf_static", 1},
      {"/bodies", 1},
      {"/fleet", 10},
      {"/tf", 10},
      {"/clock", 10},
      {"/roomba_1/odom", 5},  // 5 Hz of 10
      {"/roomba_1/ground_truth/odom", 5},
      {"/roomba_1/cmd_vel", 5},
      {"/roomba_1/scan", 10},
      {"/roomba_1/scan_1", 10},
      {"/roomba_1/array", 10},
      {"/roomba_1/edge", 10},
      {"/roomba_1/array_1", 10},
      {"/roomba_1_2/odom", 5},
      {"/roomba_1_2/ground_truth/odom", 5},
      {"/roomba_1_2/cmd_vel", 5},
      {"/roomba_1_2/scan", 10},
  };
  EXPECT_EQ(topics, expected);
}

/// Names of earlier versions, on request.
TEST(Recorder, TopicsMayBeNamedAfterSensors) {
  RunInfo info = sample_info(true);
  put_naming({.style = TopicStyle::sensor}, info);
  Recorder recorder(fresh_directory("sensor_names"), info);
  write_ticks(recorder, 0, 1);
  recorder.finish();
  std::map<std::string, std::size_t> expected;
  for (const char* name :
       {"/run", "/tf_static", "/bodies", "/fleet", "/tf", "/clock", "/roomba_1/odom", "/roomba_1/cmd_vel",
        "/roomba_1/front/scan", "/roomba_1/front_2/scan", "/roomba_1/front_3/array", "/roomba_1/_3rd_edge/edge",
        "/roomba_1/rear/array", "/roomba_1_2/odom", "/roomba_1_2/cmd_vel", "/roomba_1_2/laser/scan"})
    expected[name] = 1;
  EXPECT_EQ(topics_of(bytes_of(recorder.path())), expected);
}

TEST(Recorder, RecordsTheQualityOfEstimatedStates) {
  const std::string directory = fresh_directory("estimated");
  RunInfo info = sample_info(false);
  info.estimated = true;
  info.odometry_rate = 0.0;
  Recorder recorder(directory, info);
  SampleTick tick(0);
  // The first mover has a state that is 1/4 s old, the second an unknown state; then the first leaves the world.
  const std::vector<base::StateQuality> qualities = {
      {.stated = true, .stale = true, .age = 250'000'000, .covariance = {1, 2, 3, 4, 5, 6}}, {}};
  tick.record.qualities = qualities;
  recorder.write(tick.record);
  tick.reports[0].X_WM = base::kAbsent;
  recorder.write(tick.record);
  recorder.finish();
  const base::Bytes bytes = bytes_of(recorder.path());
  EXPECT_EQ(topics_of(bytes).at("/roomba_1/state_quality"), 2u);
  EXPECT_FALSE(topics_of(bytes).contains("/roomba_1_2/state_quality"));
  const McapContents contents = read_mcap(bytes, "run.mcap");
  for (const McapMessage& message : contents.messages) {
    if (contents.channels.at(message.channel).topic != "/roomba_1/state_quality") continue;
    CdrReader cdr(message.data);
    std::int64_t time = 0;
    EXPECT_EQ(get_header(cdr, time), "roomba_1/base_link");
    EXPECT_TRUE(cdr.get<bool>());
    EXPECT_EQ(cdr.get<double>(), 0.25);
    for (int i = 1; i <= 6; ++i) EXPECT_EQ(cdr.get<float>(), static_cast<float>(i));
    EXPECT_TRUE(cdr.good());
  }
  const Recording recording = read_recording(bytes, "run.mcap");
  EXPECT_TRUE(recording.damage.empty()) << recording.damage[0];
  EXPECT_TRUE(base::is_absent(recording.states[0][1].X_WM));
  EXPECT_FALSE(base::is_absent(recording.states[1][1].X_WM));
}

TEST(Recorder, WithoutReadingsAndOdometryRecordsOnlyExactStatesAndFrames) {
  const std::string directory = fresh_directory("lean");
  RunInfo info = sample_info(false);
  info.odometry_rate = 0.0;
  Recorder recorder(directory, info);
  write_ticks(recorder, 0, 3);
  recorder.finish();
  const std::map<std::string, std::size_t> expected = {{"/run", 1},   {"/tf_static", 1}, {"/bodies", 1},
                                                       {"/fleet", 3}, {"/tf", 3},        {"/clock", 3}};
  EXPECT_EQ(topics_of(bytes_of(recorder.path())), expected);
}

TEST(Recorder, EverySensorHasAFrame) {
  Recorder recorder(fresh_directory("frames"), sample_info(false), kUncompressed);
  recorder.finish();
  const base::Bytes file = bytes_of(recorder.path());
  const std::string text(file.begin(), file.end());
  for (const char* frame :
       {"roomba_1/laser", "roomba_1/laser_1", "roomba_1/array", "roomba_1/array_1", "roomba_1/edge"})
    EXPECT_NE(text.find(std::string(frame) + '\0'), std::string::npos) << frame;
}

TEST(Recorder, TheSameRunGivesTheSameBytes) {
  base::Bytes files[2];
  for (base::Bytes& file : files) {
    Recorder recorder(fresh_directory("same"), sample_info(true));
    write_ticks(recorder, 0, 5);
    recorder.finish();
    file = bytes_of(recorder.path());
  }
  EXPECT_EQ(files[0], files[1]);
}

TEST(Recorder, TheDestructorFinishes) {
  const std::string directory = fresh_directory("destructor");
  { Recorder(directory, sample_info(false)).write(SampleTick(0).record); }
  EXPECT_FALSE(open_recording(directory).truncated);
}

TEST(Recorder, FinishIsIdempotent) {
  Recorder recorder(fresh_directory("twice"), sample_info(false));
  recorder.finish();
  const auto size = recorder.size();
  recorder.finish();
  EXPECT_EQ(recorder.size(), size);
}

/// With compression, all ticks except those that its thread still holds.
TEST(Recorder, KilledProcessLeavesEveryWrittenTick) {
  for (const Compression compression : {Compression::none, Compression::zstd}) {
    const std::string directory = fresh_directory("killed");
    const pid_t child = ::fork();
    if (child == 0) {
      Recorder recorder(directory, sample_info(true), {.compression = compression});
      write_ticks(recorder, 0, 7);
      ::raise(SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    const Recording recording = open_recording(directory);
    EXPECT_TRUE(recording.truncated);
    EXPECT_TRUE(recording.damage.empty());
    EXPECT_LE(recording.ticks, 7u);
    EXPECT_GE(recording.ticks, compression == Compression::none ? 7u : 7u - ChunkWriter::kMaxWaiting - 1);
    EXPECT_EQ(recording.readings.size(), 6 * recording.ticks);
  }
}

/// Both forms contain the same messages, and the version that wrote them.
TEST(Recorder, CompressedChunksContainTheSameMessages) {
  McapContents contents[2];
  base::Bytes files[2];
  for (const bool zstd : {false, true}) {
    Recorder recorder(fresh_directory("form"), sample_info(true), zstd ? RecordingPart{} : kUncompressed);
    write_ticks(recorder, 0, 20);
    recorder.finish();
    files[zstd] = bytes_of(recorder.path());
    contents[zstd] = read_mcap(files[zstd], "run.mcap");
    EXPECT_TRUE(contents[zstd].damage.empty()) << contents[zstd].damage[0];
    EXPECT_FALSE(contents[zstd].truncated);
    EXPECT_EQ(contents[zstd].compression, zstd ? Compression::zstd : Compression::none);
    EXPECT_EQ(contents[zstd].library, "sensorfarm " SF_VERSION);
  }
  EXPECT_LT(files[1].size(), files[0].size() * 3 / 4);
  ASSERT_EQ(contents[0].messages.size(), contents[1].messages.size());
  for (std::size_t i = 0; i < contents[0].messages.size(); ++i) {
    const McapMessage &a = contents[0].messages[i], &b = contents[1].messages[i];
    EXPECT_EQ(std::tie(a.channel, a.sequence, a.log_time, a.publish_time),
              std::tie(b.channel, b.sequence, b.log_time, b.publish_time));
    EXPECT_TRUE(std::equal(a.data.begin(), a.data.end(), b.data.begin(), b.data.end())) << i;
  }
}

TEST(Recorder, ReplacesAnOlderRecordingCompletely) {
  const std::string directory = fresh_directory("replaced");
  {
    Recorder recorder(directory, sample_info(true));
    write_ticks(recorder, 0, 5);
  }
  std::ofstream(directory + "/run.mcap.new") << "left by a process that was killed before it began";
  Recorder recorder(directory, sample_info(false));
  EXPECT_EQ(open_recording(directory).ticks, 0u);
  EXPECT_EQ(bytes_of(recorder.path()).size(), recorder.size());  // no bytes of the old file follow the new ones
}

TEST(Recorder, FailedStartKeepsTheOlderRecording) {
  const std::string directory = fresh_directory("kept");
  {
    Recorder recorder(directory, sample_info(true));
    write_ticks(recorder, 0, 5);
  }
  RunInfo info = sample_info(false);
  info.movers.resize(40'000);  // two topics each
  EXPECT_NE(refusal_of([&] { Recorder(directory, info); }).find("needs 80008 topics"), std::string::npos);
  EXPECT_EQ(open_recording(directory).ticks, 5u);
  EXPECT_FALSE(fs::exists(directory + "/run.mcap.new"));
}

/// Replaces a link of that name, whoever created it in the folder. Its target is unchanged.
TEST(Recorder, DoesNotFollowLinks) {
  const std::string directory = fresh_directory("link");
  const std::string target = directory + "/target";
  fs::create_directories(directory);
  std::ofstream(target) << "precious";
  fs::create_symlink(target, directory + "/run.mcap.new");
  {
    Recorder recorder(directory, sample_info(false));
    write_ticks(recorder, 0, 2);
  }
  EXPECT_EQ(fs::file_size(target), 8u);
  EXPECT_FALSE(fs::is_symlink(directory + "/run.mcap"));
  EXPECT_EQ(open_recording(directory).ticks, 2u);
}

/// A plug-in may change it before the file gets its name.
TEST(Recorder, WorkingDirectoryMayChange) {
  const std::string directory = fresh_directory("moved");
  const fs::path here = fs::current_path();
  {
    Recorder recorder(fs::relative(directory, here).string(), sample_info(false));
    fs::current_path("/");
    write_ticks(recorder, 0, 2);
  }
  fs::current_path(here);
  EXPECT_EQ(open_recording(directory).ticks, 2u);
}

TEST(Recorder, RejectsASecondRecorderWhileTheFirstExists) {
  const std::string directory = fresh_directory("second");
  {
    Recorder first(directory, sample_info(false));
    EXPECT_NE(refusal_of([&] { Recorder(directory, sample_info(false)); }).find("another run is being recorded here"),
              std::string::npos);
    write_ticks(first, 0, 2);
  }
  EXPECT_EQ(open_recording(directory).ticks, 2u);
  EXPECT_NO_THROW(Recorder(directory, sample_info(false)));
}

TEST(Recorder, RejectsAnUnwritableFolderWithTheReason) {
  EXPECT_NE(refusal_of([] { Recorder("/dev/null/run", sample_info(false)); }).find("cannot be created as a directory"),
            std::string::npos);  // below a file
  const std::string directory = fresh_directory("occupied");
  fs::create_directories(directory + "/run.mcap.new");
  EXPECT_NE(refusal_of([&] { Recorder(directory, sample_info(false)); }).find("Is a directory"), std::string::npos);
}

/// Limits the size of all files of this process, like a full disk.
class FullDisk {
 public:
  explicit FullDisk(std::uint64_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit bound = {bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &bound);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_ = {};
  void (*handler_)(int) = nullptr;
};

TEST(Recorder, FullDiskIsReportedAndKeepsEarlierTicks) {
  const std::string directory = fresh_directory("full");
  std::uint64_t kept = 0;
  std::string error;
  {
    Recorder recorder(directory, sample_info(true), kUncompressed);
    write_ticks(recorder, 0, 2);
    const std::uint64_t whole = recorder.size();
    const FullDisk disk(whole + 5000);
    error = refusal_of([&] {
      for (kept = 2; kept < 100; ++kept) write_ticks(recorder, kept, 1);
    });
    EXPECT_NO_THROW(recorder.finish());  // no more data to lose
  }
  EXPECT_NE(error.find("run.mcap: cannot take more than"), std::string::npos) << error;
  EXPECT_LT(kept, 100u);
  const Recording recording = open_recording(directory);
  EXPECT_TRUE(recording.truncated);
  EXPECT_GE(recording.ticks, kept);
  EXPECT_LE(recording.ticks, kept + 1);  // the whole messages of the truncated chunk
}

/// The error of the thread is reported at a later tick, or at the end.
TEST(Recorder, FullDiskIsReportedForCompressedTicks) {
  const std::string directory = fresh_directory("full_compressed");
  std::uint64_t written = 0;
  std::string error;
  {
    Recorder recorder(directory, sample_info(true));
    const FullDisk disk(recorder.size() + 5000);
    error = refusal_of([&] {
      for (; written < 100; ++written) write_ticks(recorder, written, 1);
    });
    EXPECT_NO_THROW(recorder.finish());
  }
  EXPECT_NE(error.find("run.mcap: cannot take more than"), std::string::npos) << error;
  EXPECT_LT(written, 100u);
  const Recording recording = open_recording(directory);
  EXPECT_TRUE(recording.truncated);
  EXPECT_TRUE(recording.damage.empty());
  EXPECT_LT(recording.ticks, written + 1);
  EXPECT_GE(recording.ticks + ChunkWriter::kMaxWaiting + 1, written);
  EXPECT_GT(recording.ticks, 0u);
}

TEST(Recorder, FullDiskAtTheEndIsReported) {
  Recorder recorder(fresh_directory("full_end"), sample_info(false));
  const FullDisk disk(recorder.size());
  EXPECT_NE(refusal_of([&] { recorder.finish(); }).find("cannot take more than"), std::string::npos);
}

TEST(Recorder, FullDiskAtTheStartLeavesNothing) {
  const std::string directory = fresh_directory("full_start");
  const FullDisk disk(100);
  EXPECT_NE(refusal_of([&] { Recorder(directory, sample_info(false)); }).find("cannot take more"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(directory));
}

TEST(Recorder, BrokenPreconditionsAbortWithTheValues) {
  const std::string directory = fresh_directory("contracts");
  RunInfo worldless = sample_info(false);
  worldless.snapshot.clear();
  EXPECT_DEATH(Recorder(directory, worldless), "without its world");
  EXPECT_DEATH(Recorder(directory, sample_info(false)).write(SampleTick(0, 3).record), "mover 2");
  const auto wrong_sensor = [&] {
    SampleTick tick(0);
    tick.readings[2].sensor = 1;
    Recorder(directory, sample_info(true)).write(tick.record);
  };
  EXPECT_DEATH(wrong_sensor(), "mover 1 type 1 sensor 1");
  const auto wrong_type = [&](std::uint8_t type, std::uint32_t sensor) {
    SampleTick tick(0);
    tick.readings[3].type = type;
    tick.readings[3].sensor = sensor;
    Recorder(directory, sample_info(true)).write(tick.record);
  };
  EXPECT_DEATH(wrong_type(4, 0), "mover 0 type 4 sensor 0");  // no such sensor type
  EXPECT_DEATH(wrong_type(3, 2), "mover 0 type 3 sensor 2");  // only two of them
  EXPECT_DEATH(wrong_type(2, 0), "10 values in a reading of type edge");
  RunInfo typeless = sample_info(true);
  typeless.sensor_types.pop_back();
  EXPECT_DEATH(Recorder(directory, typeless), "sensor type 3");
}

// The size for a hundred robots: the figures in docs/recordings.md.
TEST(Recorder, BytesPerTickOfAHundredRobots) {
  RunInfo info = sample_info(false);
  info.odometry_rate = 1.0;
  info.movers.clear();
  for (std::uint32_t i = 0; i < 100; ++i) {
    info.movers.push_back({.name = "robot" + std::to_string(i), .id = i, .sensors = {{.type = 1, .name = "laser0"}}});
  }
  Recorder recorder(fresh_directory("hundred"), info, kUncompressed);
  const auto start = recorder.size();
  for (std::uint64_t tick = 0; tick < 600; ++tick) {
    SampleTick sample(tick, 100);
    sample.record.readings = {};
    recorder.write(sample.record);
  }
  recorder.finish();
  const auto per_tick = (recorder.size() - start) / 600;
  RecordProperty("bytes_per_tick", std::to_string(per_tick));
  EXPECT_LT(per_tick, 32'000u);
  EXPECT_GT(per_tick, 8'800u);  // 88 bytes per state
}

}  // namespace
}  // namespace sf::record
