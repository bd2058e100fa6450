// sensorfarm: one program, its subcommands, and what becomes of errors.

#include <csignal>
#include <cstdio>
#include <exception>

#include "apps/command_line.h"
#include "apps/commands.h"
#include "base/error.h"

namespace {

int dispatch(const sf::apps::Options& options) {
  using sf::apps::Command;
  switch (options.command) {
    case Command::devices:
      return sf::apps::devices(options);
    case Command::check:
      return sf::apps::check(options);
    case Command::draw:
      return sf::apps::draw(options);
    case Command::field:
      return sf::apps::field(options);
    case Command::sense:
      return sf::apps::sense(options);
    case Command::run:
      return sf::apps::run(options);
    case Command::serve:
      return sf::apps::serve(options);
    case Command::robot:
      return sf::apps::robot(options);
    case Command::start:
      return sf::apps::start(options);
    case Command::plot:
      return sf::apps::plot(options);
    case Command::listen:
      return sf::apps::listen(options);
    case Command::experiment:
      return sf::apps::experiment(options);
    case Command::test:
      return sf::apps::test_scenarios(options);
    case Command::verify:
      return sf::apps::verify(options);
    case Command::explain:
      return sf::apps::explain(options);
    case Command::tradeoff:
      return sf::apps::tradeoff(options);
    case Command::selftest:
      return sf::apps::selftest(options);
    case Command::map:
      return sf::apps::map(options);
  }
  return 1;
}

int fail(int code, const char* what) {
  std::fprintf(stderr, "sensorfarm: %s\n", what);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  // A file that may not grow any more is an error with a message, as a full disk is.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    const sf::apps::Parsed parsed = sf::apps::parse_command_line(argc, argv);
    const int code = parsed.exit_code ? *parsed.exit_code : dispatch(parsed.options);
    // A full disk must not pass for an answer.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) return fail(2, "standard output cannot be written");
    return code;
  } catch (const sf::base::InputError& error) {
    return fail(2, error.what());
  } catch (const sf::base::DeviceError& error) {
    return fail(3, error.what());
  } catch (const std::exception& error) {
    return fail(1, error.what());
  }
}
