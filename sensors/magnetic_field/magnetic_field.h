#pragma once
// The field of all magnets of a world at many places, on the device.
//
// Sums are right to 1e-12 of the sum of magnitudes, of places and moments as they are here: places in 64 bits, nearer
// than 4 um to a magnet's middle to 4e-18 m over the distance; moments in 32 bits: 1 A m^2 is itself there, any other
// within 6e-8 (`field_bound` has it all). With a
// cut-off, a magnet counts when its distance along the ground is at most the cut-off, decided magnet by magnet in 64
// bits; what is left out is bounded by `truncation_bound`. Nearer to a magnet than its radius, the field is the one at
// the radius in the same direction; exactly in its middle, the one above. A place's sum depends on the place and the
// magnets alone, not on what else is asked.

#include <cstdint>
#include <memory>
#include <span>

#include "base/pose.h"
#include "base/thread_pool.h"
#include "gpu/batch.h"
#include "gpu/device.h"
#include "sensors/magnetic_field/records.h"
#include "world/world.h"

namespace sf::sensors {

using base::Pose;

inline constexpr double kPermeability = 1e-7;  ///< [T m / A] mu0 / 4 pi, to 5e-10 of itself

/// A point [m] in the world.
struct FieldPoint {
  double x = 0.0, y = 0.0, z = 0.0;
};

/// What the kernel takes: row of the world's magnet, or of a mover's at its place in the world.
DipoleRow dipole_row(const world::Magnet& magnet, glm::dvec2 p, double z);

/// One thread. World, device and workers must outlive it.
class MagneticField {
 public:
  /// Magnets stand where the world has them at load.
  /// @param magnitudes also add up the magnets' own magnitudes.
  /// @param cutoff [m] instead of the world's; 0: none
  /// @throws base::DeviceError when the device cannot hold them.
  MagneticField(const world::World& world, gpu::Device& device, base::ThreadPool& thread_pool, bool magnitudes,
                double cutoff);
  MagneticField(MagneticField&&) noexcept;
  ~MagneticField();

  /// Moves what movers carry: one pose a mover, whose z is not looked at (the world is 2.5-D).
  void set_poses(std::span<const Pose> poses);

  /// Names the places of the next batch, in groups of up to SF_FIELD_PLACES neighbours.
  /// @param ends of each group: one past its last place; ascending.
  /// @return true when the batch must be recorded again.
  bool prepare(std::span<const FieldPoint> points, std::span<const std::uint32_t> ends);
  void record(gpu::Batch& batch);
  void add_copies(gpu::Batch& batch);
  /// After the batch: the field at place `i` of group `group`.
  FieldSum at(std::size_t group, std::size_t i) const;

  std::uint64_t dipoles() const;  ///< pairs of a magnet and a place that were summed since the start

 private:
  struct Tables;
  std::unique_ptr<Tables> t_;
};

}  // namespace sf::sensors
