#pragma once
// Runs users' code (plug-ins, Python) in a child process, so that anything it does to the process is reported.

#include <optional>

namespace sf::apps {

/// True if the command should run in a child: the arguments or SENSORFARM_PLUGINS name users' code, or memory is
/// limited, so that a driver may crash. False for MPI ranks and with `--in-process`.
bool needs_supervision(int argc, const char* const* argv);

/// Continues in a child with the same terminal; forwards signals and the exit code. Ends not caused by the program
/// itself (exit() and _exit() in a plug-in, crashes, SIGKILL) are reported on standard error with exit code 1. After a
/// stop request (SIGINT, SIGTERM, SIGHUP), the child is ended shortly before base::kStopLimit if calls are still in
/// progress. It is also ended if a thread continues after the program's end; without a stop request, such a thread has
/// base::seconds_to_end(). Processes that the child leaves running are killed. Must be called before threads exist.
/// @return the exit code in the parent; nullopt in the child, or if no child could be started
std::optional<int> supervise();

}  // namespace sf::apps
