#include "apps/processes/scenario_processes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <thread>

#include "apps/options/open_device.h"
#include "apps/processes/job_processes.h"
#include "apps/processes/memory_limit.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/bytes.h"
#include "base/error.h"

namespace sf::apps {

namespace {

using scenarios::ScenarioResult;

/// Serializes the part of a result that `test` prints: `row`, the size of the rest, and the rest.
base::Bytes bytes_of(std::size_t row, const ScenarioResult& result) {
  base::Bytes body, bytes;
  base::ByteWriter out(body);
  out.put_string(result.name);
  out.put_string(result.failure);
  out.put(result.simulated);
  out.put(result.wall);
  for (const scenarios::ExpectationResult& o : result.outcomes) {
    for (const std::string* text : {&o.what, &o.expected, &o.measured}) out.put_string(*text);
    out.put(static_cast<std::uint8_t>(o.met));
    out.put(o.line);
  }
  base::ByteWriter whole(bytes);
  whole.put(static_cast<std::uint64_t>(row));
  whole.put(static_cast<std::uint64_t>(body.size()));
  whole.put_bytes(body.data(), body.size());
  return bytes;
}

ScenarioResult result_of(const std::string& file, std::span<const std::uint8_t> bytes) {
  ScenarioResult result{.file = file};
  base::ByteReader in(bytes);
  result.name = in.get_string();
  result.failure = in.get_string();
  result.simulated = in.get<double>();
  result.wall = in.get<double>();
  while (in.left() > 0 && in.good()) {
    scenarios::ExpectationResult& o = result.outcomes.emplace_back();
    for (std::string* text : {&o.what, &o.expected, &o.measured}) *text = in.get_string();
    o.met = in.get<std::uint8_t>() != 0;
    o.line = in.get<int>();
  }
  return result;
}

/// Passes results from children to their parent through a file in memory that all of them append to.
class ResultFile {
 public:
  ResultFile() : descriptor_(memfd_create("results", MFD_CLOEXEC)) {
    if (descriptor_ < 0 || fcntl(descriptor_, F_SETFL, O_APPEND) != 0)
      throw base::InputError(std::string("no memory for results: ") + std::strerror(errno));
  }
  ~ResultFile() { ::close(descriptor_); }
  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  void put(std::size_t row, const ScenarioResult& result) const {
    const base::Bytes bytes = bytes_of(row, result);
    if (::write(descriptor_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
      throw std::runtime_error(std::string("its result cannot be passed to the parent: ") + std::strerror(errno));
  }

  /// Reads the results added since the last call.
  void take(const std::vector<std::string>& files, std::vector<std::optional<ScenarioResult>>& results) {
    std::uint64_t head[2];
    while (::pread(descriptor_, head, sizeof head, position_) == static_cast<ssize_t>(sizeof head)) {
      base::Bytes body(head[1]);
      if (head[0] >= files.size() ||
          ::pread(descriptor_, body.data(), body.size(), position_ + static_cast<off_t>(sizeof head)) !=
              static_cast<ssize_t>(body.size()))
        return;
      results[head[0]] = result_of(files[head[0]], body);
      position_ += static_cast<off_t>(sizeof head + body.size());
    }
  }

 private:
  int descriptor_;
  off_t position_ = 0;  ///< offset of the first unread byte
};

/// The scenarios of one command.
class OwnProcesses {
 public:
  OwnProcesses(const TestOptions& options, const std::function<void(const ScenarioResult&)>& show)
      : options_(options), show_(show), results_(options.scenarios.size()), came_(results_.size()) {}

  /// Checks each scenario in a separate process, since this loads plug-ins and creates controllers.
  bool check() {
    for (std::size_t row = 0; row < results_.size(); ++row) rows_.push_back(row);
    return run_in_processes(rows_.size(), 1,
                            calls([] {},
                                  [&](std::size_t row) {
                                    const scenarios::Scenario scenario = scenarios::read_scenario(file(row));
                                    print_warnings(scenario.world, scenarios::check_scenario(scenario));
                                  }));
  }

  bool run() {
    std::erase_if(rows_, [&](std::size_t row) { return results_[row].has_value(); });
    show();
    std::unique_ptr<gpu::Device> device;  // of a child process
    JobCalls all = calls([&] { device = std::make_unique<gpu::Device>(open_device_silently(options_)); },
                         [&](std::size_t job) {
                           if (job == 0) print_notice(*device);  // only one process prints it
                           file_.put(rows_[job], result_of_run(rows_[job], *device));
                           device.reset();
                         });
    all.ended = [&](std::size_t job) {
      file_.take(options_.scenarios, came_);
      results_[rows_[job]] = came_[rows_[job]].value_or(lost(rows_[job], "its result is not readable"));
      show();
    };
    return run_in_processes(rows_.size(), options_.jobs, all);
  }

 private:
  const std::string& file(std::size_t row) const { return options_.scenarios[row]; }

  ScenarioResult lost(std::size_t row, const std::string& why) const {
    return {.name = std::filesystem::path(file(row)).stem().string(), .file = file(row), .failure = why};
  }

  /// Job callbacks for the scenarios in `rows_`.
  JobCalls calls(std::function<void()> begin, std::function<void(std::size_t)> run) {
    return {.begin = std::move(begin),
            .run = std::move(run),
            .died =
                [this](std::size_t job, const std::string& cause) {
                  Progress::clear();
                  results_[rows_[job]] = lost(rows_[job], cause);
                  show();
                },
            .ended = {},
            .wait = [](std::size_t) {},
            .stop = [] { return stop_requested().load(); },
            .own_processes = true,
            .timeout = options_.timeout};
  }

  /// Runs in a child. Errors of a controller fail its scenario.
  ScenarioResult result_of_run(std::size_t row, gpu::Device& device) const {
    ScenarioResult result = lost(row, "");
    try {
      const scenarios::Scenario scenario = scenarios::read_scenario(file(row));
      result.name = scenario.name;
      Progress progress(scenario.name);
      const auto show = [&](double part) {
        if (options_.jobs == 1) progress.show(part);
      };
      const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
      return scenarios::run_scenario(scenario, device, show, std::max(1u, cores / options_.jobs));
    } catch (const base::DeviceError&) {
      throw;
    } catch (const std::bad_alloc&) {
      result.failure = kNoMemory;
    } catch (const std::exception& error) {
      result.failure = error.what();
    }
    return result;
  }

  /// Prints results in the order of the files.
  void show() {
    const std::size_t shown = shown_;
    for (; shown_ < results_.size() && results_[shown_]; ++shown_) show_(*results_[shown_]);
    if (shown_ > shown) flush_output();
  }

  const TestOptions& options_;
  const std::function<void(const ScenarioResult&)>& show_;
  std::vector<std::optional<ScenarioResult>> results_, came_;  ///< by file; `came_`: of children that may still die
  std::vector<std::size_t> rows_;                              ///< of the scenarios to check or run
  std::size_t shown_ = 0;
  ResultFile file_;
};

}  // namespace

bool run_in_own_processes(const TestOptions& options, const std::function<void()>& checked,
                          const std::function<void(const ScenarioResult&)>& show) {
  install_stop_handlers();
  OwnProcesses processes(options, show);
  if (!processes.check()) return false;
  checked();
  return processes.run();
}

}  // namespace sf::apps
