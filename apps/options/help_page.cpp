#include "apps/options/help_page.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <vector>

namespace sf::apps {

namespace {

struct Section {
  const char* title;
  std::vector<const char*> names;
};

/// Lists every command once, which a test checks.
const Section kSections[] = {
    {"Common", {"run", "check", "view", "plot", "test"}},
    {"Run", {"experiment", "sweep", "serve", "robot", "merge"}},
    {"Inspect", {"draw", "sense", "field", "explain", "map", "listen", "dump"}},
    {"Testbed", {"vps", "calibrate", "light", "start", "object", "lane", "v2x"}},
    {"Analyse", {"export", "derive", "identify", "tradeoff"}},
    {"Check", {"devices", "selftest", "verify", "help"}},
};

/// The most common options of commands with many options.
const Section kEveryday[] = {
    {"run",
     {"--robots", "--controller", "--set", "--duration", "--seed", "--record", "--view", "--send", "--accuracy",
      "--json"}},
    {"serve",
     {"--port", "--bind", "--rate", "--peers", "--filter", "--lockstep", "--record", "--duration", "--view", "--ros2"}},
    {"robot",
     {"--name", "--server", "--port", "--controller", "--set", "--rate", "--duration", "--peers", "--map", "--json"}},
    {"listen", {"--robots", "--of", "--seed", "--wire", "--bind", "--from", "--silence", "--duration", "--json"}},
    {"vps",
     {"--input", "--rendered", "--images", "--robots", "--send", "--peers", "--track", "--overlay", "--duration",
      "--json"}},
    {"tradeoff",
     {"--out", "--robots", "--of", "--seed", "--auto", "--max-error", "--by", "--min-rate", "--format", "--json"}},
};

const Section* everyday_of(const CLI::App& app) {
  for (const Section& command : kEveryday)
    if (command.title == app.get_name()) return &command;
  return nullptr;
}

class HelpPage : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
  std::string make_subcommands(const CLI::App* app, CLI::AppFormatMode mode) const override;

 private:
  std::string make_everyday(const CLI::App& app) const;
};

std::string HelpPage::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  if (mode == CLI::AppFormatMode::Sub) return make_expanded(app);
  std::string page = make_description(app) + make_usage(app, std::move(name));
  if (const std::string examples = make_footer(app); !examples.empty()) page += "\n" + examples;
  page += make_positionals(app);
  page +=
      mode == CLI::AppFormatMode::Normal && everyday_of(*app) != nullptr ? make_everyday(*app) : make_groups(app, mode);
  return page + make_subcommands(app, mode);
}

std::string HelpPage::make_everyday(const CLI::App& app) const {
  std::vector<const CLI::Option*> shown;
  for (const char* name : everyday_of(app)->names) shown.push_back(app.get_option(name));
  const auto all = app.get_options([](const CLI::Option* option) { return option->nonpositional(); });
  return make_group(get_label("Options"), false, shown) +
         fmt::format("\n{} more options: sensorfarm {} --help-all\n", all.size() - shown.size(), app.get_name());
}

std::string HelpPage::make_subcommands(const CLI::App* app, CLI::AppFormatMode mode) const {
  const auto any = app->get_subcommands([](const CLI::App*) { return true; });
  if (mode != CLI::AppFormatMode::Normal || any.empty()) return CLI::Formatter::make_subcommands(app, mode);
  std::string text;
  for (const Section& section : kSections) {
    text += fmt::format("\n{}:\n", section.title);
    for (const char* name : section.names) text += make_subcommand(app->get_subcommand(name));
  }
  return text;
}

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_page(std::size_t column_width) {
  const auto page = std::make_shared<HelpPage>();
  page->column_width(column_width);
  return page;
}

}  // namespace sf::apps
