#include "apps/processes/slurm.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>

#include "base/error.h"

namespace sf::apps {

namespace {

std::optional<std::uint64_t> whole_of(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string variable(const char* name) {
  const char* const text = std::getenv(name);
  return text == nullptr ? "" : text;
}

/// "0-3,7": ranges of successive numbers.
std::string ranges_of(const std::vector<std::uint64_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ",", numbers[i]);
    if (last > i) text += fmt::format("-{}", numbers[last]);
    i = last + 1;
  }
  return text;
}

void check_directive(const std::string& text, const char* what) {
  if (text.find_first_of("\"\\\r\n") == std::string::npos) return;
  throw base::InputError(fmt::format(
      "{} '{}' cannot be used in a batch script; expected no quotes, backslashes or line ends", what, text));
}

}  // namespace

std::optional<Share> read_share(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) return std::nullopt;
  const auto part = whole_of(std::string_view(text).substr(0, slash));
  const auto count = whole_of(std::string_view(text).substr(slash + 1));
  if (!part || !count || *part < 1 || *part > *count) return std::nullopt;
  return Share{*part - 1, *count};
}

std::optional<Share> share_of_slurm_step() {
  if (variable("SLURM_STEP_ID").empty()) return std::nullopt;
  const std::string procid = variable("SLURM_PROCID"), ntasks = variable("SLURM_STEP_NUM_TASKS").empty()
                                                                    ? variable("SLURM_NTASKS")
                                                                    : variable("SLURM_STEP_NUM_TASKS");
  const auto index = whole_of(procid), count = whole_of(ntasks);
  if (!index || !count || *index >= *count)
    throw base::InputError(fmt::format(
        "SLURM_PROCID is '{}' and SLURM_NTASKS '{}'; expected a task number and the number of tasks, or --share K/N",
        procid, ntasks));
  return Share{*index, *count};
}

std::optional<unsigned> slurm_cpus() {
  const auto cpus = whole_of(variable("SLURM_CPUS_PER_TASK"));
  if (cpus && *cpus >= 1 && *cpus <= 1024) return static_cast<unsigned>(*cpus);
  return variable("SLURM_STEP_ID").empty() ? std::optional<unsigned>() : 1u;
}

std::string shell_quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string batch_script_text(const BatchScript& script) {
  check_directive(script.name, "the name");
  check_directive(script.log, "the folder");
  std::string text = fmt::format(
      "#!/bin/bash\n# Written by `sensorfarm sweep --slurm`: jobs without a result, by shares. Run the same command "
      "again to\n# rewrite it for the jobs missing then. SENSORFARM may contain another command, such as: apptainer "
      "exec sensorfarm.sif sensorfarm\n#SBATCH --job-name=\"{}\"\n#SBATCH --array={}\n#SBATCH --ntasks=1\n#SBATCH "
      "--cpus-per-task={}\n#SBATCH --output=\"{}\"\n",
      script.name, ranges_of(script.tasks), script.cpus, script.log);
  for (const std::string& directive : script.directives) {
    if (!directive.starts_with('-') || directive.find_first_of("\r\n") != std::string::npos)
      throw base::InputError(
          fmt::format("--sbatch '{}': expected one option of sbatch, such as --time=1:00:00", directive));
    text += "#SBATCH " + directive + "\n";
  }
  std::string arguments;
  for (const std::string& argument : script.arguments) arguments += " " + shell_quoted(argument);
  return text + fmt::format(
                    "\nprogram=(${{SENSORFARM:-{}}})\n"
                    "exec \"${{program[@]}}\"{} --share \"$((SLURM_ARRAY_TASK_ID + 1))/{}\"\n",
                    shell_quoted(script.program), arguments, script.shares);
}

}  // namespace sf::apps
