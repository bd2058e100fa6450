#include "world/light_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "base/elementary.h"
#include "base/suggest.h"
#include "world/fields.h"
#include "world/fixed_programs.h"
#include "world/toml_reader.h"

namespace sf::world {

namespace {

using Kind = TomlNode::Kind;

constexpr std::size_t kMaxPrograms = 1000, kMaxStages = 100, kMaxDetectors = 1000, kMaxCalls = 10'000;
constexpr double kMaxSeconds = 1e6, kMaxMetres = 1e7;
constexpr std::array<std::string_view, 4> kPlanKeys{"world", "program", "detector", "wave"};
constexpr std::array<std::string_view, 4> kProgramKeys{"name", "lights", "offset", "stage"};
constexpr std::array<std::string_view, 9> kStageKeys{"states",    "duration", "min",    "max",  "gap",
                                                     "detectors", "on_call",  "yellow", "clear"};
constexpr std::array<std::string_view, 4> kDetectorKeys{"name", "at", "radius", "calls"};
constexpr std::array<std::string_view, 4> kWaveKeys{"lights", "speed", "start", "distances"};

/// Reads the parts of one file.
class PlanReader {
 public:
  PlanReader(const std::string& file, World& world) : reader_(file), world_(world) {
    for (const Light& light : world.lights) lights_.emplace_back(light.name);
  }
  LightPlan read(const TomlNode& root);

 private:
  const TomlNode& required(const TomlNode& table, std::string_view key, std::string_view example) const;
  std::vector<const TomlNode*> texts(const TomlNode& table, std::string_view key, bool needed) const;
  std::uint32_t row(const TomlNode& node, std::string_view text, const std::vector<std::string_view>& names,
                    std::string_view what) const;
  void require_new(const TomlNode& node, const std::string& name, std::vector<std::string_view>& names) const;
  LightDetector read_detector(const TomlNode& table) const;
  LightProgram read_program(const TomlNode& table);
  LightStage read_stage(const TomlNode& table, const LightProgram& program) const;
  void read_length(const TomlNode& table, LightStage& stage) const;
  void read_states(const TomlNode& table, const LightProgram& program, LightStage& stage) const;
  void read_wave(const TomlNode& table, LightPlan& plan) const;
  double distance(const TomlNode& table, const std::vector<std::uint32_t>& lights, std::size_t k) const;

  TomlReader reader_;
  World& world_;
  std::vector<std::string_view> lights_, detectors_;
  std::vector<std::string> programs_;
  std::vector<std::string_view> taken_;  ///< lights that have a program
};

const TomlNode& PlanReader::required(const TomlNode& table, std::string_view key, std::string_view example) const {
  const TomlNode* node = find(table, key);
  if (node == nullptr) reader_.fail(table, fmt::format("'{}' is missing; expected {}", key, example));
  return *node;
}

std::vector<const TomlNode*> PlanReader::texts(const TomlNode& table, std::string_view key, bool needed) const {
  const std::string example = fmt::format("{} = [\"...\", ...]", key);
  std::vector<const TomlNode*> all;
  if (!needed && find(table, key) == nullptr) return all;
  const TomlNode& list = required(table, key, example);
  for (const TomlNode& item : list.items) all.push_back(&item);
  const bool fine = list.kind == Kind::list && !all.empty() &&
                    std::all_of(all.begin(), all.end(), [](const auto* item) { return item->kind == Kind::text; });
  if (!fine) reader_.fail(list, fmt::format("'{}' expects names: {}", key, example));
  return all;
}

std::uint32_t PlanReader::row(const TomlNode& node, std::string_view text, const std::vector<std::string_view>& names,
                              std::string_view what) const {
  const auto at = std::find(names.begin(), names.end(), text);
  if (at == names.end())
    reader_.fail(node, fmt::format("no {} is called '{}'{}", what, text,
                                   names.empty() ? "; there is none" : base::expected_one_of(text, names)));
  return static_cast<std::uint32_t>(at - names.begin());
}

void PlanReader::require_new(const TomlNode& node, const std::string& name,
                             std::vector<std::string_view>& names) const {
  if (std::find(names.begin(), names.end(), name) != names.end())
    reader_.fail(node, fmt::format("'{}' is listed twice", name));
}

LightDetector PlanReader::read_detector(const TomlNode& table) const {
  reader_.require_known(table, kDetectorKeys);
  LightDetector detector;
  required(table, "name", "name = \"north\"");
  detector.name = reader_.text(table, "name", "");
  if (find(table, "at") != nullptr) {
    std::array<double, 2> p{};
    reader_.numbers(table, "at", p, kMaxMetres, "[x, y] in metres");
    detector.p = {p[0], p[1]};
    required(table, "radius", "radius = 0.3, in metres");
    detector.radius = reader_.number(table, "radius", 0.0, 1e-3, 1e3, "metres");
  }
  const TomlNode* calls = find(table, "calls");
  if (calls == nullptr && !detector.p)
    reader_.fail(table, "a detector requires a position ('at', 'radius') or 'calls'");
  if (calls == nullptr) return detector;
  if (calls->kind != Kind::list || calls->items.size() > kMaxCalls)
    reader_.fail(*calls, fmt::format("'calls' expects up to {} times [from, to] in seconds", kMaxCalls));
  for (const TomlNode& item : calls->items) {
    const bool fine = item.kind == Kind::list && item.items.size() == 2;
    if (!fine) reader_.fail(item, "'calls' expects times such as [[10, 12.5]], in seconds");
    const double from = reader_.number(item.items[0], "calls", 0.0, 1e9, "seconds");
    detector.calls.emplace_back(from, reader_.number(item.items[1], "calls", from, 1e9, "seconds"));
  }
  return detector;
}

void PlanReader::read_length(const TomlNode& table, LightStage& stage) const {
  constexpr double kLeast = 1e-3;
  const TomlNode* duration = find(table, "duration");
  const TomlNode* least = find(table, "min");
  if ((duration == nullptr) == (least == nullptr))
    reader_.fail(table, "a stage requires 'duration', or 'min', 'max', 'gap' and 'detectors', in seconds");
  for (const std::string_view key : {"max", "gap"})
    if (duration != nullptr && find(table, key) != nullptr)
      reader_.fail(*find(table, key), fmt::format("a stage with a 'duration' cannot have '{}'", key));
  if (duration != nullptr) {
    stage.shortest = stage.longest = reader_.number(*duration, "duration", kLeast, kMaxSeconds, "seconds");
    return;
  }
  stage.shortest = reader_.number(*least, "min", kLeast, kMaxSeconds, "seconds");
  stage.longest =
      reader_.number(required(table, "max", "max = 20, in seconds"), "max", stage.shortest, kMaxSeconds, "seconds");
  stage.gap = reader_.number(required(table, "gap", "gap = 2, in seconds"), "gap", 0.0, kMaxSeconds, "seconds");
  if (stage.detectors.empty()) reader_.fail(*least, "a stage with 'min' and 'max' requires 'detectors'");
}

void PlanReader::read_states(const TomlNode& table, const LightProgram& program, LightStage& stage) const {
  std::vector<std::string_view> own;
  for (const std::uint32_t light : program.lights) own.push_back(lights_[light]);
  stage.states.assign(own.size(), LightState::red);
  const TomlNode* states = reader_.table(table, "states");
  if (states == nullptr) return;
  constexpr auto kWords = words_of(LightState{});
  for (const TomlNode& item : states->items) {
    const std::uint32_t light = row(item, item.key, own, "light of this program");
    const auto word = std::find(kWords.begin(), kWords.end(), item.text);
    if (item.kind != Kind::text || word == kWords.end())
      reader_.fail(item,
                   fmt::format("'{}' expects a state in quotes{}", item.key, base::expected_one_of(item.text, kWords)));
    stage.states[light] = static_cast<LightState>(word - kWords.begin());
  }
}

LightStage PlanReader::read_stage(const TomlNode& table, const LightProgram& program) const {
  reader_.require_known(table, kStageKeys);
  LightStage stage;
  read_states(table, program, stage);
  for (const TomlNode* name : texts(table, "detectors", false))
    stage.detectors.push_back(row(*name, name->text, detectors_, "detector"));
  read_length(table, stage);
  stage.on_call = reader_.flag(table, "on_call");
  if (stage.on_call && stage.detectors.empty()) reader_.fail(table, "a stage that is 'on_call' requires 'detectors'");
  if (!stage.detectors.empty() && stage.shortest == stage.longest && !stage.on_call)
    reader_.fail(*find(table, "detectors"), "a stage of fixed length can have 'detectors' only with on_call = true");
  stage.yellow = reader_.number(table, "yellow", 2.0, 0.0, kMaxSeconds, "seconds");
  stage.clear = reader_.number(table, "clear", 1.0, 0.0, kMaxSeconds, "seconds");
  return stage;
}

LightProgram PlanReader::read_program(const TomlNode& table) {
  reader_.require_known(table, kProgramKeys);
  LightProgram program;
  program.name = reader_.text(table, "name", fmt::format("program of line {}", table.line));
  for (const TomlNode* name : texts(table, "lights", true)) {
    program.lights.push_back(row(*name, name->text, lights_, "light of the world"));
    require_new(*name, name->text, taken_);
    taken_.push_back(lights_[program.lights.back()]);
  }
  const auto stages = reader_.tables(table, "stage");
  if (stages.empty() || stages.size() > kMaxStages)
    reader_.fail(table, fmt::format("a program requires 1 to {} [[program.stage]] sections", kMaxStages));
  for (const TomlNode* stage : stages) program.stages.push_back(read_stage(*stage, program));
  program.offset = reader_.number(table, "offset", 0.0, -kMaxSeconds, kMaxSeconds, "seconds");
  if (is_actuated(program) && find(table, "offset") != nullptr)
    reader_.fail(*find(table, "offset"), "an actuated program cannot have an 'offset': its stages have no fixed times");
  const auto always = [](const LightStage& stage) { return !stage.on_call; };
  if (std::none_of(program.stages.begin(), program.stages.end(), always))
    reader_.fail(table, "every stage is 'on_call'; expected one in which the lights can rest");
  return program;
}

/// Returns the distance [m] from light k - 1 of a wave to light k: as given, or else straight.
double PlanReader::distance(const TomlNode& table, const std::vector<std::uint32_t>& lights, std::size_t k) const {
  const TomlNode* given = find(table, "distances");
  if (given != nullptr) {
    if (given->kind != Kind::list || given->items.size() + 1 != lights.size())
      reader_.fail(*given, fmt::format("'distances' expects {} numbers, one from each light to the next, in metres",
                                       lights.size() - 1));
    return reader_.number(given->items[k - 1], "distances", 0.0, kMaxMetres, "metres");
  }
  const Pose &a = world_.lights[lights[k - 1]].X_WL, &b = world_.lights[lights[k]].X_WL;
  return base::hypot(b.x - a.x, b.y - a.y);
}

/// Shifts programs so that each light of the wave turns green when a robot at the wave's speed arrives from the
/// previous one.
void PlanReader::read_wave(const TomlNode& table, LightPlan& plan) const {
  reader_.require_known(table, kWaveKeys);
  const double speed = reader_.number(required(table, "speed", "speed = 0.2, in m/s"), "speed", 1e-3, 1e3, "m/s");
  double green_at = reader_.number(table, "start", 0.0, -kMaxSeconds, kMaxSeconds, "seconds");
  std::vector<std::uint32_t> lights;
  const auto names = texts(table, "lights", true);
  for (const TomlNode* name : names) lights.push_back(row(*name, name->text, lights_, "light of the world"));
  std::optional<double> cycle;
  for (std::size_t k = 0; k < lights.size(); ++k) {
    if (k > 0) green_at += distance(table, lights, k) / speed;
    const auto has = [&](const LightProgram& p) {
      return std::find(p.lights.begin(), p.lights.end(), lights[k]) != p.lights.end();
    };
    const auto program = std::find_if(plan.programs.begin(), plan.programs.end(), has);
    if (program == plan.programs.end() || is_actuated(*program))
      reader_.fail(*names[k],
                   fmt::format("'{}' is in no program of fixed stages; a wave requires one", names[k]->text));
    const std::optional<double> green = first_green(*program, lights[k]);
    if (!green) reader_.fail(*names[k], fmt::format("'{}' is never green in its program", names[k]->text));
    if (cycle && std::abs(*cycle - cycle_of(*program)) > 1e-6)
      reader_.fail(*names[k], fmt::format("the cycle of '{}' is {:g} s, that of the lights before it {:g} s; a wave "
                                          "requires equal cycles (including yellow and clear times)",
                                          names[k]->text, cycle_of(*program), *cycle));
    cycle = cycle_of(*program);
    program->offset = green_at - *green;
  }
}

LightPlan PlanReader::read(const TomlNode& root) {
  reader_.require_kind(root, "a plan of traffic lights");
  reader_.require_known(root, kPlanKeys);
  LightPlan plan;
  const auto detectors = reader_.tables(root, "detector"), programs = reader_.tables(root, "program");
  if (programs.empty()) reader_.fail(root, "no program; expected a [[program]] section, see docs/v2x.md");
  if (programs.size() > kMaxPrograms || detectors.size() > kMaxDetectors)
    reader_.fail(root, fmt::format("more than {} programs or {} detectors", kMaxPrograms, kMaxDetectors));
  plan.detectors.reserve(detectors.size());  // names refer to it
  for (const TomlNode* table : detectors) {
    plan.detectors.push_back(read_detector(*table));
    require_new(*table, plan.detectors.back().name, detectors_);
    detectors_.emplace_back(plan.detectors.back().name);
  }
  for (const TomlNode* table : programs) plan.programs.push_back(read_program(*table));
  for (const TomlNode* table : reader_.tables(root, "wave")) read_wave(*table, plan);
  for (const LightProgram& program : plan.programs)
    if (!is_actuated(program)) set_phases(program, world_);
  return plan;
}

}  // namespace

bool is_actuated(const LightProgram& program) {
  return std::any_of(program.stages.begin(), program.stages.end(),
                     [](const LightStage& stage) { return stage.on_call || stage.shortest < stage.longest; });
}

bool needs_yellow(const LightProgram& program, std::size_t from, std::size_t to, std::size_t i) {
  const LightState next = program.stages[to].states[i];
  return program.stages[from].states[i] == LightState::green && next != LightState::green && next != LightState::yellow;
}

std::string world_of_plan(const std::string& file, std::string_view text) {
  const TomlReader reader(file);
  const TomlNode root = parse_toml(file, text);
  if (find(root, "world") == nullptr) reader.fail(root, "'world' is missing; expected world = \"town.world\"");
  const std::filesystem::path named = reader.text(root, "world", "");
  return (std::filesystem::path(file).parent_path() / named).lexically_normal().string();
}

LightPlan parse_light_plan(const std::string& file, std::string_view text, World& world) {
  LightPlan plan = PlanReader(file, world).read(parse_toml(file, text));
  plan.world = world.file;
  return plan;
}

}  // namespace sf::world
