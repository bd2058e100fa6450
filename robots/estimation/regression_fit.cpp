#include "robots/estimation/regression_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <unsupported/Eigen/NonLinearOptimization>

#include "base/random.h"
#include "base/thread_pool.h"

namespace sf::estimation {

namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kLeastRegressorVariance =
    1e-9;  // of scaled regressors, as a ridge: some are constant, or multiples of others

/// Regressors, a row each, and the outputs that follow them.
struct Design {
  std::vector<double> regressors, outputs;
};

template <class Row>
void for_each_row(const Structure& structure, const SampledSignals& signals, std::span<const StepRange> ranges,
                  const Row& row) {
  History history(structure);
  for (const StepRange& range : ranges) {
    history.clear();
    for (std::size_t k = range.first; k < range.last; ++k) {
      history.add_inputs(signals.inputs_at(k));
      if (history.complete() && std::isfinite(signals.output_at(k))) row(history.regressors(), signals.output_at(k));
      history.add_output(signals.output_at(k));
    }
  }
}

Scale scale_of(std::span<const double> values, std::size_t first, std::size_t stride) {
  const double count = static_cast<double>(values.size() / stride);
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = first; i < values.size(); i += stride) sum += values[i];
  const double mean = sum / count;
  for (std::size_t i = first; i < values.size(); i += stride) squares += (values[i] - mean) * (values[i] - mean);
  const double deviation = std::sqrt(squares / count);
  return {mean, deviation > 0.0 ? deviation : 1.0};
}

/// Scaled regressors and outputs.
struct Scaled {
  RowMatrix X;
  Eigen::VectorXd y;
};

Scaled scaled(const Regression& model, const Design& design, std::size_t every) {
  const auto columns = static_cast<Eigen::Index>(model.scales.size());
  const std::size_t rows = (design.outputs.size() + every - 1) / every;
  Scaled all{RowMatrix(rows, columns), Eigen::VectorXd(rows)};
  for (std::size_t k = 0; k < rows; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    for (Eigen::Index i = 0; i < columns; ++i)
      all.X(row, i) = model.scales[static_cast<std::size_t>(i)].apply(
          design.regressors[k * every * model.scales.size() + static_cast<std::size_t>(i)]);
    all.y(row) = model.output.apply(design.outputs[k * every]);
  }
  return all;
}

/// Least squares with a penalty of squared weights: an offset, then one weight per regressor.
Eigen::VectorXd linear_weights(const Scaled& data, double decay) {
  const Eigen::Index n = data.X.cols();
  const double count = static_cast<double>(data.X.rows());
  Eigen::MatrixXd normal = data.X.transpose() * data.X / count;
  normal.diagonal().array() += std::max(decay, kLeastRegressorVariance);
  const Eigen::VectorXd right = data.X.transpose() * (data.y.array() - data.y.mean()).matrix() / count;
  Eigen::VectorXd weights(n + 1);
  weights.tail(n) = normal.llt().solve(right);
  weights(0) = data.y.mean() - data.X.colwise().mean().dot(weights.tail(n));
  return weights;
}

/// Residuals of all samples, then of the penalty, as Eigen's Levenberg-Marquardt wants them.
class Residuals {
 public:
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;

  Residuals(const Structure& structure, const Scaled& data, double decay)
      : structure_(structure), data_(data), penalty_(std::sqrt(decay * static_cast<double>(data.X.rows()))) {}
  int inputs() const { return static_cast<int>(structure_.weights()); }
  int values() const { return static_cast<int>(data_.X.rows()) + inputs(); }

  int operator()(const Eigen::VectorXd& w, Eigen::VectorXd& residuals) const {
    const Eigen::Index rows = data_.X.rows();
    for (Eigen::Index k = 0; k < rows; ++k)
      residuals(k) = evaluate(structure_, {w.data(), static_cast<std::size_t>(w.size())}, row(k)) - data_.y(k);
    residuals.tail(w.size()) = penalty_ * w;
    return 0;
  }

  int df(const Eigen::VectorXd& w, Eigen::MatrixXd& jacobian) const {
    const Eigen::Index n = data_.X.cols(), rows = data_.X.rows();
    jacobian.setZero();
    for (Eigen::Index k = 0; k < rows; ++k) {
      jacobian(k, 0) = 1.0;
      jacobian.block(k, 1, 1, n) = data_.X.row(k);
      for (Eigen::Index at = 1 + n; at < w.size(); at += n + 2) {
        const double value = sigmoid(w(at + 1) + data_.X.row(k).dot(w.segment(at + 2, n)));
        const double slope = w(at) * sigmoid_slope(value);
        jacobian(k, at) = value;
        jacobian(k, at + 1) = slope;
        jacobian.block(k, at + 2, 1, n) = slope * data_.X.row(k);
      }
    }
    jacobian.bottomRows(w.size()).diagonal().setConstant(penalty_);
    return 0;
  }

 private:
  std::span<const double> row(Eigen::Index k) const {
    return {data_.X.data() + k * data_.X.cols(), static_cast<std::size_t>(data_.X.cols())};
  }
  const Structure& structure_;
  const Scaled& data_;
  double penalty_;
};

/// The linear weights, then small random ones.
Eigen::VectorXd first_weights(const Structure& structure, const Eigen::VectorXd& linear, std::uint64_t seed) {
  Eigen::VectorXd weights(structure.weights());
  weights.head(linear.size()) = linear;
  const double spread = 1.0 / std::sqrt(static_cast<double>(structure.regressors()));
  for (Eigen::Index i = linear.size(); i < weights.size(); ++i)
    weights(i) = spread * base::random_normal({seed, base::RandomStream::decision}, static_cast<std::uint32_t>(i))[0];
  return weights;
}

TrainingRange range_of(const Scaled& data, const Design& design) {
  const auto n = static_cast<std::size_t>(data.X.cols());
  TrainingRange range{std::vector<double>(n, HUGE_VAL), std::vector<double>(n, -HUGE_VAL), {}, 0.0};
  for (std::size_t i = 0; i < design.regressors.size(); ++i) {
    range.least[i % n] = std::min(range.least[i % n], design.regressors[i]);
    range.most[i % n] = std::max(range.most[i % n], design.regressors[i]);
  }
  const Eigen::Index size = data.X.cols();
  Eigen::MatrixXd covariance = data.X.transpose() * data.X / static_cast<double>(data.X.rows());
  covariance.diagonal().array() += kLeastRegressorVariance;
  const Eigen::MatrixXd factor = covariance.llt().matrixL().solve(Eigen::MatrixXd::Identity(size, size));
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) range.decorrelation.push_back(factor(i, j));
  range.distance = std::sqrt((data.X * factor.transpose()).rowwise().squaredNorm().maxCoeff());
  return range;
}

/// Cuts all steps into parts of equal length, and parts at the starts of pieces.
std::vector<std::vector<StepRange>> parts_of(const SampledSignals& signals, std::uint32_t parts) {
  std::vector<std::vector<StepRange>> all(parts);
  for (std::size_t p = 0; p < parts; ++p) {
    std::size_t first = signals.size() * p / parts;
    const std::size_t last = signals.size() * (p + 1) / parts;
    for (const std::size_t start : signals.starts) {
      if (start <= first || start >= last) continue;
      all[p].push_back({first, start});
      first = start;
    }
    if (first < last) all[p].push_back({first, last});
  }
  return all;
}

std::vector<StepRange> all_but(const std::vector<std::vector<StepRange>>& parts, std::size_t left_out) {
  std::vector<StepRange> rest;
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (p != left_out) rest.insert(rest.end(), parts[p].begin(), parts[p].end());
  return rest;
}

double root_mean(double sum, std::size_t count) {
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : HUGE_VAL;
}

double compared(const Candidate& candidate, bool free_run) {
  return free_run ? candidate.error.free_run : candidate.error.one_step;
}

/// The simplest whose error is close to the least.
std::size_t choose(std::span<const Candidate> candidates, const SelectionOptions& options) {
  double least = HUGE_VAL;
  for (const Candidate& each : candidates) least = std::min(least, compared(each, options.free_run));
  std::size_t chosen = candidates.size();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!(compared(candidates[i], options.free_run) <= (1.0 + options.indifference) * least)) continue;
    if (chosen == candidates.size() || candidates[i].structure.weights() < candidates[chosen].structure.weights())
      chosen = i;
  }
  return chosen;
}

}  // namespace

Regression fit(const Structure& structure, const SampledSignals& signals, std::span<const StepRange> ranges,
               const FitOptions& options) {
  Regression model{.structure = structure};
  Design design;
  for_each_row(structure, signals, ranges, [&](std::span<const double> regressors, double output) {
    design.regressors.insert(design.regressors.end(), regressors.begin(), regressors.end());
    design.outputs.push_back(output);
  });
  if (design.outputs.size() < structure.weights()) return model;
  for (std::size_t i = 0; i < structure.regressors(); ++i)
    model.scales.push_back(scale_of(design.regressors, i, structure.regressors()));
  model.output = scale_of(design.outputs, 0, 1);
  const Scaled all = scaled(model, design, 1);
  model.range = range_of(all, design);
  Eigen::VectorXd weights = linear_weights(all, options.decay);
  if (structure.hidden > 0) {
    weights = first_weights(structure, weights, options.seed);
    const std::size_t most = std::max(options.most_samples, 2 * structure.weights());
    const std::size_t every = (design.outputs.size() + most - 1) / most;
    const Scaled thinned = scaled(model, design, every);
    Residuals residuals(structure, thinned, options.decay);
    Eigen::LevenbergMarquardt<Residuals> solver(residuals);
    solver.parameters.maxfev = options.evaluations;
    solver.minimize(weights);
  }
  model.weights.assign(weights.data(), weights.data() + weights.size());
  return model;
}

SquaredErrors errors_of(const Regression& model, const SampledSignals& signals, std::span<const StepRange> ranges) {
  SquaredErrors errors;
  for (const bool free_run : {false, true}) {
    double& sum = free_run ? errors.free_run : errors.one_step;
    std::size_t& steps = free_run ? errors.free_steps : errors.one_steps;
    ModelRun run(model, free_run);
    for (const StepRange& range : ranges) {
      run.restart();
      for (std::size_t k = range.first; k < range.last; ++k) {
        const double output = signals.output_at(k);
        const auto prediction = run.step(signals.inputs_at(k), output);
        if (!prediction || !std::isfinite(output)) continue;
        sum += (prediction->value - output) * (prediction->value - output);
        ++steps;
      }
    }
    if (!std::isfinite(sum)) sum = HUGE_VAL;
  }
  return errors;
}

Selection select_structure(std::span<const Structure> structures, const SampledSignals& signals,
                           const SelectionOptions& options, base::ThreadPool& thread_pool) {
  const auto parts = parts_of(signals, options.folds);
  std::vector<SquaredErrors> errors(structures.size() * options.folds);
  std::atomic<std::size_t> done = 0;
  std::atomic<bool> stopped = false;
  thread_pool.parallel_for_each(errors.size(), 1, [&](std::size_t job, unsigned thread) {
    if (stopped) return;
    const std::size_t part = job % options.folds;
    const Regression model = fit(structures[job / options.folds], signals, all_but(parts, part), options.fit);
    errors[job] =
        model.weights.empty() ? SquaredErrors{HUGE_VAL, HUGE_VAL, 1, 1} : errors_of(model, signals, parts[part]);
    ++done;
    if (thread == 0 && options.progress &&
        !options.progress(static_cast<double>(done) / static_cast<double>(errors.size() + 1)))
      stopped = true;
  });
  Selection selection;
  for (std::size_t i = 0; i < structures.size(); ++i) {
    SquaredErrors sum;
    for (std::size_t part = 0; part < options.folds; ++part) {
      const SquaredErrors& each = errors[i * options.folds + part];
      sum.one_step += each.one_step, sum.one_steps += each.one_steps;
      sum.free_run += each.free_run, sum.free_steps += each.free_steps;
    }
    selection.candidates.push_back({structures[i],
                                    {root_mean(sum.one_step, sum.one_steps), root_mean(sum.free_run, sum.free_steps)},
                                    options.free_run ? sum.free_steps : sum.one_steps});
  }
  selection.chosen = choose(selection.candidates, options);
  if (stopped || selection.chosen == structures.size()) return selection;
  std::vector<StepRange> everything = all_but(parts, parts.size());
  selection.model = fit(structures[selection.chosen], signals, everything, options.fit);
  selection.model.error = selection.candidates[selection.chosen].error;
  return selection;
}

}  // namespace sf::estimation
