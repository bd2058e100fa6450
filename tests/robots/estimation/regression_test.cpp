// Learnt models: structures, fits, selection, and training ranges, on signals with known properties.

#include "robots/estimation/regression.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "base/thread_pool.h"
#include "robots/estimation/regression_fit.h"

namespace sf::estimation {

namespace {

double normal_of(std::uint64_t k, std::uint32_t which) {
  return base::random_normal({7, base::RandomStream::decision, 1, 0, k}, which)[0];
}

/// y(k) = 0.7 y(k-1) - 0.2 y(k-2) + 0.5 u(k) + 0.1 u(k-1) + noise
SampledSignals linear_process(std::size_t steps, double noise) {
  SampledSignals signals{.inputs = 1, .values = {}, .starts = {0}};
  double y1 = 0.0, y2 = 0.0, u1 = 0.0;
  for (std::size_t k = 0; k < steps; ++k) {
    const double u = normal_of(k, 0);
    const double y = 0.7 * y1 - 0.2 * y2 + 0.5 * u + 0.1 * u1 + noise * normal_of(k, 1);
    signals.values.insert(signals.values.end(), {u, y});
    y2 = y1, y1 = y, u1 = u;
  }
  return signals;
}

/// y = sin(u0) * u1, for u in (-2, 2)
SampledSignals product_of(std::size_t steps) {
  SampledSignals signals{.inputs = 2, .values = {}, .starts = {0}};
  for (std::size_t k = 0; k < steps; ++k) {
    const auto u = base::random_uniform({7, base::RandomStream::decision, 2, 0, k}, 0);
    const double a = 4.0 * u[0] - 2.0, b = 4.0 * u[1] - 2.0;
    signals.values.insert(signals.values.end(), {a, b, std::sin(a) * b});
  }
  return signals;
}

StepRange all_of(const SampledSignals& signals) { return {0, signals.size()}; }

}  // namespace

TEST(Regression, LinearFitFindsTheCoefficientsOfAProcessWithoutNoise) {
  const SampledSignals signals = linear_process(500, 0.0);
  const StepRange all = all_of(signals);
  const Regression model = fit({1, 2, 2, 0}, signals, {&all, 1}, {.decay = 0.0});
  const double expected[]{0.5, 0.1, 0.7, -0.2};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(model.weights[1 + i] * model.output.deviation / model.scales[i].deviation, expected[i], 1e-5) << i;
}

// One-step errors are the process' noise; free runs have the noise that the process has carried along.
TEST(Regression, ErrorsOfALinearProcessAreThoseOfItsNoise) {
  const SampledSignals signals = linear_process(20'000, 0.1);
  const StepRange first{0, 10'000}, second{10'000, 20'000};
  const Regression model = fit({1, 2, 2, 0}, signals, {&first, 1}, {});
  const SquaredErrors errors = errors_of(model, signals, {&second, 1});
  EXPECT_NEAR(std::sqrt(errors.one_step / 9998.0), 0.1, 0.003);
  // The impulse response of 1 / (1 - 0.7 z^-1 + 0.2 z^-2) has a squared norm of 1.5625.
  EXPECT_NEAR(std::sqrt(errors.free_run / 9999.0), 0.1 * std::sqrt(1.5625), 0.004);
}

TEST(Regression, SigmoidsFitWhatALinearModelCannot) {
  const SampledSignals signals = product_of(4000);
  const StepRange first{0, 3000}, second{3000, 4000};
  const auto error = [&](std::uint32_t hidden) {
    const Regression model = fit({2, 1, 0, hidden}, signals, {&first, 1}, {.decay = 1e-6});
    return std::sqrt(errors_of(model, signals, {&second, 1}).one_step / 1000.0);
  };
  EXPECT_GT(error(0), 0.8);  // of a standard deviation of 0.89
  EXPECT_LT(error(12), 0.08);
}

TEST(Regression, CrossValidationPrefersTheSimplestStructureThatSuffices) {
  const SampledSignals signals = linear_process(3000, 0.1);
  const Structure structures[]{{1, 1, 0, 0}, {1, 1, 1, 0}, {1, 2, 2, 0}, {1, 3, 3, 0}, {1, 3, 3, 3}};
  base::ThreadPool one(1), three(3);
  const Selection selection = select_structure(structures, signals, {}, one);
  EXPECT_EQ(selection.chosen, 2u);
  EXPECT_GT(selection.candidates[0].error.free_run, 2.0 * selection.model.error.free_run);
  EXPECT_NEAR(selection.model.error.one_step, 0.1, 0.01);
  EXPECT_EQ(select_structure(structures, signals, {}, three).model.weights, selection.model.weights);
}

// Cross-validation never predicts across the border of two recordings.
TEST(Regression, HistoriesEndWithTheirPiece) {
  SampledSignals signals = linear_process(40, 0.0);
  signals.starts = {0, 20};
  const StepRange ranges[]{{0, 20}, {20, 40}};
  const Regression model = fit({1, 2, 2, 0}, signals, ranges, {});
  EXPECT_EQ(errors_of(model, signals, ranges).one_steps, 2u * (20 - 2));
  EXPECT_EQ(errors_of(model, signals, ranges).free_steps, 2u * (20 - 1));
}

TEST(Regression, SamplesThatAreNotKnownAreLeftOut) {
  SampledSignals signals = linear_process(100, 0.0);
  signals.values[2 * 50 + 1] = NAN;  // an output: no target at 50, no regressor at 51 and 52
  const StepRange all = all_of(signals);
  const Regression model = fit({1, 2, 2, 0}, signals, {&all, 1}, {});
  EXPECT_EQ(errors_of(model, signals, {&all, 1}).one_steps, 98u - 3);
  EXPECT_EQ(errors_of(model, signals, {&all, 1}).free_steps, 99u - 1);  // free runs bridge it
  for (const double weight : model.weights) EXPECT_TRUE(std::isfinite(weight));
}

TEST(Regression, FewerSamplesThanWeightsGiveNoModel) {
  const SampledSignals signals = linear_process(6, 0.0);
  const StepRange all = all_of(signals);
  EXPECT_TRUE(fit({1, 2, 2, 0}, signals, {&all, 1}, {}).weights.empty());
  base::ThreadPool one(1);
  const Structure structure{1, 2, 2, 0};
  EXPECT_TRUE(select_structure({&structure, 1}, signals, {}, one).model.weights.empty());
}

// Two inputs that are always equal: a sample within the box of each may still be unlike all others.
TEST(Regression, RangeIsABoxAndAnEllipsoid) {
  SampledSignals signals{.inputs = 2, .values = {}, .starts = {0}};
  for (std::size_t k = 0; k < 200; ++k) {
    const double u = normal_of(k, 0);
    signals.values.insert(signals.values.end(), {u, u + 0.01 * normal_of(k, 1), 2.0 * u});
  }
  const StepRange all = all_of(signals);
  const Regression model = fit({2, 1, 0, 0}, signals, {&all, 1}, {});
  const auto in_range = [&](double a, double b) {
    const double inputs[]{a, b};
    return ModelRun(model, true).step(inputs, 0.0)->in_range;
  };
  EXPECT_TRUE(in_range(0.5, 0.5));
  EXPECT_FALSE(in_range(0.5, -0.5));
  EXPECT_FALSE(in_range(50.0, 50.0));
}

TEST(Regression, HistoryStartsOverAfterAnInputThatIsNotKnown) {
  History history({1, 2, 0, 0});
  const double one = 1.0, unknown = NAN;
  history.add_inputs({&one, 1});
  history.add_inputs({&one, 1});
  EXPECT_TRUE(history.complete());
  history.add_inputs({&unknown, 1});
  EXPECT_FALSE(history.complete());
}

TEST(Regression, SlopeIsTheDerivativeOfTheSigmoid) {
  for (const double x : {-30.0, -1.0, 0.0, 0.3, 5.0})
    EXPECT_NEAR(sigmoid_slope(sigmoid(x)), (sigmoid(x + 1e-5) - sigmoid(x - 1e-5)) / 2e-5, 1e-9) << x;
}

}  // namespace sf::estimation
