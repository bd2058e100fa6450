#include "scenarios/lane_picture.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "control/lane_view.h"
#include "farm/farm.h"
#include "sensors/camera.h"
#include "vision/lane_tracker.h"
#include "vision/opencv.h"
#include "viz/png.h"

namespace sf::scenarios {

namespace {

constexpr double kPlace = 0.7;     // [m] along the course: the bend is in view
constexpr double kOffset = 0.05;   // [m] of the robot to the left of the middle
constexpr std::size_t kEvery = 9;  // points: rows have two or three
constexpr int kScale = 2;          // picture's pixels per cell and per pixel of the camera
constexpr std::array<std::uint8_t, 3> kEdge{230, 60, 40}, kMiddle{30, 90, 220}, kPaint{0, 170, 70};

/// Points [m] in the robot's frame on a parallel of the lane's middle.
std::vector<glm::dvec2> parallel(const vision::Lane& lane, double left, double far) {
  std::vector<glm::dvec2> points;
  double y = left - lane.offset;
  for (double x = 0.1; x < far; x += 0.02) {
    for (int k = 0; k < 8; ++k) y += left - vision::left_of_middle(lane, {x, y});
    points.push_back({x, y});
  }
  return points;
}

vision::Image enlarged(const vision::Image& small, int columns, int rows) {
  vision::Image large{columns, rows, 3, std::vector<std::uint8_t>(static_cast<std::size_t>(3) * columns * rows, 255)};
  for (int v = 0; v < std::min(rows, kScale * small.height); ++v)
    for (int u = 0; u < std::min(columns, kScale * small.width); ++u)
      for (int c = 0; c < 3; ++c) large.at(u, v)[c] = small.at(u / kScale, v / kScale)[small.channels == 3 ? c : 0];
  return large;
}

glm::dvec2 in_picture(glm::dvec2 pixel) { return static_cast<double>(kScale) * (pixel + 0.5) - 0.5; }

vision::Image side_by_side(const vision::Image& left, const vision::Image& right) {
  constexpr int kSpace = 12;
  vision::Image both{left.width + kSpace + right.width, std::max(left.height, right.height), 3, {}};
  both.pixels.assign(static_cast<std::size_t>(3) * both.width * both.height, 255);
  for (const vision::Image* part : {&left, &right})
    for (int v = 0; v < part->height; ++v)
      std::copy_n(part->at(0, v), 3 * part->width, both.at(part == &left ? 0 : left.width + kSpace, v));
  return both;
}

/// Pixels of points on the ground; those behind the camera are left out.
std::vector<glm::dvec2> in_image(const sensors::CameraSettings& camera, const std::vector<glm::dvec2>& ground) {
  std::vector<glm::dvec2> pixels;
  for (const glm::dvec2& p : ground) {
    const glm::dvec3 q = glm::transpose(camera.X_MS.R) * (glm::dvec3(p, 0.0) - camera.X_MS.p);
    if (q.x > 0.05) pixels.push_back(in_picture(base::pixel_of(camera.lens, {-q.y / q.x, -q.z / q.x})));
  }
  return pixels;
}

}  // namespace

void draw_lane_view(const Scenario& scenario, const LaneVariant& variant, gpu::Device& device,
                    const std::string& file) {
  const world::World world = lane_world(scenario, variant);
  const std::uint32_t probe = probe_of(world);
  farm::Farm farm(world, device, {});
  const base::ReadingBlock reading = farm.sense(
      probe, sensors::kCamera, 0, base::compose(pose_on(lane_course(world), kPlace), {0.0, kOffset, 0.0, 0.0}));
  const auto& camera = farm.sensor_set().settings_of<sensors::CameraSettings>(sensors::kCamera, probe)[0];
  const vision::GroundRaster raster;
  control::LaneView view(raster, {}, camera);
  const std::vector<glm::dvec2> points = view.look(reading.values);
  vision::LaneTracker tracker{vision::LaneLimits{}};
  for (int k = 0; k < 3; ++k) tracker.update(points);
  vision::Image image{static_cast<int>(camera.width), static_cast<int>(camera.height), 3, {}};
  for (std::size_t i = 0; i < reading.values.size(); i += camera.columns())
    for (int shift = 16; shift >= 0; shift -= 8)
      image.pixels.push_back(static_cast<std::uint8_t>(static_cast<std::uint32_t>(reading.values[i + 1]) >> shift));
  vision::Image left = enlarged(image, kScale * image.width, kScale * image.height),
                right = enlarged(view.ground(), kScale * raster.columns(), kScale * raster.rows());
  std::vector<vision::Mark> in_left, in_right;
  const auto on_ground = [&](glm::dvec2 p) {
    return in_picture({0.5 * raster.columns() - p.y / raster.cell - 0.5, (raster.far - p.x) / raster.cell - 0.5});
  };
  for (std::size_t i = 0; i < points.size(); i += kEvery) {
    const glm::dvec2 at = on_ground(points[i]), half{2.0, 0.0};
    in_right.push_back({{at - half, at + half}, "", kPaint, 3});
  }
  for (const double side : {-0.5, 0.0, 0.5}) {
    if (!tracker.has_lane()) break;
    const auto line = parallel(tracker.lane(), side * tracker.lane().width, raster.far);
    const auto color = side == 0.0 ? kMiddle : kEdge;
    in_left.push_back({in_image(camera, line), "", color, 2});
    std::vector<glm::dvec2> above;
    std::ranges::transform(line, std::back_inserter(above), on_ground);
    in_right.push_back({above, "", color, 1});
  }
  vision::opencv().draw(left, in_left), vision::opencv().draw(right, in_right);
  const vision::Image both = side_by_side(left, right);
  viz::write_png(file, both.pixels, both.width, both.height, viz::PngContent::photograph);
}

}  // namespace sf::scenarios
