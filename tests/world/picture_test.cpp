#include "world/picture.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"

namespace sf::world {
namespace {

// Pictures of a few pixels, one for each PNG type.
const std::vector<std::uint8_t> kRgba{
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
    0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00, 0x00, 0xf4, 0x22, 0x7f, 0x8a, 0x00, 0x00, 0x00,
    0x0f, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x60, 0x00, 0x82, 0x13, 0x5c, 0x72, 0xff, 0x01, 0x04, 0x82,
    0x01, 0xf0, 0x04, 0x0d, 0x9e, 0x64, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
const std::vector<std::uint8_t> kOneBit{
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
    0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x01, 0x01, 0x00, 0x00, 0x00, 0x00, 0x33, 0x9b, 0x29, 0x19, 0x00,
    0x00, 0x00, 0x0a, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x70, 0x00, 0x00, 0x00, 0x42, 0x00, 0x41,
    0x84, 0xbf, 0x8e, 0x62, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
const std::vector<std::uint8_t> kDeepGray{
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
    0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x10, 0x00, 0x00, 0x00, 0x00, 0x6a, 0xee, 0x47, 0x16, 0x00,
    0x00, 0x00, 0x0b, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x68, 0xf8, 0x0f, 0x00, 0x02, 0x02, 0x01,
    0x80, 0xfd, 0xf2, 0xfc, 0xf4, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
const std::vector<std::uint8_t> kPalette{
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
    0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x03, 0x00, 0x00, 0x00, 0xc3, 0xfc, 0x8f, 0xb8, 0x00, 0x00, 0x00,
    0x06, 0x50, 0x4c, 0x54, 0x45, 0xff, 0xff, 0xff, 0x09, 0x08, 0x07, 0x0c, 0xae, 0xf7, 0x5a, 0x00, 0x00, 0x00,
    0x0b, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x60, 0x64, 0x00, 0x00, 0x00, 0x05, 0x00, 0x02, 0x42, 0xc2,
    0x44, 0x9f, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
const std::vector<std::uint8_t> kInterlaced{
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
    0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x00, 0x00, 0x00, 0x01, 0x20, 0xda, 0x62, 0x6e, 0x00, 0x00, 0x00,
    0x0f, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xe0, 0x62, 0x10, 0x61, 0x90, 0xd3, 0x00, 0x00, 0x00, 0xf7,
    0x00, 0x65, 0x26, 0x2e, 0x0e, 0x42, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

// 16 x 8 in grey, with a dark left half.
const std::vector<std::uint8_t> kJpeg{
    0xff, 0xd8, 0xff, 0xe0, 0x00, 0x10, 0x4a, 0x46, 0x49, 0x46, 0x00, 0x01, 0x01, 0x00, 0x00, 0x01, 0x00, 0x01,
    0x00, 0x00, 0xff, 0xdb, 0x00, 0x43, 0x00, 0x0d, 0x09, 0x0a, 0x0b, 0x0a, 0x08, 0x0d, 0x0b, 0x0a, 0x0b, 0x0e,
    0x0e, 0x0d, 0x0f, 0x13, 0x20, 0x15, 0x13, 0x12, 0x12, 0x13, 0x27, 0x1c, 0x1e, 0x17, 0x20, 0x2e, 0x29, 0x31,
    0x30, 0x2e, 0x29, 0x2d, 0x2c, 0x33, 0x3a, 0x4a, 0x3e, 0x33, 0x36, 0x46, 0x37, 0x2c, 0x2d, 0x40, 0x57, 0x41,
    0x46, 0x4c, 0x4e, 0x52, 0x53, 0x52, 0x32, 0x3e, 0x5a, 0x61, 0x5a, 0x50, 0x60, 0x4a, 0x51, 0x52, 0x4f, 0xff,
    0xc0, 0x00, 0x0b, 0x08, 0x00, 0x08, 0x00, 0x10, 0x01, 0x01, 0x11, 0x00, 0xff, 0xc4, 0x00, 0x15, 0x00, 0x01,
    0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x07, 0x08, 0xff,
    0xc4, 0x00, 0x14, 0x10, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0xff, 0xda, 0x00, 0x08, 0x01, 0x01, 0x00, 0x00, 0x3f, 0x00, 0x3d, 0x50, 0x2f, 0xff, 0xd9};
// 3 x 2: black, white, white, and a black row.
const std::vector<std::uint8_t> kGif{0x47, 0x49, 0x46, 0x38, 0x37, 0x61, 0x03, 0x00, 0x02, 0x00, 0x80, 0x00, 0x00,
                                     0x00, 0x00, 0x00, 0xff, 0xff, 0xff, 0x2c, 0x00, 0x00, 0x00, 0x00, 0x03, 0x00,
                                     0x02, 0x00, 0x00, 0x02, 0x05, 0x04, 0xc3, 0x10, 0x04, 0x51, 0x00, 0x3b};
// 1 x 2 in 24 bits.
const std::vector<std::uint8_t> kBmpBytes{0x42, 0x4d, 0x3e, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x36, 0x00, 0x00,
                                          0x00, 0x28, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00,
                                          0x01, 0x00, 0x18, 0x00, 0x00, 0x00, 0x00, 0x00, 0x08, 0x00, 0x00, 0x00, 0x00,
                                          0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
                                          0x00, 0x00, 0x07, 0x08, 0x09, 0x00, 0x01, 0x02, 0x03, 0x00};
const std::string kBmp(kBmpBytes.begin(), kBmpBytes.end());

using Values = std::vector<std::uint8_t>;

/// A picture as passed to its rule, row by row from the top.
struct Seen {
  Bitmap grid;
  Values rgba;
  bool has_alpha = false;

  Values channel(std::size_t k) const {
    Values values;
    for (std::size_t i = k; i < rgba.size(); i += 4) values.push_back(rgba[i]);
    return values;
  }
};

Seen read(const std::string& bytes, const std::string& file = "picture") {
  Seen seen;
  seen.grid = decode_bitmap(file, bytes, [&](const PixelRow& row, std::uint8_t* solid) {
    seen.has_alpha = row.has_alpha;
    seen.rgba.insert(seen.rgba.end(), row.rgba.begin(), row.rgba.end());
    for (std::size_t i = 0; i < row.rgba.size(); i += 4) *solid++ = row.rgba[i] < 128 ? 1 : 0;
  });
  return seen;
}
Seen read(const Values& bytes) { return read(std::string(bytes.begin(), bytes.end())); }
Values grey(const std::string& bytes) { return read(bytes).channel(0); }

std::string error_of_picture(const std::string& bytes) {
  try {
    read(bytes);
  } catch (const base::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Pictures, ColoursAreRedGreenBlueAndAlpha) {
  const Seen seen = read(kRgba);
  EXPECT_EQ(seen.rgba, (Values{0, 0, 0, 0, 200, 10, 30, 255}));
  EXPECT_TRUE(seen.has_alpha);
  EXPECT_FALSE(read(kOneBit).has_alpha);
}

TEST(Pictures, TopRowIsTheLastOfTheGrid) { EXPECT_EQ(read("P2 1 2 255\n0 255").grid.solid, (Values{0, 1})); }

TEST(Pictures, OneBitIsBlackAndWhite) { EXPECT_EQ(read(kOneBit).channel(0), (Values{0, 255, 0})); }

TEST(Pictures, SixteenBitsAreScaledDown) { EXPECT_EQ(read(kDeepGray).channel(1), (Values{0x80})); }

TEST(Pictures, PalettesAreLookedUp) {
  EXPECT_EQ(read(kPalette).channel(0), (Values{9, 255}));
  EXPECT_EQ(read(kPalette).channel(2), (Values{7, 255}));
}

TEST(Pictures, InterlacedPicturesAreTheSame) { EXPECT_EQ(read(kInterlaced).channel(0), (Values{10, 20, 30, 40})); }

TEST(Pictures, EveryTruncationOfAPngIsRejected) {
  const std::size_t after_pixels = kRgba.size() - 16;  // a checksum and the chunk IEND follow
  for (std::size_t size = 1; size < after_pixels; ++size) {
    EXPECT_THROW(read(Values(kRgba.begin(), kRgba.begin() + static_cast<std::ptrdiff_t>(size))), base::InputError)
        << size;
  }
}

// --- Netpbm

TEST(Pictures, BinaryAndTextGreyAreRead) {
  EXPECT_EQ(grey("P5\n# made by hand\n2 1\n255\n\x05\xff"), (Values{5, 255}));
  EXPECT_EQ(grey("P2 3 1 # three\n10 0 5 10"), (Values{0, 127, 255}));
  EXPECT_EQ(grey("P5 1 1 65535\n\x80\x01"), (Values{127})) << "two bytes a pixel, the first one high";
  EXPECT_EQ(grey("P5 2 1 256\n" + std::string("\x01\x00\x00\x80", 4)), (Values{255, 127})) << "the least of two bytes";
  EXPECT_EQ(grey("P5 1 1 # to the end\n255 #"), (Values{'#'})) << "one blank, then pixels";
  EXPECT_EQ(grey("P2\r\n1 1\r\n1\r\n1\r\n"), (Values{255}));
}

TEST(Pictures, PixelsBeginAfterTheHeadersLastBlank) {
  EXPECT_EQ(grey("P5\r\n2 1\r\n255\r\n\x05\xff"), (Values{5, 255})) << "CRLF counts as one";
  EXPECT_EQ(grey("P5\n2 1\n255\r\n\x05"), (Values{'\n', 5})) << "CR alone: no byte is left for LF";
  EXPECT_EQ(grey("P5 2 1 255#made by hand\n\x05\xff"), (Values{5, 255})) << "a comment behind the last number";
  EXPECT_EQ(grey("P5 2 1 255#made by hand\r\n\x05\xff"), (Values{5, 255}));
  EXPECT_EQ(grey("P5 # a\r2 1 255 \x05\xff"), (Values{5, 255})) << "CR ends a comment, too";
  EXPECT_EQ(read("P6\r\n1 1\r\n255\r\nabc").rgba, (Values{'a', 'b', 'c', 255}));
  EXPECT_EQ(grey("P4 8 1\r\n\x0f"), (Values{255, 255, 255, 255, 0, 0, 0, 0}));
  EXPECT_EQ(grey("P4 8 1#c\n\x0f"), (Values{255, 255, 255, 255, 0, 0, 0, 0}));
  EXPECT_THROW(read("P5 1 1 255x\x05"), base::InputError) << "no blank";
  EXPECT_THROW(read("P5 1 1 255# no line end"), base::InputError);
}

TEST(Pictures, BitsAreBlackWhereTheyAreOne) {
  EXPECT_EQ(grey("P1 3 2 010\n1 # a comment\n 0 1"), (Values{255, 0, 255, 0, 255, 0})) << "blanks may be left out";
  const std::string rows("\x40\x80\xff\x7f", 4);  // nine bits each: rows are padded to bytes
  EXPECT_EQ(grey("P4 9 2\n" + rows), (Values{255, 0, 255, 255, 255, 255, 255, 255, 0,  //
                                             0, 0, 0, 0, 0, 0, 0, 0, 255}));
  EXPECT_EQ(grey("P4 8 1\n\x0f"), (Values{255, 255, 255, 255, 0, 0, 0, 0})) << "no padding";
}

TEST(Pictures, BinaryAndTextColourAreRead) {
  EXPECT_EQ(read("P3 2 1 10 10 5 0 0 5 10").rgba, (Values{255, 127, 0, 255, 0, 127, 255, 255}));
  EXPECT_EQ(read("P6 2 1 255\nabcdef").rgba, (Values{'a', 'b', 'c', 255, 'd', 'e', 'f', 255}));
  EXPECT_EQ(read("P6 1 1 65535\naabbcc").rgba, (Values{97, 98, 99, 255})) << "97 * 257 of 65535 is 97 of 255";
}

TEST(Pictures, InconsistentNetpbmIsRejected) {
  for (const std::string bytes : {"P5",
                                  "P5 2",
                                  "P5 0 1 255 ",
                                  "P5 1 1 0 x",
                                  "P5 1 1 70000 x",
                                  "P5 2 2 255 abc",
                                  "P2 1 1 5 6",
                                  "P2 2 1 255 1",
                                  "P5 99999999999 1 255 ",
                                  "P5 1 1 65535 a",
                                  "",
                                  "P",
                                  "P6 1 1 255 ab",
                                  "P3 1 1 255 1 2",
                                  "P4 9 1\n\x01",
                                  "P4 1 1",
                                  "P1 2 1 1",
                                  "P1 1 1 2",
                                  "P7\nWIDTH 1\n",
                                  "P5 1 1 1 \x02"}) {
    EXPECT_THROW(read(bytes), base::InputError) << bytes;
  }
}

/// Sizes are rejected before memory is allocated: above 16384 per side, or more than the file can contain.
TEST(Pictures, SizesAreLimited) {
  EXPECT_NE(error_of_picture("P5 16385 1 255\n").find("16385 x 1 pixels; expected 1 to 16384"), std::string::npos);
  EXPECT_NE(error_of_picture("P4 1 16385\n").find("1 x 16385 pixels"), std::string::npos);
  EXPECT_NE(error_of_picture("P6 16384 16384 255\n").find("fewer pixels than the header states"), std::string::npos);
  EXPECT_EQ(read("P4 16384 1\n" + std::string(2048, '\0')).grid.width, 16384u);
  std::string bmp = kBmp;
  bmp.replace(18, 8, std::string("\x00\x40\x00\x00\x00\x40\x00\x00", 8));  // 16384 x 16384
  bmp[30] = 1;  // run-length encoded, so its size does not follow from its pixels
  EXPECT_NE(error_of_picture(bmp).find("expected at most 67108864 of them"), std::string::npos)
      << error_of_picture(bmp);
}

// --- The plug-in's formats

TEST(Pictures, JpegIsRead) {
  const Seen seen = read(std::string(kJpeg.begin(), kJpeg.end()));
  ASSERT_EQ(seen.grid.width, 16u);
  ASSERT_EQ(seen.grid.height, 8u);
  EXPECT_FALSE(seen.has_alpha);
  for (std::uint32_t y = 0; y < 8; ++y)
    for (std::uint32_t x = 0; x < 16; ++x)
      EXPECT_EQ(seen.grid.solid[y * 16 + x], x < 8 ? 1 : 0) << x << " " << y << ": the left half is dark";
}

TEST(Pictures, EveryTruncationOfAJpegIsRejected) {
  for (std::size_t size = 3; size < kJpeg.size(); ++size)
    EXPECT_NE(error_of_picture({kJpeg.begin(), kJpeg.begin() + static_cast<std::ptrdiff_t>(size)}), "") << size;
}

/// Each scan of a progressive picture takes as long as the whole picture.
TEST(Pictures, JpegOfManyScansIsRejected) {
  std::string bytes(kJpeg.begin(), kJpeg.end() - 2);
  const std::size_t scan = bytes.find("\xFF\xDA");
  const std::string again = bytes.substr(scan);
  for (int i = 0; i < 100; ++i) bytes += again;
  EXPECT_NE(error_of_picture(bytes + "\xFF\xD9").find("more than 100 scans"), std::string::npos);
}

TEST(Pictures, BmpIsReadFromEitherEnd) {
  EXPECT_EQ(read(kBmp).rgba, (Values{3, 2, 1, 255, 9, 8, 7, 255})) << "blue, green, red; the bottom row first";
  std::string down = kBmp;
  down.replace(22, 4, "\xFE\xFF\xFF\xFF");  // a height of -2: the top row first
  EXPECT_EQ(read(down).rgba, (Values{9, 8, 7, 255, 3, 2, 1, 255}));
  for (std::size_t size = 2; size + 1 < kBmp.size(); ++size)  // the last byte pads a row
    EXPECT_NE(error_of_picture(kBmp.substr(0, size)), "") << size;
}

TEST(Pictures, GifIsRead) {
  const std::string file = ::testing::TempDir() + "/picture_" + std::to_string(::getpid()) + ".gif";
  const std::string bytes(kGif.begin(), kGif.end());
  std::ofstream(file, std::ios::binary) << bytes;
  EXPECT_EQ(read(bytes, file).channel(0), (Values{0, 255, 255, 0, 0, 0}));
  std::filesystem::remove(file);
  EXPECT_NE(error_of_picture(bytes.substr(0, bytes.size() - 1)).find("truncated"), std::string::npos);
}

TEST(Pictures, OtherFormatsAreNamed) {
  EXPECT_EQ(error_of_picture("hello"),
            "picture: is not a picture in PNG, Netpbm (P1 to P6), JPEG, BMP or GIF; convert it to PNG");
}

}  // namespace
}  // namespace sf::world
