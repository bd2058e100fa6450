#include "scenarios/sweep_results.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "base/error.h"
#include "base/files.h"
#include "scenarios/sweep_tables.h"

namespace sf::scenarios {
namespace {

namespace fs = std::filesystem;

Sweep two_points(const std::string& more = "") {
  return parse_sweep(SF_SOURCE_DIR "/experiments/sweeps/test.toml",
                     "scenario = \"../simville.toml\"\nseeds = 2\n" + more + "[grid]\nlabel = [\"a, b\", \"c|d\"]\n");
}

std::string empty_folder(const std::string& name) {
  const std::string path = testing::TempDir() + name;
  fs::remove_all(path);
  return path;
}

JobResult result_of_job(JobStatus status, double x, double y) {
  return {.status = status, .simulated = 2.5, .hash = UINT64_MAX, .metrics = {{"x", x}, {"y of r1", y}}};
}

TEST(SweepFolder, ResultsRoundTripBitwise) {
  const SweepFolder folder(two_points(), empty_folder("results"));
  EXPECT_FALSE(folder.read(0).has_value());
  JobResult written = result_of_job(JobStatus::missed, 0.1 + 0.2, std::nan(""));
  written.metrics.push_back({"infinite", -std::numeric_limits<double>::infinity()});
  written.metrics.push_back({"smallest", std::numeric_limits<double>::denorm_min()});
  written.message = "two\nlines\tand a tab";
  for (const std::uint64_t job : {std::uint64_t{0}, std::uint64_t{999}, std::uint64_t{1000}, kMostJobs - 1}) {
    folder.write(job, written);
    const std::optional<JobResult> read = folder.read(job);
    ASSERT_TRUE(read.has_value()) << job;
    EXPECT_EQ(read->status, JobStatus::missed);
    EXPECT_EQ(read->message, "two lines and a tab");
    EXPECT_EQ(read->hash, UINT64_MAX);
    EXPECT_EQ(read->simulated, 2.5);
    ASSERT_EQ(read->metrics.size(), 4u);
    EXPECT_EQ(read->metrics[0].value, 0.1 + 0.2);
    EXPECT_TRUE(std::isnan(read->metrics[1].value));
    EXPECT_EQ(read->metrics[1].name, "y of r1");
    EXPECT_EQ(read->metrics[2].value, -std::numeric_limits<double>::infinity());
    EXPECT_EQ(read->metrics[3].value, std::numeric_limits<double>::denorm_min());
  }
}

TEST(SweepFolder, AFolderHasAThousandResults) {
  const SweepFolder folder(two_points(), empty_folder("thousand"));
  for (const std::uint64_t job : {999u, 1000u}) folder.write(job, result_of_job(JobStatus::passed, 1.0, 2.0));
  EXPECT_TRUE(fs::exists(folder.file("jobs/000/000999.txt")));
  EXPECT_TRUE(fs::exists(folder.file("jobs/001/001000.txt")));
}

/// As after a system crash or on a full disk: a truncated file is not a result.
TEST(SweepFolder, ATruncatedResultIsIgnored) {
  const SweepFolder folder(two_points(), empty_folder("parts"));
  folder.write(3, result_of_job(JobStatus::passed, 1.0, 2.0));
  const std::string file = folder.file("jobs/000/000003.txt");
  const std::string whole = base::read_text(file);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << whole.substr(0, size);
    EXPECT_FALSE(folder.read(3).has_value()) << size;
  }
  for (const char* wrong : {"status\tgood\nend\n", "metric\tx\tmuch\nend\n", "hash\t-1\nend\n", "unknown\t1\nend\n"}) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << wrong;
    EXPECT_FALSE(folder.read(3).has_value()) << wrong;
  }
}

TEST(SweepFolder, AnotherSweepIsRejected) {
  const std::string path = empty_folder("mine");
  const SweepFolder folder(two_points(), path);
  EXPECT_NO_THROW(SweepFolder(two_points(), path));
  EXPECT_THROW(SweepFolder(two_points("name = \"other\"\n"), path), base::InputError);
  EXPECT_THROW(SweepFolder(two_points(), "/proc/none"), base::InputError);
}

TEST(SweepFolder, LeavesNoOtherFiles) {
  const SweepFolder folder(two_points(), empty_folder("tidy"));
  folder.write(0, result_of_job(JobStatus::passed, 1.0, 2.0));
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path())) files += entry.is_regular_file() ? 1 : 0;
  EXPECT_EQ(files, 2u) << "the mark and the result";
}

TEST(SweepFolder, AFileThatCannotBeReplacedLeavesNoPart) {
  const std::string path = empty_folder("not_replaced");
  fs::create_directories(path + "/file/that_is_a_folder");
  EXPECT_THROW(write_whole(path + "/file", "text"), base::InputError);
  EXPECT_EQ(std::distance(fs::directory_iterator(path), {}), 1);
}

/// Returns each row of points.csv up to its column `met`, and the numbers after it.
std::vector<std::pair<std::string, std::vector<double>>> table_rows(const std::string& text) {
  std::vector<std::pair<std::string, std::vector<double>>> rows;
  for (std::size_t at = text.find('\n') + 1; at < text.size(); at = text.find('\n', at) + 1) {
    const std::string row = text.substr(at, text.find('\n', at) - at);
    std::size_t from = row.size();
    for (int k = 0; k < 8; ++k) from = row.rfind(',', from - 1);
    std::vector<double> numbers;
    for (std::size_t k = from; k != std::string::npos; k = row.find(',', k + 1))
      numbers.push_back(std::strtod(row.c_str() + k + 1, nullptr));
    rows.emplace_back(row.substr(0, from), numbers);
  }
  return rows;
}

TEST(SweepTables, OneRowPerJobAndStatisticsPerPoint) {
  const Sweep sweep = two_points();
  std::vector<std::optional<JobResult>> results(4);
  results[0] = result_of_job(JobStatus::passed, 1.0, std::nan(""));
  results[1] = result_of_job(JobStatus::missed, 4.0, std::nan(""));
  results[1]->message = "x: expected <= 2, got 4";
  results[2] = JobResult{.message = "it said \"no\""};
  EXPECT_EQ(csv_of_jobs(sweep, results),
            "job,point,label,seed,status,x,y of r1,simulated_s,hash,message\n"
            "0,0,\"a, b\",1,pass,1,,2.5,ffffffffffffffff,\n"
            "1,0,\"a, b\",2,missed,4,,2.5,ffffffffffffffff,\"x: expected <= 2, got 4\"\n"
            "2,1,c|d,1,failed,,,,,\"it said \"\"no\"\"\"\n"
            "3,1,c|d,2,missing,,,,,\n");
  // Mean 2.5, deviation 1.5 sqrt(2), half an interval 12.7062 times 1.5; empty if no job has a value. One job of two
  // met its expectations, and none of one.
  const std::string text = csv_of_points(sweep, results);
  EXPECT_EQ(text.substr(0, text.find('\n')),
            "point,label,jobs,pass,missed,none,failed,missing,x_mean,x_std,x_min,x_max,y of r1_mean,y of r1_std,y of "
            "r1_min,y of r1_max,met,met_low95,met_high95,x_n,x_low95,x_high95,y of r1_n,y of r1_low95,y of r1_high95");
  const auto rows = table_rows(text);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].first, "0,\"a, b\",2,1,1,0,0,0,2.5,2.1213203435596424,1,4,,,,,0.5");
  EXPECT_EQ(rows[1].first, "1,c|d,2,0,0,0,1,1,,,,,,,,,0");
  EXPECT_NEAR(rows[0].second[0], 0.09453, 1e-5);  // Wilson, 1 of 2
  EXPECT_NEAR(rows[0].second[1], 0.90547, 1e-5);
  EXPECT_EQ(rows[0].second[2], 2.0);
  EXPECT_NEAR(rows[0].second[3], 2.5 - 1.5 * 12.70620473617471, 1e-9);
  EXPECT_NEAR(rows[0].second[4], 2.5 + 1.5 * 12.70620473617471, 1e-9);
  EXPECT_EQ(rows[0].second[5], 0.0) << "no value of y";
  EXPECT_NEAR(rows[1].second[1], 0.79345, 1e-5);  // 0 of 1
  EXPECT_TRUE(missing_values(results, 10).empty()) << "no job has a y";
  results[0]->metrics[1].value = std::numeric_limits<double>::infinity();
  results[3] = result_of_job(JobStatus::passed, 1.0, 2.0);
  EXPECT_EQ(missing_values(results, 10),
            (std::vector<std::string>{"job 0: y of r1 is inf", "job 1: y of r1 is empty"}));
  EXPECT_EQ(missing_values(results, 1).back(), "and 1 more, in jobs.csv");
  results[0]->metrics[1].value = std::nan("");
  results[3].reset();
  EXPECT_EQ(markdown_of_points(sweep, results, 1),
            "| point | label | pass | missed | failed | missing | x |\n|---|---|---|---|---|---|---|\n"
            "| 0 | a, b | 1 | 1 | 0 | 0 | 2.5 ± 2.1 |\n\nMore in points.csv: 1 point.\n");
  EXPECT_EQ(job_counts_text(counts_of(results)), "4 jobs: 1 pass, 1 missed, 1 failed, 1 missing");
  EXPECT_FALSE(counts_of(results).good());
}

TEST(SweepTables, EqualValuesHaveNoDeviationAndBarsAreReplaced) {
  const std::vector<std::optional<JobResult>> results(4, result_of_job(JobStatus::passed, 0.1, 2.0));
  EXPECT_EQ(markdown_of_points(two_points(), results, 2),
            "| point | label | pass | missed | failed | missing | x | y of r1 |\n|---|---|---|---|---|---|---|---|\n"
            "| 0 | a, b | 2 | 0 | 0 | 0 | 0.1 | 2 |\n| 1 | c/d | 2 | 0 | 0 | 0 | 0.1 | 2 |\n")
      << "all points are shown: there are none more";
}

TEST(SweepTables, AReportListsUpToTenSeedsAndAThousandPoints) {
  const auto report = [](const std::string& more) {
    const Sweep sweep =
        parse_sweep(SF_SOURCE_DIR "/experiments/sweeps/test.toml", "scenario = \"../simville.toml\"\n" + more);
    const std::vector<std::string> files = write_sweep_tables(sweep, SweepFolder(sweep, empty_folder("report")),
                                                              std::vector<std::optional<JobResult>>(sweep.jobs()));
    return base::read_text(files.at(2));
  };
  EXPECT_NE(report("seeds = 10\n").find(", seeds 1, 2, 3, 4, 5, 6, 7, 8, 9, 10. "), std::string::npos);
  EXPECT_NE(report("seeds = 11\n").find(", seeds 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, ... (11 in all). "), std::string::npos);
  const std::string grid = "[grid]\nduration = { from = 1, to = 2, count = ";
  EXPECT_EQ(report(grid + "1000 }\n").find("More in"), std::string::npos);
  EXPECT_NE(report(grid + "1001 }\n").find("\nMore in points.csv: 1 point.\n"), std::string::npos);
}

TEST(JobCounts, OnlyMissedFailedAndMissingJobsAreBad) {
  std::vector<std::optional<JobResult>> results{result_of_job(JobStatus::passed, 1.0, 1.0),
                                                result_of_job(JobStatus::no_expectations, 1.0, 1.0)};
  EXPECT_TRUE(counts_of(results).good());
  for (const auto& bad : {std::optional(result_of_job(JobStatus::missed, 1.0, 1.0)),
                          std::optional(JobResult{.status = JobStatus::failed}), std::optional<JobResult>()}) {
    results[0] = bad;
    EXPECT_FALSE(counts_of(results).good());
  }
}

TEST(JobResult, ExpectationsDecideItsStatus) {
  ScenarioResult result{.simulated = 1.0, .metrics = {{"contacts", 0.0}}};
  EXPECT_EQ(job_result_of(result).status, JobStatus::no_expectations);
  result.outcomes.push_back({.what = "a", .expected = "<= 1", .measured = "0", .met = true});
  EXPECT_EQ(job_result_of(result).status, JobStatus::passed);
  result.outcomes.push_back({.what = "b", .expected = "done", .measured = "not done"});
  EXPECT_EQ(job_result_of(result).status, JobStatus::missed);
  EXPECT_EQ(job_result_of(result).message, "b: expected done, got not done");
  EXPECT_EQ(job_result_of(result).metrics.size(), 1u);
  result.outcomes.push_back({.what = "c", .expected = ">= 3", .measured = "2"});
  EXPECT_EQ(job_result_of(result).message, "b: expected done, got not done; c: expected >= 3, got 2");
}

}  // namespace
}  // namespace sf::scenarios
