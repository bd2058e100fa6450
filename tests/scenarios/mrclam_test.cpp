// The experiment `mrclam`: interpolation of the truth, and the goals on the real measurements where they are present.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "scenarios/mrclam_runs.h"
#include "tests/folder.h"
#include "tests/instrumented.h"
#include "tests/units.h"

namespace sf::scenarios {
namespace {

TEST(Mrclam, TruthIsInterpolatedTheShortWay) {
  const std::vector<record::MrclamTruth> truth{{kSecond, {0.0, 0.0, 0.0, 3.0}}, {2 * kSecond, {1.0, 2.0, 0.0, -3.0}}};
  EXPECT_FALSE(true_pose(truth, kSecond - 1));
  EXPECT_FALSE(true_pose(truth, 2 * kSecond + 1));
  EXPECT_EQ(true_pose(truth, kSecond)->yaw, 3.0);
  const base::Pose middle = *true_pose(truth, kSecond + kSecond / 2);
  EXPECT_DOUBLE_EQ(middle.x, 0.5);
  EXPECT_DOUBLE_EQ(middle.y, 1.0);
  EXPECT_NEAR(std::abs(middle.yaw), M_PI, 1e-12);
}

class MrclamData : public FolderTest {};

TEST_F(MrclamData, ReachesItsGoals) {
  const std::string packed = SF_SOURCE_DIR "/../shared/data/mrclam/dataset6.tar.xz";
  if (!std::filesystem::exists(packed)) GTEST_SKIP() << packed << " is missing: no real measurements to compare with";
  if (instrumented()) GTEST_SKIP() << "takes minutes with sanitizers";
  const std::string unpack = "tar -xJf '" + packed + "' -C '" + folder_.string() + "'";
  ASSERT_EQ(std::system(unpack.c_str()), 0);
  const record::MrclamData data = record::read_mrclam(path("MRCLAM_Dataset6"));
  ASSERT_EQ(data.robots.size(), 5u);
  const std::vector<MrclamRow> rows = run_mrclam(data, {}, 0, {}, {});
  ASSERT_EQ(rows.size(), 5u * 3 * 2 * 2);
  double filter = 0.0, smoother = 0.0, third = 0.0;
  for (const MrclamRow& row : rows) {
    EXPECT_GT(row.samples, 45'000u);
    if (row.landmarks == MrclamLandmarks::third && row.cooperative && !row.smoother) third += row.rms_m / 5.0;
    if (row.landmarks != MrclamLandmarks::all || row.cooperative) continue;
    SCOPED_TRACE(row.robot);
    (row.smoother ? smoother : filter) += row.rms_m / 5.0;
    EXPECT_LE(row.rms_m, 0.22);
    EXPECT_GE(row.nees, 0.5);
    EXPECT_LE(row.nees, 2.0);
  }
  EXPECT_LE(filter, 0.18);
  EXPECT_LE(smoother, 0.13);
  EXPECT_LE(third, 0.3);
}

}  // namespace
}  // namespace sf::scenarios
