#pragma once
// A model of a signal, learnt from data: the present value of an output from the last values of its inputs and of the
// output itself.
//
//   y(k) = f(u(k), ..., u(k - inputs_lags + 1), y(k - 1), ..., y(k - output_lags))
//
// f is linear (with output lags: ARX), or linear plus one layer of sigmoids (with output lags: NARX; without: a
// feed-forward network). References: L. Ljung, System Identification, 2nd edition, 1999; S. A. Billings, Nonlinear
// System Identification, 2013.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sf::estimation {

/// Limits of a model that is read from a file.
inline constexpr std::size_t kMostRegressors = 256, kMostHidden = 64, kMostLags = 64;

/// Which values a model uses.
struct Structure {
  std::uint32_t inputs = 1;       ///< >= 1 signals
  std::uint32_t input_lags = 1;   ///< >= 1: the present value and those before
  std::uint32_t output_lags = 0;  ///< values of the output before the present one
  std::uint32_t hidden = 0;       ///< sigmoids; 0: linear

  std::size_t regressors() const { return std::size_t{inputs} * input_lags + output_lags; }
  /// Number of weights: offset and one per regressor; per sigmoid its weight, its offset and one per regressor.
  std::size_t weights() const { return 1 + regressors() + hidden * (2 + regressors()); }
  bool operator==(const Structure&) const = default;
};

/// Scales values to a mean of 0 and a standard deviation of 1.
struct Scale {
  double mean = 0.0;
  double deviation = 1.0;  ///< > 0
  double apply(double v) const { return (v - mean) / deviation; }
  double revert(double v) const { return mean + deviation * v; }
};

/// How far from the training data the regressors may lie: a box, and an ellipsoid around the mean.
struct TrainingRange {
  std::vector<double> least, most;    ///< per regressor, in its unit
  std::vector<double> decorrelation;  ///< row-major, lower triangle of a matrix that makes scaled regressors
                                      ///< uncorrelated, line by line
  double distance = 0.0;              ///< largest length of decorrelated regressors
  /// @param regressors in their units @param scaled the same after Scale::apply
  bool contains(std::span<const double> regressors, std::span<const double> scaled) const;
};

/// Root mean square errors on data that the model was not fitted to, in the output's unit.
struct ModelError {
  double one_step = 0.0;  ///< with measured values of the output before the present one
  double free_run = 0.0;  ///< with the model's own values instead; equal to `one_step` without output lags
};

struct Regression {
  Structure structure;
  std::vector<Scale> scales;  ///< per regressor
  Scale output;
  std::vector<double> weights;  ///< as `Structure::weights` says, on scaled values
  TrainingRange range;
  ModelError error;
};

/// x / sqrt(1 + x^2): in contrast to tanh, of exactly rounded operations, so that all machines give the same bits.
double sigmoid(double x);
/// d sigmoid / dx. @param value sigmoid(x)
double sigmoid_slope(double value);

/// Returns f of scaled regressors, scaled. @param weights Structure::weights
double evaluate(const Structure& structure, std::span<const double> weights, std::span<const double> scaled);

/// The last values of a model's signals.
class History {
 public:
  explicit History(const Structure& structure);

  /// Adds the present inputs. A value that is not finite clears the history, outputs included.
  void add_inputs(std::span<const double> inputs);
  /// Adds the output's present value, after `predict`.
  void add_output(double output);
  /// Sets all values of the output before the present one.
  void fill_outputs(double output);
  void clear();

  bool outputs_known() const { return outputs_known_ == structure_.output_lags; }
  /// True if the regressors of the next step are complete.
  bool complete() const { return inputs_known_ == structure_.input_lags && outputs_known(); }
  /// In the order of f's arguments, all inputs of one step together. @pre complete()
  std::span<const double> regressors() const { return values_; }

 private:
  Structure structure_;
  std::uint32_t inputs_known_ = 0, outputs_known_ = 0;
  std::vector<double> values_;
};

struct ModelPrediction {
  double value = 0.0;
  bool in_range = false;  ///< the regressors lie in the range of the training data
};

/// Computes a model step by step. In a free run the model uses its own values of the output, from the mean of the
/// training data on; otherwise it uses measured ones.
class ModelRun {
 public:
  /// `model` must outlive it.
  ModelRun(const Regression& model, bool free_run);

  /// Starts over.
  void restart();
  /// Computes the present output, before it is measured. Returns nullopt while earlier values are not known.
  /// @param inputs one per input of the model; values that are not finite are not known
  /// @param measured the present output, for the next steps; NaN: not known. Unused in a free run
  std::optional<ModelPrediction> step(std::span<const double> inputs, double measured);

 private:
  const Regression& model_;
  bool free_run_;
  History history_;
  std::vector<double> scaled_;
};

}  // namespace sf::estimation
