#pragma once
// Base class of instruments that read up to three numbers of their pose, with the errors of a Triad.

#include <string>
#include <vector>

#include "sensors/host_backend.h"
#include "sensors/triad.h"

namespace sf::sensors {

/// Mount and errors of one instrument.
struct TriadInstrument {
  base::RigidTransform X_MS;  ///< sensor in the mover's frame
  TriadErrors errors;
};

/// Reads a setting in the unit of an instrument's numbers: `angle`, `length` or `number`.
using SettingReader = double (*)(const world::Sensor& sensor, std::string_view key, double fallback, double least,
                                 double most);
/// Reads the errors whose keys begin with `prefix`; absent ones keep their values. @param most in their unit
/// @throws base::InputError with file and line
void read_errors(const world::Sensor& sensor, const std::string& prefix, SettingReader quantity, double most,
                 TriadErrors& errors);

/// Reads an instrument whose `noise` is the deviation of a reading, and sets the mount, the noise and the limit of its
/// row. Its readings depend on more than poses nearby.
TriadInstrument read_instrument(const world::Sensor& sensor, SettingReader quantity, double most, SensorSpec& row);

/// Returns the `instrument` of each row's settings.
template <class Settings>
std::vector<TriadInstrument> instruments_of(const std::vector<Settings>& settings) {
  std::vector<TriadInstrument> instruments;
  for (const Settings& each : settings) instruments.push_back(each.instrument);
  return instruments;
}

/// Not thread-safe.
class TriadBackend : public HostBackend {
 public:
  void write_state(std::uint32_t row, base::ByteWriter& out) const override { triads_[row].write(out); }
  void read_state(std::uint32_t row, base::ByteReader& in) override { triads_[row].read(in); }
  void restart(std::uint32_t row, std::int64_t /*now*/) override { triads_[row] = triad_at_start(row); }

 protected:
  /// @param number of its Triads' random numbers
  TriadBackend(const SensorContext& context, const SensorType& type, const ParsedSensors& sensors,
               std::vector<TriadInstrument> instruments, std::uint32_t number);

  /// Returns the true numbers of a sensor at a pose in the world. Several threads call it at once.
  virtual glm::dvec3 truth(std::uint32_t row, const base::RigidTransform& X_WS) const = 0;
  /// Writes a reading.
  virtual void write(const Triad::Output& output, std::span<double> values) const = 0;

 private:
  void measure_all() override;
  Triad triad_at_start(std::uint32_t row) const;

  std::vector<TriadInstrument> instruments_;  ///< per row
  std::uint32_t number_;
  bool noise_;
  std::vector<Triad> triads_;  ///< per row
};

}  // namespace sf::sensors
