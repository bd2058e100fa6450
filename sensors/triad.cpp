#include "sensors/triad.h"

#include <algorithm>

namespace sf::sensors {

namespace {

constexpr std::uint32_t kRun = 16;       // first draw number of a run; those of readings are below
constexpr std::uint32_t kRunDraws = 16;  // per triad

}  // namespace

double allan_variance(const TriadErrors& errors, double time) {
  return errors.noise * errors.noise / time + allan_variance(errors.drift, time);
}

double reading_deviation(const TriadErrors& errors, double interval) {
  const bool constant = errors.bias > 0.0 || errors.scale > 0.0 || errors.misalignment > 0.0;
  const bool wanders = errors.drift.instability > 0.0 || errors.drift.walk > 0.0;
  return constant || wanders ? HUGE_VAL : errors.noise / std::sqrt(interval);
}

Triad::Triad(const TriadErrors& errors, double cross, double interval, const base::RandomKey& noise,
             const base::RandomKey& drift, std::uint32_t number, bool noisy)
    : errors_(errors),
      noise_(noise),
      number_(number),
      deviation_(noisy ? errors.noise / std::sqrt(interval) : 0.0),
      drifts_{Drift(noisy ? errors.drift : DriftSettings{}, interval, drift, 3 * number),
              Drift(noisy ? errors.drift : DriftSettings{}, interval, drift, 3 * number + 1),
              Drift(noisy ? errors.drift : DriftSettings{}, interval, drift, 3 * number + 2)} {
  if (!noisy) return;
  noise_.c = 0;
  std::uint32_t draws = 0;
  const auto normal = [&] {
    const std::uint32_t k = draws++;
    return base::random_normal(noise_, kRun + number * kRunDraws + k / 2)[k % 2];
  };
  for (int row = 0; row < 3; ++row) {
    bias_[row] = errors.bias * normal();
    for (int column = 0; column < 3; ++column) {
      const double error = (row == column ? errors.scale : errors.misalignment) * normal();
      response_[column][row] += error;
      cross_[column][row] = cross * normal();
    }
  }
}

Triad::Output Triad::measure(const glm::dvec3& truth, const glm::dvec3& other, std::uint64_t reading) {
  Output out;
  out.values = response_ * truth + cross_ * other + bias_;
  noise_.c = reading;
  for (int axis = 0; axis < 3; ++axis) {
    double& value = out.values[axis];
    const auto k = static_cast<std::uint32_t>(axis);
    drifts_[k].advance(reading);
    value += drifts_[k].value();
    if (deviation_ > 0.0) value += deviation_ * base::random_normal(noise_, number_ * 2 + k / 2)[k % 2];
    if (errors_.step > 0.0) value = std::floor(value / errors_.step + 0.5) * errors_.step;
    if (std::abs(value) >= errors_.range) out.saturated |= 1u << k;
    value = std::clamp(value, -errors_.range, errors_.range);
  }
  return out;
}

}  // namespace sf::sensors
