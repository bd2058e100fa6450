#pragma once
// What arguments of the command line may be, for `->check(...)`, and the groups of options that subcommands share.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "apps/options.h"

namespace CLI {
class App;
}  // namespace CLI

namespace sf::apps {

/// What is wrong with an argument, or "" (apps/option_parsers.h).
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

void add_json(CLI::App& app, Options& o);
/// CLI11's own envname would set what all subcommands share after the one that was called has set it.
void add_device(CLI::App& app, Options& o);
void add_world(CLI::App& app, Options& o);
void add_accuracy(CLI::App& app, Options& o);
/// What errors are allowed, or which rate is wanted.
void add_accuracy_target(CLI::App& app, Options& o);
/// `--auto`, with a wish.
void add_automatic(CLI::App& app, Options& o);
void add_no_return(CLI::App& app, Options& o);
void add_wire(CLI::App& app, Options& o);
void add_bind(CLI::App& app, Options& o);
/// `--from`: the host that packets are taken from.
void add_from(CLI::App& app, Options& o);
void add_silence(CLI::App& app, Options& o);
/// `--duration`, without which it goes on; and calls it `command`.
void add_until(CLI::App& sub, Options& o, Command command, const std::string& help);
void add_ports(CLI::App& app, Options& o);
void add_threads(CLI::App& app, Options& o);
/// What a run was recorded into.
void add_recording(CLI::App& app, Options& o);
void add_kind(CLI::App& app, Options& o);
void add_seed(CLI::App& app, Options& o, const std::string& what);
void add_robots(CLI::App& app, Options& o);
void add_controller(CLI::App& app, Options& o);

}  // namespace sf::apps
