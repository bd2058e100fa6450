// Camera images and drawings over them, compared with golden records.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/golden.h"
#include "tests/vision/cameras.h"
#include "vision/overlay.h"
#include "vision/rendered_fleet.h"
#include "vision/rendering/renderer.h"

namespace sf::vision {

namespace {

/// A camera of 96 x 64 pixels, 2 m x 1.4 m of the floor from 2.5 m.
Camera record_camera() {
  Camera camera = distorted_camera();
  camera.intrinsics.width = 96;
  camera.intrinsics.height = 64;
  camera.intrinsics.focal = {118.0, 120.0};
  camera.intrinsics.center = {48.2, 30.9};
  camera.position = {0.1, -0.05, 2.5};
  return camera;
}

std::string marks_text(const std::vector<Mark>& marks) {
  std::string text;
  for (const Mark& mark : marks) {
    const glm::dvec2 first = mark.points.front(), last = mark.points.back();
    glm::dvec2 sum{};
    for (const glm::dvec2& p : mark.points) sum += p;
    sum /= static_cast<double>(mark.points.size());
    text += fmt::format(
        "{} points from {:.2f} {:.2f} to {:.2f} {:.2f}, mean "
        "{:.2f} {:.2f}, color {}, width {}, '{}'\n",
        mark.points.size(), first.x, first.y, last.x, last.y, sum.x, sum.y, fmt::join(mark.color, " "), mark.width,
        mark.text);
  }
  return text;
}

std::string scene_text(const Scene& scene) {
  std::string text = fmt::format("floor {} texture {} gradient {} {}\n", scene.floor, scene.texture, scene.gradient.x,
                                 scene.gradient.y);
  for (const Patch& p : scene.patches)
    text += fmt::format(
        "shape {} at {:.4f} {:.4f} {:.4f} yaw {:.4f} time {:.3f} velocity "
        "{:.4f} {:.4f} turn {:.4f} size {:.4f} {:.4f} "
        "albedo {:.3f} {:.3f} {:.3f} border {:.1f} cells {}\n",
        static_cast<int>(p.shape), p.X_WP.x, p.X_WP.y, p.X_WP.z, p.X_WP.yaw, p.time, p.velocity.x, p.velocity.y, p.turn,
        p.size.x, p.size.y, p.albedo, p.dark, p.light, p.border, p.pattern.cells);
  return text;
}

/// Mean grey values of blocks of `side` x `side` pixels.
std::string image_text(const Image& image, int side) {
  std::string text;
  for (int v = 0; v + side <= image.height; v += side) {
    for (int u = 0; u + side <= image.width; u += side) {
      double sum = 0.0;
      for (int k = 0; k < side * side * image.channels; ++k)
        sum += (k % image.channels + 1) *
               image.at(u + k / image.channels % side, v + k / image.channels / side)[k % image.channels];
      text += fmt::format("{}{:.1f}", u == 0 ? "" : " ", sum / (side * side));
    }
    text += '\n';
  }
  return text;
}

Sighting overlay_sighting(std::uint32_t id, const base::Pose& X_WT, double side) {
  Sighting s;
  s.id = id;
  s.fit.X_WT = X_WT;
  s.fit.side = side;
  s.fit.pixel = 0.004;
  return s;
}

/// Tags in the middle, at two corners of the picture and behind the camera.
std::vector<Sighting> sightings() {
  return {overlay_sighting(7, {0.3, -0.2, 0.2, 0.5}, 0.15), overlay_sighting(123, {2.3, -1.8, 0.2, -2.0}, 0.15),
          overlay_sighting(8, {-2.35, 1.85, 0.1, 3.0}, 0.2), overlay_sighting(9, {0.0, 0.0, 9.0, 0.0}, 0.15)};
}

world::World drawn_world() {
  world::World world;
  world.lane_markings.push_back({{{-1.0, 0.3}, {0.4, 0.3}, {9.0, 0.9}, {0.0, -1.4}}, 0.02});
  world.lane_markings.push_back({{{-9.0, -1.0}, {9.0, 1.2}}, 0.02});
  for (const glm::dvec2& end : {glm::dvec2{0.7, 0.9}, {0.7, -50.0}, {-0.4, 0.2}}) {
    world::Segment wall;
    wall.a = {-0.4, -0.6};
    wall.b = end;
    wall.z_min = 0.1;
    wall.z_max = 0.8;
    world.walls.push_back(wall);
  }
  return world;
}

Testbed two_cameras() {
  Testbed testbed;
  testbed.file = "t.toml";
  testbed.tag = {0.15, 0.2, {}, "", {}};
  testbed.tags[4] = {0.1, 0.25, {0.05, -0.1, 0.0, 0.7}, "", {}};
  testbed.cameras = {{record_camera(), ""}, {record_camera(), ""}};
  testbed.cameras[1].camera.name = "other";
  testbed.cameras[1].camera.position = {1.4, 0.3, 2.6};
  return testbed;
}

}  // namespace

TEST(OverlayRecord, MarksTagsAndTheWorld) {
  golden::expect(marks_text(tag_marks(distorted_camera(), sightings())), "vision", "tag_marks", 0.02);
  golden::expect(marks_text(world_marks(distorted_camera(), drawn_world())), "vision", "world_marks", 0.02);
}

TEST(OverlayRecord, IsDrawnInColours) {
  const Camera camera = record_camera();
  const Image grey{96, 64, 1, std::vector<std::uint8_t>(96 * 64, 100)};
  std::vector<Mark> marks = world_marks(camera, drawn_world());
  marks.push_back({{{10.0, 40.0}}, "8", {10, 200, 90}, 1});
  golden::expect(image_text(draw_over(grey, marks), 8), "vision", "drawn_over", 0.3);
}

TEST(FleetRecord, MovesOnItsCircles) {
  const Testbed testbed = two_cameras();
  const RenderedFleet fleet(testbed, {3, 0.5, 2, true, 5});
  std::string text = scene_text(fleet.scene_at(0.4));
  for (std::size_t tag = 0; tag < fleet.size(); ++tag)
    for (const double time : {0.0, 2.7}) {
      const TrueTag t = fleet.truth(tag, time);
      text += fmt::format("tag {} at {}: {:.4f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f}\n", t.id, time, t.X_WT.x,
                          t.X_WT.y, t.X_WT.z, t.X_WT.yaw, t.velocity.x, t.velocity.y, t.turn);
    }
  for (const TestbedCamera& each : testbed.cameras)
    for (std::size_t tag = 0; tag < fleet.size(); ++tag) {
      text += fmt::format("{} sees {}: ", each.camera.name, tag);
      for (int i = 0; i < 60; ++i) text += fleet.is_visible(each.camera, tag, 0.35 * i) ? 'x' : '.';
      text += '\n';
    }
  golden::expect(text, "vision", "fleet", 2e-4);
}

TEST(RendererRecord, ShowsMovingPatchesInTheirLight) {
  Scene scene;
  scene.gradient = {0.1, -0.2};
  scene.patches = {{Patch::Shape::rectangle, {-0.5, 0.2, 0.0, 0.4}, 0.0, {1.5, 0.5}, 2.0, {0.5, 0.3}, 0.8},
                   {Patch::Shape::disc, {0.4, 0.1, 0.3, 0.0}, 0.01, {0.0, -2.0}, 0.0, {0.4, 0.6}, 0.1},
                   {Patch::Shape::rectangle, {0.6, -0.4, 0.1, 1.0}, 0.0, {}, -9.0, {0.9, 0.05}, 0.9}};
  Patch tag{Patch::Shape::tag, {-0.2, -0.35, 0.2, 0.3}, 0.0, {0.4, 0.0}, 0.0, {0.3, 0.3}};
  tag.pattern = opencv().tag_pattern("aruco_4x4_50", 5);
  scene.patches.push_back(tag);
  Image image;
  Renderer renderer(record_camera(), Imaging{}, 3);
  renderer.render(scene, 0.02, 4, image);
  golden::expect(image_text(image, 4), "vision", "rendered", 0.3);
}

}  // namespace sf::vision
