#include "sensors/cones/rangers.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/random.h"

namespace sf::sensors {

namespace {

constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

std::vector<raycast::Cone> cones_of(const std::vector<ConeArray>& arrays) {
  std::vector<raycast::Cone> cones;
  for (const ConeArray& array : arrays) {
    raycast::ScanSettings beams;
    beams.fov = array.rays > 1 ? array.fov : 0.0;
    beams.samples = array.rays;
    beams.range_max = array.range_max;
    for (const Pose& X_SC : array.X_SC) {
      beams.X_MS = base::compose(array.row.X_MS, X_SC);
      cones.push_back({{beams, array.row.mover, array.row.sensor}, static_cast<float>(array.min_cosine)});
    }
  }
  return cones;
}

class Rangers : public SensorBackend {
 public:
  Rangers(const SensorContext& context, const std::vector<ConeArray>& arrays, const RangerType& type);

  void place_movers() override { cones_.place_movers(); }
  bool update_outlines(const world::World& world) override { return cones_.update_outlines(world); }
  bool prepare(std::span<const DueSample> due) override;
  void record_measure(gpu::Batch& batch) override { cones_.record_measure(batch); }
  void record_derive(gpu::Batch& batch) override { cones_.record_derive(batch); }
  void add_copies(gpu::Batch& batch) override { cones_.add_copies(batch); }
  void collect(std::span<base::ReadingBlock> out) override;
  void write_state(std::uint32_t row, base::ByteWriter& out) const override;
  void restart(std::uint32_t row, std::int64_t now) override;
  void read_state(std::uint32_t row, base::ByteReader& in) override;
  SensorStats stats() const override { return cones_.stats(); }
  bool on_device() const override { return cones_.on_device(); }

 private:
  void fire(const DueSample& due);
  std::size_t first_value(std::uint32_t row) const { return type_.columns * std::size_t{first_cones_[row]}; }
  std::size_t held(std::uint32_t row) const { return arrays_[row].turns > 1 ? arrays_[row].X_SC.size() : 0; }
  void write_reading(std::size_t i);
  std::span<const base::QualityFlag> quality_of(std::uint32_t row) const;

  base::ThreadPool& thread_pool_;
  std::span<const base::Report> states_;
  raycast::Episodes episodes_;
  bool noise_;
  const std::vector<ConeArray>& arrays_;
  RangerType type_;
  raycast::ConeCaster cones_;
  std::vector<std::uint32_t> first_cones_;  ///< per array
  std::vector<std::uint64_t> last_;         ///< per array: sequence number of its last reading, or kNever
  std::vector<double> values_;              ///< of all arrays; transducers that do not fire keep their values
  std::vector<base::QualityFlag> quality_;  ///< per cone; same rule
  std::vector<DueSample> due_;
  std::vector<Pose> X_WS_;               ///< per due array
  std::vector<DueSample> due_cones_;     ///< transducers that fire
  std::vector<std::size_t> cones_ends_;  ///< per due array: end of its cones
};

Rangers::Rangers(const SensorContext& context, const std::vector<ConeArray>& arrays, const RangerType& type)
    : thread_pool_(context.thread_pool),
      states_(context.states),
      episodes_(context.episodes),
      noise_(context.noise),
      arrays_(arrays),
      type_(type),
      cones_(context, cones_of(arrays_), type.kernel),
      last_(arrays_.size(), kNever) {
  std::uint32_t cones = 0;
  for (const ConeArray& array : arrays_) {
    first_cones_.push_back(cones);
    cones += static_cast<std::uint32_t>(array.X_SC.size());
  }
  values_.resize(type_.columns * std::size_t{cones});
  quality_.resize(cones);
}

bool Rangers::prepare(std::span<const DueSample> due) {
  due_.assign(due.begin(), due.end());
  X_WS_.clear();
  due_cones_.clear();
  cones_ends_.clear();
  for (const DueSample& d : due_) {
    const SensorSpec& row = arrays_[d.row].row;
    X_WS_.push_back(base::compose(states_[row.mover].X_WM, row.X_MS));
    fire(d);
    cones_ends_.push_back(due_cones_.size());
  }
  return cones_.prepare(due_cones_);
}

void Rangers::fire(const DueSample& due) {
  const ConeArray& array = arrays_[due.row];
  const std::uint64_t last = std::exchange(last_[due.row], due.sequence);
  for (std::uint32_t i = 0; i < array.X_SC.size(); ++i)
    if (has_fired(i, array.turns, due.sequence, last)) due_cones_.push_back({first_cones_[due.row] + i, due.sequence});
}

void Rangers::write_reading(std::size_t i) {
  const DueSample& due = due_[i];
  const ConeArray& array = arrays_[due.row];
  // Sonar and infrared share a stream and sensor numbers, so the type is part of the number. A draw keeps 24 bits of
  // it.
  const std::uint32_t name = (std::uint32_t{type_.id} << 16) | array.row.sensor;
  const base::RandomKey draw = episodes_.key(base::RandomStream::range_cone, array.row.mover, name, due.sequence);
  const bool noisy = noise_ && (array.sigma > 0.0 || array.proportional > 0.0);
  for (std::size_t k = i > 0 ? cones_ends_[i - 1] : 0; k < cones_ends_[i]; ++k) {
    const std::uint32_t transducer = due_cones_[k].row - first_cones_[due.row];
    const raycast::ConeEcho echo = cones_.echo(k);
    const double deviate = noisy ? base::random_normal(draw, transducer)[0] : 0.0;
    const auto out = std::span(values_).subspan(type_.columns * std::size_t{due_cones_[k].row}, type_.columns);
    type_.write_reading(array, echo.range, echo.hit != SF_NO_HIT, deviate, out);
    quality_[due_cones_[k].row] = echo.range < array.range_min ? base::QualityFlag::too_near : base::QualityFlag::none;
  }
}

/// Returns an empty span when all flags are none.
std::span<const base::QualityFlag> Rangers::quality_of(std::uint32_t row) const {
  const auto own = std::span<const base::QualityFlag>(quality_).subspan(first_cones_[row], arrays_[row].X_SC.size());
  const bool any = std::any_of(own.begin(), own.end(), [](auto flag) { return flag != base::QualityFlag::none; });
  return any ? own : std::span<const base::QualityFlag>();
}

// Arrays with a firing cycle hold the echoes of transducers that do not fire.
void Rangers::write_state(std::uint32_t row, base::ByteWriter& out) const {
  out.put(last_[row]);
  out.put_bytes(values_.data() + first_value(row), sizeof(double) * type_.columns * held(row));
  out.put_bytes(quality_.data() + first_cones_[row], sizeof(base::QualityFlag) * held(row));
}

void Rangers::read_state(std::uint32_t row, base::ByteReader& in) {
  last_[row] = in.get<std::uint64_t>();
  in.get_into(values_.data() + first_value(row), sizeof(double) * type_.columns * held(row));
  in.get_into(quality_.data() + first_cones_[row], sizeof(base::QualityFlag) * held(row));
}

void Rangers::restart(std::uint32_t row, std::int64_t /*now*/) {
  last_[row] = kNever;
  std::fill_n(values_.begin() + static_cast<std::ptrdiff_t>(first_value(row)), type_.columns * held(row), 0.0);
  std::fill_n(quality_.begin() + first_cones_[row], held(row), base::QualityFlag::none);
}

void Rangers::collect(std::span<base::ReadingBlock> out) {
  thread_pool_.parallel_for_each(due_.size(), 64, [this](std::size_t i, unsigned) { write_reading(i); });
  cones_.take_flags();
  for (std::size_t i = 0; i < due_.size(); ++i) {
    const ConeArray& array = arrays_[due_[i].row];
    base::ReadingBlock block;
    block.mover = array.row.mover;
    block.sensor = array.row.sensor;
    block.type = type_.id;
    block.X_WS = X_WS_[i];
    block.values = std::span<const double>(values_).subspan(type_.columns * std::size_t{first_cones_[due_[i].row]},
                                                            type_.columns * array.X_SC.size());
    block.quality = quality_of(due_[i].row);
    out[i] = block;
  }
}

}  // namespace

ParsedSensors parse_rangers(const world::World& world, std::string_view type, ReadConeArray read) {
  std::vector<ConeArray> arrays = cone_arrays_of(world, type, read);
  std::vector<SensorSpec> rows;
  for (const ConeArray& array : arrays) {
    rows.push_back(array.row);
    double& reach = rows.back().reach = 0.0;
    for (const Pose& X_SC : array.X_SC)
      reach = std::max(reach, array.range_max + glm::length(glm::dvec2{X_SC.x, X_SC.y}));
    // With a firing cycle, a reading contains echoes of earlier readings, so it cannot be reused.
    if (array.turns == 1) rows.back().dependency_radius = reach;
  }
  return {std::move(rows), std::move(arrays)};
}

std::unique_ptr<SensorBackend> make_ranger_backend(const SensorContext& context, const ParsedSensors& sensors,
                                                   const RangerType& type) {
  return std::make_unique<Rangers>(context, sensors.settings_as<ConeArray>(), type);
}

bool has_fired(std::uint32_t number, std::uint32_t turns, std::uint64_t sequence, std::uint64_t last) {
  if (last == kNever || last >= sequence) return true;
  const std::uint64_t readings_ago = (sequence % turns + turns - number % turns) % turns;
  return readings_ago < sequence - last;
}

}  // namespace sf::sensors
