// Readings as standard ROS messages, decoded with the layout that ROS documents.

#include "record/standard_readings.h"

#include <gtest/gtest.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/camera_pixels.h"
#include "base/jpeg.h"
#include "record/cdr.h"
#include "record/ros_messages.h"
#include "tests/base/decoded_png.h"

namespace sf::record {
namespace {

using Message = StandardTopic::Message;
constexpr std::int64_t kMeasured = 3'000'000'021;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A message of the topic, after its header.
struct Encoded {
  Encoded(const StandardTopic& topic, const std::vector<double>& values, const std::string& frame = "robot/x") {
    encode_standard(topic, kMeasured, values, bytes);
    cdr = CdrReader(bytes);
    EXPECT_EQ(get_header(cdr, time), frame);
    EXPECT_EQ(time, kMeasured);
  }
  void skip(int numbers) {
    for (int i = 0; i < numbers; ++i) cdr.get<double>();
  }
  base::Bytes bytes;
  CdrReader cdr{bytes};
  std::int64_t time = 0;
};

Encoded of(StandardTopic topic, const std::vector<double>& values) {
  topic.frame = "robot/x";
  return {topic, values};
}

TEST(StandardReadings, RangeContainsConeAndLimits) {
  StandardTopic topic{.message = Message::range, .element = 1, .fov = 0.5, .range_min = 0.25, .range_max = 4.0};
  for (const auto& [range, published] : {std::pair{2.5, 2.5F},
                                         {4.0, kInfinity},
                                         {0.25, 0.25F},
                                         {-HUGE_VAL, -kInfinity},
                                         {std::nextafter(4.0, 0.0), std::nextafter(4.0F, 0.0F)}}) {
    Encoded message = of(topic, {9.0, range, 9.0});
    EXPECT_EQ(message.cdr.get<std::uint8_t>(), 0) << "ultrasound";
    EXPECT_EQ(message.cdr.get<float>(), 0.5F);
    EXPECT_EQ(message.cdr.get<float>(), 0.25F);
    EXPECT_EQ(message.cdr.get<float>(), 4.0F);
    EXPECT_EQ(message.cdr.get<float>(), published);
    EXPECT_EQ(message.cdr.get<float>(), 0.0F) << "variance: unknown";
    EXPECT_TRUE(message.cdr.good());
  }
}

TEST(StandardReadings, InfraredElementsHaveTwoColumns) {
  Encoded message =
      of({.message = Message::range, .element = 1, .infrared = true, .range_max = 1.0}, {0.1, 900.0, 0.2, 800.0});
  EXPECT_EQ(message.cdr.get<std::uint8_t>(), 1);
  for (int i = 0; i < 3; ++i) message.cdr.get<float>();
  EXPECT_EQ(message.cdr.get<float>(), 0.2F);
}

TEST(StandardReadings, MagneticFieldIsTheVectorOfItsElement) {
  Encoded message = of({.message = Message::magnetic_field, .element = 1}, {9, 9, 9, 9, 5e-5, 3e-5, 4e-5, -1e-6});
  EXPECT_EQ(message.cdr.get<double>(), 3e-5);
  EXPECT_EQ(message.cdr.get<double>(), 4e-5);
  EXPECT_EQ(message.cdr.get<double>(), -1e-6);
  message.skip(9);
  EXPECT_TRUE(message.cdr.good());
}

/// The plane's points as computed by GeographicLib: on the ellipsoid, above or below.
TEST(StandardReadings, FixIsOnTheEllipsoidAboveItsPoint) {
  const GeographicLib::LocalCartesian plane(0.0, 0.0);
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {25.0, -3.0}, {-7e4, 9e4}}) {
    Encoded message = of({.message = Message::fix}, {x, y, 1.2, 7});
    EXPECT_EQ(message.cdr.get<std::int8_t>(), 0) << "a fix";
    EXPECT_EQ(message.cdr.get<std::uint16_t>(), 1u) << "GPS";
    const double latitude = message.cdr.get<double>(), longitude = message.cdr.get<double>();
    double east = 0, north = 0, up = 0;
    plane.Forward(latitude, longitude, 0.0, east, north, up);
    EXPECT_NEAR(east, x, 1e-6);
    EXPECT_NEAR(north, y, 1e-6);
    EXPECT_TRUE(std::isnan(message.cdr.get<double>())) << "no altitude is measured";
    message.skip(9);
    EXPECT_EQ(message.cdr.get<std::uint8_t>(), 0) << "covariance: unknown";
    EXPECT_TRUE(message.cdr.good());
  }
}

TEST(StandardReadings, StatesKnownErrors) {
  Encoded fix = of({.message = Message::fix, .sigma = 2.0}, {1.0, 2.0, 1.5, 7});
  fix.cdr.get<std::int8_t>();
  fix.cdr.get<std::uint16_t>();
  fix.skip(3);
  EXPECT_EQ(fix.cdr.get<double>(), 4.5) << "east: half of (2 m x 1.5)^2";
  fix.skip(3);
  EXPECT_EQ(fix.cdr.get<double>(), 4.5) << "north";
  fix.skip(4);
  EXPECT_EQ(fix.cdr.get<std::uint8_t>(), 1) << "approximated";
  EXPECT_TRUE(fix.cdr.good());
  Encoded imu = of({.message = Message::imu, .sigma = 0.5}, {0.75});
  imu.skip(4 + 9 + 3);
  EXPECT_EQ(imu.cdr.get<double>(), kLeastVariance) << "no turn but about z";
  imu.skip(7);
  EXPECT_EQ(imu.cdr.get<double>(), 0.25);
}

TEST(StandardReadings, FixHasTheAltitudeOfReceiversThatMeasureIt) {
  Encoded fix = of({.message = Message::fix, .spatial = true, .sigma = 2.0}, {1.0, 2.0, 1.5, 7, 100.0, 3.0});
  fix.cdr.get<std::int8_t>();
  fix.cdr.get<std::uint16_t>();
  fix.skip(2);
  EXPECT_EQ(fix.cdr.get<double>(), 100.0);
  fix.skip(8);
  EXPECT_EQ(fix.cdr.get<double>(), 36.0) << "(2 m x 3)^2";
}

TEST(StandardReadings, FieldOfACompassIsTurnedIntoItsFrame) {
  const glm::dmat3 left{{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
  Encoded field =
      of({.message = Message::magnetic_field, .spatial = true, .R_FS = left, .sigma = 0.5}, {9, 1, 2, 3, 1.5});
  for (const double part : {-2.0, 1.0, 3.0}) EXPECT_EQ(field.cdr.get<double>(), part);
  EXPECT_EQ(field.cdr.get<double>(), 0.25);
  field.skip(8);
  EXPECT_TRUE(field.cdr.good());
}

/// As radar_msgs: speeds are positive where the range grows, angles those of the level frame.
TEST(StandardReadings, RadarScanHasTheTargets) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const glm::dmat3 left{{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
  Encoded scan = of({.message = Message::radar_scan, .R_FS = left}, {12.5, 0.25, 3.5, -0.125, nan, nan, nan, nan});
  EXPECT_EQ(scan.cdr.get_count(20), 1u);
  for (const float number : {12.5F, static_cast<float>(M_PI / 2 + 0.25), -0.125F, -3.5F, 0.0F})
    EXPECT_FLOAT_EQ(scan.cdr.get<float>(), number);
  EXPECT_TRUE(scan.cdr.good());
}

/// The frame is level where the sensor, which is turned in it, is not.
TEST(StandardReadings, OrientationIsThatOfTheFrame) {
  const glm::dmat3 left{{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
  const double h = std::sqrt(0.5);
  Encoded imu = of({.message = Message::imu, .spatial = true, .R_FS = left}, {0, 0, 0, 0, 0, 9.8, 0, h, 0, 0, h});
  for (const double part : {0.0, 0.0, 0.0, 1.0}) EXPECT_NEAR(imu.cdr.get<double>(), part, 1e-15);
  EXPECT_EQ(imu.cdr.get<double>(), 0.0) << "its covariance is not known";
  Encoded none = of({.message = Message::imu, .spatial = true}, {0, 0, 0, 0, 0, 9.8, 0});
  none.skip(4);
  EXPECT_EQ(none.cdr.get<double>(), -1.0) << "not measured";
}

TEST(StandardReadings, NoFixGivesNoPosition) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Encoded message = of({.message = Message::fix}, {nan, nan, nan, 3});
  EXPECT_EQ(message.cdr.get<std::int8_t>(), -1);
  message.cdr.get<std::uint16_t>();
  EXPECT_TRUE(std::isnan(message.cdr.get<double>()));
  EXPECT_TRUE(std::isnan(message.cdr.get<double>()));
}

TEST(StandardReadings, ImuContainsOnlyTheYawRate) {
  Encoded message = of({.message = Message::imu}, {0.75});
  message.skip(4);
  EXPECT_EQ(message.cdr.get<double>(), -1.0) << "no orientation";
  message.skip(8 + 2);
  EXPECT_EQ(message.cdr.get<double>(), 0.75);
  message.skip(9 + 3);
  EXPECT_EQ(message.cdr.get<double>(), -1.0) << "no acceleration";
  message.skip(8);
  EXPECT_TRUE(message.cdr.good());
}

/// The vectors of an imu whose x points to the left are those of its level frame; each axis has its variance.
TEST(StandardReadings, ImuOfSixAxesIsTurnedIntoItsFrame) {
  const glm::dmat3 left{{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
  Encoded message = of({.message = Message::imu, .spatial = true, .R_FS = left, .force_sigma = 0.25, .sigma = 0.5},
                       {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.0});
  message.skip(4);
  EXPECT_EQ(message.cdr.get<double>(), -1.0) << "no orientation";
  message.skip(8);
  for (const auto& [vector, variance] : {std::pair{glm::dvec3{-2, 1, 3}, 0.25}, {glm::dvec3{-5, 4, 6}, 0.0625}}) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(message.cdr.get<double>(), vector[axis]);
    for (int i = 0; i < 9; ++i) EXPECT_EQ(message.cdr.get<double>(), i % 4 == 0 ? variance : 0.0);
  }
  EXPECT_TRUE(message.cdr.good());
}

/// One word of 4 x 4 cells: rows of a ROS map begin at the lower left, rows of a word at the upper left.
TEST(StandardReadings, MapIsFlippedVertically) {
  maps::OccupancyGrid grid({.left = -1.0, .top = 3.0, .cell = 0.5, .word_columns = 2, .word_rows = 1});
  grid.set({0, 0}, maps::Cell::occupied);  // upper left
  grid.set({7, 3}, maps::Cell::free);      // lower right
  Encoded message({.message = Message::map, .frame = "world", .grid = grid.geometry},
                  {grid.words.begin(), grid.words.end()}, "world");
  EXPECT_EQ(message.cdr.get<std::int32_t>(), 3);
  EXPECT_EQ(message.cdr.get<std::uint32_t>(), 21u);
  EXPECT_EQ(message.cdr.get<float>(), 0.5F);
  EXPECT_EQ(message.cdr.get<std::uint32_t>(), 8u);
  EXPECT_EQ(message.cdr.get<std::uint32_t>(), 4u);
  EXPECT_EQ(message.cdr.get<double>(), -1.0);
  EXPECT_EQ(message.cdr.get<double>(), 1.0) << "two metres below the top";
  message.skip(5);
  ASSERT_EQ(message.cdr.get_count(1), 32u);
  for (int i = 0; i < 32; ++i) EXPECT_EQ(message.cdr.get<std::int8_t>(), i == 7 ? 0 : i == 24 ? 100 : -1) << i;
  EXPECT_TRUE(message.cdr.good());
}

/// With intensities and times, points have the layout of velodyne_pointcloud's PointXYZIRT, of 22 bytes.
TEST(StandardReadings, PointsHaveTheFieldsOfDrivers) {
  StandardTopic topic{.message = Message::points, .range_min = 0.5, .range_max = 8.0};
  topic.directions = std::make_shared<const std::vector<glm::dvec3>>(2, glm::dvec3{0, 1, 0});
  topic.times = std::make_shared<const std::vector<double>>(std::vector<double>{-0.05, 0.0});
  topic.width = 3;
  Encoded message = of(topic, {2.0, 0.25, 0.1, 3.0, 0.75, 0.2});
  CdrReader& cdr = message.cdr;
  cdr.get<std::uint32_t>(), cdr.get<std::uint32_t>();
  ASSERT_EQ(cdr.get_count(1), 6u);
  for (const auto& [name, offset, type] : {std::tuple{"x", 0u, 7},
                                           {"y", 4u, 7},
                                           {"z", 8u, 7},
                                           {"intensity", 12u, 7},
                                           {"ring", 16u, 4},
                                           {"time", 18u, 7}}) {
    EXPECT_EQ(cdr.get_string(), name);
    EXPECT_EQ(cdr.get<std::uint32_t>(), offset);
    EXPECT_EQ(cdr.get<std::uint8_t>(), type);
    EXPECT_EQ(cdr.get<std::uint32_t>(), 1u);
  }
  cdr.get<std::uint8_t>();
  EXPECT_EQ(cdr.get<std::uint32_t>(), 22u);
  EXPECT_EQ(cdr.get<std::uint32_t>(), 44u);
  ASSERT_EQ(cdr.get_count(1), 44u);
  std::array<std::uint8_t, 44> bytes;
  for (std::uint8_t& byte : bytes) byte = cdr.get<std::uint8_t>();
  const auto number = [&](std::size_t at) {
    float value;
    std::memcpy(&value, &bytes[at], sizeof value);
    return value;
  };
  EXPECT_EQ(number(4), 2.0F);
  EXPECT_EQ(number(12), 0.25F);
  EXPECT_EQ(number(18), -0.05F);
  EXPECT_EQ(number(22 + 4), 3.0F);
  EXPECT_EQ(number(22 + 12), 0.75F);
  EXPECT_EQ(cdr.get<std::uint8_t>(), 0) << "is_dense";
  EXPECT_TRUE(cdr.good());
}

/// An organized cloud, one row per ring. Points without an echo in [min, max) are NaN.
TEST(StandardReadings, PointsAreRangesAlongDirections) {
  const std::vector<glm::dvec3> directions{{1, 0, 0}, {0, 1, 0}, {0.6, 0, 0.8}, {0, 0, -1}};
  StandardTopic topic{.message = Message::points, .range_min = 0.5, .range_max = 8.0};
  topic.directions = std::make_shared<const std::vector<glm::dvec3>>(directions);
  topic.rings = 2;
  Encoded message = of(topic, {2.0, 8.0, 5.0, -HUGE_VAL});
  CdrReader& cdr = message.cdr;
  EXPECT_EQ(cdr.get<std::uint32_t>(), 2u) << "height";
  EXPECT_EQ(cdr.get<std::uint32_t>(), 2u) << "width";
  ASSERT_EQ(cdr.get_count(1), 4u);
  for (const auto& [name, offset, type] : {std::tuple{"x", 0u, 7}, {"y", 4u, 7}, {"z", 8u, 7}, {"ring", 12u, 4}}) {
    EXPECT_EQ(cdr.get_string(), name);
    EXPECT_EQ(cdr.get<std::uint32_t>(), offset);
    EXPECT_EQ(cdr.get<std::uint8_t>(), type);
    EXPECT_EQ(cdr.get<std::uint32_t>(), 1u);
  }
  EXPECT_EQ(cdr.get<std::uint8_t>(), 0) << "little-endian";
  EXPECT_EQ(cdr.get<std::uint32_t>(), 16u);
  EXPECT_EQ(cdr.get<std::uint32_t>(), 32u);
  ASSERT_EQ(cdr.get_count(1), 64u);
  for (std::size_t i = 0; i < 4; ++i) {
    const float x = cdr.get<float>(), y = cdr.get<float>(), z = cdr.get<float>();
    if (i % 2 == 1) {
      EXPECT_TRUE(std::isnan(x) && std::isnan(y) && std::isnan(z));
    } else {
      EXPECT_EQ(x, i == 0 ? 2.0F : 3.0F);
      EXPECT_EQ(z, i == 0 ? 0.0F : 4.0F);
    }
    EXPECT_EQ(cdr.get<std::uint16_t>(), i / 2) << "ring";
    cdr.get<std::uint16_t>();
  }
  EXPECT_EQ(cdr.get<std::uint8_t>(), 0) << "not dense";
  EXPECT_TRUE(cdr.good());
}

/// A camera of 3 x 2 pixels with colours: depth and colour per pixel.
StandardTopic camera(Message message) {
  StandardTopic topic{.message = message, .range_min = 0.5, .range_max = 8.0, .width = 2, .columns = 3, .rows = 2};
  topic.lens = {{310.0, 305.0}, {1.0, 0.5}, {-0.2, 0.05, 0.001, -0.002, 0.01}};
  return topic;
}
const std::vector<double> kPixels{2.0, 0x102030, 8.0, 0, -HUGE_VAL, 1, 7.5, 2, 0.5, 3, 1.0, 0xFFFEFD};
const std::vector<double> kGreyPixels{2, 0x202020, 8, 0x909090, 1, 0, 7, 0x010101, 1, 0xFEFEFE, 1, 0xFFFFFF};

/// An image up to its data.
void expect_image(CdrReader& cdr, const char* encoding, std::uint32_t bytes) {
  EXPECT_EQ(cdr.get<std::uint32_t>(), 2u) << "height";
  EXPECT_EQ(cdr.get<std::uint32_t>(), 3u) << "width";
  EXPECT_EQ(cdr.get_string(), encoding);
  EXPECT_EQ(cdr.get<std::uint8_t>(), 0) << "little-endian";
  EXPECT_EQ(cdr.get<std::uint32_t>(), 3 * bytes) << "step";
  ASSERT_EQ(cdr.get_count(1), 6 * bytes);
}

/// REP 118: infinity without a surface, -infinity for one that is too near.
TEST(StandardReadings, DepthImages) {
  Encoded message = of(camera(Message::depth_image), kPixels);
  expect_image(message.cdr, "32FC1", 4);
  for (const float depth : {2.0f, kInfinity, -kInfinity, 7.5f, 0.5f, 1.0f}) EXPECT_EQ(message.cdr.get<float>(), depth);
  EXPECT_TRUE(message.cdr.good());
}

TEST(StandardReadings, ColourImages) {
  Encoded message = of(camera(Message::color_image), kPixels);
  expect_image(message.cdr, "rgb8", 3);
  for (const int byte : {0x10, 0x20, 0x30, 0, 0, 0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0xFF, 0xFE, 0xFD})
    EXPECT_EQ(message.cdr.get<std::uint8_t>(), byte);
  EXPECT_TRUE(message.cdr.good());
}

TEST(StandardReadings, GreyImages) {
  StandardTopic grey = camera(Message::color_image);
  grey.mono = true;
  Encoded message = of(grey, kGreyPixels);
  expect_image(message.cdr, "mono8", 1);
  for (const int byte : {0x20, 0x90, 0, 1, 0xFE, 0xFF}) EXPECT_EQ(message.cdr.get<std::uint8_t>(), byte);
  EXPECT_TRUE(message.cdr.good());
}

/// The file of a CompressedImage.
std::string bytes_of(CdrReader& cdr, const char* format, std::size_t header) {
  EXPECT_EQ(cdr.get_string(), format);
  std::string bytes(cdr.get_count(1), '\0');
  for (char& byte : bytes) byte = static_cast<char>(cdr.get<std::uint8_t>());
  EXPECT_TRUE(cdr.good());
  EXPECT_EQ(cdr.left(), 0u);
  EXPECT_EQ(bytes.substr(0, header), std::string(header, '\0'));
  return bytes.substr(header);
}
base::DecodedPng file_of(CdrReader& cdr, const char* format, std::size_t header) {
  base::DecodedPng png = base::decode_png(bytes_of(cdr, format, header));
  EXPECT_EQ(png.header.width, 3u);
  EXPECT_EQ(png.header.height, 2u);
  return png;
}

/// As image_transport's plug-ins `compressed` and `compressedDepth` publish them.
TEST(StandardReadings, CompressedImages) {
  Encoded color = of(camera(Message::color_file), kPixels);
  EXPECT_EQ(file_of(color.cdr, "rgb8; png compressed bgr8", 0).pixels, base::color_bytes(kPixels, 2));
  StandardTopic far = camera(Message::depth_png);
  far.range_max = 100.0;
  std::vector<double> depths;
  for (const double depth : {0.5004, 0.5006, 65.5354, 65.5356, -HUGE_VAL, 100.0})
    depths.insert(depths.end(), {depth, 0.0});
  Encoded depth = of(far, depths);
  const base::DecodedPng png = file_of(depth.cdr, "16UC1; compressedDepth png", 12);
  ASSERT_EQ(png.header.bit_depth, 16);
  std::vector<std::uint16_t> millimetres(6);
  ASSERT_EQ(png.pixels.size(), 12u);
  std::memcpy(millimetres.data(), png.pixels.data(), 12);
  EXPECT_EQ(millimetres, (std::vector<std::uint16_t>{500, 501, 65535, 0, 0, 0})) << "too far, too near, no surface";
}

/// The names of ROS 2's plug-in, by colours and file.
TEST(StandardReadings, CompressedImagesNameTheirFiles) {
  StandardTopic topic = camera(Message::color_file);
  topic.jpeg = 90;
  Encoded color = of(topic, kPixels);
  EXPECT_EQ(bytes_of(color.cdr, "rgb8; jpeg compressed bgr8", 0),
            base::encode_jpeg(base::color_bytes(kPixels, 2), 3, 2, 90));
  topic.mono = true;
  Encoded grey = of(topic, kGreyPixels);
  EXPECT_EQ(bytes_of(grey.cdr, "mono8; jpeg compressed mono8", 0),
            base::encode_jpeg(base::image_bytes(kGreyPixels, 2, true), 3, 2, 90));
  topic.jpeg = 0;
  Encoded lossless = of(topic, kGreyPixels);
  EXPECT_EQ(file_of(lossless.cdr, "mono8; png compressed mono8", 0).pixels, base::image_bytes(kGreyPixels, 2, true));
}

/// The coefficients that each model has, K, and P, which is K without rectification.
TEST(StandardReadings, CameraInfoHasTheLens) {
  const auto expect_model = [](const StandardTopic& topic, const char* model, std::size_t coefficients) {
    Encoded message = of(topic, kPixels);
    CdrReader& cdr = message.cdr;
    EXPECT_EQ(cdr.get<std::uint32_t>(), 2u) << "height";
    EXPECT_EQ(cdr.get<std::uint32_t>(), 3u) << "width";
    EXPECT_EQ(cdr.get_string(), model);
    ASSERT_EQ(cdr.get_count(8), coefficients);
    for (std::size_t i = 0; i < coefficients; ++i) EXPECT_EQ(cdr.get<double>(), topic.lens.distortion[i]);
    for (const double k : {310.0, 0.0, 1.0, 0.0, 305.0, 0.5, 0.0, 0.0, 1.0}) EXPECT_EQ(cdr.get<double>(), k);
    for (int i = 0; i < 9; ++i) EXPECT_EQ(cdr.get<double>(), i % 4 == 0 ? 1.0 : 0.0) << "R";
    for (const double p : {310.0, 0.0, 1.0, 0.0, 0.0, 305.0, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0})
      EXPECT_EQ(cdr.get<double>(), p);
    for (int i = 0; i < 6; ++i) EXPECT_EQ(cdr.get<std::uint32_t>(), 0u);
    EXPECT_EQ(cdr.get<std::uint8_t>(), 0);
    EXPECT_TRUE(cdr.good());
  };
  StandardTopic topic = camera(Message::camera_info);
  expect_model(topic, "plumb_bob", 5);
  topic.lens.distortion[6] = 0.3;
  expect_model(topic, "rational_polynomial", 8);
  topic.lens.fisheye = true;
  expect_model(topic, "equidistant", 4);
}

}  // namespace
}  // namespace sf::record
