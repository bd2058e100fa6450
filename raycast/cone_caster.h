#pragma once
// Casts cones of beams exactly. The device copies back only the nearest echo of each cone.

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
  float min_cosine = 0.0;  ///< smallest cosine of an angle of incidence that returns an echo; 0: any angle
};

/// The kernel that reduces a cone's beams to a reading.
struct ConeKernel {
  std::string_view name;
  std::span<const std::uint32_t> spirv;
  bool uses_incidence = false;  ///< also binds the tables of directions, reflectors and headings
};

/// Not thread-safe. `context`, except `context.world`, must outlive this object.
class ConeCaster {
 public:
  /// @throws base::DeviceError if the tables exceed the device's memory; base::InputError if there are more cones than
  /// one dispatch supports
  ConeCaster(const SensorContext& context, std::span<const Cone> cones, const ConeKernel& kernel);

  void place_movers();
  /// See Caster::update_outlines; false also where the angle of incidence limits echoes.
  bool update_outlines(const world::World& world) { return !incidence_ && caster_.update_outlines(world); }
  /// @param due rows are cones  @return true if kernels must be recorded again
  bool prepare(std::span<const DueSample> due);
  void record_measure(gpu::Batch& batch) { caster_.record(batch); }
  void record_derive(gpu::Batch& batch) const {
    if (on_device()) batch.dispatch(kernel_, groups_, 0);
  }
  void add_copies(gpu::Batch& batch);
  /// Call once after each batch.
  void take_flags() { caster_.take_flags(); }
  SensorStats stats() const { return caster_.stats(); }

  /// Returns the echo of the i-th due cone. Thread-safe.
  ConeEcho echo(std::size_t i) { return on_device() ? echoes_.host<ConeEcho>()[i] : nearest_echo(i); }
  /// Returns false if scans run on the host and no kernels are recorded.
  bool on_device() const { return caster_.on_device(); }

 private:
  ConeCaster(const SensorContext& context, std::span<const Cone> cones, bool incidence, const Reflectors& reflectors,
             const ConeKernel& kernel);
  ConeRow row_of(std::size_t i) const;
  /// Performs the operations of shaders/lib/cone.glsl in the same order.
  ConeEcho nearest_echo(std::size_t i);
  /// Performs the operations of shaders/sonar.comp. @param beam index in the caster's table of directions
  bool returns_echo(const ConeRow& row, std::size_t beam, std::uint32_t hit);

  base::ThreadPool& thread_pool_;
  std::span<const base::Report> states_;
  std::vector<float> min_cosines_;  ///< per cone
  RayCaster caster_;
  bool fresh_ = true;      ///< the constant tables are not on the device yet
  std::size_t count_ = 0;  ///< number of due cones
  gpu::Kernel kernel_;
  gpu::Buffer rows_, echoes_, groups_, reflectors_, headings_;
  bool incidence_;  ///< at least one cone limits the angle of incidence
};

}  // namespace sf::raycast
