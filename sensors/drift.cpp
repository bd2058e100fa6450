#include "sensors/drift.h"

#include <cmath>

#include "base/elementary.h"

namespace sf::sensors {

namespace {

constexpr std::uint64_t kMostSteps = 1024;  // of one reading each
constexpr std::uint32_t kPairs = (kDriftTimes + 1) / 2;
static_assert(2 * kPairs == kDriftTimes + 1, "the walk draws the last number of each step");

double correlation_time(std::size_t process) { return static_cast<double>(1u << 2 * process); }  // [s]

/// Returns the variance of each process.
double variance_of(double instability) { return instability * instability * 2.0 * M_LN2 / M_PI; }

}  // namespace

double allan_variance(const DriftSettings& drift, double time) {
  double sum = 0.0;
  for (std::size_t k = 0; k < kDriftTimes; ++k) {
    const double x = time / correlation_time(k), e = base::exp(-x);
    sum += x < 1e-3 ? 2.0 / 3.0 * x : 2.0 / x * (1.0 - (3.0 - 4.0 * e + e * e) / (2.0 * x));
  }
  return variance_of(drift.instability) * sum + drift.walk * drift.walk * time / 3.0;
}

Drift::Drift(const DriftSettings& drift, double interval, const base::RandomKey& draw, std::uint32_t axis)
    : drift_(drift), interval_(interval), draw_(draw), axis_(axis) {
  draw_.c = 0;
  for (std::size_t k = 0; k < kDriftTimes; ++k) kept_[k] = base::exp(-interval / correlation_time(k));
  if (drift.instability <= 0.0) return;
  for (std::size_t k = 0; k < kDriftTimes; ++k)
    parts_[k] = std::sqrt(variance_of(drift.instability)) *
                base::random_normal(draw_, axis_ * kPairs + static_cast<std::uint32_t>(k / 2))[k % 2];
}

/// Takes one step over `readings` at once.
void Drift::step(std::uint64_t readings) {
  reading_ += readings;
  draw_.c = reading_;
  const double time = static_cast<double>(readings) * interval_;
  for (std::uint32_t pair = drift_.instability > 0.0 ? 0 : kPairs - 1; pair < kPairs; ++pair) {
    const auto normal = base::random_normal(draw_, axis_ * kPairs + pair);
    for (std::size_t i = 0; i < 2; ++i) {
      const std::size_t k = 2 * pair + i;
      if (k == kDriftTimes) {
        walk_ += drift_.walk * std::sqrt(time) * normal[i];
        continue;
      }
      const double kept = readings == 1 ? kept_[k] : base::exp(-time / correlation_time(k));
      parts_[k] = kept * parts_[k] + std::sqrt(variance_of(drift_.instability) * (1.0 - kept * kept)) * normal[i];
    }
  }
}

void Drift::advance(std::uint64_t reading) {
  if (reading <= reading_ || (drift_.instability <= 0.0 && drift_.walk <= 0.0)) return;
  if (reading - reading_ > kMostSteps) step(reading - reading_);
  while (reading_ < reading) step(1);
}

double Drift::value() const {
  double sum = walk_;
  for (const double part : parts_) sum += part;
  return sum;
}

void Drift::write(base::ByteWriter& out) const {
  out.put(reading_);
  out.put_bytes(parts_.data(), sizeof parts_);
  out.put(walk_);
}

void Drift::read(base::ByteReader& in) {
  reading_ = in.get<std::uint64_t>();
  in.get_into(parts_.data(), sizeof parts_);
  walk_ = in.get<double>();
}

}  // namespace sf::sensors
