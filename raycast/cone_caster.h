#pragma once
// Cones of beams, cast exactly. On the device only the nearest echo of each cone is copied back.

#include <cstdint>
#include <span>
#include <vector>

#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "raycast/ray_caster.h"
#include "raycast/reflectors.h"

namespace sf::raycast {

/// One cone.
struct Cone {
  Scanner scanner;         ///< its beams
  float min_cosine = 0.0;  ///< least cosine of an angle of incidence that returns an echo; 0: any angle
};

/// The kernel that reduces a cone's beams to a reading.
struct ConeKernel {
  std::string_view name;
  std::span<const std::uint32_t> spirv;
  bool uses_incidence = false;  ///< also binds the tables of directions, reflectors and headings
};

/// Not thread-safe. `context` must outlive it, except for `context.world`.
class ConeCaster {
 public:
  /// @throws base::DeviceError when the device cannot hold the tables; base::InputError for more cones than one
  /// dispatch takes
  ConeCaster(const SensorContext& context, std::span<const Cone> cones, const ConeKernel& kernel);

  void place_movers();
  /// Rows of `due` are cones. @return true when kernels must be recorded again
  bool prepare(std::span<const DueSample> due);
  void record_measure(gpu::Batch& batch) { caster_.record(batch); }
  void record_derive(gpu::Batch& batch) const {
    if (on_device()) batch.dispatch(kernel_, groups_, 0);
  }
  void add_copies(gpu::Batch& batch);
  /// Call once after each batch.
  void take_flags() { caster_.take_flags(); }
  SensorStats stats() const { return caster_.stats(); }

  /// Echo of the i-th due cone. Thread-safe.
  ConeEcho echo(std::size_t i) { return on_device() ? echoes_.host<ConeEcho>()[i] : nearest_echo(i); }
  /// False: scans run on the host, and nothing is recorded.
  bool on_device() const { return caster_.on_device(); }

 private:
  ConeCaster(const SensorContext& context, std::span<const Cone> cones, bool incidence, const Reflectors& reflectors,
             const ConeKernel& kernel);
  ConeRow row_of(std::size_t i) const;
  /// Same operations in the same order as shaders/lib/cone.glsl.
  ConeEcho nearest_echo(std::size_t i);
  /// Same operations as shaders/sonar.comp. @param beam index in the caster's table of directions
  bool returns_echo(const ConeRow& row, std::size_t beam, std::uint32_t hit);

  base::ThreadPool& thread_pool_;
  std::span<const base::Report> states_;
  std::vector<float> min_cosines_;  ///< per cone
  RayCaster caster_;
  bool fresh_ = true;      ///< constant tables are not yet on the device
  std::size_t count_ = 0;  ///< number of due cones
  gpu::Kernel kernel_;
  gpu::Buffer rows_, echoes_, groups_, reflectors_, headings_;
  bool incidence_;  ///< some cone limits the angle of incidence
};

}  // namespace sf::raycast
