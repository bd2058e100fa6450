#include "robots/estimation/regression.h"

#include <algorithm>
#include <cmath>

namespace sf::estimation {

namespace {

/// Returns offset + the sum of weights times values, and advances `weights` behind them.
double affine(const double*& weights, std::span<const double> values) {
  double sum = *weights++;
  for (const double v : values) sum += *weights++ * v;
  return sum;
}

}  // namespace

double sigmoid(double x) { return x / std::sqrt(1.0 + x * x); }

double sigmoid_slope(double value) {
  const double rest = 1.0 - value * value;  // 1 / (1 + x^2)
  return rest * std::sqrt(rest);
}

double evaluate(const Structure& structure, std::span<const double> weights, std::span<const double> scaled) {
  const double* next = weights.data();
  double sum = affine(next, scaled);
  for (std::uint32_t k = 0; k < structure.hidden; ++k) {
    const double weight = *next++;
    sum += weight * sigmoid(affine(next, scaled));
  }
  return sum;
}

bool TrainingRange::contains(std::span<const double> regressors, std::span<const double> scaled) const {
  for (std::size_t i = 0; i < regressors.size(); ++i)
    if (!(regressors[i] >= least[i] && regressors[i] <= most[i])) return false;
  double squared = 0.0;
  const double* factor = decorrelation.data();
  for (std::size_t i = 0; i < scaled.size(); ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j <= i; ++j) sum += *factor++ * scaled[j];
    squared += sum * sum;
  }
  return squared <= distance * distance;
}

History::History(const Structure& structure) : structure_(structure), values_(structure.regressors(), 0.0) {}

void History::clear() { inputs_known_ = outputs_known_ = 0; }

void History::add_inputs(std::span<const double> inputs) {
  if (!std::ranges::all_of(inputs, [](double v) { return std::isfinite(v); })) return clear();
  const auto end = values_.begin() + static_cast<std::ptrdiff_t>(structure_.inputs * structure_.input_lags);
  std::shift_right(values_.begin(), end, static_cast<std::ptrdiff_t>(structure_.inputs));
  std::ranges::copy(inputs, values_.begin());
  inputs_known_ = std::min(inputs_known_ + 1, structure_.input_lags);
}

void History::add_output(double output) {
  if (structure_.output_lags == 0) return;
  if (!std::isfinite(output)) {
    outputs_known_ = 0;
    return;
  }
  const auto first = values_.begin() + static_cast<std::ptrdiff_t>(structure_.inputs * structure_.input_lags);
  std::shift_right(first, values_.end(), 1);
  *first = output;
  outputs_known_ = std::min(outputs_known_ + 1, structure_.output_lags);
}

void History::fill_outputs(double output) {
  for (std::uint32_t k = 0; k < structure_.output_lags; ++k) add_output(output);
}

ModelRun::ModelRun(const Regression& model, bool free_run)
    : model_(model), free_run_(free_run), history_(model.structure) {
  restart();
}

void ModelRun::restart() {
  history_.clear();
  if (free_run_) history_.fill_outputs(model_.output.mean);
}

std::optional<ModelPrediction> ModelRun::step(std::span<const double> inputs, double measured) {
  std::optional<ModelPrediction> prediction;
  history_.add_inputs(inputs);
  if (history_.complete()) {
    const std::span<const double> regressors = history_.regressors();
    scaled_.resize(regressors.size());
    for (std::size_t i = 0; i < scaled_.size(); ++i) scaled_[i] = model_.scales[i].apply(regressors[i]);
    prediction = {model_.output.revert(evaluate(model_.structure, model_.weights, scaled_)),
                  model_.range.contains(regressors, scaled_)};
  }
  if (!free_run_) history_.add_output(measured);
  if (free_run_ && prediction) history_.add_output(prediction->value);
  if (free_run_ && !history_.outputs_known()) history_.fill_outputs(model_.output.mean);
  return prediction;
}

}  // namespace sf::estimation
