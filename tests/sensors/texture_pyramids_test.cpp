// Textures against sums in `double`, and as cameras see them.

#include "sensors/texture_pyramids.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>
#include <set>

#include "base/srgb.h"
#include "raycast/casters.h"
#include "sensors/camera.h"
#include "tests/folder.h"
#include "tests/sensors/series.h"
#include "tests/world/textured_square.h"

namespace sf::trial {
namespace {

using sensors::TexturePyramids;
using world::TextureUse;
using world::TextureWrap;

/// Linear light of an 8-bit value of sRGB, by the standard's formula.
double linear(double srgb) {
  const double s = srgb / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

world::Texture random_texture(std::uint32_t width, std::uint32_t height) {
  world::Texture texture{"", width, height, {}};
  std::mt19937 random(width * 100 + height);
  for (std::uint32_t i = 0; i < 3 * width * height; ++i) texture.rgb.push_back(static_cast<std::uint8_t>(random()));
  return texture;
}

/// Row or column of a texel of the plane that a texture covers.
std::int64_t wrapped(std::int64_t i, std::int64_t size, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) return std::clamp<std::int64_t>(i, 0, size - 1);
  const std::int64_t period = wrap == TextureWrap::mirror ? 2 * size : size, k = ((i % period) + period) % period;
  return k < size ? k : period - 1 - k;
}

/// Bilinear interpolation among the texels of the whole plane.
glm::dvec3 between(const world::Texture& t, const TextureUse& use, glm::dvec2 at) {
  const glm::dvec2 p = at * glm::dvec2(t.width, t.height) - 0.5, low = glm::floor(p);
  glm::dvec3 sum{};
  for (const int dy : {0, 1})
    for (const int dx : {0, 1}) {
      const auto x = wrapped(static_cast<std::int64_t>(low.x) + dx, t.width, use.u);
      const auto y = wrapped(static_cast<std::int64_t>(low.y) + dy, t.height, use.v);
      const double weight = (1.0 - std::abs(p.x - low.x - dx)) * (1.0 - std::abs(p.y - low.y - dy));
      for (int c = 0; c < 3; ++c)
        sum[c] += weight * linear(t.rgb[3 * static_cast<std::size_t>(y * t.width + x) + static_cast<std::size_t>(c)]);
    }
  return sum;
}

/// Random places, borders and corners of texels, far copies, of all ways to continue.
TEST(TexturePyramids, AgreeWithSumsInDouble) {
  std::mt19937_64 random(1);
  for (const auto& [width, height] : {std::pair{7u, 5u}, {8u, 1u}, {1u, 1u}, {64u, 32u}}) {
    const world::Texture texture = random_texture(width, height);
    const TexturePyramids pyramids({&texture, 1});
    for (int i = 0; i < 2'000; ++i) {
      const double far = i % 10 == 0 ? 1e4 : 3.0;
      glm::dvec2 at{std::uniform_real_distribution(-far, far)(random),
                    std::uniform_real_distribution(-far, far)(random)};
      if (i % 3 == 0) at = glm::round(2.0 * at * glm::dvec2(width, height)) / (2.0 * glm::dvec2(width, height));
      const TextureUse use{0, static_cast<TextureWrap>(i % 3), static_cast<TextureWrap>(i / 3 % 3)};
      const glm::dvec3 found(pyramids.color_at(use, at, {})), expected = between(texture, use, at);
      EXPECT_LT(glm::distance(found, expected), 2e-5) << width << " " << at.x << " " << at.y << " " << i;
    }
  }
}

/// A footprint of 2^k texels along its longer axis has the means of 2^k x 2^k texels; a large one that of all, also of
/// sizes that are no powers of two.
TEST(TexturePyramids, LevelsAreMeans) {
  const TextureUse use{0};
  for (const auto& [width, height] : {std::pair{16u, 8u}, {7u, 3u}, {1u, 5u}, {3u, 3u}}) {
    const world::Texture texture = random_texture(width, height);
    const TexturePyramids pyramids({&texture, 1});
    const auto mean = [&](std::uint32_t x0, std::uint32_t y0, std::uint32_t w, std::uint32_t h) {
      glm::dvec3 sum{};
      for (std::uint32_t y = y0; y < y0 + h; ++y)
        for (std::uint32_t x = x0; x < x0 + w; ++x)
          for (int c = 0; c < 3; ++c) sum[c] += linear(texture.rgb[3 * (y * width + x) + static_cast<std::size_t>(c)]);
      return sum / static_cast<double>(w * h);
    };
    for (const float size : {1e3f, 1e30f, INFINITY, NAN}) {
      const glm::dvec3 found(pyramids.color_at(use, {0.3, 0.4}, {size, 0, size}));
      EXPECT_LT(glm::distance(found, mean(0, 0, width, height)), 1e-3) << "levels are rounded to 16 bits";
    }
    if (width != 16) continue;
    const glm::vec3 four{4.0f / (16 * 16), 0, 1.0f / (8 * 8)};  // 2 texels wide, 1 high
    EXPECT_LT(glm::distance(glm::dvec3(pyramids.color_at(use, {3.0 / 8, 1.0 / 4}, {four})), mean(5, 1, 2, 2)), 1.0)
        << "between four means";
    EXPECT_LT(glm::distance(glm::dvec3(pyramids.color_at(use, {5.0 / 16, 3.0 / 8}, four)), mean(4, 2, 2, 2)), 0.01);
    EXPECT_LT(
        glm::distance(glm::dvec3(pyramids.color_at(use, {5.0 / 16, 3.0 / 8}, 2.25f * four)),
                      0.5 * (mean(4, 2, 2, 2) + glm::dvec3(pyramids.color_at(use, {5.0 / 16, 3.0 / 8}, 4.0f * four)))),
        0.01)
        << "three texels: halfway between two and four";
  }
}

class TexturedCamera : public FolderTest {
 protected:
  /// Colours of an image in light that shows surfaces which stand upright in their own colour.
  std::vector<std::uint32_t> shoot(const world::TexturedSquare& square, const std::string& camera,
                                   const std::string& model = "", const char* caster = "auto") {
    write("a.glb", world::glb_of(square));
    return shoot_text(fmt::format("sunlight 0 skylight 1.6\nmodel( mesh \"{}\" pose [1 0 0 0] {} )\n"
                                  "position( name \"r\" size [0.1 0.1 0.1] camera( rgb 1 pose6 [0 0 0.35 0 0 0] {} ) )",
                                  path("a.glb"), model, camera),
                      caster);
  }
  static std::vector<std::uint32_t> shoot_text(const std::string& text, const char* caster = "auto") {
    farm::FarmOptions options{.noise = false, .threads = 2};
    options.scene.caster = raycast::caster_named(caster);
    const world::World world = world_of(text);
    farm::Farm farm(world, host_device(), options);
    std::vector<std::uint32_t> colors;
    const base::ReadingBlock r = farm.sense(0, sensors::kCamera, 0, {}, {});
    for (std::size_t i = 1; i < r.values.size(); i += 2) colors.push_back(static_cast<std::uint32_t>(r.values[i]));
    return colors;
  }
};

/// A square of 1 m at 1 m fills 80 x 80 px: each of 4 x 2 texels 20 x 40 px, upright, of its own colour in its middle.
TEST_F(TexturedCamera, TexelsAreWhereTheyBelong) {
  const std::initializer_list<std::uint32_t> colors{0xFF0000, 0x00FF00, 0x0000FF, 0xFFFFFF,
                                                    0x102030, 0x808080, 0xFFFF00, 0x000000};
  const auto image =
      shoot({.picture = world::png_of(colors, 4)}, "resolution [81 81] focal 80 principal [40 40] range [0.1 5]");
  const std::vector<std::uint32_t> texels(colors);
  for (std::size_t row = 0; row < 2; ++row)
    for (std::size_t column = 0; column < 4; ++column) {
      const std::size_t u = 10 + 20 * column, v = 20 + 40 * row;
      EXPECT_EQ(image[81 * v + u], texels[4 * row + column]) << row << " " << column;
    }
  // Halfway between two texels is the mean of their light.
  const auto half = static_cast<std::uint32_t>(base::srgb_color(glm::vec3(0.5f, 0.5f, 0.0f)));
  EXPECT_EQ(image[81 * 20 + 20], half);
}

/// Beyond the picture: 3 x 3 copies, of which the middle one is the picture itself.
TEST_F(TexturedCamera, ContinuesBeyondThePicture) {
  const std::string picture = world::png_of({0xFF0000, 0x00FF00}, 2);
  const auto row_of = [&](const char* sampler) {
    const auto image = shoot({.coordinates = {-1, 0, 2, 0, 2, 1, -1, 1}, .picture = picture, .sampler = sampler},
                             "resolution [61 3] focal 60 principal [30 1] range [0.1 5]");
    std::string row;
    for (std::size_t k = 0; k < 6; ++k) {
      const std::uint32_t color = image[61 + 5 + 10 * k];
      row += color == 0xFF0000 ? 'r' : color == 0x00FF00 ? 'g' : '?';
    }
    return row;
  };
  EXPECT_EQ(row_of("{}"), "rgrgrg");
  EXPECT_EQ(row_of(R"({"wrapS":33071})"), "rrrggg");
  EXPECT_EQ(row_of(R"({"wrapS":33648})"), "grrggr");
}

/// The factor multiplies the picture's light; a model turned and scaled shows the same picture.
TEST_F(TexturedCamera, HasItsFactorAndSize) {
  const std::string picture = world::png_of({0xFFFFFF, 0x808080}, 2);
  const char* const kCamera = "resolution [41 3] focal 40 principal [20 1] range [0.1 5]";
  const auto image = shoot({.picture = picture, .factor = "[0.5,0,1,1]"}, kCamera);
  const float grey = base::linear_color(0x808080).x;
  EXPECT_EQ(image[41 + 10], base::srgb_color({0.5f, 0.0f, 1.0f}));
  EXPECT_EQ(image[41 + 30], base::srgb_color({0.5f * grey, 0.0f, grey}));
  const auto large = shoot({.picture = picture}, kCamera, "mesh_scale 2");
  EXPECT_EQ(large[41], 0xFFFFFFu) << "the middle of the left texel";
  EXPECT_EQ(large[41 + 20], shoot({.picture = picture}, kCamera)[41 + 20]) << "the border of both";
  const auto behind = shoot({.picture = picture}, kCamera, "mesh_rotation [0 0 180]");
  EXPECT_EQ(behind[41 + 30], 0xFFFFFFu) << "seen from behind, mirrored";
}

/// A chequered square far away is grey, whatever the place of its pixels, and brighter than the mean of its values.
TEST_F(TexturedCamera, IsFilteredFarAway) {
  std::vector<std::uint8_t> pixels;
  for (int i = 0; i < 256 * 256; ++i) pixels.insert(pixels.end(), 3, (i ^ i >> 8) & 1 ? 255 : 0);
  const auto image = shoot({.picture = base::encode_png(pixels, 256, 256)},
                           "resolution [21 21] focal 20 principal [10.3 9.6] range [0.1 5]");
  for (std::size_t v = 5; v < 15; ++v)
    for (std::size_t u = 5; u < 15; ++u) EXPECT_EQ(image[21 * v + u], 0xBCBCBCu) << u << " " << v;
}

/// A rough ball whose faces have random coordinates, tilted and far from the origin, with all lenses and several
/// samples: every pixel as cast by the reference, which computes coordinates in `long double` by another method.
TEST_F(TexturedCamera, AgreesWithEveryFace) {
  std::mt19937 random(3);
  const auto draw = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  std::string obj = "mtllib m.mtl\nusemtl m\n";
  const int rings = 9, sides = 14;
  for (int i = 0; i <= rings; ++i)
    for (int k = 0; k < sides; ++k) {
      const double r = draw(0.9, 1.0), a = M_PI * i / rings, b = 2 * M_PI * k / sides;
      obj += fmt::format("v {} {} {}\n", r * std::sin(a) * std::cos(b), r * std::sin(a) * std::sin(b), r * std::cos(a));
    }
  for (int i = 0; i < 100; ++i) obj += fmt::format("vt {} {}\n", draw(-2, 2), draw(-2, 2));
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < sides; ++k) {
      const int a = 1 + i * sides + k, b = 1 + i * sides + (k + 1) % sides;
      const auto vt = [&] { return static_cast<int>(draw(1, 100.99)); };
      obj += fmt::format("f {}/{} {}/{} {}/{}\nf {}/{} {}/{} {}/{}\n", a, vt(), b, vt(), b + sides, vt(), a, vt(),
                         b + sides, vt(), a + sides, vt());
    }
  std::vector<std::uint8_t> pixels;
  for (int i = 0; i < 3 * 64 * 32; ++i) pixels.push_back(static_cast<std::uint8_t>(random()));
  write("m.png", base::encode_png(pixels, 64, 32)), write("m.mtl", "newmtl m\nmap_Kd m.png\n");
  const std::string ball = write("a.obj", obj);
  for (const char* const lens : {"fov 80", "focal 50 fisheye [0.02 0 0 0]", "fov 60 samples 4 normals 0"}) {
    const std::string text = fmt::format(
        "sunlight 0 skylight 1\nmodel( mesh \"{}\" pose [1001.5 2000.1 -0.5 20] mesh_rotation [20 30 0] )\n"
        "position( name \"r\" size [0.1 0.1 0.1] camera( resolution [60 60] range [0.1 9] rgb 1 {} "
        "pose6 [1000 2000 0.3 3 4 5] ) )",
        ball, lens);
    const auto fast = shoot_text(text), slow = shoot_text(text, "reference");
    std::size_t same = 0, near = 0;
    for (std::size_t i = 0; i < fast.size(); ++i) {
      int most = 0;
      for (const int shift : {0, 8, 16})
        most = std::max(most,
                        std::abs(static_cast<int>(fast[i] >> shift & 255) - static_cast<int>(slow[i] >> shift & 255)));
      same += most == 0, near += most <= 1;
    }
    EXPECT_GE(near, fast.size() - 3) << lens << ": all but borders of faces";
    EXPECT_GE(same, fast.size() - 40) << lens;
    EXPECT_GT(std::set<std::uint32_t>(fast.begin(), fast.end()).size(), 300u) << lens;
  }
}

}  // namespace
}  // namespace sf::trial
