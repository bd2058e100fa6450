#pragma once
// The field of all magnets of a world at many points, on the device or, with the same bytes, on the host. The world's
// homogeneous field (World::earth_field) is added on the host to the sum of either.
//
// Sums are accurate to 1e-12 of the sum of magnitudes, for points and moments in device precision (`field_bound`
// includes all errors). Points have 64 bits, with an error of 4e-18 m over the distance when nearer than 4 um to a
// magnet's centre. Moments have 32 bits: 1 A m^2 is exact and any other is within 6e-8. With a cut-off, a magnet counts
// when its distance along the ground is at most the cut-off, decided per magnet in 64 bits; `truncation_bound` bounds
// the rest. Nearer to a magnet than its radius, the field is that at the radius in the same direction; at its exact
// centre, it is the field straight above. The sum at a point depends only on the point and the magnets, not on the
// other points of a batch.

#include <cstdint>
#include <memory>
#include <span>

#include "base/pose.h"
#include "base/report.h"
#include "base/thread_pool.h"
#include "gpu/batch.h"
#include "gpu/device.h"
#include "sensors/magnetic_field/records.h"
#include "world/world.h"

namespace sf::sensors {

using base::Pose;

inline constexpr double kPermeability = 1e-7;  ///< [T m / A] mu0 / 4 pi, to a relative 5e-10

/// A point [m] in the world frame.
struct FieldPoint {
  double x = 0.0, y = 0.0, z = 0.0;
};

/// Returns the device's row of a world's magnet, or of a mover's magnet at its world position.
DipoleRow dipole_row(const world::Magnet& magnet, glm::dvec2 p, double z);

/// Not thread-safe. World, device and thread pool must outlive it.
class MagneticField {
 public:
  /// Places magnets at their poses at load.
  /// @param magnitudes also sums the magnitudes of the magnets' fields
  /// @param cutoff [m] replaces the world's; 0: none
  /// @throws base::DeviceError when the device cannot hold the magnets
  MagneticField(const world::World& world, gpu::Device& device, base::ThreadPool& thread_pool, bool magnitudes,
                double cutoff);
  MagneticField(MagneticField&&) noexcept;
  ~MagneticField();

  /// Moves the movers' magnets. @param states one per mover
  void place_movers(std::span<const base::Report> states);

  /// Sets the points of the next batch, in groups of up to SF_FIELD_POINTS neighbours.
  /// @param ends index after the last point of each group, ascending
  /// @return true when the batch must be recorded again
  bool prepare(std::span<const FieldPoint> points, std::span<const std::uint32_t> ends);
  bool on_device() const;  ///< false: call `sum_on_host` instead of running the batch
  void record(gpu::Batch& batch);
  void add_copies(gpu::Batch& batch);
  void sum_on_host();
  /// Returns the field at point `i` of group `group`, after the batch or `sum_on_host`, including the world's
  /// homogeneous field. Its magnitude is one more of the summed magnitudes.
  FieldSum at(std::size_t group, std::size_t i) const;

  std::uint64_t dipoles() const;  ///< number of pairs of a magnet and a point summed since construction

 private:
  struct Tables;
  std::unique_ptr<Tables> t_;
};

}  // namespace sf::sensors
