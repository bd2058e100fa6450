#include "vision/rendering/renderer.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>
#include <vector>

#include "base/elementary.h"
#include "base/hash.h"
#include "base/lens.h"
#include "base/random.h"
#include "sensors/camera_response.h"
#include "vision/rendering/sample_caster.h"

namespace sf::vision {

namespace {

constexpr std::uint32_t kFewSamples = 8, kManySamples = 32;  // per pixel without an edge, and with one
constexpr float kEven = 0.005f;  // [light] maximum difference of samples within a pixel without an edge

/// Returns the smooth unevenness of the floor, in [-1, 1].
double unevenness(glm::dvec2 p) {
  return 0.5 * base::sin(3.1 * p.x + 1.7 * base::sin(1.3 * p.y)) +
         0.5 * base::sin(4.3 * p.y + 1.1 * base::sin(2.3 * p.x));
}

double floor_at(const Scene& scene, glm::dvec2 p) {
  return (scene.floor + scene.texture * unevenness(p)) * std::max(0.0, 1.0 + glm::dot(scene.gradient, p));
}

/// Returns the rays of all pixels, in normalised coordinates.
std::vector<glm::dvec2> rays_of(const Intrinsics& intrinsics) {
  base::Lens lens{intrinsics.focal, intrinsics.center};
  std::ranges::copy(intrinsics.distortion, lens.distortion.begin());
  const base::LensImage image(lens, static_cast<unsigned>(intrinsics.width), static_cast<unsigned>(intrinsics.height));
  std::vector<glm::dvec2> rays;
  for (int v = 0; v < intrinsics.height; ++v)
    for (int u = 0; u < intrinsics.width; ++u) rays.push_back(image.direction({u, v}).value());
  return rays;
}

sensors::CameraResponse response_of(const Imaging& imaging) {
  return {imaging.exposure_gain / 255.0, imaging.vignetting, imaging.blur, imaging.read_noise / 255.0,
          imaging.shot_noise / 255.0};
}

}  // namespace

struct Renderer::State {
  State(const Camera& of, const Imaging& imaging, std::uint64_t camera_seed);
  std::size_t index(int u, int v) const { return static_cast<std::size_t>(v) * camera.intrinsics.width + u; }
  void light_floor(const Scene& scene);
  void list_pixels(int first_row, int last_row);
  void render_rows(int first, int last);
  void expose(std::uint32_t frame, Image& out) const;

  Camera camera;
  sensors::CameraResponse response;
  sensors::LensBlur blur;
  std::uint64_t seed;
  std::vector<glm::dvec2> rays;  ///< per pixel
  std::vector<float> floor;      ///< light from the floor of `floor_scene`, per pixel
  Scene floor_scene;
  SampleCaster caster;
  SampleSet few, many;
  std::vector<float> light;        ///< per pixel
  std::vector<SampledPixel> near;  ///< pixels of some rows near patches
  std::vector<int> columns;        ///< scratch memory
};

Renderer::State::State(const Camera& of, const Imaging& imaging, std::uint64_t camera_seed)
    : camera(of),
      response(response_of(imaging)),
      blur(imaging.blur),
      // Cameras with the same seed have different noise.
      seed(base::hash_bytes(of.name.data(), of.name.size(), camera_seed)),
      rays(rays_of(of.intrinsics)),
      caster(camera),
      few(camera, kFewSamples),
      many(camera, kManySamples) {}

/// Computes the light of the bare floor and caches it between images.
void Renderer::State::light_floor(const Scene& scene) {
  const bool same = !floor.empty() && scene.floor == floor_scene.floor && scene.texture == floor_scene.texture &&
                    scene.gradient == floor_scene.gradient;
  if (same) return;
  floor_scene = {scene.floor, scene.texture, scene.gradient, {}};
  floor.clear();
  for (const glm::dvec2& ray : rays) {
    const auto p = meet_plane(camera, ray, 0.0);
    floor.push_back(p ? static_cast<float>(floor_at(scene, *p)) : 0.0f);
  }
}

void Renderer::State::list_pixels(int first_row, int last_row) {
  near.clear();
  for (int v = first_row; v <= last_row; ++v) {
    caster.list_columns(v, columns);
    const int v0 = std::min(v, camera.intrinsics.height - 2);
    for (const int u : columns) {
      const int u0 = std::min(u, camera.intrinsics.width - 2);
      near.push_back({u, v, rays[index(u, v)], rays[index(u0 + 1, v)] - rays[index(u0, v)],
                      rays[index(u, v0 + 1)] - rays[index(u, v0)], floor[index(u, v)]});
    }
  }
}

/// Computes the light of rows: means over each pixel and its exposure.
void Renderer::State::render_rows(int first, int last) {
  caster.begin_rows(first, last);
  list_pixels(first, last);
  const auto write = [this](std::span<const SampledPixel> pixels, const SampleSet& set) {
    for (const SampledPixel& p : pixels) light[index(p.u, p.v)] = p.sum / static_cast<float>(set.count);
  };
  caster.cast(near, few);
  write(near, few);
  const auto even = std::ranges::stable_partition(near, [](const auto& p) { return p.most - p.least >= kEven; });
  const std::span<SampledPixel> edges(near.begin(), even.begin());
  caster.cast(edges, many);
  write(edges, many);
}

/// Computes grey values with noise.
void Renderer::State::expose(std::uint32_t frame, Image& out) const {
  const int width = camera.intrinsics.width, height = camera.intrinsics.height;
  const base::RandomKey key{seed, base::RandomStream::range_noise, frame};
  for (std::size_t i = 0; i < light.size(); i += 2) {
    const auto normal = base::random_normal(key, static_cast<std::uint32_t>(i / 2));
    for (std::size_t k = 0; k < 2 && i + k < light.size(); ++k) {
      const glm::dvec2 pixel{(i + k) % width, (i + k) / width};
      const double mean = response.gain * light[i + k] * response.falloff(pixel, {width, height});
      const double grey = 255.0 * (mean + normal[k] * response.noise_of(mean));
      out.pixels[i + k] = static_cast<std::uint8_t>(std::clamp(std::round(grey), 0.0, 255.0));
    }
  }
}

Renderer::Renderer(const Camera& camera, const Imaging& imaging, std::uint64_t seed)
    : state_(std::make_unique<State>(camera, imaging, seed)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;

void Renderer::render(const Scene& scene, double time, std::uint32_t frame, Image& out) {
  State& s = *state_;
  const int width = s.camera.intrinsics.width, height = s.camera.intrinsics.height;
  s.light_floor(scene);
  s.light = s.floor;
  s.caster.begin(scene, time);
  const int rows = s.caster.rows_at_once();
  for (int v = 0; v < height; v += rows) s.render_rows(v, std::min(v + rows, height) - 1);
  s.blur.apply(s.light, static_cast<std::size_t>(width));
  out.width = width;
  out.height = height;
  out.channels = 1;
  out.pixels.resize(s.light.size());
  s.expose(frame, out);
}

}  // namespace sf::vision
