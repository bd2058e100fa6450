#pragma once
// Cones of beams, cast exactly. On the device only the nearest echo of each cone is copied back.

#include <cstdint>
#include <span>
#include <vector>

#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "raycast/ray_caster.h"
#include "sensors/cones/cone_array.h"
#include "sensors/cones/reflectors.h"

namespace sf::sensors {

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
  ConeCaster(const SensorContext& context, const std::vector<ConeArray>& arrays, const ConeKernel& kernel);

  /// Index of the first cone of an array; the others follow in order.
  std::uint32_t first_cone(std::uint32_t array) const { return first_cones_[array]; }

  void place_movers();
  /// Rows of `due` are cones. @return true when kernels must be recorded again
  bool prepare(std::span<const DueSample> due);
  void record_measure(gpu::Batch& batch) { caster_.record(batch); }
  void record_derive(gpu::Batch& batch) const {
    if (on_device()) batch.dispatch(kernel_, groups_, 0);
  }
  void add_copies(gpu::Batch& batch);
  /// Call once after each batch.
  void count() { caster_.count(); }
  SensorStats stats() const { return caster_.stats(); }

  /// Echo of the i-th due cone. Thread-safe.
  ConeEcho echo(std::size_t i) { return on_device() ? echoes_.host<ConeEcho>()[i] : nearest_echo(i); }
  /// False: scans run on the host, and nothing is recorded.
  bool on_device() const { return caster_.on_device(); }

 private:
  struct Plan {
    std::vector<raycast::Scanner> scanners;
    std::vector<float> min_cosines;    ///< per cone
    std::vector<std::uint32_t> first;  ///< per array
    bool incidence = false;            ///< some array limits the angle of incidence
  };
  static Plan plan(const world::World& world, const std::vector<ConeArray>& arrays, std::size_t most_cones);
  ConeCaster(const SensorContext& context, const Plan& plan, const ConeKernel& kernel);
  ConeCaster(const SensorContext& context, const Plan& plan, const Reflectors& reflectors, const ConeKernel& kernel);
  ConeRow row_of(std::size_t i) const;
  /// Same operations in the same order as shaders/lib/cone.glsl.
  ConeEcho nearest_echo(std::size_t i);
  /// Same operations as shaders/sonar.comp. @param beam index in the caster's table of directions
  bool returns_echo(const ConeRow& row, std::size_t beam, std::uint32_t hit);

  base::ThreadPool& thread_pool_;
  std::span<const base::Report> states_;
  std::vector<std::uint32_t> first_cones_;
  std::vector<float> min_cosines_;
  raycast::RayCaster caster_;
  bool fresh_ = true;      ///< constant tables are not yet on the device
  std::size_t count_ = 0;  ///< number of due cones
  gpu::Kernel kernel_;
  gpu::Buffer rows_, echoes_, groups_, reflectors_, headings_;
  bool incidence_;
};

}  // namespace sf::sensors
