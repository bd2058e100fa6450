#pragma once
// Interface of ray casters: implemented by the farm and the methods that it is compared with.

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "base/hash.h"
#include "base/thread_pool.h"
#include "bench/scans.h"

namespace sf::bench {

/// Casts one set of `Scans`, round by round. One virtual call per round.
class Caster {
 public:
  virtual ~Caster() = default;
  virtual std::string name() const = 0;
  /// Overwrites all results, to detect results that are not written.
  virtual void poison() = 0;
  virtual void cast(std::size_t round) = 0;
  /// Returns the number of results that are still overwritten.
  virtual std::size_t unwritten() const = 0;
  virtual double range(std::size_t robot, std::size_t beam) const = 0;  ///< [m]
  virtual std::uint64_t hash() const = 0;                               ///< of all ranges
};

inline constexpr std::uint32_t kPoisonHit = 0xDEADBEEFu;

/// Results of a caster on the host: range and hit model per ray.
template <class Real>
class Results {
 public:
  explicit Results(const Scans& scans) : beams_(scans.beams.size()), ranges_(scans.rays()), hits_(scans.rays()) {}

  Real* ranges(std::size_t robot) { return ranges_.data() + robot * beams_; }
  std::uint32_t* hits(std::size_t robot) { return hits_.data() + robot * beams_; }

  void poison() {
    ranges_.assign(ranges_.size(), std::numeric_limits<Real>::quiet_NaN());
    hits_.assign(hits_.size(), kPoisonHit);
  }
  std::size_t unwritten() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < ranges_.size(); ++i) count += std::isnan(ranges_[i]) || hits_[i] == kPoisonHit;
    return count;
  }
  double range(std::size_t robot, std::size_t beam) const {
    return static_cast<double>(ranges_[robot * beams_ + beam]);
  }
  std::uint64_t hash() const { return base::hash_bytes(ranges_.data(), ranges_.size() * sizeof(Real)); }

 private:
  std::size_t beams_;
  std::vector<Real> ranges_;
  std::vector<std::uint32_t> hits_;
};

/// Robots per chunk of work of a thread.
inline constexpr std::size_t kRobotsPerPiece = 8;

}  // namespace sf::bench
