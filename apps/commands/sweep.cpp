// `sweep`: runs a scenario over a grid or a sample of its parameters, in processes, by shares or as a Slurm job array.

#include "scenarios/sweep.h"
#include "apps/options/open_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <thread>

#include "apps/commands/commands.h"
#include "apps/processes/job_processes.h"
#include "apps/processes/slurm.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "scenarios/sweep_plots.h"
#include "scenarios/sweep_results.h"
#include "scenarios/sweep_tables.h"

namespace sf::apps {

namespace {

namespace fs = std::filesystem;
using scenarios::JobResult;
using scenarios::JobStatus;
using scenarios::Sweep;
using scenarios::SweepFolder;
using Jobs = std::vector<std::uint64_t>;
using Results = std::vector<std::optional<JobResult>>;

constexpr std::size_t kRowsShown = 50;  // rows of the table on standard output

Share share_of(const SweepOptions& options) {
  if (!options.share.empty()) return *read_share(options.share);
  return share_of_slurm_step().value_or(Share{});
}

unsigned processes_of(const SweepOptions& options) {
  if (options.jobs > 0) return options.jobs;
  return slurm_cpus().value_or(std::max(1u, std::thread::hardware_concurrency()));
}

/// Reads the results of all jobs.
Results read_results(const Sweep& sweep, const SweepFolder& folder) {
  Results results(sweep.jobs());
  for (std::uint64_t job = 0; job < results.size(); ++job) results[job] = folder.read(job);
  return results;
}

/// Jobs without a result; with `--retry`, also failed jobs.
Jobs pending_jobs(const SweepOptions& options, const Results& results, const Share& share) {
  Jobs jobs;
  for (std::uint64_t job = share.index; job < results.size(); job += share.count)
    if (!results[job] || (options.retry && results[job]->status == JobStatus::failed)) jobs.push_back(job);
  return jobs;
}

/// Checks the scenarios in a child process, since this creates controllers. @throws base::InputError also if a
/// controller ends the process
void check_in_process(const SweepOptions& options, const Sweep& sweep) {
  const auto check = [&] { print_warnings(sweep.scenario, check_sweep(sweep)); };
  if (options.in_process) return check();
  run_in_processes(1, 1,
                   {.begin = [] {},
                    .run = [&](std::size_t) { check(); },
                    .died = [&](std::size_t, const std::string& why) { throw base::InputError(options.file, 0, why); },
                    .wait = [](std::size_t) {},
                    .stop = [] { return false; },
                    .own_processes = true});
}

int list_points(const Sweep& sweep) {
  std::string text = fmt::format("{}: {} x {} = {}\n", sweep.name, counted(sweep.points(), "point"),
                                 counted(sweep.seeds.size(), "seed"), counted(sweep.jobs(), "job"));
  for (std::uint64_t point = 0; point < std::min<std::uint64_t>(sweep.points(), kRowsShown); ++point) {
    const std::vector<std::size_t> rows = scenarios::rows_at(sweep, point);
    std::vector<std::string> values;
    for (std::size_t i = 0; i < rows.size(); ++i)
      values.push_back(fmt::format("{} = {}", sweep.parameters[i].name,
                                   scenarios::parameter_value_text(sweep.parameters[i].values[rows[i]])));
    text += fmt::format("{:>6}  {}\n", point, fmt::join(values, ", "));
  }
  if (sweep.points() > kRowsShown) text += fmt::format("{} points more\n", sweep.points() - kRowsShown);
  print(text);
  return 0;
}

JobResult run_job(const Sweep& sweep, std::uint64_t job, gpu::Device& device, unsigned threads) {
  try {
    return job_result_of(run_scenario(scenario_of(sweep, job), device, {}, threads));
  } catch (const base::DeviceError&) {
    throw;
  } catch (const std::exception& error) {
    return {.message = error.what()};
  }
}

/// @return false if interrupted
bool run_jobs(const SweepOptions& options, const Sweep& sweep, const SweepFolder& folder, const Jobs& jobs,
              bool replace) {
  const unsigned processes = processes_of(options);
  const bool alone = processes == 1 && !slurm_cpus();
  std::unique_ptr<gpu::Device> device;  // of a child process
  install_stop_handlers();
  Progress progress(sweep.name);
  return run_in_processes(
      jobs.size(), processes,
      {.begin = [&] { device = std::make_unique<gpu::Device>(open_device_silently(options)); },
       .run =
           [&](std::size_t row) {
             if (row == 0) print_notice(*device);  // only one process prints it
             const std::uint64_t job = jobs[row];
             if (!replace && folder.read(job)) return;  // finished by another process in the meantime
             folder.write(job, run_job(sweep, job, *device, alone ? 0 : 1));
           },
       .died = [&](std::size_t row, const std::string& cause) { folder.write(jobs[row], {.message = cause}); },
       .wait =
           [&](std::size_t done) {
             progress.show(static_cast<double>(done) / static_cast<double>(jobs.size()),
                           fmt::format("{} of {}", done, counted(jobs.size(), "job")));
           },
       .stop = [] { return stop_requested().load(); },
       .timeout = options.timeout});
}

/// Prints failures and missed expectations on standard error.
void print_failures(const Results& results) {
  constexpr std::size_t kMost = 10;
  std::size_t count = 0;
  for (std::uint64_t job = 0; job < results.size(); ++job) {
    if (!results[job] || results[job]->message.empty() || ++count > kMost) continue;
    print_message("job {} {}: {}", job, word_of(results[job]->status), results[job]->message);
  }
  if (count > kMost) print_message("{}: see jobs.csv", counted(count - kMost, "more job"));
}

/// Draws into the folder `plots`. The tables are the result, so a failure to draw (a node without Cairo) is not an
/// error.
void draw_plots(const SweepFolder& folder, const std::string& jobs) {
  const std::string plots_folder = folder.file("plots");
  try {
    const scenarios::SweepPlots plots = scenarios::draw_sweep(folder.file("jobs.csv"), jobs, plots_folder, {});
    for (const std::string& note : plots.notes) print_message(note);
    if (!plots.files.empty()) print_message("wrote {} in {}", counted(plots.files.size(), "plot"), plots_folder);
  } catch (const base::InputError& error) {
    print_message("no plots (`plot {}` can draw them later): {}", folder.path(), error.what());
  }
}

int write_tables(const SweepOptions& options, const Sweep& sweep, const SweepFolder& folder, const Results& results) {
  install_stop_handlers();  // the tables are written completely in any case
  const std::vector<std::string> files = write_sweep_tables(sweep, folder, results);
  const scenarios::JobCounts counts = scenarios::counts_of(results);
  print(markdown_of_points(sweep, results, kRowsShown) + "\n" + job_counts_text(counts) + "\n");
  print_failures(results);
  for (const std::string& line : scenarios::missing_values(results, 10)) print_message("excluded from means: {}", line);
  for (const std::string& file : files) print_message("wrote {}", file);
  if (options.plots) draw_plots(folder, csv_of_jobs(sweep, results));
  return counts.good() ? 0 : 1;
}

/// Reports one share while others are not finished.
int report_share(const SweepOptions& options, const Results& results, const Share& share) {
  Results own;
  for (std::uint64_t job = share.index; job < results.size(); job += share.count) own.push_back(results[job]);
  const scenarios::JobCounts counts = scenarios::counts_of(own);
  print_failures(results);
  print_message("share {} of {}: {}. {} has no tables yet: {} of {} missing", share.index + 1, share.count,
                job_counts_text(counts), options.out, scenarios::counts_of(results).missing,
                counted(results.size(), "job"));
  return counts.good() ? 0 : 1;
}

std::vector<std::string> arguments_of(const SweepOptions& options, const SweepFolder& folder) {
  std::vector<std::string> words{"sweep",  fs::absolute(options.file).lexically_normal().string(),
                                 "-o",     folder.path(),
                                 "--jobs", std::to_string(std::max(1u, options.jobs))};
  if (!options.device.empty()) words.insert(words.end(), {"--device", options.device});
  if (options.require_vulkan) words.emplace_back("--require-vulkan");
  if (options.retry) words.emplace_back("--retry");
  if (options.timeout > 0.0) words.insert(words.end(), {"--timeout", fmt::format("{}", options.timeout)});
  return words;
}

int write_batch_script(const SweepOptions& options, const Sweep& sweep, const SweepFolder& folder, const Jobs& jobs) {
  const std::uint64_t shares = std::min<std::uint64_t>(options.tasks, sweep.jobs());
  std::vector<bool> wanted(shares, false);
  for (const std::uint64_t job : jobs) wanted[job % shares] = true;
  BatchScript script{.name = sweep.name,
                     .shares = shares,
                     .cpus = std::max(1u, options.jobs),
                     .log = folder.file("slurm-%a.log"),
                     .directives = options.sbatch,
                     .arguments = arguments_of(options, folder)};
  for (std::uint64_t k = 0; k < shares; ++k)
    if (wanted[k]) script.tasks.push_back(k);
  std::error_code error;
  script.program = fs::read_symlink("/proc/self/exe", error).string();
  const std::string file = folder.file("sweep.sbatch");
  scenarios::write_whole(file, batch_script_text(script));
  print_message("wrote {}: {} in {}", file, counted(jobs.size(), "job"), counted(script.tasks.size(), "task"));
  print(fmt::format("sbatch {}\n", shell_quoted(file)));
  return 0;
}

}  // namespace

int sweep(const SweepOptions& options) {
  const Sweep sweep = scenarios::read_sweep(options.file);
  check_in_process(options, sweep);
  if (options.list) return list_points(sweep);
  const Share share = share_of(options);
  const SweepFolder folder(sweep, fs::absolute(options.out).lexically_normal().string());
  Results results = read_results(sweep, folder);
  const Jobs jobs = options.merge ? Jobs{} : pending_jobs(options, results, share);
  if (options.slurm && !jobs.empty()) return write_batch_script(options, sweep, folder, jobs);
  if (!jobs.empty()) {
    const bool whole = run_jobs(options, sweep, folder, jobs, options.retry);
    results = read_results(sweep, folder);
    if (!whole) {
      print_message("interrupted: {} of {} missing; run the same command again to continue",
                    scenarios::counts_of(results).missing, counted(results.size(), "job"));
      return interrupted_code();
    }
  }
  const bool complete = scenarios::counts_of(results).missing == 0;
  if (complete || options.merge) return write_tables(options, sweep, folder, results);
  return report_share(options, results, share);
}

}  // namespace sf::apps
