#include "scenarios/lane_picture.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "base/camera_pixels.h"
#include "base/png.h"
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

vision::Image enlarged(const vision::Image& small) {
  vision::Image large{kScale * small.width, kScale * small.height, 3, {}};
  for (int v = 0; v < large.height; ++v)
    for (int u = 0; u < large.width; ++u)
      for (int c = 0; c < 3; ++c) large.pixels.push_back(small.at(u / kScale, v / kScale)[small.channels == 3 ? c : 0]);
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

/// The camera's image, with lines on the ground.
vision::Image drawn_image(const sensors::CameraSettings& camera, std::span<const double> values,
                          const std::vector<vision::Mark>& lines) {
  vision::Image picture = enlarged({static_cast<int>(camera.width), static_cast<int>(camera.height), 3,
                                    base::color_bytes(values, camera.columns())});
  std::vector<vision::Mark> marks;
  for (const vision::Mark& line : lines) {
    std::vector<glm::dvec2> pixels;
    for (const glm::dvec2& p : line.points) {
      const glm::dvec3 q = glm::transpose(camera.X_MS.R) * (glm::dvec3(p, 0.0) - camera.X_MS.p);
      if (q.x > 0.05) pixels.push_back(in_picture(base::pixel_of(camera.lens, {-q.y / q.x, -q.z / q.x})));
    }
    marks.push_back({pixels, "", line.color, 2});
  }
  vision::opencv().draw(picture, marks);
  return picture;
}

/// The ground, with points of paint and lines.
vision::Image drawn_ground(const vision::GroundRaster& raster, const vision::Image& ground,
                           const std::vector<glm::dvec2>& points, const std::vector<vision::Mark>& lines) {
  vision::Image picture = enlarged(ground);
  const auto pixel = [&](glm::dvec2 p) {
    return in_picture({0.5 * raster.columns() - p.y / raster.cell - 0.5, (raster.far - p.x) / raster.cell - 0.5});
  };
  std::vector<vision::Mark> marks;
  for (std::size_t i = 0; i < points.size(); i += kEvery) {
    const glm::dvec2 at = pixel(points[i]), half{2.0, 0.0};
    marks.push_back({{at - half, at + half}, "", kPaint, 3});
  }
  for (vision::Mark line : lines) {
    std::ranges::transform(line.points, line.points.begin(), pixel);
    marks.push_back(std::move(line));
  }
  vision::opencv().draw(picture, marks);
  return picture;
}

/// The lane's edges and middle [m] in the robot's frame; empty without a lane.
std::vector<vision::Mark> lane_lines(const vision::LaneTracker& tracker, double far) {
  std::vector<vision::Mark> lines;
  for (const double side : {-0.5, 0.0, 0.5})
    if (tracker.has_lane())
      lines.push_back({parallel(tracker.lane(), side * tracker.lane().width, far), "", side == 0.0 ? kMiddle : kEdge});
  return lines;
}

}  // namespace

void draw_lane_view(const Scenario& scenario, const LaneVariant& variant, gpu::Device& device,
                    const std::string& file) {
  const world::World world = lane_world(scenario, variant);
  const std::uint32_t probe = probe_of(world);
  farm::Farm farm(world, device, {});
  const base::Pose X_WM = base::compose(pose_on(lane_course(world), kPlace), base::Pose{0.0, kOffset, 0.0, 0.0});
  const base::ReadingBlock reading = farm.sense(probe, sensors::kCamera, 0, X_WM);
  const auto& camera = farm.sensor_set().settings_of<sensors::CameraSettings>(sensors::kCamera, probe)[0];
  const vision::GroundRaster raster;
  control::LaneView view(raster, {}, camera);
  const std::vector<glm::dvec2> points = view.look(reading.values);
  vision::LaneTracker tracker{vision::LaneLimits{}};
  for (int k = 0; k < 3; ++k) tracker.update(points);
  const std::vector<vision::Mark> lines = lane_lines(tracker, raster.far);
  const vision::Image both =
      side_by_side(drawn_image(camera, reading.values, lines), drawn_ground(raster, view.ground(), points, lines));
  viz::write_png(file, both.pixels, both.width, both.height, base::PngContent::photograph);
}

}  // namespace sf::scenarios
