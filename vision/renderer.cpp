#include "vision/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/hash.h"
#include "base/random.h"

namespace sf::vision {

namespace {

constexpr int kTile = 16;        // [px]
constexpr int kFewSamples = 8;   // of a pixel without an edge
constexpr double kEven = 0.005;  // [albedo] difference of samples within a pixel without an edge

/// A patch in motion about the middle of the image's exposure.
struct MovingPatch {
  const Patch* patch = nullptr;
  glm::dvec2 at;  ///< [m]
  double cosine = 1.0, sine = 0.0;
  glm::dvec2 half;    ///< [m] including a tag's border
  double cell = 1.0;  ///< [m] of a tag
};

/// Albedo of the patch `dt` seconds after the middle of the exposure, at point `p` of its plane; negative outside.
double albedo_at(const MovingPatch& m, glm::dvec2 p, double dt) {
  const Patch& patch = *m.patch;
  const glm::dvec2 d = p - (m.at + dt * patch.velocity);
  // Rotation by the angle of the exposure, to third order.
  const double a = dt * patch.turn;
  const double c1 = 1.0 - 0.5 * a * a, s1 = a * (1.0 - a * a / 6.0);
  const double c = m.cosine * c1 - m.sine * s1, s = m.sine * c1 + m.cosine * s1;
  const glm::dvec2 q{c * d.x + s * d.y, c * d.y - s * d.x};
  if (std::abs(q.x) > m.half.x || std::abs(q.y) > m.half.y) return -1.0;
  if (patch.shape == Patch::Shape::rectangle) return patch.albedo;
  if (patch.shape == Patch::Shape::disc)
    return q.x * q.x / (m.half.x * m.half.x) + q.y * q.y / (m.half.y * m.half.y) <= 1.0 ? patch.albedo : -1.0;
  const int n = patch.pattern.cells;
  const int column = static_cast<int>(std::floor(q.x / m.cell + 0.5 * n));
  const int row = static_cast<int>(std::floor(0.5 * n - q.y / m.cell));
  if (column < 0 || row < 0 || column >= n || row >= n) return patch.light;
  return patch.pattern.white[static_cast<std::size_t>(row * n + column)] != 0 ? patch.light : patch.dark;
}

/// Fractional part.
double wrap(double x) { return x - std::floor(x); }

/// Smooth unevenness of the floor, in [-1, 1].
double unevenness(glm::dvec2 p) {
  return 0.5 * std::sin(3.1 * p.x + 1.7 * std::sin(1.3 * p.y)) + 0.5 * std::sin(4.3 * p.y + 1.1 * std::sin(2.3 * p.x));
}

/// [1/(width of a step)] a separable Gaussian of 7 taps.
std::array<float, 7> gaussian(double sigma) {
  std::array<float, 7> taps{};
  double sum = 0.0;
  for (int i = -3; i <= 3; ++i) sum += std::exp(-0.5 * i * i / (sigma * sigma));
  for (int i = -3; i <= 3; ++i)
    taps[static_cast<std::size_t>(i + 3)] = static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)) / sum);
  return taps;
}

}  // namespace

struct Renderer::State {
  Camera camera;
  Imaging imaging;
  std::uint64_t seed = 0;
  std::vector<glm::dvec2> rays;  ///< normalised, of each pixel
  std::vector<float> falloff;    ///< by vignetting, of each pixel
  std::vector<float> light, blurred;
  std::vector<float> floor;  ///< light from the floor, of `floor_scene`
  Scene floor_scene;
  std::vector<MovingPatch> patches;               ///< the highest first
  std::vector<std::vector<std::uint32_t>> tiles;  ///< patches near each tile, the highest first
  int columns = 0, rows = 0;                      ///< of tiles

  std::size_t index(int u, int v) const { return static_cast<std::size_t>(v) * camera.intrinsics.width + u; }
  void light_floor(const Scene& scene);
  void place_patches(const Scene& scene, double middle);
  void box_of(const MovingPatch& m, glm::dvec2& low, glm::dvec2& high) const;
  void list_patches();
  glm::dvec2 ray_at(int u, int v, glm::dvec2 offset) const;
  double brightness(const Scene& scene, int u, int v, double middle, double start) const;
  double light_of_floor(const Scene& scene, glm::dvec2 ray) const;
  double sample(const Scene& scene, const std::vector<std::uint32_t>& near, glm::dvec2 ray, double dt,
                double bare) const;
  void blur();
  void expose(std::uint32_t frame, Image& out) const;
};

/// Keeps the light of the bare floor from image to image.
void Renderer::State::light_floor(const Scene& scene) {
  const bool same = !floor.empty() && scene.floor == floor_scene.floor && scene.texture == floor_scene.texture &&
                    scene.gradient == floor_scene.gradient;
  if (same) return;
  floor_scene = {scene.floor, scene.texture, scene.gradient, {}};
  floor.clear();
  for (const glm::dvec2& ray : rays) floor.push_back(static_cast<float>(light_of_floor(scene, ray)));
}

void Renderer::State::place_patches(const Scene& scene, double middle) {
  patches.clear();
  for (const Patch& patch : scene.patches) {
    const base::Pose X_WP = pose_at(patch, middle);
    MovingPatch m{&patch, {X_WP.x, X_WP.y}, std::cos(X_WP.yaw), std::sin(X_WP.yaw), 0.5 * patch.size, 1.0};
    if (patch.shape == Patch::Shape::tag) {
      m.cell = patch.size.x / patch.pattern.cells;
      m.half += glm::dvec2{patch.border * m.cell};
    }
    patches.push_back(m);
  }
  std::reverse(patches.begin(), patches.end());
  std::stable_sort(patches.begin(), patches.end(),
                   [](const MovingPatch& a, const MovingPatch& b) { return a.patch->X_WP.z > b.patch->X_WP.z; });
}

/// Box in the image of the outline of a patch during the exposure; the whole image where a part of the outline has no
/// projection.
void Renderer::State::box_of(const MovingPatch& m, glm::dvec2& low, glm::dvec2& high) const {
  constexpr int kSteps = 16;  // along each side, since straight lines are bent
  const double seconds = 0.5 * (camera.exposure + camera.readout);
  const double swing = seconds * std::abs(m.patch->turn) * glm::length(m.half);
  const glm::dvec2 half = m.half + swing;
  low = glm::dvec2{std::numeric_limits<double>::infinity()};
  high = -low;
  for (int side = 0; side < 4; ++side)
    for (int i = 0; i < kSteps; ++i)
      for (const double t : {-seconds, seconds}) {
        const double along = 2.0 * i / kSteps - 1.0;
        const glm::dvec2 corner =
            side < 2 ? glm::dvec2{along, side == 0 ? 1.0 : -1.0} : glm::dvec2{side == 2 ? 1.0 : -1.0, -along};
        const glm::dvec2 q = half * corner;
        const glm::dvec2 p =
            m.at + t * m.patch->velocity + glm::dvec2{m.cosine * q.x - m.sine * q.y, m.sine * q.x + m.cosine * q.y};
        const auto pixel = project(camera, {p.x, p.y, m.patch->X_WP.z});
        low = pixel ? glm::min(low, *pixel) : glm::dvec2{-1e9};
        high = pixel ? glm::max(high, *pixel) : glm::dvec2{1e9};
        if (!pixel) return;
      }
}

/// Enters each patch in the tiles that its box in the image overlaps.
void Renderer::State::list_patches() {
  constexpr double kMargin = 4.0;  // [px] bends between the points of a box
  for (auto& tile : tiles) tile.clear();
  for (std::uint32_t i = 0; i < patches.size(); ++i) {
    glm::dvec2 low, high;
    box_of(patches[i], low, high);
    const auto tile_of = [](double pixel, int count) {
      return static_cast<int>(std::clamp(std::floor(pixel / kTile), -1.0, static_cast<double>(count)));
    };
    const int top = std::max(0, tile_of(low.y - kMargin, rows)), left = std::max(0, tile_of(low.x - kMargin, columns));
    const int bottom = std::min(rows - 1, tile_of(high.y + kMargin, rows));
    const int right = std::min(columns - 1, tile_of(high.x + kMargin, columns));
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) tiles[static_cast<std::size_t>(y * columns + x)].push_back(i);
  }
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

/// Light from the point that the ray meets. @param dt [s] after the middle of the exposure
/// @param bare light of the floor there
double Renderer::State::sample(const Scene& scene, const std::vector<std::uint32_t>& near, glm::dvec2 ray, double dt,
                               double bare) const {
  for (const std::uint32_t i : near) {
    const auto p = meet_plane(camera, ray, patches[i].patch->X_WP.z);
    if (!p) continue;
    const double albedo = albedo_at(patches[i], *p, dt);
    if (albedo >= 0.0) return albedo * std::max(0.0, 1.0 + scene.gradient.x * p->x + scene.gradient.y * p->y);
  }
  return bare;
}

/// Mean over the pixel and its exposure. @param middle, start [s] of all rows' exposures, of this row's
double Renderer::State::brightness(const Scene& scene, int u, int v, double middle, double start) const {
  const auto& near = tiles[static_cast<std::size_t>(v / kTile * columns + u / kTile)];
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

/// Grey values with noise.
void Renderer::State::expose(std::uint32_t frame, Image& out) const {
  // The seed is a hash with the camera's name, so no key is one of a range sensor.
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
  // Cameras of one seed have different noise.
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
  s.columns = (width + kTile - 1) / kTile;
  s.rows = (height + kTile - 1) / kTile;
  s.tiles.resize(static_cast<std::size_t>(s.columns) * s.rows);
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;

void Renderer::render(const Scene& scene, double time, std::uint32_t frame, Image& out) {
  State& s = *state_;
  const int width = s.camera.intrinsics.width, height = s.camera.intrinsics.height;
  const double middle = time + 0.5 * (s.camera.exposure + s.camera.readout);
  s.light_floor(scene);
  s.place_patches(scene, middle);
  s.list_patches();
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

base::Pose pose_at(const Patch& patch, double t) {
  const base::Pose& X_WP = patch.X_WP;
  const double dt = t - patch.time;
  return {X_WP.x + dt * patch.velocity.x, X_WP.y + dt * patch.velocity.y, X_WP.z, X_WP.yaw + dt * patch.turn};
}

}  // namespace sf::vision
