#include "record/mrclam.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "tests/folder.h"

namespace sf::record {
namespace {

class MrclamFormat : public FolderTest {
 protected:
  MrclamFormat() {
    write("Barcodes.dat", "# Subject # Barcode #\n  1 \t 5\n 6 \t 63\n  7 81\n9 9\n");
    write("Landmark_Groundtruth.dat", "# Subject x y\n 7  1.5 -2.5 0.0001 0.0002\n  6 \t 0.5 \t -4.25 \t 0 \t 0\n");
    write("Robot1_Odometry.dat", "# Time v w\n1248444188.949 \t  0.086 \t -0.398\n1248444188.849 0 0\n");
    write("Robot1_Measurement.dat", "1248444189.5 63 2.5 -0.1\n1248444189.5 43 2 0\n1248444189.6 9 2 0\n");
    write("Robot1_Groundtruth.dat", "1248444175.103 2.4 -0.2 3.0\r\n\r\n1248444175.115 2.5 -0.3 3.1\r\n");
  }
  void expect_refused(const std::string& part) const {
    try {
      read_mrclam(folder_.string());
      ADD_FAILURE() << "accepted; expected an error with " << part;
    } catch (const base::InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
};

TEST_F(MrclamFormat, ReadsSortsAndCounts) {
  const MrclamData data = read_mrclam(folder_.string());
  ASSERT_EQ(data.robots.size(), 1u);
  ASSERT_EQ(data.landmarks.size(), 2u);
  EXPECT_EQ(data.landmarks[0].subject, 6);
  EXPECT_EQ(data.landmarks[0].p.y, -4.25);
  const MrclamRobot& robot = data.robots[0];
  EXPECT_EQ(robot.subject, 1);
  ASSERT_EQ(robot.odometry.size(), 2u);
  EXPECT_EQ(robot.odometry[1].time, 1248444188949000000);
  EXPECT_EQ(robot.odometry[1].turn, -0.398);
  ASSERT_EQ(robot.sightings.size(), 1u);
  EXPECT_EQ(robot.sightings[0].subject, 6);
  EXPECT_EQ(robot.unknown_barcodes, 1u);
  EXPECT_EQ(robot.unknown_subjects, 1u);
  ASSERT_EQ(robot.truth.size(), 2u) << "CRLF and blank lines";
  EXPECT_EQ(robot.truth[1].X_WM.yaw, 3.1);
}

/// Each bad file is refused in one line that names it, the line, and what was expected.
TEST_F(MrclamFormat, RefusesBadFiles) {
  struct Bad {
    const char *file, *text, *message;
  };
  const Bad corpus[]{
      {"Robot1_Odometry.dat", "1 2\n", "Robot1_Odometry.dat:1: has 2 columns; expected 3"},
      {"Robot1_Odometry.dat", "1 2 3 4\n", "has 4 columns"},
      {"Robot1_Odometry.dat", "# c\n1 2 x\n", "Robot1_Odometry.dat:2: column 3 is \"x\""},
      {"Robot1_Odometry.dat", "1 nan 0\n", "column 2 is \"nan\""},
      {"Robot1_Odometry.dat", "1 inf 0\n", "column 2 is \"inf\""},
      {"Robot1_Odometry.dat", "1 1e7 0\n", "column 2"},
      {"Robot1_Odometry.dat", "1 0.5m 0\n", "column 2 is \"0.5m\""},
      {"Robot1_Odometry.dat", "-1 0 0\n", "the time is -1 s"},
      {"Robot1_Odometry.dat", "1e300 0 0\n", "column 1"},
      {"Robot1_Odometry.dat", "# only a comment\n", "has no rows"},
      {"Robot1_Measurement.dat", "1 63 0 0\n", "the range is 0 m"},
      {"Robot1_Measurement.dat", "1 6.5 1 0\n", "column 2 is 6.5; expected a whole number"},
      {"Robot1_Measurement.dat", "1 -6 1 0\n", "expected a whole number"},
      {"Robot1_Groundtruth.dat", "1 2 3\n", "expected 4"},
      {"Barcodes.dat", "6 63\n7 63\n", "Barcodes.dat:2: barcode 63 belongs to two subjects"},
      {"Landmark_Groundtruth.dat", "6 0 0 0 0\n6 1 0 0 0\n", "landmark 6 has two positions"},
      {"Landmark_Groundtruth.dat", "6 0 0\n", "expected 5"},
  };
  for (const Bad& bad : corpus) {
    SCOPED_TRACE(bad.text);
    std::ifstream in(path(bad.file), std::ios::binary);
    const std::string good{std::istreambuf_iterator<char>(in), {}};
    write(bad.file, bad.text);
    expect_refused(bad.message);
    write(bad.file, good);
  }
  EXPECT_NO_THROW(read_mrclam(folder_.string()));
}

TEST_F(MrclamFormat, RefusesMissingFiles) {
  for (const char* file : {"Robot1_Groundtruth.dat", "Robot1_Measurement.dat", "Barcodes.dat"}) {
    std::filesystem::rename(path(file), path("away"));
    expect_refused(file);
    std::filesystem::rename(path("away"), path(file));
  }
  std::filesystem::remove(path("Robot1_Odometry.dat"));
  expect_refused("has no robot");
  EXPECT_THROW(read_mrclam("/nowhere"), base::InputError);
}

}  // namespace
}  // namespace sf::record
