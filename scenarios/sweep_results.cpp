#include "scenarios/sweep_results.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/files.h"
#include "base/hash.h"
#include "base/number_text.h"
#include "scenarios/experiment.h"

namespace sf::scenarios {

namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> kStatusWords{"pass", "missed", "none", "failed"};
constexpr std::string_view kEnd = "end\n";  // the last line of a complete result

std::string in_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20; }, ' ');
  return text;
}

/// Writes numbers as the shortest text that is parsed to the same value.
std::string text_of_job(const JobResult& result) {
  std::string text = fmt::format("status\t{}\nmessage\t{}\nsimulated\t{}\nhash\t{}\n", word_of(result.status),
                                 in_one_line(result.message), result.simulated, result.hash);
  for (const Metric& metric : result.metrics)
    text += fmt::format("metric\t{}\t{}\n", in_one_line(metric.name),
                        std::isnan(metric.value) ? "" : fmt::format("{}", metric.value));
  return text + std::string(kEnd);
}

/// Returns the text up to `end`, and removes it and `end`.
std::string_view cut(std::string_view& text, char end) {
  const std::string_view part = text.substr(0, text.find(end));
  text.remove_prefix(std::min(part.size() + 1, text.size()));
  return part;
}

template <class Number>
bool read_number(std::string_view text, Number& value) {
  const std::optional<Number> read = base::number_of<Number>(text);
  value = read.value_or(value);
  return read.has_value();
}

bool read_metric(std::string_view text, JobResult& result) {
  Metric metric{std::string(cut(text, '\t')), std::numeric_limits<double>::quiet_NaN()};
  const bool fine = text.empty() || read_number(text, metric.value);
  result.metrics.push_back(std::move(metric));
  return fine;
}

bool read_line(std::string_view line, JobResult& result) {
  const std::string_view key = cut(line, '\t');
  if (key == "simulated") return read_number(line, result.simulated);
  if (key == "hash") return read_number(line, result.hash);
  if (key == "metric") return read_metric(line, result);
  if (key == "message") result.message = line;
  if (key != "status") return key == "message";
  const auto* const word = std::find(kStatusWords.begin(), kStatusWords.end(), line);
  if (word == kStatusWords.end()) return false;
  result.status = static_cast<JobStatus>(word - kStatusWords.begin());
  return true;
}

/// Returns a name that also distinguishes temporary files of processes on different machines.
std::string name_of_process() {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  return fmt::format("{}.{}", host.data(), getpid());
}

}  // namespace

std::string_view word_of(JobStatus status) { return kStatusWords[static_cast<std::size_t>(status)]; }

JobResult job_result_of(const ScenarioResult& result) {
  JobResult job{
      .status = JobStatus::passed, .simulated = result.simulated, .hash = result.hash, .metrics = result.metrics};
  if (result.status() == ScenarioStatus::no_expectations) job.status = JobStatus::no_expectations;
  for (const ExpectationResult& o : result.outcomes) {
    if (o.met) continue;
    job.status = JobStatus::missed;
    job.message +=
        fmt::format("{}{}: expected {}, got {}", job.message.empty() ? "" : "; ", o.what, o.expected, o.measured);
  }
  return job;
}

void write_whole(const std::string& path, std::string_view text) {
  const std::string part = fmt::format("{}.{}.part", path, name_of_process());
  write_text(part, std::string(text));
  std::error_code error;
  fs::rename(part, path, error);
  if (!error) return;
  fs::remove(part, error);
  throw base::InputError(path, 0, "cannot be written; name a writable folder");
}

SweepFolder::SweepFolder(const Sweep& sweep, std::string path) : path_(std::move(path)) {
  make_folder(file("jobs"));
  const std::string id = base::hash_hex(sweep.hash) + "\n";
  const std::string mark = file("sweep.id");
  if (!fs::exists(mark)) write_whole(mark, id);
  if (base::read_text(mark, 1u << 10) != id)
    throw base::InputError(path_, 0,
                           fmt::format("contains the results of another sweep, or of {} before it or its scenario "
                                       "changed; name another folder, or remove this one",
                                       sweep.file));
}

std::string SweepFolder::file(std::string_view name) const { return (fs::path(path_) / name).string(); }

std::string SweepFolder::job_file(std::uint64_t job) const {
  return file(fmt::format("jobs/{:03}/{:06}.txt", job / 1000, job));  // at most a thousand files in a folder
}

void SweepFolder::write(std::uint64_t job, const JobResult& result) const {
  const std::string path = job_file(job);
  make_folder(fs::path(path).parent_path().string());
  write_whole(path, text_of_job(result));
}

std::optional<JobResult> SweepFolder::read(std::uint64_t job) const {
  const std::string path = job_file(job);
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored) || fs::file_size(path, ignored) == 0) return std::nullopt;
  const std::string text = base::read_text(path, 1u << 20);
  std::string_view rest = text;
  if (!rest.ends_with(kEnd)) return std::nullopt;
  rest.remove_suffix(kEnd.size());
  JobResult result;
  while (!rest.empty())
    if (!read_line(cut(rest, '\n'), result)) return std::nullopt;
  return result;
}

}  // namespace sf::scenarios
