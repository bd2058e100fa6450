#include "sensors/aggregate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "base/error.h"
#include "base/suggest.h"
#include "sensors/aggregation.h"
#include "sensors/derived/wiring.h"
#include "sensors/expression.h"
#include "sensors/pose_sensor.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

/// One column of an input's rows.
struct Source {
  std::uint32_t input = 0;
  std::size_t column = 0;
  std::size_t valid = kNone;     ///< column that states whether the row is valid
  std::size_t variance = kNone;  ///< column with its variance
  double sigma = 0.0;            ///< standard deviation of a sensor that measures; 0: not stated
  static constexpr std::size_t kNone = SIZE_MAX;
};

Source source_of(const sensorfarm::SensorInfo& sensor, std::uint32_t input, std::size_t column) {
  Source source{input, column};
  const auto types = sensor_types();
  const auto found = std::ranges::find_if(types, [&](const SensorType* type) { return type->name == sensor.type; });
  if (found == types.end() || (*found)->derived == nullptr) return source;
  const DerivedForm& form = *(*found)->derived;
  const std::size_t quantities = form.quantities;
  source.valid = quantities;
  if (!form.covariance || column >= quantities) return source;
  source.variance = quantities + 1;
  for (std::size_t row = 0; row < column; ++row) source.variance += quantities - row;
  return source;
}

/// Returns the value with its variance: as stated, of the sensor's noise, or NaN.
std::optional<estimation::Stated> value_of(const Source& source, const sensorfarm::Reading& reading, double noise) {
  const std::span<const double> v = reading.values;
  if (source.column >= v.size() || !std::isfinite(v[source.column])) return std::nullopt;
  if (source.valid != Source::kNone && v[source.valid] == 0.0) return std::nullopt;
  const double sigma = noise > 0.0 ? noise : source.sigma;
  const bool stated = noise == 0.0 && source.variance != Source::kNone;
  const double variance = stated ? v[source.variance] : sigma > 0.0 ? sigma * sigma : NAN;
  return estimation::Stated{{v[source.column], 0.0}, {variance, 0.0, 1.0}};
}

/// Returns the place of each source's input.
std::vector<std::uint32_t> places_of(const DerivedContext& context, std::span<const Source> sources) {
  std::vector<std::uint32_t> places;
  for (const Source& source : sources) places.push_back(context.inputs[source.input].place);
  return places;
}

class AggregateSensor : public sensorfarm::DerivedSensor {
 public:
  AggregateSensor(const DerivedContext& context, AggregationSettings settings, std::vector<Source> sources)
      : aggregation_(std::move(settings), places_of(context, sources)), sources_(std::move(sources)) {}

  void take(std::uint32_t input, const sensorfarm::Reading& reading) override {
    for (std::size_t i = 0; i < sources_.size(); ++i)
      if (sources_[i].input == input)
        aggregation_.take(i, reading.time, value_of(sources_[i], reading, aggregation_.noise(i)));
  }

  void read(double time, sensorfarm::DerivedReading out) override {
    const std::optional<Aggregate> now = aggregate(time);
    out.valid[0] = now.has_value();
    double* const extra = out.values.data() + 1;
    extra[0] = now ? now->source : NAN;
    extra[1] = now ? now->age : NAN;
    if (!now) return;
    out.values[0] = now->estimate.value.x;
    out.covariance[0] = now->estimate.covariance[0];
  }

 protected:
  virtual std::optional<Aggregate> aggregate(double time) { return aggregation_.at(time); }
  Aggregation aggregation_;
  std::vector<Source> sources_;
};

/// One quantity of all inputs.
class QuantitySensor final : public AggregateSensor {
 public:
  QuantitySensor(const DerivedContext& context, AggregationSettings settings, std::vector<Source> sources,
                 std::string quantity)
      : AggregateSensor(context, std::move(settings), std::move(sources)), quantity_(std::move(quantity)) {}

  void add_input(const sensorfarm::DerivedInput& input) override {
    const auto column = std::ranges::find(input.sensor.columns, quantity_) - input.sensor.columns.begin();
    const double sigma = sources_.back().sigma;  // it is a sensor of the same kind
    sources_.push_back(
        source_of(input.sensor, static_cast<std::uint32_t>(sources_.size()), static_cast<std::size_t>(column)));
    sources_.back().sigma = sigma;
    aggregation_.add_value();
  }

 private:
  std::string quantity_;
};

class ExpressionSensor final : public AggregateSensor {
 public:
  ExpressionSensor(const DerivedContext& context, AggregationSettings settings, std::vector<Source> sources,
                   Expression expression)
      : AggregateSensor(context, std::move(settings), std::move(sources)),
        expression_(std::move(expression)),
        numbers_(sources_.size()) {}

 private:
  std::optional<Aggregate> aggregate(double time) override {
    double variance = 0.0, oldest = 0.0;
    for (const std::size_t i : expression_.used()) {
      const std::optional<Aggregate> now = aggregation_.of(i, time);
      if (!now) return std::nullopt;
      numbers_[i] = now->estimate.value.x;
      oldest = std::max(oldest, now->age);
    }
    const double value = expression_.evaluate(numbers_);
    if (!std::isfinite(value)) return std::nullopt;
    for (const std::size_t i : expression_.used()) variance += variance_by(i, aggregation_.of(i, time)->estimate);
    const auto used = expression_.used();
    const bool single =
        std::ranges::all_of(used, [&](std::size_t i) { return sources_[i].input == sources_[used[0]].input; });
    const double source = single ? aggregation_.of(used[0], time)->source : -1.0;
    return Aggregate{{{value, 0.0}, {variance, 0.0, 1.0}}, source, oldest};
  }

  double variance_by(std::size_t i, const estimation::Stated& stated) {
    const double sigma = std::sqrt(stated.covariance[0]);
    numbers_[i] = stated.value.x + sigma;
    const double above = expression_.evaluate(numbers_);
    numbers_[i] = stated.value.x - sigma;
    const double below = expression_.evaluate(numbers_);
    numbers_[i] = stated.value.x;
    return 0.25 * (above - below) * (above - below);
  }

  Expression expression_;
  std::vector<double> numbers_;  ///< per source
};

/// Returns the column of each input that is called so. @throws base::InputError if an input has none
std::vector<Source> sources_called(const DerivedContext& context, const std::string& quantity) {
  std::vector<Source> sources;
  for (const sensorfarm::DerivedInput& input : context.site.inputs) {
    const std::vector<std::string>& columns = input.sensor.columns;
    const auto found = std::ranges::find(columns, quantity);
    if (found == columns.end()) {
      const std::vector<std::string_view> known(columns.begin(), columns.end());
      refuse(context.settings, "quantity",
             fmt::format("'{}' has no column '{}'{}", input.sensor.type, quantity,
                         base::expected_one_of(quantity, known)));
    }
    const std::size_t row = sources.size();
    sources.push_back(
        source_of(input.sensor, static_cast<std::uint32_t>(row), static_cast<std::size_t>(found - columns.begin())));
    if (sources.back().column == 0) sources.back().sigma = context.sigmas[row];
  }
  return sources;
}

std::string input_name(const DerivedContext& context, std::size_t row) {
  const sensorfarm::DerivedInput& input = context.site.inputs[row];
  std::string name = input.robot == context.spec.mover ? "" : context.world.movers[input.robot].name + ".";
  name += input.sensor.type;
  if (input.sensor.number > 0) name += std::to_string(input.sensor.number);
  return expression_name(name);
}

std::unique_ptr<sensorfarm::DerivedSensor> make_expression(const DerivedContext& context, const std::string& text) {
  std::vector<Source> sources;
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < context.site.inputs.size(); ++i)
    for (std::size_t k = 0; k < context.site.inputs[i].sensor.columns.size(); ++k) {
      sources.push_back(source_of(context.site.inputs[i].sensor, i, k));
      if (k == 0) sources.back().sigma = context.sigmas[i];
      names.push_back(input_name(context, i) + "." + expression_name(context.site.inputs[i].sensor.columns[k]));
    }
  for (const std::string_view key : {kChooseKey, kDriftKey})
    if (find(context.settings, key) != nullptr)
      refuse(context.settings, key, fmt::format("'{}' is for a quantity; an expression uses all its inputs", key));
  AggregationSettings settings = read_aggregation(context, 0.0);
  try {
    return std::make_unique<ExpressionSensor>(context, std::move(settings), std::move(sources),
                                              Expression(text, std::move(names)));
  } catch (const base::InputError& error) {
    refuse(context.settings, "expression", fmt::format("the expression: {}", error.what()));
  }
}

std::unique_ptr<sensorfarm::DerivedSensor> make_aggregate(const DerivedContext& context) {
  const world::Setting* const quantity = find(context.settings, "quantity");
  const world::Setting* const expression = find(context.settings, "expression");
  if (quantity != nullptr && expression != nullptr)
    refuse(context.settings, "expression", "an aggregate has a quantity or an expression; expected one of them");
  if (quantity == nullptr && expression == nullptr)
    refuse(context.settings, "quantity", "an aggregate expects quantity \"COLUMN\" or expression \"...\"");
  if (expression != nullptr) return make_expression(context, expression->text);
  const AggregationSettings settings = read_aggregation(context, 0.0);
  std::vector<Source> sources = sources_called(context, quantity->text);
  require_errors(context, settings,
                 [&](std::size_t i) { return sources[i].variance != Source::kNone || sources[i].sigma > 0.0; });
  return std::make_unique<QuantitySensor>(context, settings, std::move(sources), quantity->text);
}

constexpr DerivedPort kPorts[] = {{"input", {}, 1, 64}};
constexpr DerivedForm kDerived{
    .ports = kPorts, .quantities = 1, .covariance = true, .extra = 2, .make = make_aggregate};

constexpr std::string_view kKeys[] = {kDerivedKeys[0], kDerivedKeys[1], "quantity", "expression",
                                      kChooseKey,      kMaxAgeKey,      kDriftKey,  kNoiseKey};
constexpr Column kColumns[] = {{"value"}, {"valid", 1, true}, {"variance"}, {"source"}, {"age_s"}};
constexpr PlainNumber kNumbers[] = {kReal, {1.0, 0.0, 1.0}, kReal, {1.0, -1.0, 63.0}, kReal};
constexpr PlainForm kForm{kAggregate, "aggregate", kNumbers};

}  // namespace

constinit const SensorType aggregate_type = plain<kForm>({
    .word = {"aggregate", kKeys, {}, true},
    .base_port = 18000,
    .list = "",
    .columns = kColumns,
    .derived = &kDerived,
    .parse = [](const world::World& world) { return parse_derived(world, aggregate_type, 1, 10.0); },
    .make = no_backend,
});

}  // namespace sf::sensors
