#pragma once
// Methods of the field comparison.

#include <memory>
#include <string>

#include "bench/field_comparison.h"
#include "bench/field_sums.h"

namespace sf::bench {

/// Elements per array.
inline constexpr std::size_t kArrayElements = 5;

class FieldMethod {
 public:
  virtual ~FieldMethod() = default;
  virtual std::string name() const = 0;
  /// Overwrites the results of the last turn.
  virtual void poison() = 0;
  /// The timed part: from poses to readings.
  virtual void sum(std::size_t repeat) = 0;
  /// [T] Returns the field at element `e` of robot `robot`, in the element's frame; NaN if it was not written.
  virtual FieldVector value(std::size_t robot, std::size_t e) const = 0;
  /// Returns the number of pairs of a magnet and an element summed so far; 0 for methods that do not count.
  virtual double pairs() const { return 0.0; }
};

/// `scene` and `device` must outlive the methods.
std::unique_ptr<FieldMethod> make_farm_method(const FieldScene& scene, gpu::Device& device);
std::unique_ptr<FieldMethod> make_plain_method(const FieldScene& scene, const std::string& name, SumField sum);

}  // namespace sf::bench
