#include "vision/rendering/sample_caster.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace sf::vision {

namespace {

constexpr double kDisplaced = 0.01;  // [px] of patches, by the difference of times of rows
constexpr double kRange = 1e4;       // [m]

/// Returns the frame of the sensor: x along the optical axis, y to the left of the image, z up.
base::RigidTransform pose_of(const Camera& camera) {
  return {{camera.forward, -camera.right, -camera.down}, camera.position};
}

/// Camera::readout ends with the last row.
sensors::Shutter shutter_of(const Camera& camera, std::uint32_t samples) {
  const int height = camera.intrinsics.height;
  const double readout = camera.readout * height / std::max(1, height - 1);
  return {camera.exposure, readout, static_cast<std::uint32_t>(height), samples};
}

}  // namespace

SampleSet::SampleSet(const Camera& camera, std::uint32_t samples)
    : count(samples), places(samples + 1), shutter(shutter_of(camera, samples)) {}

SampleCaster::SampleCaster(const Camera& camera) : camera_(camera), X_WS_(pose_of(camera)) {}

void SampleCaster::begin(const Scene& scene, double time) {
  start_ = time;
  gradient_S_ = glm::transpose(X_WS_.R) * glm::dvec3(scene.gradient, 0.0);
  gradient_at_camera_ = glm::dot(scene.gradient, glm::dvec2(camera_.position));
  patches_.place(camera_, scene, time + 0.5 * (camera_.exposure + camera_.readout));
}

int SampleCaster::rows_at_once() const {
  constexpr int kMostRows = 8;
  const double moved = patches_.speed(camera_) * camera_.readout / camera_.intrinsics.height;  // [px] from row to row
  return 1 + static_cast<int>(std::min(2.0 * kDisplaced / (moved + 1e-9), kMostRows - 1.0));
}

void SampleCaster::cast(std::span<SampledPixel> pixels, const SampleSet& set) {
  for (SampledPixel& pixel : pixels) pixel.sum = 0.0f, pixel.least = HUGE_VALF, pixel.most = -HUGE_VALF;
  // The mean time of a row's samples is the middle of its exposure.
  const double last = start_ + camera_.readout + camera_.exposure * (1.0 - 0.5 / set.count);
  for (std::uint32_t k = 0; k < set.count; ++k) {
    const auto time_of = [&](int v) { return set.shutter.time_of(static_cast<std::size_t>(v), k); };
    const double time = last + 0.5 * (time_of(first_row_) + time_of(last_row_));
    if (time != beam_time_) flush();
    beam_time_ = time;
    for (SampledPixel& pixel : pixels) {
      const auto u = static_cast<std::uint32_t>(pixel.u), v = static_cast<std::uint32_t>(pixel.v);
      const glm::dvec3 beam = pixel.beam(set.place(k, u, v));
      const bool full = beams_.size() == scene::kTileBeams;
      if (full || (!beams_.empty() && glm::dot(beam, beams_.front()) < scene::kLeastTileCosine)) flush();
      beams_.push_back(beam), pixels_.push_back(&pixel);
    }
  }
  flush();
}

void SampleCaster::flush() {
  if (beams_.empty()) return;
  scene::fill_tile(beams_, beam_time_, tile_);
  patches_.list(first_row_, last_row_, beam_time_, instances_);
  scene::ScanOutput out{ranges_, hits_, quality_};
  out.sink = this;
  rasterizer_.scan(X_WS_, {&tile_, 1}, kRange, {instances_}, out);
  beams_.clear(), pixels_.clear();
}

void SampleCaster::take(const scene::BeamTile& tile, const scene::TileSurfaces& surfaces) {
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    float light = pixels_[i]->floor;
    if (surfaces.hits[i] != base::kNoHit) {
      const glm::dvec3 d{tile.dx[i], tile.dy[i], tile.dz[i]};
      const double here = 1.0 + gradient_at_camera_ + surfaces.ranges[i] * glm::dot(gradient_S_, d);
      light = static_cast<float>(patches_.albedo(surfaces.materials[i]) * std::max(0.0, here));
    }
    pixels_[i]->add(light);
  }
}

}  // namespace sf::vision
