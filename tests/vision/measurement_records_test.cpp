// From edges to tracks, compared with golden records of the numbers.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/golden.h"
#include "tests/vision/cameras.h"
#include "vision/accuracy.h"
#include "vision/rendering/renderer.h"
#include "vision/tag_detector.h"
#include "vision/tracker.h"

namespace sf::vision {

namespace {

std::string tracked_tags_text(const std::vector<TrackedTag>& tags) {
  std::string text;
  for (const TrackedTag& t : tags)
    text += fmt::format(
        "  tag {} at {:.4f}: {:.5f} {:.5f} {:.3f} {:.5f}, "
        "velocity {:.5f} {:.5f}, turn {:.5f}, {} cameras\n",
        t.id, t.time, t.X_WT.x, t.X_WT.y, t.X_WT.z, t.X_WT.yaw, t.velocity.x, t.velocity.y, t.turn, t.cameras);
  return text;
}

Sighting scripted_sighting(std::uint32_t id, double time, double x, double y, double yaw, double pixel) {
  Sighting s;
  s.id = id;
  s.time = time;
  s.fit.X_WT = {x, y, 0.1 * id, base::wrap_angle(yaw)};
  s.fit.pixel = pixel;
  return s;
}

/// Tag 1 drives on a circle in view of two cameras, tag 2 stops and jumps, tag 3 is seen intermittently.
std::vector<Sighting> seen_at(int i) {
  const double t = 0.07 * i, a = 1.5 * t;
  std::vector<Sighting> seen{scripted_sighting(1, t, std::sin(a), -std::cos(a), a + 2.5, 0.004)};
  if (i % 3 != 0) seen.push_back(scripted_sighting(3, t, 0.2 * t, 1.0, -1.0 - 0.3 * t, 0.003));
  seen.push_back(scripted_sighting(2, t, i < 9 ? 0.3 * t * t : 2.5, i < 9 ? 0.1 : 0.1 + 0.08 * i, 0.1 * i, 0.005));
  const double later = t + 0.004 * (i % 4), b = 1.5 * later;
  seen.push_back(scripted_sighting(1, later, std::sin(b) + 0.002, -std::cos(b), b + 2.501, 0.007));
  if (i == 5) seen.push_back(scripted_sighting(1, t, 0.9, 0.9, 0.0, 0.004));
  return seen;
}

/// One tag of 0.15 m at 2 m from a camera.
struct View {
  Camera camera = distorted_camera();
  Testbed testbed;
  Image image;

  View() {
    camera.intrinsics = {320, 240, {420.0, 410.0}, {161.0, 118.0}, {-0.18, 0.06, 0.0005, -0.0004, 0.0}};
    camera.position = {0.1, 0.0, 2.0};
    testbed.file = "t.toml";
    testbed.tag.height = 0.2;
    Scene scene;
    Patch tag;
    tag.shape = Patch::Shape::tag;
    tag.X_WP = {0.25, -0.1, 0.2, 0.7};
    tag.size = {0.15, 0.15};
    tag.pattern = family_pattern(testbed.dictionary, 17);
    scene.patches.push_back(tag);
    Renderer(camera, Imaging{}, 1).render(scene, 0.0, 0, image);
  }
};

std::string tag_fit_text(const TagFit& fit) {
  return fmt::format(
      "{:.4f} {:.4f} {:.4f} {:.4f}, side {:.4f}, residual "
      "{:.5f}, pixel {:.5f}, row {:.2f}\n",
      fit.X_WT.x, fit.X_WT.y, fit.X_WT.z, fit.X_WT.yaw, fit.side, fit.residual, fit.pixel, fit.row);
}

}  // namespace

TEST(TrackerRecord, MergesPredictsAndRejects) {
  Tracker tracker;
  std::string text;
  std::vector<TrackedTag> tracked;
  for (int i = 0; i < 24; ++i) {
    if (i > 14 && i < 18) continue;
    tracker.update(seen_at(i), tracked);
    if (i % 3 == 2) text += fmt::format("moment {}, {} refused\n", i, tracker.refused()) + tracked_tags_text(tracked);
  }
  golden::expect(text, "vision", "tracks", 3e-5);
}

TEST(DetectionRecord, FindsEdgesAndFitsASquare) {
  const View view;
  std::vector<TagOutline> outlines;
  ASSERT_TRUE(make_family_finder(view.testbed.dictionary)->find(view.image, whole(view.image), outlines));
  ASSERT_EQ(outlines.size(), 1u);
  for (glm::dvec2& corner : outlines[0].corners) corner = glm::dvec2{std::round(corner.x), std::round(corner.y)};
  std::vector<EdgePoint> edges;
  find_edges(view.image, outlines[0], 8, edges);
  std::string text = fmt::format("{} edges\n", edges.size());
  for (std::size_t i = 0; i < edges.size(); i += 5)
    text += fmt::format("side {} at {:.3f} {:.3f}\n", edges[i].side, edges[i].pixel.x, edges[i].pixel.y);
  text += tag_fit_text(fit_tag(view.camera, edges, 0.2).value());
  text += tag_fit_text(fit_tag(view.camera, edges, 0.5).value());
  for (std::size_t i = 0; i < edges.size(); i += 9) edges[i].pixel += glm::dvec2{3.0, -1.0};
  text += tag_fit_text(fit_tag(view.camera, edges, 0.2).value());
  std::erase_if(edges, [](const EdgePoint& e) { return e.side == 1; });
  text += tag_fit_text(fit_tag(view.camera, edges, 0.2).value());
  std::erase_if(edges, [](const EdgePoint& e) { return e.side == 2; });
  EXPECT_FALSE(fit_tag(view.camera, edges, 0.2)) << "two sides";
  golden::expect(text, "vision", "edges", 2e-3);
}

TEST(DetectionRecord, CountsAndTimesItsSightings) {
  View view;
  view.camera.exposure = 0.004;
  view.camera.readout = 0.02;
  TagDetector detector(view.testbed, view.camera);
  std::vector<Sighting> seen;
  detector.detect(view.image, 3.0, seen);
  ASSERT_EQ(seen.size(), 1u);
  std::string text = fmt::format("tag {} at {:.6f}: ", seen[0].id, seen[0].time) + tag_fit_text(seen[0].fit);
  golden::expect(text, "vision", "sighting", 1e-4);
}

TEST(AccuracyRecord, ComparesWithGroundTruth) {
  Testbed testbed;
  testbed.file = "t.toml";
  testbed.tag.height = 0.2;
  testbed.cameras.push_back({plain_camera(), ""});
  const RenderedFleet fleet(testbed, {4, 0.5, 1, false, 2});
  AccuracyMeter meter(testbed, fleet);
  for (int i = 0; i < 9; ++i) {
    std::vector<TrackedTag> tracked;
    for (std::size_t k = i % 4 == 0 ? 1 : 0; k < fleet.size(); ++k) {
      const TrueTag t = fleet.truth(k, 0.1 * i);
      tracked.push_back({t.id, 0.1 * i, t.X_WT, t.velocity, t.turn, 1});
      tracked.back().X_WT.x += k == 3 && i > 6 ? 0.06 : 0.003 * static_cast<double>(k);
      tracked.back().X_WT.yaw += 0.01 * i;
      tracked.back().velocity.y += 0.02;
      tracked.back().turn -= 0.1 * i;
    }
    if (i == 3) tracked.push_back({99, 0.3, {}, {}, 0.0, 1});
    meter.add(0.1 * i, tracked);
  }
  const Accuracy& a = meter.accuracy();
  std::string text = fmt::format("missed {}, wrong {}\n", a.missed, a.wrong);
  for (const RmsError* e : {&a.position, &a.heading, &a.velocity, &a.turn})
    text += fmt::format("{:.6f} largest {:.6f} of {}\n", e->rms(), e->largest, e->count);
  golden::expect(text, "vision", "accuracy", 1e-5);
}

}  // namespace sf::vision
