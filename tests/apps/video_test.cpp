// `run --video`, `plot --video` and `view --frames`.

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>

#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/viz/png.h"

namespace sf {
namespace {

class Video : public testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path program = SF_PROGRAM;
    if (!std::filesystem::exists(program.parent_path() / "sensorfarm_ffmpeg.so"))
      GTEST_SKIP() << "built without FFmpeg";
  }
  /// Two robots that wander for `seconds`.
  Words run(const std::string& video, const std::string& seconds, const Words& more = {}) const {
    return with({"run", our_world("cave.world"), "--robots", "2", "--duration", seconds, "--video", video,
                 "--video-size", "160x120", "--json"},
                more);
  }
  std::string record(const std::string& seconds) const {
    run_successfully(
        {"run", our_world("cave.world"), "--robots", "2", "--duration", seconds, "--record", folder.path("r")});
    return folder.path("r");
  }
  /// Checks with another program, if it is installed: "codec,frames" and the duration.
  void expect_probed(const std::string& file, const std::string& expected) const {
    if (!succeeds("ffprobe -version")) return;
    EXPECT_TRUE(
        succeeds("(ffprobe -v error -count_frames -of csv=p=0 -show_entries "
                 "stream=codec_name,nb_read_frames:format=duration '" +
                 file + "' > '" + folder.path("probe") + "')"));
    EXPECT_EQ(read_file(folder.path("probe")).substr(0, expected.size()), expected);
  }
  Folder folder;
};

/// Ten seconds of ticks give ten seconds of video, divided by the speed.
TEST_F(Video, DurationIsThatOfTheRunDividedByTheSpeed) {
  const Outcome one = run_successfully(run(folder.path("one.webm"), "10"));
  EXPECT_NE(one.out.find("\"frames\": 250"), std::string::npos) << one.out;
  EXPECT_NE(one.out.find("\"seconds\": 10.0"), std::string::npos) << one.out;
  EXPECT_EQ(one.err.find('\r'), std::string::npos) << "progress in a pipe";
  const Outcome four =
      run_successfully(run(folder.path("four.webm"), "10", {"--video-speed", "4", "--video-fps", "10"}));
  EXPECT_NE(four.out.find("\"frames\": 25,"), std::string::npos) << four.out;
  expect_probed(folder.path("one.webm"), "vp9,250\n10.000000\n");
  expect_probed(folder.path("four.webm"), "vp9,25\n2.500000\n");
}

/// Frames depend only on states: those of a run and of its recording are the same.
TEST_F(Video, ARecordingHasTheSameVideoAsItsRun) {
  run_successfully(run(folder.path("run.webm"), "4", {"--record", folder.path("r")}));
  const Outcome plotted =
      run_successfully({"plot", folder.path("r"), "--video", folder.path("plot.webm"), "--video-size", "160x120"});
  EXPECT_NE(plotted.err.find("plot.webm: 100 frames, 4 s"), std::string::npos) << plotted.err;
  EXPECT_FALSE(read_file(folder.path("run.webm")).empty());
  EXPECT_TRUE(read_file(folder.path("run.webm")) == read_file(folder.path("plot.webm")));
}

/// A video does not change the run.
TEST_F(Video, ReadingsDoNotDependOnIt) {
  const Outcome with = run_successfully(run(folder.path("v.webm"), "2", {"--video-readings", "roomba1"}));
  const Outcome without = run_program({"run", our_world("cave.world"), "--robots", "2", "--duration", "2", "--json"});
  const auto hash = [](const Outcome& outcome) {
    return outcome.out.substr(outcome.out.find("\"hash\"")).substr(0, 30);
  };
  EXPECT_EQ(hash(with), hash(without));
}

TEST_F(Video, FramesArePngFilesForOtherEncoders) {
  const std::string recording = record("2");
  const Outcome outcome = run_successfully({"view", recording, "--frames", folder.path("f"), "--video-fps", "10",
                                            "--video-size", "160x120", "--from", "0.5", "--video-readings", "roomba1"});
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path("f")))
    count += entry.path().extension() == ".png";
  EXPECT_EQ(count, 15u) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(folder.path("f/000014.png")));
  EXPECT_NE(read_file(folder.path("f/000000.png")), read_file(folder.path("f/000014.png")));
}

/// Frames left by a longer earlier call would be read as the end of this video; other files belong to the user.
TEST_F(Video, FramesOfAnEarlierCallAreRemoved) {
  const std::string recording = record("2"), frames = folder.path("f");
  const auto write = [&](const std::string& fps) {
    const Outcome outcome =
        run_successfully({"view", recording, "--frames", frames, "--video-fps", fps, "--video-size", "64x64"});
    return outcome.err;
  };
  EXPECT_EQ(write("20").find("earlier"), std::string::npos);
  ASSERT_TRUE(std::filesystem::exists(frames + "/000039.png"));
  const Words others{"00039.png", "x000039.png", "000039.jpg", "000039", "0000a9.png"};
  for (const std::string& name : others) folder.write("f/" + name, "");
  folder.write("f/1000000.png", "");  // the frame after 999999
  const std::string message = write("5");
  EXPECT_NE(message.find("removed 41 files of an earlier call (NNNNNN.png) from " + frames), std::string::npos)
      << message;
  EXPECT_TRUE(std::filesystem::exists(frames + "/000009.png"));
  EXPECT_FALSE(std::filesystem::exists(frames + "/000010.png"));
  EXPECT_FALSE(std::filesystem::exists(frames + "/1000000.png"));
  for (const std::string& name : others) EXPECT_TRUE(std::filesystem::exists(frames + "/" + name)) << name;
}

/// At any frame rate, between ticks and at them, after the requested start.
TEST_F(Video, FramesAtEqualTimesAreEqual) {
  const std::string recording = record("2");
  const auto write = [&](const std::string& fps, const std::string& name) {
    EXPECT_EQ(run_program({"view", recording, "--frames", folder.path(name), "--video-fps", fps, "--video-size",
                           "160x120", "--from", "0.5"})
                  .code,
              0);
  };
  write("10", "a");
  write("40", "b");
  for (const auto& [tick, frame] : {std::pair{"000000", "000000"}, {"000001", "000004"}, {"000012", "000048"}})
    EXPECT_TRUE(read_file(folder.path("a/") + tick + ".png") == read_file(folder.path("b/") + frame + ".png")) << tick;
  EXPECT_FALSE(read_file(folder.path("b/000004.png")) == read_file(folder.path("b/000005.png"))) << "between ticks";
}

/// Uses another program's decoder and metric, frame by frame.
TEST_F(Video, DecodedFramesResembleThePaintedOnes) {
  if (!succeeds("ffmpeg -version")) GTEST_SKIP() << "no FFmpeg on this machine (Debian: ffmpeg)";
  const std::string recording = record("3"), video = folder.path("v.webm"), frames = folder.path("f");
  const Words look{"--video-size", "640x360", "--video-readings", "roomba1", "--video-follow", "roomba1"};
  for (Words words : {Words{"plot", recording, "--video", video}, Words{"view", recording, "--frames", frames}}) {
    words.insert(words.end(), look.begin(), look.end());
    ASSERT_EQ(run_program(words).code, 0) << words[0];
  }
  ASSERT_TRUE(succeeds("ffmpeg -v error -i '" + video + "' -framerate 25 -i '" + frames +
                       "/%06d.png' -lavfi '[0:v]format=rgb24[a];[1:v]format=rgb24[b];[a][b]psnr=" +
                       folder.path("psnr") + "' -f null -"));
  const std::string log = read_file(folder.path("psnr"));
  EXPECT_EQ(count_lines(log), 75u);
  for (std::size_t at = 0; (at = log.find("psnr_avg:", at)) != std::string::npos; at += 9)
    EXPECT_GT(std::strtod(log.c_str() + at + 9, nullptr), 33.0) << log.substr(at, 16);
}

TEST_F(Video, AStopLeavesAVideoThatPlays) {
  Program program(run(folder.path("v.webm"), "1e6"));
  ASSERT_TRUE(program.handles(SIGINT)) << program.err();
  const Outcome outcome = program.stop();
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_NE(outcome.out.find("\"video\""), std::string::npos) << outcome.out;
  expect_probed(folder.path("v.webm"), "vp9,");
}

TEST_F(Video, AStoppedPlotReportsThatItsVideoEndsEarly) {
  const std::string recording = record("600");
  Program program({"plot", recording, "--video", folder.path("v.webm"), "--video-size", "160x120"});
  ASSERT_TRUE(program.handles(SIGINT)) << program.err();
  const Outcome outcome = program.stop();
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_NE(outcome.err.find("the video ends early"), std::string::npos) << outcome.err;
  expect_probed(folder.path("v.webm"), "vp9,");
}

/// The plug-in or FFmpeg may be missing: the message names the package. Frames need neither.
TEST_F(Video, WithoutFfmpegTheMessageNamesItsPackage) {
  const std::filesystem::path program = SF_PROGRAM;
  const std::string alone = folder.path("alone");
  std::filesystem::copy_file(program, alone);
  std::filesystem::copy_file(program.parent_path() / "sensorfarm_cairo.so", folder.path("sensorfarm_cairo.so"));
  const Outcome outcome = Program(run(folder.path("v.webm"), "1"), {}, "", "", alone).wait();
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  for (const char* part : {"no video can be written", "apt-get install ffmpeg", "--frames"})
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  const Outcome frames =
      Program({"view", record("0.5"), "--frames", folder.path("f"), "--video-size", "64x64"}, {}, "", "", alone).wait();
  EXPECT_EQ(frames.code, 0) << frames.err;
}

/// A robot at rest with a camera in colours, of an odd width, and one of depths alone.
std::string record_cameras(const Folder& folder) {
  const std::string world = folder.write("w.world",
                                         "position( name \"a\" pose [0 0 0 0] camera( resolution [33 24] rgb 1 ) "
                                         "camera( resolution [16 18] range [0 4] ) )\n"
                                         "model( name \"box\" pose [2 0 0 0] size [0.5 0.5 1] color \"gold\" )\n");
  run_successfully(
      {"run", world, "--controller", "remote", "--duration", "1", "--record", folder.path("c"), "--record-readings"});
  return world;
}

/// Frames are the images that `sense` takes, with the last column repeated, or shades of depths.
TEST(CameraVideo, FramesAreTheRecordedImages) {
  const Folder folder;
  const std::string world = record_cameras(folder);
  const auto frames = [&](const char* camera) {
    run_successfully(
        {"view", folder.path("c"), "--frames", folder.path("f"), "--video-camera", camera, "--video-fps", "10"});
    EXPECT_TRUE(std::filesystem::exists(folder.path("f/000009.png")));
    EXPECT_FALSE(std::filesystem::exists(folder.path("f/000010.png"))) << "the last image lasts for its interval";
    return scenes::read_png(folder.path("f/000009.png"));
  };
  run_successfully({"sense", world, "--type", "camera", "--image", "colour", "-o", folder.path("s.png")});
  const scenes::Picture frame = frames("a"), sensed = scenes::read_png(folder.path("s.png"));
  ASSERT_EQ(std::pair(frame.width, frame.height), std::pair(34, 24));
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 34; ++x) ASSERT_EQ(frame.at(x, y), sensed.at(std::min(x, 32), y)) << x << ", " << y;

  const scenes::Picture depths = frames("a:camera:1");
  ASSERT_EQ(std::pair(depths.width, depths.height), std::pair(16, 18));
  EXPECT_EQ(depths.at(0, 0), kBlack) << "the sky";
  EXPECT_GT(depths.at(8, 17), depths.at(8, 14)) << "nearer ground is brighter";
}

TEST(CameraVideo, WrongOptionsAreReported) {
  const Folder folder;
  record_cameras(folder);
  const auto refuse = [&](const Words& more, const std::string& message) {
    expect_refused(with({"view", folder.path("c"), "--frames", folder.path("f")}, more), message);
  };
  refuse({"--video-camera", "b"}, "has no camera 'b'; expected 'a:camera:0', 'a:camera:1'");
  refuse({"--video-camera", "a", "--video-size", "64x64"}, "--video-size");
  expect_refused({"view", folder.path("c"), "--video-camera", "a"}, "--video-camera requires --frames");
  run_successfully({"run", folder.path("w.world"), "--duration", "0.2", "--record", folder.path("d")});
  expect_refused({"view", folder.path("d"), "--frames", folder.path("f"), "--video-camera", "a"}, "--record-readings");
}

TEST_F(Video, WrongOptionsAreReported) {
  const std::string world = our_world("cave.world");
  const auto message = [&](const Words& more) {
    const Outcome outcome = run_program(with({"run", world, "--robots", "2", "--duration", "0.1"}, more));
    EXPECT_EQ(outcome.code, 2) << more.front();
    return outcome.err;
  };
  const std::string video = folder.path("v.webm");
  for (const auto& [more, part] : std::vector<std::pair<Words, std::string>>{
           {{"--video", "v.mp4"}, "videos are WebM files; write v.webm"},
           {{"--video", ""}, "expected a file"},
           {{"--video", "."}, "'.' is a folder; write ./run.webm"},
           {{"--video", "/tmp/"}, "'/tmp/' is a folder; write /tmp/run.webm"},
           {{"--video", video, "--video-size", "161x120"}, "even numbers from 16 to 4096"},
           {{"--video", video, "--video-size", "160"}, "even numbers from 16 to 4096"},
           {{"--video", video, "--video-size", "8192x120"}, "even numbers from 16 to 4096"},
           {{"--video", video, "--video-fps", "0"}, "expected a whole number from 1 to 120"},
           {{"--video", video, "--video-speed", "0"}, "expected a number from 0.001"},
           {{"--video", video, "--video-follow", "roomba9"}, "has no robot 'roomba9'"},
           {{"--video", video, "--video-readings", "roomba3"}, "has no robot 'roomba3'"},
           {{"--video", "/nowhere/v.webm"}, "/nowhere/v.webm: the video cannot be written: No such file"},
           {{"--video-fps", "10"}, "--video-fps requires --video"}})
    EXPECT_NE(message(more).find(part), std::string::npos) << part;
  const std::string blind = folder.write("w.world", "position( name \"a\" pose [0 0 0 0] gps( ) )\n");
  expect_refused({"run", blind, "--duration", "0.1", "--video", video, "--video-readings", "a"},
                 "'a' has no laser, sonar or infrared sensor");
  expect_refused({"plot", record("0.1"), "--video", video, "--csv"}, "--csv: changes figures");
}

}  // namespace
}  // namespace sf
