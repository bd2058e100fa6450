#include "sensors/model_file.h"

#include <fmt/format.h>

#include <cmath>

#include "base/files.h"
#include "world/toml_reader.h"

namespace sf::sensors {

namespace {

constexpr double kMostValue = 1e18;

constexpr std::string_view kModelKeys[] = {"inputs",      "output",        "rate",           "input_lags",
                                           "output_lags", "hidden",        "one_step_error", "free_run_error",
                                           "means",       "deviations",    "output_scale",   "least",
                                           "most",        "decorrelation", "distance",       "weights"};

std::string list_of(std::span<const double> values) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : i % 8 == 0 ? ",\n  " : ", ", values[i]);
  return text + "]";
}

class ModelReader {
 public:
  ModelReader(const std::string& file, std::string_view text) : root_(world::parse_toml(file, text)), reader_(file) {
    reader_.require_known(root_, kModelKeys);
  }

  ModelFile read() {
    ModelFile model;
    for (const world::TomlNode& item : node("inputs").items) {
      if (item.kind != world::TomlNode::Kind::text) reader_.fail(item, "'inputs' expects texts");
      model.inputs.push_back(item.text);
    }
    model.output = reader_.text(root_, "output", "");
    model.rate = reader_.number(node("rate"), "rate", 1e-6, 1e6, "Hz");
    estimation::Regression& regression = model.regression;
    estimation::Structure& structure = regression.structure;
    structure = {static_cast<std::uint32_t>(model.inputs.size()), whole("input_lags", 1, estimation::kMostLags),
                 whole("output_lags", 0, estimation::kMostLags), whole("hidden", 0, estimation::kMostHidden)};
    const std::size_t n = structure.regressors();
    if (model.inputs.empty() || n > estimation::kMostRegressors)
      reader_.fail(
          node("inputs"),
          fmt::format("{} inputs at {} steps; expected 1 to {} numbers, with {} steps of the output",
                      model.inputs.size(), structure.input_lags, estimation::kMostRegressors, structure.output_lags));
    regression.error = {number("one_step_error"), number("free_run_error")};
    const std::vector<double> means = numbers("means", n), deviations = numbers("deviations", n, 1e-300);
    for (std::size_t i = 0; i < n; ++i) regression.scales.push_back({means[i], deviations[i]});
    const std::vector<double> output = numbers("output_scale", 2);
    if (!(output[1] > 0.0)) reader_.fail(node("output_scale"), "'output_scale' expects [mean, deviation > 0]");
    regression.output = {output[0], output[1]};
    regression.range = {numbers("least", n), numbers("most", n), numbers("decorrelation", n * (n + 1) / 2),
                        number("distance")};
    regression.weights = numbers("weights", structure.weights());
    return model;
  }

 private:
  const world::TomlNode& node(std::string_view key) const {
    if (const world::TomlNode* found = world::find(root_, key)) return *found;
    reader_.fail(root_, fmt::format("has no '{}': expected a file written by 'sensorfarm identify'", key));
  }
  std::uint32_t whole(std::string_view key, std::uint32_t least, std::size_t most) const {
    const double value = reader_.number(node(key), key, least, static_cast<double>(most));
    if (value != std::floor(value)) reader_.fail(node(key), fmt::format("'{}' expects a whole number", key));
    return static_cast<std::uint32_t>(value);
  }
  double number(std::string_view key) const { return reader_.number(node(key), key, 0.0, kMostValue); }
  std::vector<double> numbers(std::string_view key, std::size_t count, double least = -kMostValue) const {
    const world::TomlNode& list = node(key);
    std::vector<double> values;
    for (const world::TomlNode& item : list.items) values.push_back(reader_.number(item, key, least, kMostValue));
    if (list.kind != world::TomlNode::Kind::list || values.size() != count)
      reader_.fail(list, fmt::format("'{}' has {} numbers; expected {}", key, values.size(), count));
    return values;
  }

  world::TomlNode root_;
  world::TomlReader reader_;
};

}  // namespace

std::vector<std::string> signal_names(const sensorfarm::SensorInfo& sensor) {
  std::vector<std::string> names;
  const std::string prefix = sensor.number == 0 ? sensor.type : fmt::format("{}:{}", sensor.type, sensor.number);
  for (std::uint32_t element = 0; element < sensor.elements; ++element)
    for (const std::string& column : sensor.columns)
      names.push_back(sensor.elements == 1 ? fmt::format("{}.{}", prefix, column)
                                           : fmt::format("{}.{}.{}", prefix, element, column));
  return names;
}

std::string text_of(const ModelFile& model) {
  const estimation::Regression& r = model.regression;
  std::string inputs;
  for (const std::string& input : model.inputs) inputs += fmt::format("{}\"{}\"", inputs.empty() ? "" : ", ", input);
  std::vector<double> means, deviations;
  for (const estimation::Scale& scale : r.scales) {
    means.push_back(scale.mean);
    deviations.push_back(scale.deviation);
  }
  return fmt::format(
      "# A learnt model, written by `sensorfarm identify`; derived( type \"model\" file ... ) loads it.\n"
      "inputs = [{}]\noutput = \"{}\"\nrate = {}\ninput_lags = {}\noutput_lags = {}\nhidden = {}\n"
      "one_step_error = {}\nfree_run_error = {}\nmeans = {}\ndeviations = {}\noutput_scale = [{}, {}]\nleast = {}\n"
      "most = {}\ndecorrelation = {}\ndistance = {}\nweights = {}\n",
      inputs, model.output, model.rate, r.structure.input_lags, r.structure.output_lags, r.structure.hidden,
      r.error.one_step, r.error.free_run, list_of(means), list_of(deviations), r.output.mean, r.output.deviation,
      list_of(r.range.least), list_of(r.range.most), list_of(r.range.decorrelation), r.range.distance,
      list_of(r.weights));
}

ModelFile read_model_file(const std::string& file) { return parse_model_file(file, base::read_text(file)); }

ModelFile parse_model_file(const std::string& file, std::string_view text) { return ModelReader(file, text).read(); }

}  // namespace sf::sensors
