// sensorfarm: one program, its subcommands, and what becomes of errors.

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "apps/command_line.h"
#include "apps/stop_signals.h"
#include "base/error.h"
#include "control/own_controllers.h"

namespace {

int fail(int code, const char* what) {
  std::fprintf(stderr, "sensorfarm: %s\n", what);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  // A file that may not grow any more is an error with a message, as a full disk is.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    if (const char* const plugins = std::getenv("SENSORFARM_PLUGINS")) sf::control::load_plugin_list(plugins);
    const sf::apps::Parsed parsed = sf::apps::parse_command_line(argc, argv);
    const int code = parsed.exit_code ? *parsed.exit_code : parsed.call();
    // A full disk must not pass for an answer.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) return fail(2, "standard output cannot be written");
    return code;
  } catch (const sf::apps::Interrupted& stop) {
    return fail(sf::apps::interrupted_code(), stop.what());
  } catch (const sf::base::InputError& error) {
    return fail(2, error.what());
  } catch (const sf::base::DeviceError& error) {
    return fail(3, error.what());
  } catch (const std::exception& error) {
    return fail(1, error.what());
  }
}
