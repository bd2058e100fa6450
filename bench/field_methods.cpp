#include "bench/field_methods.h"

#include <cmath>
#include <limits>

#include "base/thread_pool.h"
#include "bench/farm_rounds.h"
#include "sensors/magnetometer.h"

namespace sf::bench {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class FarmMethod final : public FieldMethod {
 public:
  FarmMethod(const FieldScene& scene, gpu::Device& device)
      : farm_(scene.world, device, scene.rounds, 100'000'000), on_host_(device.is_host()) {}
  std::string name() const override { return on_host_ ? "farm, host" : "farm"; }
  void poison() override { farm_.poison(); }
  void sum(std::size_t repeat) override { farm_.tick(repeat); }
  FieldVector value(std::size_t robot, std::size_t e) const override {
    const double* const at = farm_.readings()[robot].values.data() + sensors::kMagnetometerColumns * e;
    return {at[1], at[2], at[3]};
  }
  double pairs() const override { return static_cast<double>(farm_.farm().stats().work.dipoles); }

 private:
  FarmRounds farm_;
  bool on_host_;
};

class PlainMethod final : public FieldMethod {
 public:
  PlainMethod(const FieldScene& scene, std::string name, SumField sum_field)
      : scene_(scene), name_(std::move(name)), sum_(sum_field), magnets_(make_columns(scene.world)) {
    values_.assign(scene.world.movers.size() * kArrayElements, {kNaN, kNaN, kNaN});
    const sensors::Magnetometer m = sensors::read_magnetometer(scene.world.movers[0].sensors[0]);
    for (const base::Pose& X_SE : m.X_SE) {
      X_ME_.push_back(base::compose(scene.world.movers[0].sensors[0].X_MS, X_SE));
      reach_ = std::max(reach_, std::hypot(X_SE.x, X_SE.y));
    }
    reach_ += 1.000001 * scene.world.magnet_cutoff;
    spans_.resize(thread_pool_.threads());
    for (auto& spans : spans_) spans.resize(magnets_.grid.most_spans(reach_));
  }
  std::string name() const override { return name_; }
  void poison() override { std::fill(values_.begin(), values_.end(), FieldVector{kNaN, kNaN, kNaN}); }
  void sum(std::size_t repeat) override {
    thread_pool_.parallel_for(scene_.rounds[repeat].size(), 16,
                              [&](std::size_t first, std::size_t last, unsigned thread) {
                                for (std::size_t i = first; i < last; ++i)
                                  sum_array(i, scene_.rounds[repeat][i], spans_[thread]);
                              });
  }
  FieldVector value(std::size_t robot, std::size_t e) const override { return values_[robot * kArrayElements + e]; }

 private:
  void sum_array(std::size_t robot, const base::Pose& X_WM, std::vector<sensors::MagnetSpan>& spans_buffer) {
    const base::Pose X_WS = base::compose(X_WM, scene_.world.movers[robot].sensors[0].X_MS);
    const auto spans = std::span(spans_buffer).first(magnets_.grid.find({X_WS.x, X_WS.y}, reach_, spans_buffer));
    for (std::size_t e = 0; e < kArrayElements; ++e) {
      const base::Pose X_WE = base::compose(X_WM, X_ME_[e]);
      const FieldVector b = sum_(magnets_, spans, X_WE.x, X_WE.y, X_WE.z);
      const glm::dvec2 flat = base::rotate(-X_WE.yaw, {b.x, b.y});
      values_[robot * kArrayElements + e] = {flat.x, flat.y, b.z};
    }
  }

  const FieldScene& scene_;
  std::string name_;
  SumField sum_;
  MagnetColumns magnets_;
  base::ThreadPool thread_pool_;
  std::vector<base::Pose> X_ME_;
  double reach_ = 0.0;                                   ///< [m]
  std::vector<std::vector<sensors::MagnetSpan>> spans_;  ///< scratch per thread
  std::vector<FieldVector> values_;
};

}  // namespace

MagnetColumns make_columns(const world::World& world) {
  MagnetColumns columns;
  columns.cutoff = world.magnet_cutoff;
  std::vector<glm::dvec2> at;
  for (const world::Magnet& m : world.magnets) at.push_back(m.p);
  columns.grid.build(at, columns.cutoff, 8 * at.size() + (1u << 20));
  const auto put = [&](const world::Magnet& m) {
    columns.x.push_back(m.p.x);
    columns.y.push_back(m.p.y);
    columns.z.push_back(m.z);
    columns.moment.push_back(m.moment);
    columns.inverse_radius.push_back(1.0 / m.radius);
  };
  for (const std::uint32_t i : columns.grid.order()) put(world.magnets[i]);
  for (int i = 0; i < 8; ++i) put({{0, 0}, 0, 0.0, 1.0, 0});
  return columns;
}

std::unique_ptr<FieldMethod> make_farm_method(const FieldScene& scene, gpu::Device& device) {
  return std::make_unique<FarmMethod>(scene, device);
}

std::unique_ptr<FieldMethod> make_plain_method(const FieldScene& scene, const std::string& name, SumField sum) {
  return std::make_unique<PlainMethod>(scene, name, sum);
}

}  // namespace sf::bench
