#include "apps/options/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>

#include "apps/options/help_page.h"
#include "apps/options/option_groups.h"
#include "apps/options/option_parsers.h"
#include "apps/options/subcommands.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/text.h"
#include "base/suggest.h"

namespace sf::apps {

namespace {

constexpr std::size_t kNameWidth = 34;  ///< of the column of option names

std::vector<std::string> options_of(const CLI::App& sub) {
  std::vector<std::string> names;
  for (const CLI::Option* option : sub.get_options())
    names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
  return names;
}

/// Returns a misspelt option among the arguments, since CLI11 would report a missing world first; "" if there is none.
std::string unknown_option(const CLI::App& sub, int argc, const char* const* argv) {
  const std::vector<std::string> known = options_of(sub);
  for (int i = 2; i < argc; ++i) {
    const std::string_view word(argv[i]);
    const std::string_view name = word.substr(0, word.find('='));
    if (name.size() < 3 || name.substr(0, 2) != "--") continue;
    if (std::find(known.begin(), known.end(), name.substr(2)) == known.end()) return std::string(name);
  }
  return {};
}

/// Returns an error for the first unused argument, since CLI11 lists all of them in reverse order.
std::string explain_extras(const CLI::App& app, const CLI::App& sub, int argc, const char* const* argv) {
  const std::vector<std::string> rest = app.remaining(true);
  const auto* const found =
      std::find_if(argv + 1, argv + argc, [&](const char* a) { return std::count(rest.begin(), rest.end(), a) > 0; });
  const std::string word = found == argv + argc ? "" : *found;
  return fmt::format("'{}' was not expected{}", word, suggest_option(word, options_of(sub)));
}

/// Breaks the text into lines of at most `width` characters, since CLI11 does not.
std::string wrapped(const std::string& text, std::size_t width) {
  std::istringstream words(text);
  std::string lines;
  std::size_t used = 0;
  for (std::string word; words >> word; used += word.size()) {
    const bool fits = used + 1 + word.size() <= width;
    if (used > 0) lines += fits ? ' ' : '\n';
    used = used > 0 && fits ? used + 1 : 0;
    lines += word;
  }
  return lines;
}

void wrap_help(CLI::App& app) {
  constexpr std::size_t kWidth = 100;  // of the terminal
  app.description(wrapped(app.get_description(), kWidth - kNameWidth));
  for (CLI::Option* option : app.get_options())
    option->description(wrapped(option->get_description(), kWidth - kNameWidth));
}

/// Adds `help` and `help COMMAND`. @param asked receives the command's name
const CLI::App* add_help(CLI::App& app, std::string& asked) {
  CLI::App* sub = app.add_subcommand("help", "Print the help of a command");
  std::vector<std::string> names;
  for (const CLI::App* each : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(each->get_name());
  sub->add_option("command", asked, "Command (default: list all commands)")->check(one_of(names))->type_name("COMMAND");
  add_examples(*sub, {"run"});
  return sub;
}

/// Returns a one-line error for the arguments that ends with the help command.
std::string explain_refusal(const CLI::App& app, const CLI::ParseError& error, int argc, const char* const* argv) {
  const std::vector<CLI::App*> used = app.get_subcommands();
  if (used.empty()) {
    std::vector<std::string_view> names;
    for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
      names.emplace_back(sub->get_name());
    if (argc > 1)
      return fmt::format("'{}' is not a subcommand{}; see `sensorfarm --help`", argv[1],
                         base::expected_one_of(argv[1], names));
    return fmt::format("expected a subcommand: {}; see `sensorfarm --help`", fmt::join(names, ", "));
  }
  std::string what = error.what();
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) what = explain_extras(app, *used[0], argc, argv);
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr)
    if (const std::string word = unknown_option(*used[0], argc, argv); !word.empty())
      what = fmt::format("'{}' was not expected{}", word, suggest_option(word, options_of(*used[0])));
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr)
    what = what.substr(0, what.find(':')) + " requires a value";
  return fmt::format("{} `sensorfarm {} --help`", what + (what.ends_with('?') ? " See" : "; see"), used[0]->get_name());
}

}  // namespace

Parsed parse_command_line(int argc, const char* const* argv) {
  Parsed parsed;
  CLI::App app{"sensorfarm: 2-D multi-robot simulator and virtual-sensor server", "sensorfarm"};
  app.formatter(help_page(kNameWidth));
  app.set_help_all_flag("--help-all", "Print this message with all options and exit");
  app.set_version_flag("--version", std::string("sensorfarm ") + SF_VERSION);
  app.add_option_function<int>("--interrupted-code", set_interrupted_code,
                               "Exit code of a command that a signal stops before it is complete (default: 128 plus "
                               "the signal number, e.g. 130 after Ctrl-C)")
      ->check(whole(0, 255))
      ->type_name("CODE");
  wrap_help(app);
  app.require_subcommand(1);
  add_inspect_commands(app, parsed.call);
  add_export_commands(app, parsed.call);
  add_run_commands(app, parsed.call);
  add_vision_commands(app, parsed.call);
  add_test_commands(app, parsed.call);
  std::string asked;
  const CLI::App* help = add_help(app, asked);
  for (CLI::App* sub : app.get_subcommands([](CLI::App*) { return true; })) wrap_help(*sub);
  try {
    app.parse(argc, argv);
    if (help->parsed()) {
      app.clear();  // otherwise its help would be that of `help`
      const std::string text = asked.empty() ? app.help() : app.get_subcommand(asked)->help("sensorfarm");
      print(text);
      parsed.exit_code = 0;
    }
  } catch (const CLI::ParseError& error) {
    // CLI11 has a separate code for each error; this program returns 2 for all of them.
    const bool fine = error.get_exit_code() == 0;
    std::ostringstream text;
    if (fine) app.exit(error, text), print(text.str());
    if (!fine) print_message(explain_refusal(app, error, argc, argv));
    parsed.exit_code = fine ? 0 : 2;
  }
  return parsed;
}

}  // namespace sf::apps
