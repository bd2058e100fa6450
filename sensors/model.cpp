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
      : file_(std::move(file)), history_(file_.regression.structure), inputs_(file_.inputs.size(), kUnknown) {
    std::size_t next = 0;
    for (const sensorfarm::DerivedInput& input : site.inputs) {
      first_.push_back(input.port == kModelMeasured ? kNone : next);
      if (input.port == kModelMeasured) measured_known_ = true;
      if (input.port == kModelInput) next += signal_names(input.sensor).size();
    }
    if (!measured_known_) history_.fill_outputs(file_.regression.output.mean);
  }

  void take(std::uint32_t input, const sensorfarm::Reading& reading) override {
    if (first_[input] == kNone)
      measured_ = reading.values[0];
    else
      std::ranges::copy(reading.values, inputs_.begin() + static_cast<std::ptrdiff_t>(first_[input]));
  }

  void read(double, sensorfarm::DerivedReading out) override {
    const estimation::Regression& model = file_.regression;
    history_.add_inputs(inputs_);
    out.valid[0] = 0;
    double value = kUnknown;
    if (history_.complete()) {
      const estimation::ModelPrediction prediction = estimation::predict(model, history_, scratch_);
      value = prediction.value;
      out.values[0] = value;
      out.valid[0] = prediction.in_range && std::isfinite(value) ? 1 : 0;
      const double error = measured_known_ ? model.error.one_step : model.error.free_run;
      out.covariance[0] = error * error;
    }
    if (measured_known_) return history_.add_output(measured_);
    if (history_.complete()) history_.add_output(value);
    if (!history_.outputs_known()) history_.fill_outputs(model.output.mean);
  }

 private:
  static constexpr std::size_t kNone = SIZE_MAX;
  ModelFile file_;
  estimation::History history_;
  std::vector<double> inputs_;      ///< newest values
  std::vector<std::size_t> first_;  ///< per input: its place in `inputs_`; kNone: the measured output
  double measured_ = kUnknown;
  bool measured_known_ = false;  ///< the output is an input
  std::vector<double> scratch_;
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
constexpr DerivedForm kDerived{kPorts, 1, true, make_model};

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
