#include "sensors/triad_backend.h"

#include <cmath>

#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kPiece = 64;  // readings per piece of work

}  // namespace

void read_errors(const world::Sensor& sensor, const std::string& prefix, SettingReader quantity, double most,
                 TriadErrors& e) {
  const auto read = [&](const char* key, double& value, double least = 0.0) {
    value = quantity(sensor, prefix + key, value, least, most);
  };
  read("noise", e.noise);
  read("instability", e.drift.instability);
  read("walk", e.drift.walk);
  read("bias", e.bias);
  read("step", e.step);
  read("range", e.range, 1e-12);
  e.scale = number(sensor, prefix + "scale", e.scale, 0.0, 1.0);
  e.misalignment = angle(sensor, prefix + "misalignment", e.misalignment, 0.0, 0.5);
}

TriadInstrument read_instrument(const world::Sensor& sensor, SettingReader quantity, double most, SensorSpec& row) {
  TriadInstrument instrument{.X_MS = spatial_mount(sensor), .errors = {}};
  read_errors(sensor, "", quantity, most, instrument.errors);
  instrument.errors.noise /= std::sqrt(row.rate);
  row.X_MS = planar_mount(instrument.X_MS);
  if (std::isfinite(instrument.errors.range)) row.limit = instrument.errors.range;
  row.sigma = reading_deviation(instrument.errors, 1.0 / row.rate);
  row.reach = 0.0;
  return instrument;
}

TriadBackend::TriadBackend(const SensorContext& context, const SensorType& type, const ParsedSensors& sensors,
                           std::vector<TriadInstrument> instruments, std::uint32_t number)
    : HostBackend(context, type, sensors),
      instruments_(std::move(instruments)),
      number_(number),
      noise_(context.noise) {
  for (std::uint32_t row = 0; row < rows().size(); ++row) triads_.push_back(triad_at_start(row));
}

Triad TriadBackend::triad_at_start(std::uint32_t row) const {
  const SensorSpec& spec = rows()[row];
  const auto key = [&](base::RandomStream stream) { return episodes().key(stream, spec.mover, spec.sensor); };
  return {instruments_[row].errors,
          0.0,
          1.0 / spec.rate,
          key(base::RandomStream::instrument_noise),
          key(base::RandomStream::instrument_drift),
          number_,
          noise_};
}

void TriadBackend::measure_all() {
  thread_pool().parallel_for(samples().size(), kPiece, [&](std::size_t first, std::size_t end, unsigned) {
    for (std::size_t i = first; i < end; ++i) {
      const HostSample& sample = samples()[i];
      const base::Report& state = states()[rows()[sample.row].mover];
      const auto X_WS = base::compose(base::transform_of(state.X_WM, state.tilt), instruments_[sample.row].X_MS);
      write(triads_[sample.row].measure(truth(sample.row, X_WS), {}, sample.sequence), sample.values);
    }
  });
}

}  // namespace sf::sensors
