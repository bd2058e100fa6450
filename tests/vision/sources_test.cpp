// Images from folders and files.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/error.h"
#include "tests/folder.h"
#include "tests/refusal.h"
#include "vision/opencv.h"

namespace sf::vision {

namespace {

namespace fs = std::filesystem;

class Sources : public FolderTest {
 protected:
  void write_image(const std::string& name, std::uint8_t grey) const {
    write(name, "P5 4 3 255\n" + std::string(12, static_cast<char>(grey)));  // for any suffix
  }
  void make_socket(const std::string& name) const {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path(name).copy(address.sun_path, sizeof address.sun_path - 1);
    const int handle = socket(AF_UNIX, SOCK_STREAM, 0);
    ASSERT_EQ(bind(handle, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    close(handle);
  }
  std::string error_of(const std::string& source) const {
    return refusal_of([&] { opencv().open_source(source, 0, 0, 0.0); });
  }
};

}  // namespace

TEST_F(Sources, FoldersAreReadInOrderWithoutSpecialFiles) {
  write_image("b.png", 20);
  write_image("a.PNG", 10);
  write("notes.txt", "no image");
  fs::create_directories(path("c.png"));
  fs::create_symlink("/dev/zero", path("d.png"));
  fs::create_symlink("none", path("e.png"));
  ASSERT_EQ(mkfifo(path("f.png").c_str(), 0600), 0);  // opening it would block until there is a writer
  make_socket("g.png");
  fs::create_symlink("b.png", path("h.png"));
  const auto source = opencv().open_source(path(""), 0, 0, 0.0);
  EXPECT_EQ(source->size(), 3u);
  std::vector<int> seen;
  for (Image image; source->next(image);) seen.push_back(*image.at(1, 1));
  EXPECT_EQ(seen, (std::vector<int>{10, 20, 20}));
}

TEST_F(Sources, SkippedImagesAreLeftOut) {
  for (int k = 0; k < 3; ++k) write_image(std::to_string(k) + ".png", static_cast<std::uint8_t>(10 * k));
  const auto source = opencv().open_source(path(""), 0, 0, 0.0);
  Image image;
  EXPECT_TRUE(source->skip());
  ASSERT_TRUE(source->next(image));
  EXPECT_EQ(*image.at(1, 1), 10);
  EXPECT_TRUE(source->skip());
  EXPECT_FALSE(source->skip());
  EXPECT_FALSE(source->next(image));
}

/// Motion JPEG as `--overlay` writes it: images in order, in grey, and the frame rate.
TEST_F(Sources, VideosAreReadAsTheyWereWritten) {
  {
    const auto video = opencv().open_video(path("v.avi"), 32, 16, 12.0);
    for (int k = 0; k < 3; ++k) {
      Image image{32, 16, 3, std::vector<std::uint8_t>(32 * 16 * 3, static_cast<std::uint8_t>(60 + 50 * k))};
      video->write(image);
    }
  }
  std::unique_ptr<ImageSource> source;
  try {
    source = opencv().open_source(path("v.avi"), 0, 0, 0.0);
  } catch (const base::InputError&) {
    GTEST_SKIP() << "this OpenCV has no FFmpeg";
  }
  EXPECT_FALSE(source->is_live());
  EXPECT_NEAR(source->rate(), 12.0, 1e-6);
  EXPECT_TRUE(source->skip());
  int count = 1;
  for (Image image; source->next(image); ++count) {
    ASSERT_EQ(image.width, 32);
    ASSERT_EQ(image.height, 16);
    EXPECT_EQ(image.channels, 1);
    EXPECT_NEAR(*image.at(7, 5), 60 + 50 * count, 4) << count;
  }
  EXPECT_EQ(count, 3);
}

TEST_F(Sources, RejectSpecialFiles) {
  ASSERT_EQ(mkfifo(path("f.png").c_str(), 0600), 0);
  ASSERT_EQ(mkfifo(path("f.avi").c_str(), 0600), 0);
  make_socket("g.png");
  for (const char* name : {"f.png", "f.avi", "g.png"})
    expect_in("is a pipe, a socket or a block device", error_of(path(name)));
  EXPECT_NE(error_of(path("")).find("has no images"), std::string::npos);
  EXPECT_NE(error_of("/dev/null").find("cannot be opened as a camera"), std::string::npos);
}

/// Without hardware: the error names the source, what was expected and what to do.
TEST_F(Sources, MissingDevicesAreNamed) {
  for (const char* source : {"/dev/video999", "fire"})
    expect_in("does not exist; expected a device such as /dev/video0, firewire:0", error_of(source));
  expect_in("/dev/video999: does not exist", error_of("/dev/video999"));
  for (const char* source : {"firewire:", "firewire:x", "firewire:0x", "firewire:-1", "firewire:63"})
    expect_in(std::string(source) + ": has no number of a camera; expected firewire:0", error_of(source));
  const std::string fire = error_of("firewire:62");
  EXPECT_TRUE(fire.find("expected an IIDC camera") < fire.size() || fire.find("needs an OpenCV with") < fire.size())
      << fire;
  expect_in("gstreamer: : names no pipeline; expected elements as for gst-launch-1.0", error_of("gstreamer: "));
  const std::string pipeline = error_of("gstreamer:nosuchsource device=1");
  EXPECT_TRUE(pipeline.find("no element \"nosuchsource\"") < pipeline.size() ||
              pipeline.find("needs an OpenCV with GStreamer") < pipeline.size())
      << pipeline;
}

/// Four images of a pipeline with a moving ball, in grey; then its end.
TEST_F(Sources, PipelinesAreReadToTheirEnd) {
  std::unique_ptr<ImageSource> source;
  try {
    source = opencv().open_source(
        "gstreamer:videotestsrc num-buffers=4 pattern=ball ! video/x-raw,width=64,height=48 ! videoconvert ! "
        "video/x-raw,format=GRAY8 ! appsink sync=false",
        0, 0, 0.0);
  } catch (const base::InputError& error) {
    GTEST_SKIP() << "no GStreamer elements (Debian: gstreamer1.0-plugins-base): " << error.what();
  }
  EXPECT_TRUE(source->is_live());
  int count = 0;
  for (Image image; source->next(image); ++count) {
    ASSERT_EQ(image.width, 64);
    ASSERT_EQ(image.height, 48);
    EXPECT_EQ(image.channels, 1);
  }
  EXPECT_EQ(count, 4);
}

/// The sink is added.
TEST_F(Sources, PipelinesNeedNoSink) {
  try {
    const auto source = opencv().open_source("gstreamer:videotestsrc ! video/x-raw,width=32,height=24", 0, 0, 0.0);
    Image image;
    ASSERT_TRUE(source->next(image));
    EXPECT_EQ(image.pixels.size(), 32u * 24u);
  } catch (const base::InputError& error) {
    GTEST_SKIP() << "no GStreamer elements (Debian: gstreamer1.0-plugins-base): " << error.what();
  }
}

TEST_F(Sources, FilesThatCannotBeReadGiveNoPixels) {
  write_image("a.png", 10);
  write("b.png", "no image");
  write("c.png", "");
  write_image("d.png", 40);
  fs::resize_file(path("d.png"), 5);  // within the header
  write_image("e.png", 50);
  const auto source = opencv().open_source(path(""), 0, 0, 0.0);
  std::vector<std::size_t> sizes;
  for (Image image; source->next(image);) sizes.push_back(image.pixels.size());
  EXPECT_EQ(sizes, (std::vector<std::size_t>{12, 0, 0, 0, 12}));
}

TEST_F(Sources, RejectLargerImages) {
  write("a.pgm", "P5 65536 1025 255\n" + std::string(65536 * 1025, 'a'));  // 64 Mpx plus one row
  const auto source = opencv().open_source(path("a.pgm"), 0, 0, 0.0);
  Image image;
  EXPECT_THROW(source->next(image), base::InputError);
}

/// A side of 1280 px is kept, one more is reduced; a very long image keeps one pixel across.
TEST_F(Sources, JpegsAreBounded) {
  struct Case {
    int width, height, channels, left_width, left_height;
  };
  for (const Case& each : {Case{1280, 3, 3, 1280, 3}, Case{1281, 1281, 1, 1280, 1280}, Case{6400, 1, 1, 1280, 1},
                           Case{100, 2560, 3, 50, 1280}}) {
    const auto size = static_cast<std::size_t>(each.width) * each.height * each.channels;
    const Image image{each.width, each.height, each.channels, std::vector<std::uint8_t>(size, 90)};
    const std::vector<std::uint8_t> bytes = opencv().encode_jpeg(image, 1280);
    const auto source = opencv().open_source(write("a.jpg", std::string(bytes.begin(), bytes.end())), 0, 0, 0.0);
    Image read;
    ASSERT_TRUE(source->next(read));
    EXPECT_EQ(read.width, each.left_width) << each.width;
    EXPECT_EQ(read.height, each.left_height) << each.width;
    EXPECT_NEAR(*read.at(0, 0), 90, 2);
  }
}

TEST(Drawing, ReportsTheReasonForFailure) {
  Image image{8, 8, 3, std::vector<std::uint8_t>(192)};
  Mark mark{{{0.0, 0.0}, {7.0, 7.0}}, "", {255, 0, 0}, 40'000};  // wider than OpenCV's maximum line width
  EXPECT_THROW(opencv().draw(image, {mark}), base::InputError);
  mark.width = 1;
  mark.points[1] = {1e300, -1e300};
  opencv().draw(image, {mark});
}

/// Only a label: the width applies to a line that it does not have.
TEST(Drawing, OnePointIsNotALine) {
  Image image{8, 8, 3, std::vector<std::uint8_t>(192)};
  opencv().draw(image, {{{{4.0, 4.0}}, "", {255, 0, 0}, 40'000}});
  EXPECT_EQ(image.pixels, std::vector<std::uint8_t>(192));
}

}  // namespace sf::vision
