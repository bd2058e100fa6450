// Lenses against OpenCV 4.6 (cv::projectPoints, cv::fisheye::projectPoints; 12 decimals), and their inverses.

#include "base/lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

namespace sf::base {
namespace {

constexpr unsigned kWidth = 640, kHeight = 480;

Lens lens_of(std::array<double, 8> distortion, bool fisheye = false) {
  return {{310.0, 305.0}, {322.0, 236.0}, distortion, fisheye};
}

const Lens kFive = lens_of({-0.28, 0.07, 0.0012, -0.0008, 0.002});
const Lens kEight = lens_of({0.30, 0.05, -0.0006, 0.0009, 0.002, 0.45, 0.02, 0.001});
const Lens kFisheye = lens_of({-0.012, 0.021, -0.015, 0.003}, true);

TEST(Lens, AgreesWithOpenCv) {
  constexpr glm::dvec2 kDirections[] = {{0.3, -0.2}, {-0.55, 0.41}, {0.05, 0.6}, {-0.9, -0.7}};
  const struct {
    const Lens& lens;
    glm::dvec2 pixels[4];
  } kCases[] = {{kFive,
                 {{411.603707642000, 177.254108966000},
                  {170.853206658815, 346.942398379327},
                  {336.001982458984, 402.507803386719},
                  {110.068934000000, 74.545871000000}}},
                {kEight,
                 {{413.440810726829, 176.022694039392},
                  {160.833253824908, 354.214879314752},
                  {336.921472220436, 410.909227263858},
                  {68.038562057203, 41.144883330512}}},
                {kFisheye,
                 {{411.154192410155, 177.522518956780},
                  {172.896018176957, 345.357495172854},
                  {335.923055275315, 400.381878411779},
                  {114.340034889686, 77.091747128845}}}};
  for (const auto& [lens, pixels] : kCases)
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(glm::distance(pixel_of(lens, kDirections[i]), pixels[i]), 1e-10) << i;
}

/// Every pixel has a direction that is imaged there, to rounding.
TEST(Lens, DirectionsInvertProjection) {
  for (const Lens& lens : {kFive, kEight, kFisheye}) {
    const LensImage image(lens, kWidth, kHeight);
    ASSERT_FALSE(image.fold());
    for (unsigned v = 0; v < kHeight; v += 13)
      for (unsigned u = 0; u < kWidth; u += 13) {
        const auto n = image.direction({u, v});
        ASSERT_TRUE(n);
        EXPECT_LT(glm::distance(pixel_of(lens, *n), glm::dvec2(u, v)), 2e-12 * kWidth) << u << " " << v;
      }
  }
}

/// A fisheye with a short focal length images 85 degrees on a circle within the image, and nothing outside.
TEST(Lens, FisheyeEndsAtItsRim) {
  const Lens lens{{150.0, 150.0}, {319.5, 239.5}, {}, true};
  const LensImage image(lens, kWidth, kHeight);
  EXPECT_FALSE(image.fold());
  const double rim = 150.0 * kWidestFisheye;
  EXPECT_TRUE(image.direction({319.5 + rim - 1e-9, 239.5}));
  EXPECT_FALSE(image.direction({319.5 + rim + 1e-9, 239.5}));
  EXPECT_EQ(*image.direction({319.5, 239.5}), glm::dvec2{}) << "the axis";
}

/// r (1 - 0.8 r^2) has its maximum of 0.43 at r = 0.65, but the left border is at 1.04.
TEST(Lens, FoldsAreFound) {
  const auto fold = LensImage(lens_of({-0.8}), kWidth, kHeight).fold();
  ASSERT_TRUE(fold);
  EXPECT_EQ(*fold, glm::uvec2(0, 0));
  // In an image that ends before the fold, the same lens is invertible.
  EXPECT_FALSE(LensImage({{1500.0, 1500.0}, {319.5, 239.5}, {-0.8}}, kWidth, kHeight).fold());
  EXPECT_TRUE(LensImage(lens_of({-0.5}, true), kWidth, kHeight).fold()) << "a fisheye that folds at 47 degrees";
  EXPECT_TRUE(LensImage(lens_of({0.0, 0.0, 0.0, 0.5}), kWidth, kHeight).fold()) << "tangential only";
}

}  // namespace
}  // namespace sf::base
