// The parts of the live view's page that need no browser (script/check_view tests the rest).

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/lens.h"
#include "base/rigid_transform.h"
#include "tests/apps/program.h"
#include "vision/testbed.h"

namespace sf {
namespace {

using Table = nlohmann::json;

Table row_of(const glm::dvec3& p) { return {p.x, p.y, p.z}; }

/// Lenses of each kind, with points in the camera's frame and their pixels all over the image.
Table lens_table() {
  constexpr unsigned kWidth = 640, kHeight = 480;
  const std::pair<base::Lens, const char*> lenses[] = {
      {{{400, 400}, {319.5, 239.5}, {}, false}, "a pinhole"},
      {{{420, 410}, {330, 250}, {-0.2, 0.04, 0.001, -0.002, 0.001}, false}, "Brown's distortion"},
      {{{420, 410}, {310, 240}, {0.1, 0.02, 0.001, -0.001, 0.01, 0.2, 0.03, 0.001}, false}, "with a rational part"},
      {{{200, 200}, {319.5, 239.5}, {0.02, -0.005, 0.001, -0.0002}, true}, "a fisheye"}};
  Table table = Table::array();
  for (const auto& [lens, why] : lenses) {
    const base::LensImage image(lens, kWidth, kHeight);
    EXPECT_FALSE(image.fold()) << why;
    Table points = Table::array();
    for (unsigned v = 0; v < kHeight; v += 53)
      for (unsigned u = 0; u < kWidth; u += 71)
        if (const auto n = image.direction(glm::dvec2{u, v}); n) {
          const glm::dvec2 pixel = base::pixel_of(lens, *n);
          const double depth = 0.5 + 0.01 * u;
          points.push_back({depth * n->x, depth * n->y, depth, pixel.x, pixel.y});
        }
    table.push_back({{"why", why},
                     {"size", {kWidth, kHeight}},
                     {"focal", {lens.focal.x, lens.focal.y}},
                     {"center", {lens.center.x, lens.center.y}},
                     {"distortion", lens.distortion},
                     {"fisheye", lens.fisheye},
                     {"points", points}});
  }
  return table;
}

/// Poses with points in B and in A.
Table transform_table() {
  Table table = Table::array();
  for (int k = 0; k < 20; ++k) {
    const auto at = [&](int i) { return std::sin(1.0 + 7.3 * k + 2.1 * i); };
    const base::Pose X{3.0 * at(0), 3.0 * at(1), at(2), 3.0 * at(3)};
    const base::Tilt tilt{at(4), 1.5 * at(5)};
    const glm::dvec3 p{at(6), at(7), at(8)};
    table.push_back({{"pose", {X.x, X.y, X.yaw, X.z}},
                     {"tilt", {{"roll", tilt.roll}, {"pitch", tilt.pitch}}},
                     {"p", row_of(p)},
                     {"seen", row_of(base::transform(base::transform_of(X, tilt), p))}});
  }
  return table;
}

/// A calibration file with its cameras as vision/ reads them, and points with their pixels.
Table calibration_table() {
  const std::string file = SF_SOURCE_DIR "/worlds/testbed.toml";
  Table cameras = Table::array();
  for (const auto& [camera, source] : vision::read_testbed(file).cameras) {
    Table points = Table::array();
    for (const glm::dvec3& p :
         {camera.position - glm::dvec3{0, 0, 6}, glm::dvec3{0.5, -1.2, 0.2}, glm::dvec3{0, 0.7, 0}})
      if (const auto pixel = project(camera, p); pixel) points.push_back({p.x, p.y, p.z, pixel->x, pixel->y});
    EXPECT_EQ(points.size(), 3u);
    cameras.push_back({{"name", camera.name}, {"points", points}});
  }
  return {{"file", file}, {"cameras", cameras}};
}

TEST(Page, ColoursKeysImagesAndTheTimesOfReadings) {
  if (!succeeds("node --version")) GTEST_SKIP() << "no Node.js on this machine (Debian: nodejs)";
  const Folder folder;
  for (const auto& entry : std::filesystem::directory_iterator(SF_SOURCE_DIR "/viz/web"))
    std::filesystem::copy_file(entry.path(), folder.path(entry.path().filename()));
  folder.write("package.json", R"({"type": "module"})");
  folder.write(
      "tables.json",
      Table{{"lenses", lens_table()}, {"transforms", transform_table()}, {"calibration", calibration_table()}}.dump());
  const std::string log = folder.path("log");
  EXPECT_TRUE(succeeds("(node '" SF_SOURCE_DIR "/tests/apps/page.mjs' '" + folder.path() + "' >'" + log + "' 2>&1)"))
      << read_file(log);
}

}  // namespace
}  // namespace sf
