#pragma once
// Fits regressions to samples of signals, and chooses their structure by cross-validation.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "robots/estimation/regression.h"

namespace sf::base {
class ThreadPool;
}

namespace sf::estimation {

/// Signals at equal steps of time, in one or more pieces, such as one per recording.
struct SampledSignals {
  std::uint32_t inputs = 1;
  std::vector<double> values;       ///< per step: the inputs, then the output; NaN: not known
  std::vector<std::size_t> starts;  ///< first step of each piece, ascending; the first is 0

  std::size_t size() const { return values.size() / (inputs + 1); }
  std::span<const double> inputs_at(std::size_t step) const { return {&values[step * (inputs + 1)], inputs}; }
  double output_at(std::size_t step) const { return values[step * (inputs + 1) + inputs]; }
};

struct FitOptions {
  std::uint64_t seed = 1;           ///< of the first weights
  double decay = 1e-4;              ///< >= 0 penalty of squared weights, relative to the mean squared scaled error
  std::size_t most_samples = 3000;  ///< to which sigmoids are fitted: more are thinned out evenly
  int evaluations = 60;             ///< > 0 of the error, by Levenberg-Marquardt
};

/// Steps [first, last) of one piece.
struct StepRange {
  std::size_t first, last;
};

/// Returns a regression without `error`: least squares for a linear one, else Levenberg-Marquardt from there.
/// @return one whose weights are empty if there are fewer samples than weights
Regression fit(const Structure& structure, const SampledSignals& signals, std::span<const StepRange> ranges,
               const FitOptions& options);

/// The squared errors of a model.
struct SquaredErrors {
  double one_step = 0.0, free_run = 0.0;  ///< sums; infinite if a free run diverges
  std::size_t one_steps = 0, free_steps = 0;
};
/// A free run begins with the mean of the training data as the output's values before it.
SquaredErrors errors_of(const Regression& model, const SampledSignals& signals, std::span<const StepRange> ranges);

/// A structure with its errors on the folds that it was not fitted to.
struct Candidate {
  Structure structure;
  ModelError error;
  std::size_t samples = 0;
};

struct SelectionOptions {
  FitOptions fit;
  std::uint32_t folds = 5;     ///< >= 2 parts of equal length, each in the order of time
  bool free_run = true;        ///< choose by the error of free runs, else by that of one step
  double indifference = 0.02;  ///< a simpler structure is preferred if its error is larger by no more than this share
  std::function<bool(double)> progress;  ///< receives the completed fraction; returns false to stop; may be empty
};

struct Selection {
  std::vector<Candidate> candidates;  ///< like the given structures
  std::size_t chosen = 0;
  Regression model;  ///< fitted to all samples; its error is that of the folds. Without weights: too few samples, or
                     ///< stopped
};

/// Deterministic for any number of threads. @param structures not empty
Selection select_structure(std::span<const Structure> structures, const SampledSignals& signals,
                           const SelectionOptions& options, base::ThreadPool& thread_pool);

}  // namespace sf::estimation
