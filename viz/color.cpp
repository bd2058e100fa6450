#include "viz/color.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "viz/theme.h"

namespace sf::viz {
namespace {

double from_srgb(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }
double to_srgb(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055; }

double channel(std::uint32_t color, int shift) { return static_cast<double>((color >> shift) & 0xFFu) / 255.0; }

std::uint32_t byte(double c) { return static_cast<std::uint32_t>(std::lround(255.0 * std::clamp(c, 0.0, 1.0))); }

std::uint32_t pack(double r, double g, double b) { return 0xFF000000u | byte(r) << 16 | byte(g) << 8 | byte(b); }

double cube(double v) { return v * v * v; }

/// Linear RGB of an OKLab colour; outside [0, 1] for colours outside sRGB.
std::array<double, 3> light(const OklabColor& c) {
  const double l = cube(c.lightness + 0.3963377774 * c.a + 0.2158037573 * c.b);
  const double m = cube(c.lightness - 0.1055613458 * c.a - 0.0638541728 * c.b);
  const double s = cube(c.lightness - 0.0894841775 * c.a - 1.2914855480 * c.b);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool shown(const std::array<double, 3>& rgb) {
  return std::all_of(rgb.begin(), rgb.end(), [](double c) { return c >= 0.0 && c <= 1.0; });
}

/// Returns a colour as saturated as sRGB allows, with a chroma of at most `chroma`.
std::uint32_t oklch(double lightness, double chroma, double hue) {
  std::array<double, 3> rgb{};
  do {
    rgb = light({lightness, chroma * std::cos(hue), chroma * std::sin(hue)});
    chroma -= 0.001;
  } while (!shown(rgb) && chroma > 0.0);
  return pack(to_srgb(rgb[0]), to_srgb(rgb[1]), to_srgb(rgb[2]));
}

/// A curve in OKLab: lightness rises linearly from 0.22 to 0.91 while the hue changes from violet through blue and
/// green to yellow, as saturated as sRGB allows without a kink.
constexpr std::array<std::uint32_t, 21> kAnchors{
    0xFF250146u, 0xFF250F55u, 0xFF241E62u, 0xFF202C6Bu, 0xFF1C3A71u, 0xFF184776u, 0xFF13547Cu,
    0xFF0C6082u, 0xFF076D87u, 0xFF0D798Au, 0xFF1B858Du, 0xFF29918Fu, 0xFF379D90u, 0xFF44A98Fu,
    0xFF52B58Cu, 0xFF62C184u, 0xFF76CD76u, 0xFF92D663u, 0xFFB3DD54u, 0xFFD4E24Cu, 0xFFF3E749u};

}  // namespace

std::uint32_t scale_color(double t) {
  const double at = (t > 0.0 ? std::min(t, 1.0) : 0.0) * (kAnchors.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), kAnchors.size() - 2);
  return mix(kAnchors[below], kAnchors[below + 1], at - static_cast<double>(below));
}

std::uint32_t with_opacity(std::uint32_t color, double opacity) { return byte(opacity) << 24 | (color & 0x00FFFFFFu); }

std::uint32_t mix(std::uint32_t a, std::uint32_t b, double t) {
  const auto part = [&](int shift) { return (1.0 - t) * channel(a, shift) + t * channel(b, shift); };
  return pack(part(16), part(8), part(0));
}

OklabColor to_oklab(std::uint32_t color) {
  const double r = from_srgb(channel(color, 16));
  const double g = from_srgb(channel(color, 8));
  const double b = from_srgb(channel(color, 0));
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

std::uint32_t distinct(std::size_t i) {
  constexpr double kGoldenAngle = 2.399963229728653;  // [rad]
  constexpr std::array<double, 3> kLightness{0.55, 0.40, 0.70};
  return oklch(kLightness[i % kLightness.size()], 0.17, 4.0 + kGoldenAngle * static_cast<double>(i));
}

std::uint32_t row_color(std::size_t i, std::size_t count) {
  if (count <= theme::kSeries.size()) return theme::kSeries[i % theme::kSeries.size()];
  return distinct(i);
}

}  // namespace sf::viz
