// Plots of sweeps from tables of jobs, checked by their shapes.

#include "scenarios/sweep_plots.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "base/error.h"
#include "base/files.h"
#include "scenarios/sweep_jobs.h"
#include "tests/refusal.h"

namespace sf::scenarios {
namespace {

namespace fs = std::filesystem;

std::string plots_folder(const std::string& name) {
  const std::string path = testing::TempDir() + name;
  fs::remove_all(path);
  return path;
}

/// Returns rows of `job,point,PARAMETERS,seed,status,x,simulated_s,hash,message`: two seeds with 1 and 3 times the
/// number of a point.
std::string table(const std::string& parameters, const std::vector<std::string>& points) {
  std::string text = "job,point," + parameters + ",seed,status,x,simulated_s,hash,message\n";
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const int seed : {1, 2})
      text +=
          fmt::format("{},{},{},{},pass,{},1,00,\n", 2 * i + seed - 1, i, points[i], seed, (i + 1) * (2 * seed - 1));
  return text;
}

/// Returns the names of the drawn files and the text of each.
std::vector<std::pair<std::string, std::string>> drawn(const std::string& jobs, const SweepPlotChoice& choice = {}) {
  SweepPlotChoice svg = choice;
  svg.format = "svg";
  std::vector<std::pair<std::string, std::string>> files;
  for (const std::string& file : draw_sweep("jobs.csv", jobs, plots_folder("sweep_plots"), svg).files)
    files.emplace_back(fs::path(file).stem(), base::read_text(file));
  return files;
}

bool has_text(const std::string& svg, const std::string& text) {
  return svg.find(">" + text + "<") != std::string::npos;
}

/// Returns all texts, joined so that texts of several lines are found.
std::string words_of(const std::string& svg) {
  std::string words;
  for (std::size_t at = svg.find("<text "); at != std::string::npos; at = svg.find("<text ", at + 1)) {
    const std::size_t from = svg.find('>', at) + 1;
    words += (words.empty() ? "" : " ") + svg.substr(from, svg.find("</text>", from) - from);
  }
  return words;
}

TEST(SweepPlots, OneParameterIsALineWithIntervals) {
  const auto files = drawn(table("link.delay", {"0", "0.5", "1"}));
  ASSERT_EQ(files.size(), 2u) << "the metric, and the fraction of met expectations";
  EXPECT_EQ(files[0].first, "x");
  EXPECT_EQ(files[1].first, "met");
  EXPECT_TRUE(has_text(files[0].second, "link.delay [s]")) << "with its unit";
  EXPECT_TRUE(has_text(files[0].second, "0.5")) << "a tick at the swept value";
  EXPECT_NE(files[0].second.find("mean and 95 % interval (Student's t), n = 2 per point"), std::string::npos);
  EXPECT_NE(files[1].second.find("(Wilson)"), std::string::npos);
}

TEST(SweepPlots, TwoParametersAreLinesAndSmallMultiples) {
  const auto files = drawn(table("default.settings.kp,link.loss", {"1,-0.5", "1,0.5", "2,-0.5", "2,0.5"}));
  ASSERT_EQ(files.size(), 4u);
  EXPECT_EQ(files[0].first, "x");
  EXPECT_EQ(files[1].first, "x_multiples");
  for (int i : {0, 1}) {
    EXPECT_TRUE(has_text(files[i].second, "loss = \u22120.5")) << "a true minus sign";
    EXPECT_TRUE(has_text(files[i].second, "default.settings.kp"));
  }
  EXPECT_NE(files[0].second.find("stroke-dasharray"), std::string::npos) << "known without colours";
  SweepPlotChoice solid;
  solid.page.line_styles = false;
  EXPECT_EQ(drawn(table("kp,loss", {"1,0", "1,1", "2,0", "2,1"}), solid)[0].second.find("stroke-dasharray"),
            std::string::npos);
}

TEST(SweepPlots, TheAxisCanBeSelected) {
  const std::string two = table("a,b", {"1,5", "1,6", "2,5", "2,6"});
  EXPECT_TRUE(has_text(drawn(two)[0].second, "a"));
  EXPECT_TRUE(has_text(drawn(two, {.over = "b"})[0].second, "b"));
  EXPECT_THROW(drawn(two, {.over = "c"}), base::InputError) << "no such parameter";
  EXPECT_TRUE(has_text(drawn(table("name,b", {"ideal,5", "ideal,6", "thesis,5", "thesis,6"}))[0].second, "b"))
      << "numbers before words";
}

TEST(SweepPlots, TextValuesAreCategories) {
  const auto files = drawn(table("plant", {"ideal", "thesis", "\"a, b\""}));
  for (const char* word : {"ideal", "thesis", "a, b"}) EXPECT_TRUE(has_text(files[0].second, word)) << word;
}

/// Three points of two parameters are not a grid: dots over each parameter.
TEST(SweepPlots, ASampleIsDrawnOverEachParameter) {
  const auto files = drawn(table("a,b", {"0.1,7", "0.2,9", "0.3,8"}));
  ASSERT_EQ(files.size(), 4u);
  EXPECT_EQ(files[0].first, "x_over_a");
  EXPECT_EQ(files[1].first, "x_over_b");
}

TEST(SweepPlots, ThreeParametersAreSmallMultiplesUpToALimit) {
  std::vector<std::string> points;
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b)
      for (int c = 0; c < 30; ++c) points.push_back(fmt::format("{},{},{}", a, b, c));
  const SweepPlots plots = draw_sweep("jobs.csv", table("a,b,c", points), plots_folder("three"), {.format = "svg"});
  ASSERT_EQ(plots.files.size(), 2u);
  ASSERT_EQ(plots.notes.size(), 2u) << "omitted parts are listed";
  EXPECT_NE(plots.notes[0].find("x: the first 24 of 30"), std::string::npos) << plots.notes[0];
}

TEST(SweepPlots, NonFiniteResultsAreCounted) {
  std::string jobs = table("a", {"1", "2"});
  jobs.replace(jobs.find("pass,1,1"), 8, "pass,inf,1");
  jobs.replace(jobs.find("pass,3,1"), 8, "pass,,1");
  const std::string text = words_of(drawn(jobs)[0].second);
  EXPECT_NE(text.find("n = 0 to 2 per point; 2 jobs without a finite value left out"), std::string::npos) << text;
}

TEST(SweepPlots, GeometricValuesHaveALogarithmicAxis) {
  for (const auto& [values, geometric] : {std::pair{std::vector{1.0, 2.0, 4.0, 8.0}, true},
                                          {{1, 2, 5, 10}, true},
                                          {{0.001, 0.01, 0.1}, true},
                                          {{8, 1, 4, 2}, true},      // in any order
                                          {{1, 2, 4, 7.9}, false},   // too small a range
                                          {{1, 10}, false},          // two values have only one ratio
                                          {{0, 1, 10, 100}, false},  // zero has no logarithm
                                          {{1, 5, 10}, false},       // 5 and 2
                                          {{1, 2, 3, 4, 5, 6, 7, 8, 9}, false}})
    EXPECT_EQ(viz::is_geometric(values), geometric) << fmt::format("{}", fmt::join(values, " "));
  const std::string zero = table("a", {"0", "1", "2"});
  EXPECT_THROW(drawn(zero, {.x_axis = viz::AxisScale::logarithmic}), base::InputError);
  EXPECT_TRUE(has_text(drawn(table("a", {"0.00001", "0.001", "0.1"}))[0].second, "10⁻⁵"));
}

TEST(SweepPlots, ReportsThatThereIsNothingToDraw) {
  const SweepPlots plots = draw_sweep("jobs.csv", table("a", {"1"}), plots_folder("nothing"), {});
  EXPECT_TRUE(plots.files.empty());
  ASSERT_EQ(plots.notes.size(), 1u);
}

TEST(SweepJobs, ReadsItsTableBack) {
  const SweepJobs jobs = read_sweep_jobs(
      "jobs.csv",
      "job,point,seed,\"a\"\"b\",seed,status,x,y,simulated_s,hash,message\n"
      "0,0,1,\"p,\nq\",7,pass,1.5,,2,ff,\n1,0,1,\"p,\nq\",8,failed,,,,,\"it said \"\"no\"\", twice\"\n");
  EXPECT_EQ(jobs.parameters, (std::vector<std::string>{"seed", "a\"b"})) << "a parameter may be called seed";
  EXPECT_EQ(jobs.metrics, (std::vector<std::string>{"x", "y"}));
  ASSERT_EQ(jobs.points.size(), 1u);
  EXPECT_EQ(jobs.points[0].values[1], "p,\nq");
  EXPECT_EQ(jobs.points[0].status, (std::vector<std::string>{"pass", "failed"}));
  EXPECT_EQ(jobs.points[0].metrics[0][0], 1.5);
  EXPECT_TRUE(std::isnan(jobs.points[0].metrics[1][0]) && std::isnan(jobs.points[0].metrics[0][1]));
}

TEST(SweepJobs, DamageIsReportedWithItsLine) {
  const std::string head = "job,point,a,seed,status,x,simulated_s,hash,message\n";
  const auto error = [&](const std::string& text) { return refusal_of([&] { read_sweep_jobs("jobs.csv", text); }); };
  EXPECT_NE(error("time,x\n").find("jobs.csv:1: is not a sweep's table"), std::string::npos);
  EXPECT_NE(error(head + "0,0,1\n").find("jobs.csv:2: has 3 fields; expected 9"), std::string::npos);
  EXPECT_NE(error(head + "0,0,1,1,pass,one,1,ff,\n").find("jobs.csv:2: 'one' of x is not a number"), std::string::npos);
  EXPECT_EQ(error(head), "") << "a sweep whose jobs are all to come";
}

}  // namespace
}  // namespace sf::scenarios
