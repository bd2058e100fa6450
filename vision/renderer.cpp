#include "vision/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/elementary.h"
#include "base/hash.h"
#include "base/random.h"
#include "vision/moving_patches.h"

namespace sf::vision {

namespace {

constexpr int kFewSamples = 8;   // per pixel without an edge
constexpr double kEven = 0.005;  // [albedo] maximum difference of samples within a pixel without an edge

/// Returns the fractional part.
double wrap(double x) { return x - std::floor(x); }

/// Returns the smooth unevenness of the floor, in [-1, 1].
double unevenness(glm::dvec2 p) {
  return 0.5 * base::sin(3.1 * p.x + 1.7 * base::sin(1.3 * p.y)) +
         0.5 * base::sin(4.3 * p.y + 1.1 * base::sin(2.3 * p.x));
}

/// [1/(width of a step)] Returns a separable Gaussian of 7 taps.
std::array<float, 7> gaussian(double sigma) {
  std::array<float, 7> taps{};
  double sum = 0.0;
  for (int i = -3; i <= 3; ++i) sum += base::exp(-0.5 * i * i / (sigma * sigma));
  for (int i = -3; i <= 3; ++i)
    taps[static_cast<std::size_t>(i + 3)] = static_cast<float>(base::exp(-0.5 * i * i / (sigma * sigma)) / sum);
  return taps;
}

}  // namespace

struct Renderer::State {
  Camera camera;
  Imaging imaging;
  std::uint64_t seed = 0;
  std::vector<glm::dvec2> rays;  ///< normalised, per pixel
  std::vector<float> falloff;    ///< due to vignetting, per pixel
  std::vector<float> light, blurred;
  std::vector<float> floor;  ///< light from the floor of `floor_scene`
  Scene floor_scene;
  MovingPatches patches;

  std::size_t index(int u, int v) const { return static_cast<std::size_t>(v) * camera.intrinsics.width + u; }
  void light_floor(const Scene& scene);
  glm::dvec2 ray_at(int u, int v, glm::dvec2 offset) const;
  double brightness(const Scene& scene, int u, int v, double middle, double start) const;
  double light_of_floor(const Scene& scene, glm::dvec2 ray) const;
  double sample(const Scene& scene, const std::vector<std::uint32_t>& near, glm::dvec2 ray, double dt,
                double bare) const;
  void blur();
  void expose(std::uint32_t frame, Image& out) const;
};

/// Computes the light of the bare floor and caches it between images.
void Renderer::State::light_floor(const Scene& scene) {
  const bool same = !floor.empty() && scene.floor == floor_scene.floor && scene.texture == floor_scene.texture &&
                    scene.gradient == floor_scene.gradient;
  if (same) return;
  floor_scene = {scene.floor, scene.texture, scene.gradient, {}};
  floor.clear();
  for (const glm::dvec2& ray : rays) floor.push_back(static_cast<float>(light_of_floor(scene, ray)));
}

/// @param offset [px] from the pixel's centre; rays are linear within a pixel
glm::dvec2 Renderer::State::ray_at(int u, int v, glm::dvec2 offset) const {
  const int u0 = std::min(u, camera.intrinsics.width - 2), v0 = std::min(v, camera.intrinsics.height - 2);
  const glm::dvec2 across = rays[index(u0 + 1, v)] - rays[index(u0, v)];
  const glm::dvec2 along = rays[index(u, v0 + 1)] - rays[index(u, v0)];
  return rays[index(u, v)] + offset.x * across + offset.y * along;
}

double Renderer::State::light_of_floor(const Scene& scene, glm::dvec2 ray) const {
  const auto p = meet_plane(camera, ray, 0.0);
  if (!p) return 0.0;
  return (scene.floor + scene.texture * unevenness(*p)) *
         std::max(0.0, 1.0 + scene.gradient.x * p->x + scene.gradient.y * p->y);
}

/// Returns the light from the point that the ray meets. @param dt [s] after the middle of the exposure
/// @param bare light of the floor there
double Renderer::State::sample(const Scene& scene, const std::vector<std::uint32_t>& near, glm::dvec2 ray, double dt,
                               double bare) const {
  for (const std::uint32_t i : near) {
    const auto p = meet_plane(camera, ray, patches.height(i));
    if (!p) continue;
    const double albedo = patches.albedo_at(i, *p, dt);
    if (albedo >= 0.0) return albedo * std::max(0.0, 1.0 + scene.gradient.x * p->x + scene.gradient.y * p->y);
  }
  return bare;
}

/// Returns the mean over the pixel and its exposure. @param middle, start [s] of all rows' exposures, of this row's
double Renderer::State::brightness(const Scene& scene, int u, int v, double middle, double start) const {
  const std::vector<std::uint32_t>& near = patches.near(u, v);
  if (near.empty()) return floor[index(u, v)];
  // Rank-1 sequence in pixel and time, with a shift per pixel (M. Roberts' R3).
  constexpr double kX = 0.8191725133961645, kY = 0.6710436067037893, kT = 0.5497004779019703;
  const std::uint64_t bits = (index(u, v) + 1) * 0x9E3779B97F4A7C15u;
  const double shift_x = static_cast<double>(bits >> 43) * 0x1p-21;
  const double shift_y = static_cast<double>((bits >> 22) & 0x1FFFFF) * 0x1p-21;
  const double shift_t = static_cast<double>(bits & 0x3FFFFF) * 0x1p-22;
  double sum = 0.0, least = 1e9, most = -1e9;
  for (int i = 0; i < kSamples; ++i) {
    const glm::dvec2 offset{wrap(shift_x + i * kX) - 0.5, wrap(shift_y + i * kY) - 0.5};
    const double t = start + camera.exposure * wrap(shift_t + i * kT);
    const double light_now = sample(scene, near, ray_at(u, v, offset), t - middle, floor[index(u, v)]);
    sum += light_now;
    least = std::min(least, light_now);
    most = std::max(most, light_now);
    if (i + 1 == kFewSamples && most - least < kEven) return sum / kFewSamples;
  }
  return sum / kSamples;
}

void Renderer::State::blur() {
  if (imaging.blur < 0.05) return;
  const auto taps = gaussian(imaging.blur);
  const int width = camera.intrinsics.width, height = camera.intrinsics.height;
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      float sum = 0.0f;
      for (int i = -3; i <= 3; ++i)
        sum += taps[static_cast<std::size_t>(i + 3)] * light[index(std::clamp(u + i, 0, width - 1), v)];
      blurred[index(u, v)] = sum;
    }
  for (int v = 0; v < height; ++v) {
    std::array<const float*, 7> lines{};
    for (int i = -3; i <= 3; ++i)
      lines[static_cast<std::size_t>(i + 3)] = blurred.data() + index(0, std::clamp(v + i, 0, height - 1));
    for (int u = 0; u < width; ++u) {
      float sum = 0.0f;
      for (std::size_t i = 0; i < 7; ++i) sum += taps[i] * lines[i][u];
      light[index(u, v)] = sum;
    }
  }
}

/// Computes grey values with noise.
void Renderer::State::expose(std::uint32_t frame, Image& out) const {
  // The seed includes a hash of the camera's name, so keys never coincide with those of range sensors.
  const base::RandomKey key{seed, base::RandomStream::range_noise, frame};
  for (std::size_t i = 0; i < light.size(); i += 2) {
    const auto normal = base::random_normal(key, static_cast<std::uint32_t>(i / 2));
    for (std::size_t k = 0; k < 2 && i + k < light.size(); ++k) {
      const double grey = imaging.exposure_gain * light[i + k] * falloff[i + k];
      const double sigma = std::sqrt(imaging.read_noise * imaging.read_noise + imaging.shot_noise * grey);
      out.pixels[i + k] = static_cast<std::uint8_t>(std::clamp(std::round(grey + sigma * normal[k]), 0.0, 255.0));
    }
  }
}

Renderer::Renderer(const Camera& camera, const Imaging& imaging, std::uint64_t seed)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.camera = camera;
  s.imaging = imaging;
  // Cameras with the same seed have different noise.
  s.seed = base::hash_bytes(camera.name.data(), camera.name.size(), seed);
  const int width = camera.intrinsics.width, height = camera.intrinsics.height;
  const std::size_t count = static_cast<std::size_t>(width) * height;
  s.rays.resize(count);
  s.falloff.resize(count);
  s.light.resize(count);
  s.blurred.resize(count);
  const glm::dvec2 middle = 0.5 * glm::dvec2{width - 1, height - 1};
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      s.rays[s.index(u, v)] = undistort(camera.intrinsics, {u, v});
      const glm::dvec2 d = glm::dvec2{u, v} - middle;
      s.falloff[s.index(u, v)] =
          static_cast<float>(1.0 - imaging.vignetting * glm::dot(d, d) / glm::dot(middle, middle));
    }
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;

void Renderer::render(const Scene& scene, double time, std::uint32_t frame, Image& out) {
  State& s = *state_;
  const int width = s.camera.intrinsics.width, height = s.camera.intrinsics.height;
  const double middle = time + 0.5 * (s.camera.exposure + s.camera.readout);
  s.light_floor(scene);
  s.patches.place(s.camera, scene, middle);
  for (int v = 0; v < height; ++v) {
    const double start = time + middle_of_exposure(s.camera, v) - 0.5 * s.camera.exposure;
    for (int u = 0; u < width; ++u)
      s.light[s.index(u, v)] = static_cast<float>(s.brightness(scene, u, v, middle, start));
  }
  s.blur();
  out.width = width;
  out.height = height;
  out.channels = 1;
  out.pixels.resize(s.light.size());
  s.expose(frame, out);
}

}  // namespace sf::vision
