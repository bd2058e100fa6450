// Videos as read by FFmpeg's own programs.

#include "viz/video_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "base/installation.h"
#include "tests/golden.h"
#include "tests/refusal.h"
#include "tests/viz/png.h"

namespace sf::viz {
namespace {

constexpr VideoFormat kFormat{.width = 160, .height = 96, .frames_per_second = 20};
constexpr int kFrames = 50;

bool can_encode() { return std::filesystem::exists(base::plugin_file(kVideoBackendSymbol)); }
bool has_ffmpeg() { return std::system("ffprobe -version >/dev/null 2>&1 && ffmpeg -version >/dev/null 2>&1") == 0; }

/// White, with a moving blue box.
PixelImage frame(int number, const VideoFormat& format = kFormat) {
  PixelImage image{format.width, format.height, {}};
  image.rgb.assign(3u * static_cast<unsigned>(format.width * format.height), 255);
  for (int y = 20; y < 60; ++y)
    for (int x = 10 + 2 * number; x < std::min(format.width, 50 + 2 * number); ++x)
      image.rgb[3u * static_cast<unsigned>(y * format.width + x)] = 0;
  return image;
}

std::string write_video(const std::string& name, int frames) {
  const std::string file = scenes::own_file(name);
  VideoFile video(file, kFormat);
  for (int i = 0; i < frames; ++i) video.add(frame(i));
  video.finish();
  return file;
}

std::string output_of(const std::string& command) {
  std::string text;
  FILE* const pipe = popen(command.c_str(), "r");
  std::array<char, 65536> part;
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), pipe)) text.append(part.data(), size);
  EXPECT_EQ(pclose(pipe), 0) << command;
  return text;
}

double psnr(const std::uint8_t* a, const std::uint8_t* b, std::size_t size) {
  double sum = 0.0;
  for (std::size_t i = 0; i < size; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return 10.0 * std::log10(255.0 * 255.0 / std::max(1e-9, sum / static_cast<double>(size)));
}

TEST(VideoFile, OtherProgramsReadTheWrittenFrames) {
  if (!can_encode() || !has_ffmpeg()) GTEST_SKIP() << "no FFmpeg on this machine (Debian: ffmpeg)";
  const std::string file = write_video("a.webm", kFrames);
  EXPECT_EQ(output_of("ffprobe -v error -count_frames -of csv=p=0 -show_entries "
                      "stream=codec_name,width,height,r_frame_rate,nb_read_frames '" +
                      file + "'"),
            "vp9,160,96,20/1,50\n");
  EXPECT_EQ(output_of("ffprobe -v error -of csv=p=0 -show_entries format=duration '" + file + "'"), "2.500000\n");
  const std::string pixels = output_of("ffmpeg -v error -i '" + file + "' -f rawvideo -pix_fmt rgb24 -");
  const std::size_t size = frame(0).rgb.size();
  ASSERT_EQ(pixels.size(), kFrames * size);
  for (int i = 0; i < kFrames; ++i)
    EXPECT_GT(psnr(reinterpret_cast<const std::uint8_t*>(&pixels[static_cast<std::size_t>(i) * size]),
                   frame(i).rgb.data(), size),
              28.0)
        << "frame " << i;
  // Colours are preserved: BT.709 on both sides.
  EXPECT_NEAR(static_cast<std::uint8_t>(pixels[0]), 255, 2);
  const std::size_t inside = 3u * (40u * 160u + 30u);
  EXPECT_NEAR(static_cast<std::uint8_t>(pixels[inside]), 0, 12);
  EXPECT_NEAR(static_cast<std::uint8_t>(pixels[inside + 1]), 255, 12);
}

TEST(VideoFile, EqualFramesGiveEqualBytes) {
  if (!can_encode()) GTEST_SKIP() << "built without FFmpeg";
  EXPECT_EQ(golden::read(write_video("a.webm", 30)), golden::read(write_video("b.webm", 30)));
}

/// Without a frame, and closed by the destructor.
TEST(VideoFile, AnyNumberOfFramesGivesAFile) {
  if (!can_encode()) GTEST_SKIP() << "built without FFmpeg";
  EXPECT_GT(std::filesystem::file_size(write_video("none.webm", 0)), 0u);
  const std::string file = scenes::own_file("left.webm");
  { VideoFile(file, kFormat).add(frame(0)); }
  EXPECT_EQ(golden::read(file), golden::read(write_video("one.webm", 1)));
}

TEST(VideoFile, AnUnwritableFileIsReportedWithItsReason) {
  if (!can_encode()) GTEST_SKIP() << "built without FFmpeg";
  const auto message = [](const std::string& file, int frames) {
    return refusal_of([&] {
      VideoFile video(file, kFormat);
      for (int i = 0; i < frames; ++i) video.add(frame(i));
      video.finish();
    });
  };
  EXPECT_EQ(message("/nowhere/a.webm", 1), "/nowhere/a.webm: the video cannot be written: No such file or directory");
  EXPECT_EQ(message("/dev/full", 30), "/dev/full: the video cannot be written: No space left on device");
}

}  // namespace
}  // namespace sf::viz
