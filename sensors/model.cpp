#include "sensors/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "sensors/derived/derived_type.h"
#include "sensors/model_file.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

class ModelSensor final : public sensorfarm::DerivedSensor {
 public:
  ModelSensor(ModelFile file, const sensorfarm::DerivedSite& site)
      : file_(std::move(file)),
        measured_known_(std::ranges::any_of(site.inputs, [](auto& input) { return input.port == kModelMeasured; })),
        run_(file_.regression, !measured_known_),
        inputs_(file_.inputs.size(), kUnknown) {
    std::size_t next = 0;
    for (const sensorfarm::DerivedInput& input : site.inputs) {
      first_.push_back(input.port == kModelMeasured ? kNone : next);
      if (input.port == kModelInput) next += signal_names(input.sensor).size();
    }
  }

  void take(std::uint32_t input, const sensorfarm::Reading& reading) override {
    if (first_[input] == kNone)
      measured_ = reading.values[0];
    else
      std::ranges::copy(reading.values, inputs_.begin() + static_cast<std::ptrdiff_t>(first_[input]));
  }

  void read(double, sensorfarm::DerivedReading out) override {
    const auto prediction = run_.step(inputs_, measured_);
    out.valid[0] = 0;
    if (!prediction) return;
    out.values[0] = prediction->value;
    out.valid[0] = prediction->in_range && std::isfinite(prediction->value) ? 1 : 0;
    const estimation::ModelError& rms = file_.regression.error;
    const double error = measured_known_ ? rms.one_step : rms.free_run;
    out.covariance[0] = error * error;
  }

 private:
  static constexpr std::size_t kNone = SIZE_MAX;
  ModelFile file_;
  bool measured_known_;  ///< the output is an input
  estimation::ModelRun run_;
  std::vector<double> inputs_;      ///< newest values
  std::vector<std::size_t> first_;  ///< per input: its place in `inputs_`; kNone: the measured output
  double measured_ = kUnknown;
};

/// Refuses inputs other than those that the model was learnt from.
void check_inputs(const DerivedContext& context, const ModelFile& file) {
  std::vector<std::string> wired;
  for (const sensorfarm::DerivedInput& input : context.site.inputs)
    if (input.port == kModelInput)
      for (std::string& name : signal_names(input.sensor)) wired.push_back(std::move(name));
    else if (const std::string name = signal_names(input.sensor)[0]; name != file.output)
      refuse(context.settings, "inputs", fmt::format("the model's output is {}; 'measured' is {}", file.output, name));
  for (std::size_t i = 0; i < std::max(wired.size(), file.inputs.size()); ++i) {
    const auto name = [i](const std::vector<std::string>& names) { return i < names.size() ? names[i] : "nothing"; };
    const std::string has = name(wired), needs = name(file.inputs);
    if (has != needs)
      refuse(context.settings, "inputs",
             fmt::format("the model was learnt with {} as number {} of its inputs; this is {}", needs, i + 1, has));
  }
}

std::unique_ptr<sensorfarm::DerivedSensor> make_model(const DerivedContext& context) {
  const world::Setting* const setting = find(context.settings, "file");
  if (setting == nullptr || setting->text.empty())
    refuse(context.settings, "file", "a model expects file \"NAME.toml\", written by 'sensorfarm identify'");
  const std::filesystem::path path = std::filesystem::path(setting->file).parent_path() / setting->text;
  ModelFile file = read_model_file(path.string());
  check_inputs(context, file);
  if (std::abs(context.spec.rate - file.rate) > 1e-9 * file.rate)
    refuse(context.settings, "rate",
           fmt::format("the model was learnt at {} Hz; this sensor has {} Hz", file.rate, context.spec.rate));
  return std::make_unique<ModelSensor>(std::move(file), context.site);
}

constexpr DerivedPort kPorts[] = {{"input", {}, 1, 16}, {"measured", {}, 0, 1}};
constexpr DerivedForm kDerived{.ports = kPorts, .quantities = 1, .covariance = true, .make = make_model};

constexpr std::string_view kKeys[] = {kDerivedKeys[0], kDerivedKeys[1], "file"};
constexpr Column kColumns[] = {{"value"}, {"valid", 1, true}, {"variance"}};
constexpr PlainNumber kReal{.real = true};
constexpr PlainNumber kNumbers[] = {kReal, {1.0, 0.0, 1.0}, kReal};
constexpr PlainForm kForm{kModel, "model", kNumbers};

}  // namespace

constinit const SensorType model_type = plain<kForm>({
    .word = {"model", kKeys, {}, true},
    .base_port = 6000,
    .list = "",
    .columns = kColumns,
    .derived = &kDerived,
    .parse = [](const world::World& world) { return parse_derived(world, model_type, 1, 10.0); },
    .make = no_backend,
});

}  // namespace sf::sensors
