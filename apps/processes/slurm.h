#pragma once
// Slurm: the share of a process of `srun`, and batch scripts of job arrays.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sf::apps {

/// Part `index` of `count` equal ones: the jobs whose number is `index` modulo `count`.
struct Share {
  std::uint64_t index = 0;  ///< below `count`
  std::uint64_t count = 1;
};

/// "2/8": the second of eight. Empty for a text of another form.
std::optional<Share> read_share(const std::string& text);

/// This process' share where `srun` started it (SLURM_STEP_ID, SLURM_PROCID, SLURM_STEP_NUM_TASKS); none outside of a
/// step, and so in a batch script itself.
/// @throws base::InputError for values that are no share
std::optional<Share> share_of_slurm_step();

/// CPUs of a task (SLURM_CPUS_PER_TASK); 1 in a step that does not say them, as Slurm has it; none outside of Slurm.
std::optional<unsigned> slurm_cpus();

/// A word for bash.
std::string shell_quoted(const std::string& word);

struct BatchScript {
  std::string name;                     ///< of the job
  std::vector<std::uint64_t> tasks;     ///< of the array: shares, from 0
  std::uint64_t shares = 1;             ///< in all
  unsigned cpus = 1;                    ///< per task
  std::string log;                      ///< path of the tasks' output; %a is the task's number
  std::vector<std::string> directives;  ///< options of sbatch, such as "--time=1:00:00"
  std::string program;                  ///< default of SENSORFARM
  std::vector<std::string> arguments;   ///< to which --share is added
};
/// @throws base::InputError for texts that a directive cannot contain
std::string text_of(const BatchScript& script);

}  // namespace sf::apps
