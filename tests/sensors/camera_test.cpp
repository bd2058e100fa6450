// Cameras: depth, labels and normals of each pixel, against known planes and against every face in `long double`.

#include "sensors/camera.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <random>
#include <set>

#include "base/srgb.h"
#include "raycast/casters.h"
#include "robots/kinematics.h"
#include "scene/rasterizer.h"
#include "scene/reference_scan.h"
#include "scene/solids.h"
#include "sensors/image_packets.h"
#include "tests/base/decoded_png.h"
#include "tests/refusal.h"
#include "tests/sensors/series.h"

namespace sf::trial {
namespace {

/// A robot with a camera 0.75 m above the floor, a board 4 m ahead and a wall 9 m ahead.
world::World boards(const std::string& camera) {
  return world_of(
      "define robot position( size [0.4 0.4 0.5] origin [0 0 0 0] )\n"
      "model( name \"board\" pose [4.05 0 0 0] size [0.1 1 3] color \"white\" )\n"
      "model( name \"wall\" pose [9.1 0 0 0] size [0.2 40 8] )\n"
      "robot( name \"r1\" pose [0 0 0 0] camera( pose [0 0 0.25 0] size [0 0 0] " +
      camera + " ) )\n");
}

struct Image {
  std::vector<double> values;
  std::vector<std::uint32_t> hits;
  std::vector<base::QualityFlag> quality;
  double bound;
  std::size_t width;
};

Image shoot(const world::World& world, const base::Pose& X_WM = {}, const base::Tilt& tilt = {},
            const char* caster = "auto") {
  farm::FarmOptions options{.noise = false, .threads = 2};
  options.scene.caster = raycast::caster_named(caster);
  farm::Farm farm(world, host_device(), options);
  const base::ReadingBlock r = farm.sense(0, sensors::kCamera, 0, X_WM, tilt);
  Image image{{r.values.begin(), r.values.end()},
              {r.hits.begin(), r.hits.end()},
              {r.quality.begin(), r.quality.end()},
              r.bound,
              r.values.size() / r.hits.size()};
  image.quality.resize(image.hits.size());
  return image;
}

/// Depth is measured along the optical axis: all pixels that see the board read 4 m, all that see the wall 9 m.
TEST(Camera, DepthOfFacingPlanes) {
  const world::World world = boards("resolution [64 48] fov 60 range [0 50]");
  const Image image = shoot(world);
  ASSERT_EQ(image.values.size(), 64u * 48u);
  const std::uint32_t board = 0, wall = 1;
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    const double depth = image.hits[i] == board ? 4.0 : image.hits[i] == wall ? 9.0 : image.values[i];
    EXPECT_NEAR(image.values[i], depth, image.bound);
  }
  EXPECT_GT(std::ranges::count(image.hits, board), 300);
  EXPECT_GT(std::ranges::count(image.hits, wall), 500);
  EXPECT_EQ(image.hits[47 * 64 + 32], base::kFloorHit) << "rows begin at the top";
}

/// The focal length is half of the width over tan(fov / 2), and whole numbers are centres of pixels: the board's edges,
/// 0.5 m from the axis at 4 m, are at (w - 1) / 2 -+ f / 8.
TEST(Camera, PixelsOfAKnownEdge) {
  const Image image = shoot(boards("resolution [101 1] fov 60 range [0 50]"));
  const double f = 0.5 * 101 / std::tan(30 * M_PI / 180), first = 50 - f / 8, last = 50 + f / 8;
  for (int u = 0; u < 101; ++u) EXPECT_EQ(image.hits[static_cast<std::size_t>(u)] == 0, u >= first && u <= last) << u;
}

/// Every pixel of a tilted camera against the reference, with its normals.
TEST(Camera, AgreesWithEveryFace) {
  const world::World world = boards("resolution [60 40] fov 90 range [0 20] normals 1 pose6 [0.1 0 0.2 5 -10 30]");
  const base::Pose X{0.3, -0.2, 0.0, 0.5};
  const base::Tilt tilt{0.1, 0.15};
  const Image fast = shoot(world, X, tilt), slow = shoot(world, X, tilt, "reference");
  std::size_t compared = 0;
  for (std::size_t i = 0; i < fast.hits.size(); ++i) {
    if (fast.quality[i] != base::QualityFlag::none) continue;
    EXPECT_EQ(fast.hits[i], slow.hits[i]);
    EXPECT_NEAR(fast.values[5 * i], slow.values[5 * i], fast.bound);
    for (std::size_t axis = 2; axis < 5; ++axis)
      EXPECT_NEAR(fast.values[5 * i + axis], slow.values[5 * i + axis], 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 2'300u);
}

/// Ten scenes of random boxes and robots, of all lenses: every pixel's depth, label and colour against every face.
TEST(Camera, RandomScenesAgreeWithEveryFace) {
  const char* const kLenses[] = {"fov 100", "focal 30 distortion [-0.1 0.02 0.001 0.001]",
                                 "focal 25 fisheye [0.02 0 0 0]"};
  std::size_t compared = 0, labels = 0, colours = 0;
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    std::mt19937_64 random(seed);
    const auto draw = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
    std::string text = fmt::format(
        "position( size [0.5 0.4 0.6] camera( resolution [40 30] {} range [0 30] rgb 1 pose6 [0 0 0.3 {} {} {}] ) )\n",
        kLenses[seed % 3], draw(-20, 20), draw(-20, 30), draw(-180, 180));
    for (int k = 0; k < 15; ++k)
      text += fmt::format("{}( pose [{} {} {} {}] size [{} {} {}] color \"{}\" )\n", k < 4 ? "position" : "model",
                          draw(-6, 6), draw(-6, 6), k < 4 ? 0.0 : draw(0, 1), draw(-180, 180), draw(0.2, 2),
                          draw(0.2, 2), draw(0.2, 3), k % 2 ? "red" : "white");
    const world::World world = world_of(text);
    const base::Pose X{draw(-1, 1), draw(-1, 1), 0.0, draw(-3, 3)};
    const Image fast = shoot(world, X), slow = shoot(world, X, {}, "reference");
    for (std::size_t i = 0; i < fast.hits.size(); ++i) {
      if (fast.quality[i] != base::QualityFlag::none) continue;
      ++compared, colours += fast.values[2 * i + 1] == slow.values[2 * i + 1];
      EXPECT_EQ(fast.hits[i], slow.hits[i]) << seed << " " << i;
      EXPECT_NEAR(fast.values[2 * i], slow.values[2 * i], fast.bound) << seed << " " << i;
      labels += fast.hits[i] < world.models.size();
    }
  }
  EXPECT_GT(compared, 11'900u);
  EXPECT_GT(labels, 3'000u);
  EXPECT_GE(colours, compared - 10) << "pixels on borders of shadows";
}

/// A wall that is faced has the normal (-1, 0, 0), toward the camera; the floor points up; nothing has 0.
TEST(Camera, NormalsPointToTheCamera) {
  const Image image = shoot(boards("resolution [16 16] fov 100 range [0 8] normals 1"));
  ASSERT_EQ(image.width, 5u);
  for (std::size_t i = 0; i < image.hits.size(); ++i) {
    const glm::dvec3 normal{image.values[5 * i + 2], image.values[5 * i + 3], image.values[5 * i + 4]};
    const glm::dvec3 expected = image.hits[i] == base::kFloorHit ? glm::dvec3{0, 0, 1}
                                : image.hits[i] == base::kNoHit  ? glm::dvec3{}
                                                                 : glm::dvec3{-1, 0, 0};
    EXPECT_NEAR(glm::distance(normal, expected), 0.0, 1e-6);
    EXPECT_EQ(image.values[5 * i] == 8.0, image.hits[i] == base::kNoHit);
  }
}

/// Limits are depths: a corner of an image sees as far as its middle, and too near surfaces read the least depth.
TEST(Camera, LimitsAreDepths) {
  const Image far = shoot(boards("resolution [40 40] fov 120 range [0 9.0001]"));
  EXPECT_GT(std::ranges::count(far.hits, 1u), 300) << "the wall's depth is 9 m up to the corners";
  const Image near = shoot(boards("resolution [40 40] fov 60 range [5 50]"));
  for (std::size_t i = 0; i < near.hits.size(); ++i) {
    EXPECT_GE(near.values[i], 5.0);
    EXPECT_EQ(near.values[i] == 5.0, near.quality[i] == base::QualityFlag::too_near);
  }
}

/// Stage's keys: two fields of view, of which the second follows, and `pantilt`, a positive tilt looking down.
TEST(Camera, ReadsStagesKeys) {
  const world::World world = world_of(
      "position( size [0.4 0.4 0.5] origin [0 0 0 0] camera( pose [0 0 0.25 0] size [0 0 0] resolution [3 3] fov [70 "
      "40] "
      "range [0.2 8] pantilt [0 90] ) )");
  const Image image = shoot(world);
  EXPECT_NEAR(image.values[4], 0.75, 1e-9) << "straight down";
  EXPECT_EQ(image.hits[4], base::kFloorHit);
}

/// The pixels of a distorted image of a board's edge are those that the lens projects it to; normal images begin the
/// same.
TEST(Camera, LensesBendImages) {
  const struct {
    const char* keys;
    base::Lens lens;
  } kCases[] = {{"focal [60 58] principal [48.5 20] distortion [-0.2 0.05 0.01 -0.01]",
                 {{60, 58}, {48.5, 20}, {-0.2, 0.05, 0.01, -0.01}}},
                {"focal 60 fisheye [-0.05 0.01 0 0]", {{60, 60}, {49.5, 29.5}, {-0.05, 0.01}, true}}};
  for (const auto& [keys, lens] : kCases) {
    const Image image = shoot(boards(std::string("resolution [100 60] range [0 50] ") + keys));
    const base::LensImage inverse(lens, 100, 60);
    for (std::size_t i = 0; i < image.hits.size(); ++i) {
      const glm::dvec2 n = inverse.direction({i % 100, i / 100}).value();  // the board: 0.5 m aside, 3 m high, 4 m away
      const double up = 0.75 - 4.0 * n.y;
      if (std::abs(std::abs(n.x) - 0.125) < 1e-6 || std::abs(up) < 1e-6 || std::abs(up - 3.0) < 1e-6) continue;
      EXPECT_EQ(image.hits[i] == 0, std::abs(n.x) < 0.125 && up > 0.0 && up < 3.0) << keys << " " << i;
    }
  }
}

/// `fov` of a fisheye is the angle that its width images, and what lies outside of its circle sees nothing.
TEST(Camera, FisheyesEndAtTheirRim) {
  const Image image = shoot(boards("resolution [100 100] fov 160 fisheye [0 0 0 0] range [0 50] normals 1"));
  EXPECT_EQ(image.hits[0], base::kNoHit);
  EXPECT_EQ(image.values[0], 50.0);
  EXPECT_NE(image.hits[99 * 100 + 50], base::kNoHit) << "79 degrees below the axis";
}

glm::ivec3 rgb_of(const Image& image, std::size_t i) {
  const auto rgb = static_cast<int>(image.values[i * image.width + 1]);
  return {rgb >> 16, rgb >> 8 & 255, rgb & 255};
}

/// Linear light of an 8-bit value of sRGB, by the standard's formula.
double linear(double srgb) {
  const double s = srgb / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

/// Every pixel against another renderer, of rays in `long double`: paint, two robots, shadows, the sky.
TEST(Camera, ColoursAgreeWithRays) {
  const world::World world = world_of(
      "sun [70 35]  sunlight 0.7  skylight 0.25  floor_color \"gray40\"\n"
      "define robot position( size [0.5 0.4 0.6] color \"blue\" )\n"
      "model( name \"box\" pose [4 1 0 30] size [1 2 1.5] color \"green\" )\n"
      "path( pose [-2 -2.5 0 20] pieces 2 straight[0] [8 2] arc[1] [4 60 2] left \"broken_white\" right "
      "\"double_yellow\" "
      "paint_width 0.2 dash [0.8 0.6] )\n"
      "robot( name \"r1\" camera( resolution [90 60] fov 90 range [0 30] rgb 1 pose6 [0 0 1 2 15 -5] ) )\n"
      "robot( name \"r2\" pose [2.5 -0.8 0 0] )\n");
  ASSERT_EQ(world.lane_markings.size() > 4, true);
  const Image image = shoot(world);
  const scene::SurfaceTree walls = scene::build_tree(scene::mesh_of(world.walls)),
                           own = scene::build_tree(scene::mesh_of(world.movers[0].body)),
                           other = scene::build_tree(scene::mesh_of(world.movers[1].body));
  const scene::Instance all[] = {{&walls, {}, true},
                                 {&other, base::transform_of(world.movers[1].X_WM)},
                                 {&own, base::transform_of(world.movers[0].X_WM)}};
  const glm::dvec3 sun{std::cos(35 * M_PI / 180) * std::cos(70 * M_PI / 180),
                       std::cos(35 * M_PI / 180) * std::sin(70 * M_PI / 180), std::sin(35 * M_PI / 180)};
  const base::RigidTransform X_WS =
      sensors::SensorSet(world).settings_of<sensors::CameraSettings>(sensors::kCamera)[0].X_MS;  // the robot is at 0
  const double f = 45 / std::tan(45 * M_PI / 180);
  std::map<std::string, int> seen;
  int wrong = 0;
  for (std::size_t i = 0; i < image.hits.size(); ++i) {
    const glm::dvec3 d =
        glm::normalize(glm::dvec3{f, 44.5 - static_cast<double>(i % 90), 29.5 - static_cast<double>(i / 90)});
    const auto hit = scene::reference_scan(X_WS, d, 30.0 / d.x, {std::span(all).first(2), true});
    ASSERT_EQ(image.hits[i], hit.owner) << i;
    glm::dvec3 light;
    if (hit.owner == base::kNoHit) {
      light =
          glm::mix(glm::dvec3{0.75, 0.85, 0.95}, glm::dvec3{0.2, 0.4, 0.8}, std::sqrt(std::max(0.0, (X_WS.R * d).z))) *
          0.25 / 0.3;
      ++seen["sky"];
    } else {
      const glm::dvec3 p = X_WS.p + X_WS.R * (static_cast<double>(hit.range) * d), n = X_WS.R * glm::dvec3(hit.normal);
      std::uint32_t color = hit.owner == base::kFloorHit ? 0x666666 : world.models[hit.owner].color;
      for (const world::LaneMarking& m : world.lane_markings)
        for (std::size_t k = 0; hit.owner == base::kFloorHit && k + 1 < m.line.size(); ++k) {
          const glm::dvec2 a = m.line[k], e = glm::normalize(m.line[k + 1] - a), q = glm::dvec2(p) - a;
          if (glm::dot(q, e) >= 0 && glm::dot(q, e) <= glm::distance(a, m.line[k + 1]) &&
              std::abs(q.x * e.y - q.y * e.x) <= 0.5 * m.width)
            color = m.color, ++seen["paint"];
        }
      const double up = n.z, facing = std::max(0.0, glm::dot(n, sun));
      const bool dark =
          facing > 0 && scene::reference_scan({glm::dmat3(1.0), p + 3e-4 * n}, sun, 1e3, {all}).owner != base::kNoHit;
      seen["shadow"] += dark;
      const double ground = 0.25 * (0.25 + 0.7 * sun.z);
      const double shade = (dark ? 0.0 : 0.7 * facing) + 0.25 * (0.5 + 0.5 * up) + ground * (0.5 - 0.5 * up);
      light = shade * glm::dvec3{linear(color >> 16 & 255), linear(color >> 8 & 255), linear(color & 255)};
    }
    const glm::ivec3 rgb = rgb_of(image, i);
    for (int k = 0; k < 3; ++k) {
      const double low = linear(std::max(0.0, rgb[k] - 0.51)), high = rgb[k] == 255 ? 1e9 : linear(rgb[k] + 0.51);
      if (light[k] < low || light[k] > high) {
        ++wrong;
        break;
      }
    }
  }
  EXPECT_LE(wrong, 6) << "pixels on borders of paint and of shadows";
  EXPECT_GT(seen["paint"], 40);
  EXPECT_GT(seen["sky"], 100);
  EXPECT_GT(seen["shadow"], 60);
}

/// Mean and variance of the linear light of a white floor: gain, vignetting, noise in the dark and of photons.
TEST(Camera, NoiseAndVignetting) {
  const auto light_of = [](const std::string& keys, bool noise, std::uint32_t reading) {
    const world::World world = world_of(
        "sunlight 0 skylight 0.4 floor_color \"white\"\n"
        "position( size [0.4 0.4 0.5] camera( resolution [101 101] fov 30 pose6 [0 0 0.3 0 90 0] " +
        keys + " ) )");
    farm::Farm farm(world, host_device(), {.noise = noise, .threads = 1});
    farm.subscribe(0, base::only(sensors::kCamera));
    base::Report state{0, 0, world.movers[0].X_WM, {}};
    std::vector<double> light;
    for (std::uint32_t k = 0; k <= reading; ++k, state.time += 100'000'000)
      for (const base::ReadingBlock& r : farm.tick(state.time, std::span(&state, 1))) {
        light.clear();
        for (std::size_t i = 1; i < r.values.size(); i += 2)
          light.push_back(linear(static_cast<int>(r.values[i]) >> 16 & 255));
      }
    return light;
  };
  const auto even = light_of("rgb 1", true, 0);
  EXPECT_NEAR(even[0], 0.4, 0.004);
  EXPECT_EQ(std::ranges::count(even, even[0]), 101 * 101);
  const auto dim = light_of("rgb 1 gain 0.5 vignetting 0.3", true, 0);
  EXPECT_NEAR(dim[50 * 101 + 50], 0.2, 0.003);
  EXPECT_NEAR(dim[0], 0.2 * 0.7, 0.003);
  EXPECT_NEAR(dim[50 * 101], 0.2 * 0.85, 0.003) << "half of the square of the radius";
  const auto noisy = light_of("rgb 1 noise [0.02 0.001]", true, 1);
  double sum = 0.0, squares = 0.0;
  for (const double x : noisy) sum += x, squares += x * x;
  const double n = 101 * 101, mean = sum / n, variance = squares / n - mean * mean;
  EXPECT_NEAR(mean, 0.4, 5 * 0.03 / 101);
  EXPECT_NEAR(variance, 0.0004 + 0.0004, 0.0008 * 5 * std::sqrt(2 / n)) << "0.02^2 + 0.001 x 0.4; steps add 1 %";
  EXPECT_EQ(light_of("mono 1 noise [0.02 0.001]", true, 1), noisy) << "of the luminance as of a channel";
  EXPECT_NE(noisy, light_of("rgb 1 noise [0.02 0.001]", true, 0)) << "of each reading";
  EXPECT_EQ(noisy, light_of("rgb 1 noise [0.02 0.001]", true, 1));
  EXPECT_EQ(light_of("rgb 1 noise [0.02 0.001]", false, 0), even);
}

/// Errors of depths over depth_noise times their squares are Gaussian, from pixel to pixel and from reading to reading.
TEST(Camera, DepthNoiseGrowsWithTheSquare) {
  const world::World world = boards("resolution [100 60] fov 70 range [0 9.5] depth_noise 0.005");
  const Image exact = shoot(world);
  farm::Farm farm(world, host_device(), {.seed = 3, .threads = 1});
  farm.subscribe(0, base::only(sensors::kCamera));
  std::vector<std::vector<double>> readings;
  base::Report state{0, 0, world.movers[0].X_WM, {}};
  for (int k = 0; k < 2; ++k, state.time += 100'000'000)
    for (const base::ReadingBlock& r : farm.tick(state.time, std::span(&state, 1))) {
      readings.emplace_back(r.values.begin(), r.values.end());
      EXPECT_DOUBLE_EQ(r.sigma, 0.005 * 9.5 * 9.5) << "the largest";
      EXPECT_EQ(r.bound, HUGE_VAL);
      EXPECT_EQ(r.bound_without_noise, exact.bound);
      for (std::size_t i = 0; i < r.hits.size(); ++i) EXPECT_EQ(r.hits[i] == base::kNoHit, r.values[i] == 9.5) << i;
    }
  ASSERT_EQ(readings.size(), 2u);
  EXPECT_NE(readings[0], readings[1]);
  const auto stated = [](const world::World& of) {
    const sensors::SensorSet set(of);
    const auto& group = *set.group(sensors::kCamera);
    return sensors::own_noise(group, group.rows[0], 0);
  };
  EXPECT_EQ(stated(world), HUGE_VAL) << "a fault that multiplies it is refused";
  EXPECT_EQ(stated(boards("resolution [4 4]")), 0.0);
  double sum = 0.0, squares = 0.0, both = 0.0, n = 0.0, far = 0.0, lost = 0.0, outside = 0.0;
  for (std::size_t i = 0; i < exact.hits.size(); ++i) {
    const double z = exact.values[i], scale = 1.0 / (0.005 * z * z);
    far += exact.hits[i] == 1, lost += exact.hits[i] == 1 && readings[0][i] == 9.5;
    if (z > 7.5) continue;  // more than five standard deviations below the largest depth
    const double a = scale * (readings[0][i] - z), b = scale * (readings[1][i] - z);
    ++n, sum += a, squares += a * a, both += a * b, outside += std::abs(a) > 2.0;
  }
  ASSERT_GT(n, 1000.0);
  EXPECT_NEAR(sum / n, 0.0, 5.0 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1.0, 5.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(outside / n, 0.0455, 5.0 * std::sqrt(0.0455 / n));
  EXPECT_NEAR(both / n, 0.0, 5.0 / std::sqrt(n)) << "of each reading";
  EXPECT_NEAR(lost / far, 0.1085, 5.0 * std::sqrt(0.1 / far)) << "0.5 m beyond 9 m are 1.235 standard deviations";
}

std::vector<double> greys_of(const Image& image) {
  std::vector<double> greys;
  for (std::size_t i = 1; i < image.values.size(); i += 2) greys.push_back(static_cast<int>(image.values[i]) & 255);
  return greys;
}

/// Bytes of `linear 1` are in proportion to the light, of one sample and of several.
TEST(Camera, LinearBytes) {
  const std::string keys = "resolution [40 30] fov 80 range [0 50] mono 1 ";
  for (const char* const more : {"", "samples 4"}) {
    const auto srgb = greys_of(shoot(boards(keys + more))),
               linear_greys = greys_of(shoot(boards(keys + more + " linear 1")));
    for (std::size_t i = 0; i < srgb.size(); ++i)
      ASSERT_NEAR(linear_greys[i], 255.0 * linear(static_cast<int>(srgb[i])), 1.6) << "a step of sRGB is up to 2.2";
    EXPECT_NE(srgb, linear_greys);
  }
}

/// A blurred image is the sharp one under a Gaussian, continued beyond its borders, and only there differs from it.
TEST(Camera, BlurIsGaussian) {
  constexpr int kWidth = 40, kHeight = 30;
  const auto shot = [](const std::string& keys) {
    return greys_of(shoot(boards("resolution [40 30] fov 80 range [0 50] mono 1 linear 1 samples 4 " + keys)));
  };
  const auto sharp = shot("");
  EXPECT_EQ(shot("blur 0"), sharp);
  for (const double sigma : {0.6, 2.0}) {
    const auto blurred = shot(fmt::format("blur {}", sigma));
    double most = 0.0;
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) {
        double sum = 0.0, weights = 0.0;
        for (int y = -12; y <= 12; ++y)
          for (int x = -12; x <= 12; ++x) {
            const double weight = std::exp(-0.5 * (x * x + y * y) / (sigma * sigma));
            const int row = std::clamp(v + y, 0, kHeight - 1), column = std::clamp(u + x, 0, kWidth - 1);
            sum += weight * sharp[static_cast<std::size_t>(row * kWidth + column)], weights += weight;
          }
        const auto i = static_cast<std::size_t>(v * kWidth + u);
        ASSERT_NEAR(blurred[i], sum / weights, 1.0) << "rounded twice, at " << u << ' ' << v;
        most = std::max(most, std::abs(blurred[i] - sharp[i]));
      }
    EXPECT_GT(most, 20.0);
  }
}

/// Luminance of linear light, of one sample and of several; noise has one number per pixel.
TEST(Camera, GreyIsTheLuminance) {
  const std::string keys = "resolution [40 30] fov 80 range [0 50] ";
  for (const char* const more : {"", " samples 4 gain 1.2"}) {
    const Image color = shoot(boards(keys + "rgb 1" + more)), grey = shoot(boards(keys + "mono 1" + more));
    std::set<double> shades;
    for (std::size_t i = 0; i < color.values.size(); i += 2) {
      ASSERT_EQ(grey.values[i], color.values[i]) << "depths";
      const auto rgb = static_cast<std::uint32_t>(color.values[i + 1]),
                 y = static_cast<std::uint32_t>(grey.values[i + 1]);
      const float light = glm::dot(glm::vec3(0.2126f, 0.7152f, 0.0722f), base::linear_color(rgb));
      ASSERT_NEAR(y & 255, base::srgb_color(glm::vec3(light)) & 255, 1) << "rounded twice";
      ASSERT_EQ(y, (y & 255) * 0x010101);
      shades.insert(y);
    }
    EXPECT_GT(shades.size(), 3u) << "sky, floor, board and wall";
  }
}

/// Each row of a rolling image is cast from the pose at its time, and the samples of an exposure from those before it.
TEST(Camera, RowsAndSamplesHaveTheirTimes) {
  const auto driven = [](const std::string& keys, const base::Twist& twist) {
    world::World world = boards("resolution [40 30] fov 80 range [0 50] rate 10 rgb 1 " + keys);
    world.interval = 0.01;
    farm::Farm farm(world, host_device(), {.noise = false, .threads = 2});
    farm.subscribe(0, base::only(sensors::kCamera));
    base::Report state{0, 0, {}, twist};
    std::vector<double> last;
    for (int tick = 0; tick <= 20; ++tick, state.time += 10'000'000) {
      for (const base::ReadingBlock& r : farm.tick(state.time, std::span(&state, 1)))
        last.assign(r.values.begin(), r.values.end());
      if (tick < 20) state.X_WM = robots::advance(state.X_WM, twist, 0.01);
    }
    return std::pair{last, state.X_WM};
  };
  const base::Twist twist{1.0, 0.0, 1.5};
  const auto [rolled, X_WM] = driven("rolling 1", twist);
  const world::World still = boards("resolution [40 30] fov 80 range [0 50] rgb 1");
  for (std::size_t v = 0; v < 30; v += 7) {
    const Image then = shoot(still, robots::advance(X_WM, twist, -0.1 * static_cast<double>(29 - v) / 30));
    std::size_t same = 0;
    for (std::size_t i = 40 * v; i < 40 * (v + 1); ++i) same += std::abs(then.values[2 * i] - rolled[2 * i]) < 1e-6;
    EXPECT_GE(same, 39u) << v;
  }
  EXPECT_EQ(driven("rolling 1", {}).first, driven("", {}).first) << "at rest";
  // A pixel's light is the mean of those of the sub-beams' poses: an edge that moves is a ramp.
  const auto [blurred, at_end] = driven("exposure 0.1 samples 16", twist);
  const auto sharp = driven("samples 16", twist).first;
  EXPECT_EQ(at_end.x, X_WM.x);
  std::size_t between = 0, crisp = 0;
  for (std::size_t i = 40 * 10; i < 40 * 11; ++i) {
    const auto partly = [](double rgb) {
      const int green = static_cast<int>(rgb) >> 8 & 255;
      return green > 20 && green < 200;  // between the white board and the red wall
    };
    between += partly(blurred[2 * i + 1]), crisp += partly(sharp[2 * i + 1]);
    EXPECT_EQ(blurred[2 * i], sharp[2 * i]) << "depths are those of the end";
  }
  EXPECT_GT(between, crisp + 2);
}

/// Keys of the world change its hash and are recorded; without them, worlds keep theirs.
TEST(Camera, Daylight) {
  const world::World plain = world_of("model( )"),
                     sunny = world_of("sun [-30 20] sunlight 2 floor_color \"red\" model( )");
  EXPECT_TRUE(plain.daylight.empty());
  EXPECT_NE(plain.hash, sunny.hash);
  const world::Daylight day = world::daylight_of(world::from_snapshot(world::snapshot(sunny)));
  EXPECT_NEAR(day.azimuth, -M_PI / 6, 1e-15);
  EXPECT_NEAR(day.elevation, M_PI / 9, 1e-15);
  EXPECT_EQ(day.sun, 2.0);
  EXPECT_EQ(day.sky, world::Daylight{}.sky);
  EXPECT_EQ(day.floor, 0xFFFF0000u);
  expect_in("trial.world:1", refusal_of([] { world_of("sun [0 91]"); }));
  expect_in("'sun' has only 1 number; expected [azimuth elevation]", refusal_of([] { world_of("sun [0]"); }));
  expect_in("skylight", refusal_of([] { world_of("skylight -1"); }));
}

TEST(Camera, Packets) {
  const world::World world = boards("resolution [40 30] fov 60 range [0 50] normals 1");
  const Image image = shoot(world);
  const sensors::SensorSpec spec = sensors::SensorSet(world).of(sensors::kCamera, 0)[0];
  const sensors::SensorType& type = sensors::camera_type;
  const base::ReadingBlock block{.type = sensors::kCamera, .values = image.values};
  std::vector<double> received(image.values.size(), -1.0);
  ASSERT_EQ(type.parts(spec, sensors::WireFormat::farm), 4u);
  for (std::uint32_t part = 0; part < 4; ++part) {
    base::Bytes bytes;
    const std::uint8_t id = type.encode(spec, block, sensors::WireFormat::farm, part, bytes);
    EXPECT_EQ(id, sensors::kCamera + sensors::kExtended);
    ASSERT_EQ(type.decode(spec, bytes, id, sensors::WireFormat::farm).fault, sensors::PayloadError::none);
    type.read(spec, bytes, id, sensors::WireFormat::farm, received);
    EXPECT_NE(type.decode(spec, bytes, sensors::kCamera, sensors::WireFormat::farm).fault, sensors::PayloadError::none);
  }
  for (std::size_t i = 0; i < received.size(); i += 5) {
    EXPECT_NEAR(received[i], image.values[i], type.wire_error(spec, block));
    EXPECT_EQ(received[i + 1], -1.0) << "normals are not sent";
  }
}

/// Boundaries: one byte, a full part, one byte more, the largest file.
TEST(Camera, ImageFilesInParts) {
  const sensors::SensorSpec any{.elements = 0};
  for (const auto& [size, parts] : {std::pair{1u, 1u}, {1240u, 1u}, {1241u, 2u}, {4'000'000u, 3226u}}) {
    const std::uint16_t form = size % 2 == 0 ? sensors::kPngForm : sensors::kJpegForm;
    sensors::ImageFile file{std::string(size, '\0'), form};
    std::string received;
    for (std::size_t i = 0; i < size; ++i) file.bytes[i] = static_cast<char>(i * 7 >> 3);
    ASSERT_EQ(sensors::image_parts(size), parts);
    for (std::uint32_t part = 0; part < parts; ++part) {
      base::Bytes bytes;
      const std::uint8_t id = sensors::encode_image(file, part, bytes);
      ASSERT_EQ(sensors::camera_form(id, bytes), form);
      sensors::ImagePart image;
      ASSERT_EQ(sensors::read_image(bytes, image), sensors::PayloadError::none);
      ASSERT_EQ(image.form, form);
      ASSERT_EQ(image.first, received.size());
      received.append(image.bytes.begin(), image.bytes.end());
      const sensors::PayloadPart judged = sensors::camera_type.decode(any, bytes, id, sensors::WireFormat::farm);
      ASSERT_EQ(judged.fault, sensors::PayloadError::none);
      ASSERT_EQ(judged.parts, 0u) << "none of the reading's";
    }
    EXPECT_EQ(received, file.bytes);
  }
}

TEST(Camera, ColoursAsFile) {
  for (const char* const colours : {"", "rgb 1", "rgb 1 normals 1", "mono 1", "rgb 1 jpeg 90", "mono 1 jpeg 1"}) {
    const world::World world = boards("resolution [40 30] range [0 50] " + std::string(colours));
    const Image image = shoot(world);
    const base::ReadingBlock block{.type = sensors::kCamera, .values = image.values};
    const sensors::SensorSet set(world);
    const sensors::ImageFile file = sensors::image_file(set, block);
    EXPECT_EQ(file.bytes.empty(), *colours == '\0');
    if (file.bytes.empty()) continue;
    const sensors::CameraSettings& camera = set.settings_of<sensors::CameraSettings>(sensors::kCamera)[0];
    EXPECT_EQ(file.bytes, base::color_file(image.values, camera.columns(), camera.format())) << colours;
    EXPECT_EQ(file.form, camera.jpeg > 0 ? sensors::kJpegForm : sensors::kPngForm);
    EXPECT_EQ(file.bytes.substr(1, 2), camera.jpeg > 0 ? "\xD8\xFF" : "PN");
  }
}

TEST(Camera, ImpossibleSettingsAreRefused) {
  const auto refused = [](const std::string& camera) {
    return refusal_of([&] { const sensors::SensorSet set(world_of("position( \ncamera( " + camera + " ) )")); });
  };
  expect_in("trial.world:2: 0 x 5 pixels; expected whole numbers from 1 to 4096", refused("resolution [0 5]"));
  expect_in("1.5 x 5 pixels", refused("resolution [1.5 5]"));
  expect_in("16777216 pixels; expected at most 1000000", refused("resolution [4096 4096]"));
  expect_in("'resolution' expects [width height]", refused("resolution [5]"));
  expect_in("a field of view of 175 degrees", refused("fov 175"));
  expect_in("a field of view of 0 degrees", refused("fov 0"));
  expect_in("depths from 5 to 2 m", refused("range [5 2]"));
  expect_in("the lens folds its image between the axis and pixel (0, 0)", refused("distortion [-0.8 0 0 0]"));
  expect_in("6 coefficients; expected 4, 5 or 8", refused("distortion [1 2 3 4 5 6]"));
  expect_in("'distortion' and 'fisheye'; expected one", refused("distortion [0 0 0 0] fisheye [0 0 0 0]"));
  expect_in("'fov' and 'focal'; expected one", refused("fov 60 focal 300"));
  expect_in("a focal length of 0 px", refused("focal [300 0]"));
  expect_in("a focal length of 1e-09 px", refused("focal 1e-9"));
  expect_in("a focal length of 0.5 px; expected 1 to", refused("focal 0.5 fisheye [0 0 0 0]"));
  expect_in("depths from 5 to 5 m", refused("range [5 5]"));
  expect_in("'depth_noise'", refused("depth_noise -0.1"));
  expect_in("trial.world:2: a standard deviation of 15 m at the largest depth, 50 m; expected at most 0.25 of it",
            refused("depth_noise 0.006"));
  expect_in("expected 'rolling 1' with it", refused("scan_time 0.1"));
  expect_in("'samples' changes colours; expected 'rgb 1' or 'mono 1'", refused("samples 4"));
  expect_in("'jpeg' changes colours; expected 'rgb 1' or 'mono 1'", refused("jpeg 90"));
  expect_in("trial.world:2: 'rgb' and 'mono'; expected one of them", refused("rgb 1 mono 1"));
  expect_in("'jpeg'", refused("rgb 1 jpeg 101"));
  expect_in("expected 'samples' of 2 or more", refused("rgb 1 exposure 0.01"));
  expect_in("19200 different times; expected at most 10000",
            refused("rgb 1 samples 64 exposure 0.01 rolling 1 resolution [4 300]"));
  expect_in("'noise' is negative", refused("rgb 1 noise [-1]"));
  expect_in("'blur' changes colours; expected 'rgb 1' or 'mono 1'", refused("blur 1"));
  expect_in("'linear' changes colours; expected 'rgb 1' or 'mono 1'", refused("linear 1"));
  expect_in("'blur'", refused("rgb 1 blur 21"));
  expect_in("1000 x 1000 pixels of 5 samples; expected at most 4000000",
            refused("rgb 1 samples 5 resolution [1000 1000]"));
  expect_in("no pixel sees anything", refused("fisheye [0 0 0 0] principal [5000 0]"));
}

}  // namespace
}  // namespace sf::trial
