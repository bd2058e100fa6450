// sensorfarm: the main program with its subcommands and error handling.

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <string_view>
#include <system_error>

#include "apps/options/command_line.h"
#include "apps/processes/memory_limit.h"
#include "apps/processes/stop_signals.h"
#include "apps/processes/supervision.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "base/plugin_calls.h"
#include "base/printable.h"
#include "base/thread_pool.h"
#include "control/own_controllers.h"

namespace {

int fail(int code, const char* what) {
  std::fprintf(stderr, "sensorfarm: %s\n", sf::base::printable(what).c_str());
  return code;
}

/// Opens closed standard streams as descriptors whose reads and writes fail. Otherwise the next file or socket that the
/// program opens would become a standard stream. Child processes inherit none of them.
void fill_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", (stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) | O_CLOEXEC);
}

bool wants_json(int argc, const char* const* argv) {
  return std::any_of(argv, argv + argc, [](std::string_view word) { return word.substr(0, 6) == "--json"; });
}

int run(int argc, char** argv) {
  try {
    if (wants_json(argc, argv)) sf::apps::keep_output_apart();
    if (const char* const plugins = std::getenv("SENSORFARM_PLUGINS")) sf::control::load_plugin_list(plugins);
    const sf::apps::Parsed parsed = sf::apps::parse_command_line(argc, argv);
    const int code = parsed.exit_code ? *parsed.exit_code : parsed.call();
    // Report write errors, so that truncated output is never mistaken for success.
    if (!sf::apps::flush_output()) return fail(2, "standard output cannot be written");
    return code;
  } catch (const sf::apps::Incomplete& stop) {
    return fail(sf::apps::interrupted_code(), stop.what());
  } catch (const sf::base::Interrupted& stop) {
    return fail(sf::apps::interrupted_code(), stop.what());
  } catch (const sf::base::InputError& error) {
    return fail(2, error.what());
  } catch (const sf::base::DeviceError& error) {
    return fail(3, error.what());
  } catch (const std::bad_alloc&) {
    return fail(1, sf::apps::kNoMemory);
  } catch (const std::system_error& error) {
    if (error.code() != std::errc::resource_unavailable_try_again) return fail(1, error.what());
    return fail(1, "no thread can be started: raise the limit of processes (ulimit -u) or of memory (ulimit -v)");
  } catch (const std::exception& error) {
    return fail(1, error.what());
  }
}

/// For exit handlers that need longer, and for tests. @return false if it is not a valid number
bool read_seconds_to_end() {
  const char* const text = std::getenv("SENSORFARM_SECONDS_TO_END");
  if (text == nullptr || *text == '\0') return true;
  char* end = nullptr;
  const double seconds = std::strtod(text, &end);
  if (*end != '\0' || !(seconds >= 0.001 && seconds <= 1e6)) return false;
  sf::base::set_seconds_to_end(seconds);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  fill_standard_streams();
  if (!read_seconds_to_end()) return fail(2, "SENSORFARM_SECONDS_TO_END expects a number of seconds from 0.001 to 1e6");
  // Report the file size limit as an error message, like a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  if (sf::apps::needs_supervision(argc, argv))
    if (const std::optional<int> code = sf::apps::supervise()) return *code;
  sf::base::watch_plugin_calls();
  const int code = run(argc, argv);
  sf::apps::remove_stop_handlers();
  sf::base::finish_plugin_calls(code);
  return code;
}
