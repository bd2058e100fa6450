#pragma once
// Commands that run users' code (plug-ins, Python) in a child process, so that whatever this code does to the process
// is reported.

#include <optional>

namespace sf::apps {

/// Whether the command is best run in a child: these arguments or SENSORFARM_PLUGINS name code of users, or memory is
/// limited, so that a driver may crash. Not for ranks of MPI, nor with `--in-process`.
bool needs_supervision(int argc, const char* const* argv);

/// Continues in a child, with the same terminal, and passes signals and the exit code on. An end that is not the
/// program's own is reported on standard error, as exit code 1: exit() and _exit() in a plug-in, crashes, SIGKILL.
/// After a request to stop (SIGINT, SIGTERM, SIGHUP) calls that go on ahead of base::kStopLimit end the child. So does
/// a thread that goes on after the program's end, which is given base::seconds_to_end() where no stop was requested.
/// Processes that it leaves running are killed. To be called before threads exist.
/// @return in the parent the exit code; none: this is the child, or no child could be started
std::optional<int> supervise();

}  // namespace sf::apps
