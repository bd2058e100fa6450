#pragma once
// Checks of arguments, for `->check(...)`, and the groups of options that subcommands share.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/options.h"

namespace CLI {
class App;
}  // namespace CLI

namespace sf::apps {

/// The fault of an argument, or "" (apps/option_parsers.h).
using Validator = std::function<std::string(const std::string&)>;

Validator whole(std::uint64_t first, std::uint64_t last);
Validator number(double first, double last);
Validator one_of(std::vector<std::string> words);
/// @param what was expected, with its article
Validator not_empty(std::string what);
/// A file that a picture is written to: there is PNG, and a name without a suffix may stand for it.
Validator picture();
Validator key_and_value();
Validator pose();
Validator line();
Validator extent();
Validator ports();
Validator quantity();
Validator rate();

/// A command with its options. Returns the exit code.
using Call = std::function<int()>;

/// When `sub` is parsed, `check` (which may throw CLI::Error), then `set`.
void on_parsed(CLI::App& sub, std::function<void()> set, std::function<void()> check);

/// Values for the options of `sub`, with which `call` is to run `command`. They live as long as either.
template <class CommandOptions>
CommandOptions& add_command(CLI::App& sub, Call& call, int (*command)(const CommandOptions&),
                            std::function<void()> check = {}) {
  const auto options = std::make_shared<CommandOptions>();
  on_parsed(
      sub, [options, &call, command] { call = [options, command] { return command(*options); }; }, std::move(check));
  return *options;
}

void add_json(CLI::App& app, JsonOption& o);
/// Without `--device`, SENSORFARM_DEVICE counts.
void add_device(CLI::App& app, DeviceOption& o);
void add_world(CLI::App& app, WorldOptions& o);
void add_accuracy(CLI::App& app, WorldOptions& o);
/// `--max-error`, `--by` and `--min-rate`.
void add_accuracy_target(CLI::App& app, AccuracyTargetOptions& o);
/// `--auto`, with its target.
void add_automatic(CLI::App& app, AccuracyTargetOptions& o);
void add_no_return(CLI::App& app, NoReturnOption& o);
void add_wire(CLI::App& app, WireOption& o);
void add_bind(CLI::App& app, BindOption& o);
/// `--from`: the host that packets are taken from.
void add_from(CLI::App& app, ReceiveOptions& o);
void add_silence(CLI::App& app, ReceiveOptions& o);
/// `--duration`, without which the command goes on.
void add_until(CLI::App& app, DurationOption& o, const std::string& help);
void add_ports(CLI::App& app, PortOptions& o);
void add_threads(CLI::App& app, ThreadsOption& o);
/// The folder of a recorded run.
void add_recording(CLI::App& app, RecordingOption& o);
void add_kind(CLI::App& app, SenseOptions& o);
void add_seed(CLI::App& app, SeedOption& o, const std::string& what);
void add_robots(CLI::App& app, CloneOptions& o);
void add_controller(CLI::App& app, ControllerOptions& o);

}  // namespace sf::apps
