#include "bench/cone_methods.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/thread_pool.h"
#include "bench/farm_rounds.h"

namespace sf::bench {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class FarmCones final : public ConeMethod {
 public:
  FarmCones(const ConeScene& scene, gpu::Device& device) : farm_(scene.world, device, scene.rounds, 40'000'000) {}
  std::string name() const override { return "farm"; }
  void poison() override { farm_.poison(); }
  void measure(std::size_t round) override { farm_.tick(round); }
  double range(std::size_t robot, std::size_t transducer) const override {
    return farm_.readings()[robot].values[transducer];
  }

 private:
  FarmRounds farm_;
};

class PlainCones final : public ConeMethod {
 public:
  PlainCones(const ConeScene& scene, const std::vector<sensors::ConeArray>& arrays, std::string name, Walk walk)
      : scene_(scene), arrays_(arrays), name_(std::move(name)), walk_(walk), transducers_(arrays[0].X_SC.size()) {
    const sensors::ConeArray& array = arrays_[0];
    grid_ = make_grid(scene.world, scene.world.movers[0].X_WM.z + array.row.X_MS.z, 0.5);
    raycast::ScanSettings fan;
    fan.fov = array.fov;
    fan.samples = array.rays;
    for (std::uint32_t i = 0; i < array.rays; ++i) {
      const double bearing = bearing_of(fan, i);
      beams_.push_back({std::cos(bearing), std::sin(bearing)});
    }
    values_.assign(arrays_.size() * transducers_, kNaN);
    ranges_.resize(thread_pool_.threads(), std::vector<double>(array.rays));
    hits_.resize(thread_pool_.threads(), std::vector<std::uint32_t>(array.rays));
  }
  std::string name() const override { return name_; }
  void poison() override { std::fill(values_.begin(), values_.end(), kNaN); }
  void measure(std::size_t round) override {
    thread_pool_.parallel_for(arrays_.size(), kRobotsPerPiece,
                              [&](std::size_t first, std::size_t last, unsigned thread) {
                                for (std::size_t i = first; i < last; ++i)
                                  hear_ring(i, scene_.rounds[round][i], thread);
                              });
  }
  double range(std::size_t robot, std::size_t transducer) const override {
    return values_[robot * transducers_ + transducer];
  }

 private:
  void hear_ring(std::size_t robot, const base::Pose& X_WM, unsigned thread) {
    const sensors::ConeArray& array = arrays_[robot];
    const base::Pose X_WS = base::compose(X_WM, array.row.X_MS);
    std::vector<double>& ranges = ranges_[thread];
    for (std::size_t k = 0; k < transducers_; ++k) {
      walk_(grid_, base::compose(X_WS, array.X_SC[k]), beams_, array.range_max, ranges.data(), hits_[thread].data());
      values_[robot * transducers_ + k] = std::max(array.range_min, *std::min_element(ranges.begin(), ranges.end()));
    }
  }

  const ConeScene& scene_;
  const std::vector<sensors::ConeArray>& arrays_;
  std::string name_;
  Walk walk_;
  std::size_t transducers_;
  SegmentGrid grid_;
  std::vector<glm::dvec2> beams_;
  base::ThreadPool thread_pool_;
  std::vector<double> values_;
  std::vector<std::vector<double>> ranges_;  ///< scratch per thread
  std::vector<std::vector<std::uint32_t>> hits_;
};

}  // namespace

std::unique_ptr<ConeMethod> make_farm_cones(const ConeScene& scene, gpu::Device& device) {
  return std::make_unique<FarmCones>(scene, device);
}

std::unique_ptr<ConeMethod> make_plain_cones(const ConeScene& scene, const std::vector<sensors::ConeArray>& arrays,
                                             const std::string& name, Walk walk) {
  return std::make_unique<PlainCones>(scene, arrays, name, walk);
}

}  // namespace sf::bench
