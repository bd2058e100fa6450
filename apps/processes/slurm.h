#pragma once
// Slurm: the share of one process of `srun`, and batch scripts for job arrays.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sf::apps {

/// Part `index` of `count` equal parts: the jobs whose number is `index` modulo `count`.
struct Share {
  std::uint64_t index = 0;  ///< < `count`
  std::uint64_t count = 1;
};

/// Parses "2/8", the second of eight. Returns nullopt for another form.
std::optional<Share> read_share(const std::string& text);

/// Returns this process's share if `srun` started it (SLURM_STEP_ID, SLURM_PROCID, SLURM_STEP_NUM_TASKS); nullopt
/// outside of a step, including the batch script itself.
/// @throws base::InputError for invalid values
std::optional<Share> share_of_slurm_step();

/// Returns the number of CPUs per task (SLURM_CPUS_PER_TASK); 1 in a step that does not set it, which is Slurm's
/// default; nullopt outside of Slurm.
std::optional<unsigned> slurm_cpus();

/// Quotes a word for bash.
std::string shell_quoted(const std::string& word);

struct BatchScript {
  std::string name;                     ///< of the job
  std::vector<std::uint64_t> tasks;     ///< of the array: share numbers, starting at 0
  std::uint64_t shares = 1;             ///< total number of shares
  unsigned cpus = 1;                    ///< per task
  std::string log;                      ///< path of the tasks' output; %a is replaced by the task's number
  std::vector<std::string> directives;  ///< options of sbatch, such as "--time=1:00:00"
  std::string program;                  ///< default value of SENSORFARM
  std::vector<std::string> arguments;   ///< --share is appended
};
/// @throws base::InputError for texts that a directive cannot contain
std::string batch_script_text(const BatchScript& script);

}  // namespace sf::apps
