#pragma once
// Groups of options shared by several subcommands. Options of a single subcommand are in subcommands_*.cpp: those of
// `serve` for received states, for example, in `add_filter` of subcommands_run.cpp.

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/options/options.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace sf::apps {

/// Runs a command with its options and returns the exit code.
using Call = std::function<int()>;

/// After `sub` is parsed, calls `check` (which may throw CLI::Error), then `set`.
void on_parsed(CLI::App& sub, std::function<void()> set, std::function<void()> check);

/// Returns the values for the options of `sub`, and sets `call` to run `command` with them if `sub` is chosen. They
/// live as long as both.
template <class CommandOptions>
CommandOptions& add_command(CLI::App& sub, Call& call, int (*command)(const CommandOptions&),
                            std::function<void()> check = {}) {
  const auto options = std::make_shared<CommandOptions>();
  on_parsed(
      sub, [options, &call, command] { call = [options, command] { return command(*options); }; }, std::move(check));
  return *options;
}

/// Adds examples to the command's help. @param arguments one entry per example call
void add_examples(CLI::App& sub, const std::vector<std::string>& arguments);

/// Adds an option whose argument must be one of `words`. `set` receives the word.
CLI::Option* add_choice(CLI::App& app, const std::string& name, const std::vector<std::string>& words,
                        const std::function<void(const std::string&)>& set, const std::string& help);
/// The same with a value for each word.
template <class Target, class Value>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Target& target,
                        const std::vector<std::pair<std::string, Value>>& choices, const std::string& help) {
  std::vector<std::string> words;
  for (const auto& [word, value] : choices) words.push_back(word);
  const auto set = [&target, choices](const std::string& text) {
    for (const auto& [word, value] : choices)
      if (word == text) target = value;
  };
  return add_choice(app, name, words, set, help);
}

void add_json(CLI::App& app, JsonOption& o);
CLI::Option* add_compression(CLI::App& app, CompressionOption& o);
CLI::Option* add_images(CLI::App& app, ImagesOption& o);
/// Without `--device`, the environment variable SENSORFARM_DEVICE applies.
void add_device(CLI::App& app, DeviceOption& o);
void add_in_process(CLI::App& app, InProcessOption& o);
/// Adds `--timeout` for a job such as "scenario".
void add_timeout(CLI::App& app, double& seconds, const std::string& job);
void add_world(CLI::App& app, WorldOptions& o);
void add_accuracy(CLI::App& app, WorldOptions& o);
/// @param help without the list of valid words
CLI::Option* add_accuracy(CLI::App& app, std::string& words, const std::string& help);
/// `--max-error`, `--by` and `--min-rate`.
void add_accuracy_target(CLI::App& app, AccuracyTargetOptions& o);
/// `--auto`, with its target.
void add_automatic(CLI::App& app, AccuracyTargetOptions& o);
void add_no_return(CLI::App& app, NoReturnOption& o);
void add_wire(CLI::App& app, WireOption& o);
void add_bind(CLI::App& app, BindOption& o);
/// `--peers`: the table of addresses and keys.
void add_peers(CLI::App& app, PeersOption& o);
/// `--from`: the host from which packets are accepted.
void add_from(CLI::App& app, ReceiveOptions& o);
void add_silence(CLI::App& app, ReceiveOptions& o);
/// Adds `--duration`; without it, the command runs until stopped.
void add_until(CLI::App& app, DurationOption& o, const std::string& help);
/// `--latitude` and `--longitude`.
void add_origin(CLI::App& app, OriginOption& o, const std::string& group = "Options");
void add_ports(CLI::App& app, PortOptions& o);
/// Rejects topic names that contradict each other and names for topics that do not exist. @param readings_option option
/// that records readings; null: the recording always has them @throws CLI::Error
void check_naming(const CLI::App& sub, const char* readings_option = nullptr);
/// Rejects `options` if none of `wanted` is given, since they have no effect then. @throws CLI::RequiresError
void require_any(const CLI::App& sub, const std::vector<std::string>& options, const std::vector<std::string>& wanted);
void add_threads(CLI::App& app, ThreadsOption& o);
/// Group of the options for other programs that run alongside `run` and `serve`.
inline constexpr const char* kBridgeGroup = "Bridges to other programs (docs/bridges.md)";
void add_bridges(CLI::App& app, BridgeOptions& o);
/// Adds the option `NAME [HOST:]PORT`. @param what the content of the page, for the help: "a live view"
CLI::Option* add_live_view(CLI::App& app, std::optional<bridges::WebAddress>& view, const char* what,
                           const char* name = "--view");
/// `--topics`, `--odometry` and `--external`.
void add_naming(CLI::App& app, NamingOption& o);
/// Adds `--out FILE` for one picture.
CLI::Option* add_picture(CLI::App& app, std::string& file,
                         const std::string& help = "Picture to write: .png, .svg or .pdf");
/// `--size`, `--font-size`, `--dpi` and `--no-title`.
void add_page(CLI::App& app, PageOption& o);
/// The options that `add_page` adds.
inline const std::vector<std::string> kPageOptions{"--size", "--font-size", "--dpi", "--no-title"};
/// Adds `--line-styles` for figures with curves.
void add_line_styles(CLI::App& app, PageOption& o);
/// Adds `--map-colors` for occupancy maps.
void add_map_colors(CLI::App& app, PageOption& o);
/// Adds `--extent` for figures of a world.
void add_extent(CLI::App& app, PageOption& o);
/// Adds `--format` for pictures in a folder.
void add_format(CLI::App& app, std::string& format);
/// Heading in the help.
inline constexpr const char* kVideoGroup = "Video (docs/figures.md)";
/// Adds the options for a video's appearance. @param wanted option that requests the video
void add_video_look(CLI::App& app, VideoOptions& o, CLI::Option* wanted);
void add_video(CLI::App& app, VideoOptions& o, const std::string& help);

/// Adds an option for comma-separated robot names; apps/robot_names.h resolves them, since names may contain commas.
CLI::Option* add_robot_names(CLI::App& app, const std::string& option, std::vector<std::string>& names,
                             const std::string& help);
/// `--robots` (names), `--from` and `--to`.
void add_part(CLI::App& app, PartOption& o);
/// The folder of a recorded run.
void add_recording(CLI::App& app, RecordingOption& o);
void add_sensor_type(CLI::App& app, SenseOptions& o);
void add_seed(CLI::App& app, SeedOption& o, const std::string& what);
void add_robots(CLI::App& app, CloneOptions& o);
/// Adds `--robot-from`; must be called after `add_robots` if both are used.
void add_robot_from(CLI::App& app, WorldOptions& o);
void add_controller(CLI::App& app, ControllerOptions& o);

}  // namespace sf::apps
