// The testbed file.

#include "vision/testbed.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/refusal.h"
#include "tests/vision/cameras.h"

namespace sf::vision {

namespace {

const std::string kCamera =
    "[[camera]]\nname = \"north\"\nsize = [1280, 1024]\nfocal = [1664, 1663]\nposition = [0, 1, 6.5]\n";

std::string error_of(const std::string& text) {
  return refusal_of([&] { parse_testbed("t.toml", text); });
}

}  // namespace

TEST(Testbed, ReadsCamerasAndTags) {
  const Testbed testbed = parse_testbed(
      "t.toml",
      "dictionary = \"aruco_4x4_50\"\ntag_side = 0.1\ntag_height = 0.3\naddress = \"10.0.0.1:9000\"\nonly_listed = "
      "true\n" +
          kCamera + "center = [600, 500]\ndistortion = [-0.1, 0.01, 1e-4, 2e-4, 0]\norientation = [0, 0, 0.6, 0.8]\n" +
          "rate = 30\nexposure = 0.004\nreadout = 0.02\nsource = \"/dev/video0\"\n" +
          "[[tag]]\nid = 7\n[[tag]]\nid = 9\nside = 0.2\nheight = 0.4\noffset = [0.1, -0.2, 90]\naddress = \"h:1\"\n");
  EXPECT_EQ(testbed.dictionary, "aruco_4x4_50");
  EXPECT_TRUE(testbed.only_listed);
  ASSERT_EQ(testbed.cameras.size(), 1u);
  const Camera& camera = testbed.cameras[0].camera;
  EXPECT_EQ(camera.name, "north");
  EXPECT_EQ(camera.intrinsics.width, 1280);
  EXPECT_EQ(camera.intrinsics.focal, glm::dvec2(1664.0, 1663.0));
  EXPECT_EQ(camera.intrinsics.center, glm::dvec2(600.0, 500.0));
  EXPECT_EQ(camera.intrinsics.distortion[3], 2e-4);
  EXPECT_EQ(camera.position, glm::dvec3(0.0, 1.0, 6.5));
  EXPECT_NEAR(camera.right.y, 0.96, 1e-12);  // rotated by 2 acos 0.8 about z
  EXPECT_EQ(camera.rate, 30.0);
  EXPECT_EQ(camera.exposure, 0.004);
  EXPECT_EQ(camera.readout, 0.02);
  EXPECT_EQ(testbed.cameras[0].source, "/dev/video0");
  EXPECT_EQ(testbed.mount(7).side, 0.1);
  EXPECT_EQ(testbed.mount(7).address, "10.0.0.1:9000");
  EXPECT_EQ(testbed.mount(8).height, 0.3);
  EXPECT_EQ(testbed.mount(9).side, 0.2);
  EXPECT_EQ(testbed.mount(9).height, 0.4);
  EXPECT_EQ(testbed.mount(9).X_OT.y, -0.2);
  EXPECT_EQ(testbed.mount(9).X_OT.z, 0.4) << "its object is on the floor";
  EXPECT_NEAR(testbed.mount(9).X_OT.yaw, M_PI / 2.0, 1e-15);
  EXPECT_EQ(testbed.mount(9).address, "h:1");
}

/// Boundary: three numbers state no height, so the object is on the floor below the tag.
TEST(Testbed, OffsetsMayStateTheHeightOnTheObject) {
  const Testbed testbed = parse_testbed(
      "t.toml", "tag_height = 0.3\n" + kCamera + "[[tag]]\nid = 1\noffset = [0.1, 0.2, 0.05, 90]\n[[tag]]\nid = 2\n");
  EXPECT_EQ(testbed.mount(1).X_OT.z, 0.05);
  EXPECT_NEAR(testbed.mount(1).X_OT.yaw, M_PI / 2.0, 1e-15);
  EXPECT_EQ(testbed.mount(2).X_OT.z, 0.3);
  EXPECT_EQ(testbed.mount(3).X_OT.z, 0.3) << "without a section";
  EXPECT_NE(error_of(kCamera + "[[tag]]\nid = 1\noffset = [0, 0, 0, 0, 0]\n").find("[x, y, yaw] or [x, y, z, yaw]"),
            std::string::npos);
}

TEST(Testbed, ReadsMeasuredCoordinates) {
  const Testbed testbed = parse_testbed(
      "t.toml", "tag_fit = \"height\"\nreport_from = 2\n" + kCamera +
                    "[[tag]]\nid = 1\n[[tag]]\nid = 2\nfit = \"tilt\"\n[[tag]]\nid = 3\nfit = \"plane\"\n");
  EXPECT_EQ(testbed.report_from, 2u);
  EXPECT_EQ(testbed.mount(0).fit, TagFreedom::height);
  EXPECT_EQ(testbed.mount(1).fit, TagFreedom::height);
  EXPECT_EQ(testbed.mount(2).fit, TagFreedom::tilt);
  EXPECT_EQ(testbed.mount(3).fit, TagFreedom::plane);
  const Testbed plain = parse_testbed("t.toml", kCamera);
  EXPECT_EQ(plain.mount(0).fit, TagFreedom::plane);
  EXPECT_EQ(plain.report_from, 1u);
  EXPECT_NE(error_of("tag_fit = \"3d\"\n" + kCamera).find("t.toml:1: 'tag_fit' is '3d'; expected \"plane\""),
            std::string::npos);
  EXPECT_NE(error_of(kCamera + "[[tag]]\nid = 1\nfit = \"Tilt\"\n").find("t.toml:8: 'fit' is 'Tilt'"),
            std::string::npos);
}

TEST(Testbed, DefaultsToACameraThatLooksDown) {
  const Testbed testbed = parse_testbed("t.toml", kCamera);
  EXPECT_EQ(testbed.cameras[0].camera.forward, glm::dvec3(0.0, 0.0, -1.0));
  EXPECT_EQ(testbed.cameras[0].camera.intrinsics.center, glm::dvec2(639.5, 511.5));
  EXPECT_FALSE(testbed.only_listed);
}

TEST(Testbed, ErrorsHaveFileLineAndRemedy) {
  struct Case {
    std::string text, expected;
  };
  for (const Case& each : std::vector<Case>{
           {"tag_side = 0.1\n", "t.toml: has no camera"},
           {"tag_sise = 0.1\n" + kCamera, "t.toml:1: unknown key 'tag_sise'; did you mean 'tag_side'?"},
           {"tag_side = 0\n" + kCamera, "t.toml:1: 'tag_side' expects a number from 0.001 to 10"},
           {"only_listed = 1\n" + kCamera, "t.toml:1: 'only_listed' expects true or false"},
           {"camera = 3\n", "t.toml:1: 'camera' expects tables, each under [[camera]]"},
           {"[[camera]]\nname = \"a\"\n", "'size' is missing; expected size = [1280, 1024] in pixels"},
           {"[[camera]]\nname = \"a\"\nsize = [1280.5, 1024]\n", "t.toml:3: 'size' expects whole numbers"},
           {"[[camera]]\nname = \"a\"\nsize = [8, 1024]\n", "t.toml:3: 'size' expects whole numbers of pixels from 16"},
           {"[[camera]]\nname = \"a\"\nsize = [640, 480]\n", "'focal' is missing"},
           {"[[camera]]\nname = \"a\"\nsize = [640, 480]\nfocal = [0, 700]\n", "t.toml:4: 'focal' expects pixels"},
           {"[[camera]]\nname = \"a\"\nsize = [640, 480]\nfocal = [700, 700]\n", "'position' is missing"},
           {"[[camera]]\nname = \"../x\"\n", "t.toml:2: 'name' expects a name of letters, digits"},
           {kCamera + kCamera, "t.toml:7: two cameras have the name 'north'"},
           {kCamera + "orientation = [1, 1, 0, 0]\n", "t.toml:6: 'orientation' has the norm 1.414; expected a unit"},
           {kCamera + "distortion = [-9, 0, 0, 0, 0]\n", "t.toml:6: 'distortion' folds the image"},
           {kCamera + "center = [-1, 500]\n", "t.toml:6: 'center' is outside the image"},
           {kCamera + "distortion = [1, 2]\n", "t.toml:6: 'distortion' expects [k1, k2, p1, p2, k3]"},
           {kCamera + "position = 3\n", "t.toml"},  // the same key twice
           {kCamera + "exposure = -1\n", "t.toml:6: 'exposure' expects a number from 0 to 1"},
           {kCamera + "[[tag]]\nside = 0.1\n", "'id' is missing; expected id = 12"},
           {kCamera + "[[tag]]\nid = 65536\n", "t.toml:7: 'id' expects a whole number from 0 to 65535"},
           {kCamera + "[[tag]]\nid = 1\n[[tag]]\nid = 1\n", "t.toml:9: two [[tag]] sections have the id 1"},
           {kCamera + "[[tag]]\nid = 1\noffset = [1, 2]\n", "t.toml:8: 'offset' expects [x, y, yaw]"}})
    expect_in(each.expected, error_of(each.text));
}

TEST(Testbed, LimitsSizesAndNumbers) {
  const auto camera = [](int i, const std::string& size) {
    return "[[camera]]\nname = \"c" + std::to_string(i) + "\"\nsize = " + size +
           "\nfocal = [9000, 9000]\nposition = [0, 1, 6.5]\n";
  };
  EXPECT_EQ(error_of(camera(0, "[8192, 8192]")), "");  // exactly 64 Mpx
  EXPECT_EQ(error_of(camera(0, "[8193, 8192]")), "t.toml:3: 'size' is 8193 x 8192 pixels; expected at most 64 Mpx");
  EXPECT_EQ(error_of(camera(0, "[16385, 16]")).substr(0, 16), "t.toml:3: 'size'");
  std::string many, large;
  for (int i = 0; i < 64; ++i) many += camera(i, "[640, 480]");
  EXPECT_EQ(error_of(many), "");
  EXPECT_EQ(error_of(many + camera(64, "[640, 480]")), "t.toml:321: 'camera' has 65 sections; expected at most 64");
  for (int i = 0; i < 4; ++i) large += camera(i, "[8192, 8192]");
  EXPECT_EQ(error_of(large), "");  // exactly 256 Mpx
  EXPECT_EQ(error_of(large + camera(4, "[16, 16]")), "t.toml:23: 'size' of all cameras is more than 256 Mpx together");
}

TEST(Testbed, RejectsValuesOfEveryWrongForm) {
  // Each key with each of the wrong forms, and with values that are not finite.
  const std::vector<std::string> forms{"true",       "\"\"",      "''",         "nan",       "-inf",
                                       "1e999",      "-1",        "[]",         "[1]",       "[nan, nan]",
                                       "[[1], [2]]", "{ a = 1 }", "2026-01-01", "[1, \"2\"]"};
  std::size_t count = 0;
  const auto refuses = [&](const std::string& text) {
    EXPECT_TRUE(error_of(text).starts_with("t.toml")) << text << error_of(text);
    ++count;
  };
  for (const std::string& form : forms) {
    for (const char* key : {"dictionary", "tag_side", "tag_fit", "address"})
      refuses(fmt::format("{} = {}\n", key, form) + kCamera);
    for (const char* key : {"center", "distortion", "orientation", "rate", "exposure", "source"})
      refuses(kCamera + fmt::format("{} = {}\n", key, form));
    for (const char* key : {"side", "offset", "fit", "address"})
      refuses(kCamera + fmt::format("[[tag]]\nid = 1\n{} = {}\n", key, form));
    refuses(kCamera + fmt::format("[[tag]]\nid = {}\n", form));
    for (const char* key : {"name", "size", "focal", "position"}) {
      std::string text = kCamera;
      const std::size_t at = text.find(key), end = text.find('\n', at);
      refuses(text.replace(at, end - at, fmt::format("{} = {}", key, form)));
    }
  }
  EXPECT_EQ(count, forms.size() * 19);
}

TEST(Testbed, RejectsOtherFiles) {
  std::string deep = "a";
  for (int i = 0; i < 200'000; ++i) deep += ".a";
  for (const std::string& text : {std::string(), std::string("\0", 1), deep + " = 1\n", "[" + deep + "]\n",
                                  std::string(200'000, '['), "camera = " + std::string(200'000, '['),
                                  "[[camera]]\n" + deep + " = 1\n", std::string("[camera]\nname = \"a\""),
                                  std::string("[[camera]\n"), kCamera + "[tag]\nid = 1\n", kCamera + "\xFF = 1\n"})
    EXPECT_TRUE(error_of(text).starts_with("t.toml")) << text.substr(0, 80) << error_of(text);
}

TEST(Testbed, ReadsSurveyedTags) {
  const std::string camera = "[[camera]]\nname = \"a\"\nsize = [64, 48]\nfocal = [60, 60]\nposition = [0, 0, 3]\n";
  const Testbed testbed = parse_testbed(
      "t.toml",
      camera + "[[survey]]\nid = 3\nposition = [1, 2, 0.5]\nheading = 90\n[[survey]]\nid = 4\nposition = [0, 0, 0]\n");
  ASSERT_EQ(testbed.surveyed.size(), 2u);
  EXPECT_EQ(testbed.surveyed.at(3).position, glm::dvec3(1.0, 2.0, 0.5));
  EXPECT_NEAR(*testbed.surveyed.at(3).heading, M_PI / 2.0, 1e-12);
  EXPECT_FALSE(testbed.surveyed.at(4).heading);
  const auto refusal = [&](const std::string& text) { return error_of(camera + text); };
  EXPECT_EQ(refusal("[[survey]]\nid = 3\n"),
            "t.toml:6: 'position' is missing; expected position = [x, y, z] of the tag's centre in metres");
  EXPECT_EQ(refusal("[[survey]]\nid = 3\nposition = [1, 2, 3]\n[[survey]]\nid = 3\nposition = [1, 2, 3]\n"),
            "t.toml:10: two [[survey]] sections have the id 3");
  std::string many;
  for (std::size_t i = 0; i <= kMaxSurveyed; ++i)
    many += "[[survey]]\nid = " + std::to_string(i) + "\nposition = [1, 2, 3]\n";
  EXPECT_NE(refusal(many).find("'survey' has 1001 sections; expected at most 1000"), std::string::npos);
}

TEST(Testbed, WrittenCamerasReadBack) {
  const Camera camera = distorted_camera();
  const Camera read = parse_testbed("t.toml", camera_section(camera)).cameras[0].camera;
  EXPECT_EQ(camera_section(read), camera_section(camera));
  EXPECT_EQ(read.intrinsics.distortion, camera.intrinsics.distortion);
  EXPECT_NEAR(read.forward.y, camera.forward.y, 1e-11);
}

/// The minimum and maximum of each key, and the next numbers beyond.
TEST(Testbed, NumbersHaveLimits) {
  struct Range {
    const char *key, *below, *first, *last, *above;
  };
  const auto is_taken = [](const std::string& text) { return error_of(text) == ""; };
  const auto expect_range = [&](const Range& r, const std::string& before, const std::string& behind) {
    for (const auto& [value, taken] : {std::pair{r.below, false}, {r.first, true}, {r.last, true}, {r.above, false}})
      EXPECT_EQ(is_taken(before + r.key + " = " + value + "\n" + behind), taken) << r.key << " = " << value;
  };
  for (const Range& r :
       {Range{"tag_side", "0.0009", "0.001", "10", "10.001"}, Range{"tag_height", "-100.001", "-100", "100", "100.001"},
        Range{"report_from", "0", "1", "100", "101"}})
    expect_range(r, "", kCamera);
  for (const Range& r :
       {Range{"rate", "0.09", "0.1", "1000", "1000.1"}, Range{"exposure", "-0.1", "0", "1", "1.001"},
        Range{"readout", "-0.1", "0", "1", "1.001"},
        Range{"center", "[-0.1, 0]", "[0, 0]", "[1279, 1023]", "[1279.1, 1023]"},
        Range{"center", "[0, -0.1]", "[0, 1023]", "[1279, 0]", "[1279, 1023.1]"},
        Range{"orientation", "[0, 0, 0, 0.9989]", "[0, 0, 0, 0.9991]", "[0.6, 0, 0, 0.8]", "[0.61, 0, 0, 0.8]"}})
    expect_range(r, kCamera, "");
  for (const Range& r : {Range{"id", "-1", "0", "65535", "65536"}}) expect_range(r, kCamera + "[[tag]]\n", "");
  for (const Range& r :
       {Range{"side", "0.0009", "0.001", "10", "10.001"}, Range{"height", "-100.001", "-100", "100", "100.001"},
        Range{"robot", "-1", "0", "65534", "65535"},
        Range{"offset", "[-1000.1, 0, 0]", "[-1000, 0, 0]", "[0, 1000, 1000]", "[0, 0, 1000.1]"}})
    expect_range(r, kCamera + "[[tag]]\nid = 1\n", "");
  for (const Range& r :
       {Range{"heading", "-360.1", "-360", "360", "360.1"},
        Range{"position", "[-10000.1, 0, 0]", "[-10000, 0, 0]", "[0, 10000, 10000]", "[0, 0, 10000.1]"}})
    expect_range(r, kCamera + "[[survey]]\nid = 1\n" + (r.key[0] == 'h' ? "position = [0, 0, 0]\n" : ""), "");
  const std::string name = "[[camera]]\nname = \"a\"\nposition = [0, 0, 3]\n";
  for (const Range& r : {Range{"size", "[15, 16]", "[16, 16]", "[16384, 4096]", "[16385, 16]"},
                         Range{"size", "[16, 15]", "[16, 17]", "[4096, 16384]", "[16, 16385]"}})
    expect_range(r, name + "focal = [9000, 9000]\n", "");
  for (const Range& r : {Range{"focal", "[0.9, 1000]", "[1000, 1000]", "[1e6, 1e6]", "[1000001, 1e6]"},
                         Range{"focal", "[1000, 0.9]", "[1000, 2000]", "[1e6, 1000]", "[1e6, 1000001]"}})
    expect_range(r, name + "size = [64, 48]\n", "");
}

}  // namespace sf::vision
