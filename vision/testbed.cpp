#include "vision/testbed.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/files.h"
#include "world/toml_reader.h"

namespace sf::vision {

namespace {

using world::TomlNode;
using world::TomlReader;

constexpr double kMaxPosition = 1e4;  // [m]
constexpr double kMaxPixels = 16384;
constexpr double kDegree = M_PI / 180.0;
constexpr std::array<std::string_view, 11> kKeys{"dictionary", "tag_side",    "tag_height",  "tag_fit",
                                                 "address",    "only_listed", "report_from", "camera",
                                                 "tag",        "survey",      "follow"};
constexpr std::array<std::string_view, 11> kCameraKeys{"name",       "size",     "focal",       "center",
                                                       "distortion", "position", "orientation", "rate",
                                                       "exposure",   "readout",  "source"};
constexpr std::array<std::string_view, 3> kSurveyKeys{"id", "position", "heading"};
constexpr std::array<std::string_view, 7> kTagKeys{"id", "side", "height", "fit", "offset", "address", "robot"};
constexpr std::array<std::string_view, 3> kFits{"plane", "height", "tilt"};  // in the order of TagFreedom

const TomlNode& required(const TomlReader& reader, const TomlNode& table, std::string_view key,
                         std::string_view expected) {
  const TomlNode* node = world::find(table, key);
  if (node == nullptr) reader.fail(table, fmt::format("'{}' is missing; expected {}", key, expected));
  return *node;
}

void read_intrinsics(const TomlReader& reader, const TomlNode& table, Intrinsics& into) {
  std::array<double, 2> size{}, focal{}, center{};
  const TomlNode& at = required(reader, table, "size", "size = [1280, 1024] in pixels");
  reader.numbers(table, "size", size, kMaxPixels, "[columns, rows] in pixels");
  for (const double n : size)
    if (n < 16.0 || n != std::floor(n)) reader.fail(at, "'size' expects whole numbers of pixels from 16 to 16384");
  if (size[0] * size[1] > kMaxImagePixels)
    reader.fail(at, fmt::format("'size' is {:.0f} x {:.0f} pixels; expected at most {} Mpx", size[0], size[1],
                                kMaxImagePixels >> 20));
  const TomlNode& length = required(reader, table, "focal", "focal = [1664, 1664] in pixels, from a calibration");
  reader.numbers(table, "focal", focal, 1e6, "[along columns, along rows] in pixels");
  if (focal[0] < 1.0 || focal[1] < 1.0) reader.fail(length, "'focal' expects pixels from 1 to 1e6");
  center = {0.5 * (size[0] - 1.0), 0.5 * (size[1] - 1.0)};
  reader.numbers(table, "center", center, kMaxPixels, "[column, row] in pixels");
  if (center[0] < 0.0 || center[1] < 0.0 || center[0] > size[0] - 1.0 || center[1] > size[1] - 1.0)
    reader.fail(*world::find(table, "center"), "'center' is outside the image; expected a pixel near its middle");
  reader.numbers(table, "distortion", into.distortion, 1e3, "[k1, k2, p1, p2, k3]");
  into.width = static_cast<int>(size[0]);
  into.height = static_cast<int>(size[1]);
  into.focal = {focal[0], focal[1]};
  into.center = {center[0], center[1]};
  if (is_invertible(into)) return;
  const TomlNode* distortion = world::find(table, "distortion");
  reader.fail(distortion != nullptr ? *distortion : length,
              "'distortion' folds the image: two points map to one pixel, or the lens covers more than 80 degrees off "
              "its axis; expected coefficients from a calibration with points across the whole image");
}

void read_pose(const TomlReader& reader, const TomlNode& table, Camera& into) {
  std::array<double, 3> position{};
  required(reader, table, "position", "position = [x, y, z] of the camera in metres");
  reader.numbers(table, "position", position, kMaxPosition, "[x, y, z] in metres");
  into.position = {position[0], position[1], position[2]};
  const TomlNode* node = world::find(table, "orientation");
  if (node == nullptr) return;
  std::array<double, 4> q{};
  reader.numbers(table, "orientation", q, 1.0,
                 "a unit quaternion [x, y, z, w] of the camera (x right, y down, z forward)");
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (std::abs(norm - 1.0) > 1e-3)
    reader.fail(*node, fmt::format("'orientation' has the norm {:.4g}; expected a unit quaternion [x, y, z, w]", norm));
  for (double& component : q) component /= norm;
  set_orientation(into, q);
}

TestbedCamera read_camera(const TomlReader& reader, const TomlNode& table, const std::vector<TestbedCamera>& others) {
  reader.require_known(table, kCameraKeys);
  TestbedCamera read;
  Camera& camera = read.camera;
  required(reader, table, "name", "name = \"north\"");
  camera.name = reader.text(table, "name", "");
  if (!is_camera_name(camera.name))
    reader.fail(*world::find(table, "name"), fmt::format("'name' expects {}", kCameraNameForm));
  for (const TestbedCamera& other : others)
    if (other.camera.name == camera.name)
      reader.fail(*world::find(table, "name"), fmt::format("two cameras have the name '{}'", camera.name));
  read_intrinsics(reader, table, camera.intrinsics);
  read_pose(reader, table, camera);
  camera.rate = reader.number(table, "rate", 15.0, 0.1, 1000.0, "Hz");
  camera.exposure = reader.number(table, "exposure", 0.0, 0.0, 1.0, "seconds");
  camera.readout = reader.number(table, "readout", 0.0, 0.0, 1.0, "seconds");
  read.source = reader.text(table, "source", "");
  return read;
}

std::vector<TestbedCamera> read_cameras(const TomlReader& reader, const TomlNode& root) {
  const auto tables = reader.tables(root, "camera");
  if (tables.empty())
    throw base::InputError(reader.file(), 0, "has no camera; expected a [[camera]] section for each, see docs/vps.md");
  if (tables.size() > kMaxCameras)
    reader.fail(*tables[kMaxCameras],
                fmt::format("'camera' has {} sections; expected at most {}", tables.size(), kMaxCameras));
  std::vector<TestbedCamera> cameras;
  std::int64_t pixels = 0;
  for (const TomlNode* table : tables) {
    cameras.push_back(read_camera(reader, *table, cameras));
    const Intrinsics& i = cameras.back().camera.intrinsics;
    pixels += std::int64_t{i.width} * i.height;
    if (pixels > kMaxTestbedPixels)
      reader.fail(*world::find(*table, "size"),
                  fmt::format("'size' of all cameras is more than {} Mpx together", kMaxTestbedPixels >> 20));
  }
  return cameras;
}

TagFreedom read_fit(const TomlReader& reader, const TomlNode& table, std::string_view key, TagFreedom fallback) {
  const std::string word = reader.text(table, key, std::string(kFits[static_cast<std::size_t>(fallback)]));
  const auto found = std::find(kFits.begin(), kFits.end(), word);
  if (found == kFits.end())
    reader.fail(*world::find(table, key),
                fmt::format("'{}' is '{}'; expected \"plane\" (a horizontal tag at its height), \"height\" (the height "
                            "is measured) or \"tilt\" (height and tilt are measured)",
                            key, word));
  return static_cast<TagFreedom>(found - kFits.begin());
}

/// @param height [m] of the tag above the floor
base::Pose read_offset(const TomlReader& reader, const TomlNode& table, double height) {
  const TomlNode* node = world::find(table, "offset");
  std::vector<double> offset(node != nullptr && node->items.size() == 4 ? 4 : 3);
  reader.numbers(table, "offset", offset, 1e3,
                 "[x, y, yaw] or [x, y, z, yaw] of the tag on its object in metres and degrees");
  return {offset[0], offset[1], offset.size() == 4 ? offset[2] : height, offset.back() * kDegree};
}

TagMount read_tag(const TomlReader& reader, const TomlNode& table, const TagMount& fallback) {
  TagMount tag = fallback;
  tag.side = reader.number(table, "side", tag.side, 1e-3, 10.0, "metres");
  tag.height = reader.number(table, "height", tag.height, -100.0, 100.0, "metres");
  tag.fit = read_fit(reader, table, "fit", tag.fit);
  tag.address = reader.text(table, "address", tag.address);
  tag.X_OT = read_offset(reader, table, tag.height);
  if (world::find(table, "robot") != nullptr)
    tag.robot = static_cast<std::uint32_t>(reader.whole(table, "robot", 0, 65534));
  return tag;
}

void read_survey(const TomlReader& reader, const TomlNode& root, std::map<std::uint32_t, SurveyedTag>& into) {
  const auto tables = reader.tables(root, "survey");
  if (tables.size() > kMaxSurveyed)
    reader.fail(*tables[kMaxSurveyed],
                fmt::format("'survey' has {} sections; expected at most {}", tables.size(), kMaxSurveyed));
  for (const TomlNode* table : tables) {
    reader.require_known(*table, kSurveyKeys);
    const TomlNode& id = required(reader, *table, "id", "id = 12");
    required(reader, *table, "position", "position = [x, y, z] of the tag's centre in metres");
    std::array<double, 3> position{};
    reader.numbers(*table, "position", position, kMaxPosition, "[x, y, z] in metres");
    SurveyedTag tag{{position[0], position[1], position[2]}, std::nullopt};
    if (world::find(*table, "heading") != nullptr)
      tag.heading = reader.number(*table, "heading", 0.0, -360.0, 360.0, "degrees") * kDegree;
    const auto number = static_cast<std::uint32_t>(reader.whole(*table, "id", 0, 65535));
    if (!into.emplace(number, tag).second)
      reader.fail(id, fmt::format("two [[survey]] sections have the id {}", number));
  }
}

}  // namespace

const TagMount& Testbed::mount(std::uint32_t id) const {
  const auto found = tags.find(id);
  return found == tags.end() ? tag : found->second;
}

Testbed parse_testbed(const std::string& file, std::string_view text) {
  Testbed testbed;
  testbed.file = file;
  const TomlNode root = world::parse_toml(file, text);
  const TomlReader reader(file);
  reader.require_kind(root, "a testbed");
  reader.require_known(root, kKeys);
  testbed.dictionary = reader.text(root, "dictionary", testbed.dictionary);
  testbed.tag.side = reader.number(root, "tag_side", testbed.tag.side, 1e-3, 10.0, "metres");
  testbed.tag.height = reader.number(root, "tag_height", testbed.tag.height, -100.0, 100.0, "metres");
  testbed.tag.X_OT.z = testbed.tag.height;
  testbed.tag.fit = read_fit(reader, root, "tag_fit", testbed.tag.fit);
  testbed.tag.address = reader.text(root, "address", "");
  testbed.only_listed = reader.flag(root, "only_listed");
  testbed.report_from = static_cast<std::uint32_t>(reader.whole(root, "report_from", 1, 100));
  if (testbed.report_from == 0)
    reader.fail(*world::find(root, "report_from"),
                "'report_from' is 0; expected the number of a sighting from 1 to 100");
  testbed.cameras = read_cameras(reader, root);
  for (const TomlNode* table : reader.tables(root, "tag")) {
    reader.require_known(*table, kTagKeys);
    const TomlNode& id = required(reader, *table, "id", "id = 12");
    const auto number = static_cast<std::uint32_t>(reader.whole(*table, "id", 0, 65535));
    if (!testbed.tags.emplace(number, read_tag(reader, *table, testbed.tag)).second)
      reader.fail(id, fmt::format("two [[tag]] sections have the id {}", number));
  }
  read_survey(reader, root, testbed.surveyed);
  if (const TomlNode* table = reader.table(root, "follow")) testbed.follow = read_follow(reader, *table);
  return testbed;
}

Testbed read_testbed(const std::string& file) { return parse_testbed(file, base::read_text(file)); }

std::string camera_section(const Camera& camera) {
  const Intrinsics& i = camera.intrinsics;
  return fmt::format(
      "[[camera]]\nname = \"{}\"\nsize = [{}, {}]\nfocal = [{:.9g}, {:.9g}]\ncenter = [{:.9g}, {:.9g}]\n"
      "distortion = [{:.9g}]\nposition = [{:.9g}, {:.9g}, {:.9g}]\norientation = [{:.12g}]\n",
      camera.name, i.width, i.height, i.focal.x, i.focal.y, i.center.x, i.center.y, fmt::join(i.distortion, ", "),
      camera.position.x, camera.position.y, camera.position.z, fmt::join(orientation(camera), ", "));
}

}  // namespace sf::vision
