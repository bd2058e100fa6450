#include "world/picture.h"

#include <gtest/gtest.h>

#include "base/files.h"
#include "tests/refusal.h"

namespace sf::world {
namespace {

/// Returns a picture of a few pixels, which is also a seed of the fuzz target.
std::string bytes_of(const std::string& name) { return base::read_text(SF_SOURCE_DIR "/tests/fuzz/picture/" + name); }

const std::string kRgba = bytes_of("two_colours.png");
const std::string kOneBit = bytes_of("one_bit.png");
const std::string kJpeg = bytes_of("grey.jpg");      // 16 x 8, with a dark left half
const std::string kBmp = bytes_of("bottom_up.bmp");  // 1 x 2 in 24 bits

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
Values grey(const std::string& bytes) { return read(bytes).channel(0); }

std::string error_of_picture(const std::string& bytes) {
  return sf::refusal_of([&] { read(bytes); });
}

TEST(Pictures, ColoursAreRedGreenBlueAndAlpha) {
  const Seen seen = read(kRgba);
  EXPECT_EQ(seen.rgba, (Values{0, 0, 0, 0, 200, 10, 30, 255}));
  EXPECT_TRUE(seen.has_alpha);
  EXPECT_FALSE(read(kOneBit).has_alpha);
}

TEST(Pictures, TopRowIsTheLastOfTheGrid) { EXPECT_EQ(read("P2 1 2 255\n0 255").grid.solid, (Values{0, 1})); }

TEST(Pictures, OneBitIsBlackAndWhite) { EXPECT_EQ(read(kOneBit).channel(0), (Values{0, 255, 0})); }

TEST(Pictures, SixteenBitsAreScaledDown) { EXPECT_EQ(read(bytes_of("deep_gray.png")).channel(1), (Values{0x80})); }

TEST(Pictures, PalettesAreLookedUp) {
  EXPECT_EQ(read(bytes_of("looked_up.png")).channel(0), (Values{9, 255}));
  EXPECT_EQ(read(bytes_of("looked_up.png")).channel(2), (Values{7, 255}));
}

TEST(Pictures, InterlacedPicturesAreTheSame) {
  EXPECT_EQ(read(bytes_of("interlaced.png")).channel(0), (Values{10, 20, 30, 40}));
}

TEST(Pictures, EveryTruncationOfAPngIsRejected) {
  const std::size_t after_pixels = kRgba.size() - 16;  // a checksum and the chunk IEND follow
  for (std::size_t size = 1; size < after_pixels; ++size)
    EXPECT_NE(error_of_picture(kRgba.substr(0, size)), "") << size;
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
  const Seen seen = read(kJpeg);
  ASSERT_EQ(seen.grid.width, 16u);
  ASSERT_EQ(seen.grid.height, 8u);
  EXPECT_FALSE(seen.has_alpha);
  for (std::uint32_t y = 0; y < 8; ++y)
    for (std::uint32_t x = 0; x < 16; ++x)
      EXPECT_EQ(seen.grid.solid[y * 16 + x], x < 8 ? 1 : 0) << x << " " << y << ": the left half is dark";
}

TEST(Pictures, EveryTruncationOfAJpegIsRejected) {
  for (std::size_t size = 3; size < kJpeg.size(); ++size)
    EXPECT_NE(error_of_picture(kJpeg.substr(0, size)), "") << size;
}

/// Each scan of a progressive picture takes as long as the whole picture.
TEST(Pictures, JpegOfManyScansIsRejected) {
  std::string bytes = kJpeg.substr(0, kJpeg.size() - 2);
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
  const std::string bytes = bytes_of("bits.gif");  // 3 x 2: black, white, white, and a black row
  EXPECT_EQ(read(bytes, SF_SOURCE_DIR "/tests/fuzz/picture/bits.gif").channel(0), (Values{0, 255, 255, 0, 0, 0}));
  EXPECT_NE(error_of_picture(bytes.substr(0, bytes.size() - 1)).find("truncated"), std::string::npos);
}

TEST(Pictures, OtherFormatsAreNamed) {
  EXPECT_EQ(error_of_picture("hello"),
            "picture: is not a picture in PNG, Netpbm (P1 to P6), JPEG, BMP or GIF; convert it to PNG");
}

}  // namespace
}  // namespace sf::world
