#include "netio/bridges/ros_services.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "netio/bridges/ros_entities.h"

namespace sf::bridges {

using record::CdrReader;
using record::CdrWriter;

namespace {

// simulation_interfaces/msg/Result, and further codes of SetSimulationState and SetEntityState
constexpr std::uint8_t kUnsupported = 0, kOk = 1, kNotFound = 2, kFailed = 4, kAlready = 101, kInvalidPose = 101;

// simulation_interfaces/msg/SimulationState
constexpr std::uint8_t kStopped = 0, kPlaying = 1, kPaused = 2;

// simulation_interfaces/srv/ResetSimulation: all; time and state; both, and what was spawned
constexpr std::array<std::uint8_t, 4> kScopes = {0, 3, 7, 255};

// simulation_interfaces/msg/SimulatorFeatures: states of entities and of the run are given; where it is simulated,
// entities are placed, and the run is reset (its time, its state), begun and paused, and makes one step or many.
constexpr std::array<std::uint16_t, 2> kFeatures = {10, 24};
constexpr std::array<std::uint16_t, 8> kFeaturesSimulated = {11, 20, 21, 22, 25, 26, 31, 32};

constexpr std::string_view kResult = "simulation_interfaces/Result result\n";
constexpr std::string_view kSuccess = "bool success\nstring message\n";

std::size_t row_of(const record::RunInfo& info, const std::string& frame) {
  const auto found = std::find_if(info.movers.begin(), info.movers.end(),
                                  [&](const record::MoverInfo& mover) { return mover.frame == frame; });
  return static_cast<std::size_t>(found - info.movers.begin());
}

}  // namespace

/// The services, with what each does. A handler returns false where the request cannot be read.
struct RosServices::Handlers {
  using Handler = bool (*)(RosServices&, Call, CdrReader&, Requests&);
  struct Row {
    ServiceType type;
    Handler handler;
    bool simulated;
  };
  static const std::array<Row, 12> kRows;

  static bool get_features(RosServices& of, Call call, CdrReader&, Requests&) {
    CdrWriter cdr = of.begin_answer(call);
    cdr.put_count(kFeatures.size() + (of.scene_.simulated ? kFeaturesSimulated.size() : 0));
    for (const std::uint16_t feature : kFeatures) cdr.put(feature);
    if (of.scene_.simulated)
      for (const std::uint16_t feature : kFeaturesSimulated) cdr.put(feature);
    cdr.put_count(0);  // formats of what can be spawned
    cdr.put("");
    return true;
  }

  static bool get_state(RosServices& of, Call call, CdrReader&, Requests&) {
    CdrWriter cdr = of.begin_answer(call);
    cdr.put(of.stopped_ ? kStopped : of.state_.paused ? kPaused : kPlaying);
    cdr.put(kOk);
    cdr.put("");
    return true;
  }

  static bool list(RosServices& of, Call call, CdrReader& request, bool states) {
    std::vector<std::size_t> rows;
    const std::string fault = find_entities(request, of.scene_.info, of.movers_, rows);
    if (!request.good()) return false;
    CdrWriter cdr = of.begin_answer(call);
    cdr.put(fault.empty() ? kOk : kUnsupported);
    cdr.put(fault);
    cdr.put_count(rows.size());
    for (const std::size_t row : rows) cdr.put(of.scene_.info.movers[row].frame);
    if (!states) return true;
    cdr.put_count(rows.size());
    for (const std::size_t row : rows) put_entity_state(cdr, of.time_, of.movers_[row]);
    return true;
  }
  static bool get_entities(RosServices& of, Call call, CdrReader& request, Requests&) {
    return list(of, call, request, false);
  }
  static bool get_entities_states(RosServices& of, Call call, CdrReader& request, Requests&) {
    return list(of, call, request, true);
  }

  static bool get_entity(RosServices& of, Call call, CdrReader& request, Requests&) {
    const std::string name = request.get_string();
    if (!request.good()) return false;
    const std::size_t row = row_of(of.scene_.info, name);
    const bool found = row < of.movers_.size() && !base::is_absent(of.movers_[row].X_WM);
    CdrWriter cdr = of.begin_answer(call);
    cdr.put(found ? kOk : kNotFound);
    cdr.put(found ? "" : "no entity of that name is present");
    put_entity_state(cdr, of.time_, found ? of.movers_[row] : base::Report{});
    return true;
  }

  static bool set_entity(RosServices& of, Call call, CdrReader& request, Requests& requests) {
    const std::string name = request.get_string();
    const std::size_t row = row_of(of.scene_.info, name);
    const bool found = row < of.movers_.size() && !base::is_absent(of.movers_[row].X_WM);
    const EntityState wanted = get_entity_state(request, found ? of.movers_[row].X_WM.z : 0.0);
    if (!request.good()) return false;
    if (!found) return of.add_result(call, kNotFound, "no entity of that name is present"), true;
    if (!wanted.frame.empty() && wanted.frame != "world")
      return of.add_result(call, kUnsupported, "poses are in the frame \"world\""), true;
    if (!wanted.pose || wanted.twist || wanted.acceleration)
      return of.add_result(call, kUnsupported, "only poses are set; velocities are commanded by cmd_vel"), true;
    if (!wanted.valid)
      return of.add_result(call, kInvalidPose, "expected a finite position, and a turn about z of length 1"), true;
    requests.placements.push_back({static_cast<std::uint32_t>(row), wanted.X_WM});
    of.add_result(call, kOk);
    return true;
  }

  static bool pause(RosServices& of, Call call, bool paused, Requests& requests) {
    requests.paused = paused;
    call.paused = paused;
    return of.wait(call);
  }

  static bool set_state(RosServices& of, Call call, CdrReader& request, Requests& requests) {
    const auto wanted = request.get<std::uint8_t>();
    if (!request.good()) return false;
    if (wanted > kPaused)
      return of.add_result(call, kUnsupported, "a run is stopped (0), played (1) or paused (2)"), true;
    const std::uint8_t present = of.stopped_ ? kStopped : of.state_.paused ? kPaused : kPlaying;
    if (wanted == present) return of.add_result(call, kAlready), true;
    if (wanted == kPaused && present == kStopped) return of.stopped_ = false, of.add_result(call, kOk), true;
    if (wanted != kStopped) return pause(of, call, wanted == kPaused, requests);
    requests.paused = true;
    requests.reset = true;
    call.until = Until::reset;
    call.paused = true;
    return of.wait(call);
  }

  static bool step(RosServices& of, Call call, std::uint64_t steps, Requests& requests) {
    if (!of.state_.paused) return of.add_result(call, kFailed, "the run is not paused"), true;
    if (steps == 0 || steps > kMaxSteps)
      return of.add_result(call, kFailed, fmt::format("expected 1 to {} steps", kMaxSteps)), true;
    requests.steps += static_cast<std::uint32_t>(steps);
    call.until = Until::steps;
    call.steps = static_cast<std::uint32_t>(steps);
    return of.wait(call);
  }

  static bool step_simulation(RosServices& of, Call call, CdrReader& request, Requests& requests) {
    const auto steps = request.get<std::uint64_t>();
    return request.good() && step(of, call, steps, requests);
  }

  static bool reset(RosServices& of, Call call, CdrReader&, Requests& requests) {
    requests.reset = true;
    call.until = Until::reset;
    return of.wait(call);
  }

  static bool reset_simulation(RosServices& of, Call call, CdrReader& request, Requests& requests) {
    const auto scope = request.get<std::uint8_t>();
    if (!request.good()) return false;
    if (std::find(kScopes.begin(), kScopes.end(), scope) == kScopes.end())
      return of.add_result(call, kUnsupported, "time and state are reset together only: scope 0, 3, 7 or 255"), true;
    return reset(of, call, request, requests);
  }

  static bool set_pause(RosServices& of, Call call, CdrReader& request, Requests& requests) {
    const bool paused = request.get<bool>();
    return request.good() && pause(of, call, paused, requests);
  }

  static bool step_once(RosServices& of, Call call, CdrReader&, Requests& requests) {
    return step(of, call, 1, requests);
  }
};

const std::array<RosServices::Handlers::Row, 12> RosServices::Handlers::kRows = {{
    {{"/get_simulator_features", "simulation_interfaces/srv/GetSimulatorFeatures", "",
      "simulation_interfaces/SimulatorFeatures features\n"},
     get_features,
     false},
    {{"/get_simulation_state", "simulation_interfaces/srv/GetSimulationState", "",
      "simulation_interfaces/SimulationState state\nsimulation_interfaces/Result result\n"},
     get_state,
     false},
    {{"/get_entities", "simulation_interfaces/srv/GetEntities", "simulation_interfaces/EntityFilters filters\n",
      "simulation_interfaces/Result result\nstring[] entities\n"},
     get_entities,
     false},
    {{"/get_entities_states", "simulation_interfaces/srv/GetEntitiesStates",
      "simulation_interfaces/EntityFilters filters\n",
      "simulation_interfaces/Result result\nstring[] entities\nsimulation_interfaces/EntityState[] states\n"},
     get_entities_states,
     false},
    {{"/get_entity_state", "simulation_interfaces/srv/GetEntityState", "string entity\n",
      "simulation_interfaces/Result result\nsimulation_interfaces/EntityState state\n"},
     get_entity,
     false},
    {{"/set_entity_state", "simulation_interfaces/srv/SetEntityState",
      "string entity\nsimulation_interfaces/EntityState state\n"
      "bool set_pose\nbool set_twist\nbool set_acceleration\n",
      kResult},
     set_entity,
     true},
    {{"/set_simulation_state", "simulation_interfaces/srv/SetSimulationState",
      "simulation_interfaces/SimulationState state\n", kResult},
     set_state,
     true},
    {{"/step_simulation", "simulation_interfaces/srv/StepSimulation", "uint64 steps 1\n", kResult},
     step_simulation,
     true},
    {{"/reset_simulation", "simulation_interfaces/srv/ResetSimulation", "uint8 scope\n", kResult},
     reset_simulation,
     true},
    {{"/sensorfarm/pause", "std_srvs/srv/SetBool", "bool data\n", kSuccess}, set_pause, true},
    {{"/sensorfarm/step", "std_srvs/srv/Trigger", "", kSuccess}, step_once, true},
    {{"/sensorfarm/reset", "std_srvs/srv/Trigger", "", kSuccess}, reset, true},
}};

// The services that change nothing come first, so that a service's row is the same in both lists.
RosServices::RosServices(const Scene& scene) : scene_(scene) {
  for (const Handlers::Row& row : Handlers::kRows)
    if (scene.simulated || !row.simulated) types_.push_back(row.type);
  for (const world::Mover& mover : scene.world.movers)
    movers_.push_back({.mover = static_cast<std::uint32_t>(movers_.size()), .X_WM = mover.X_WM});
}

bool RosServices::take(std::size_t service, std::span<const std::uint8_t> message, std::uint64_t writer,
                       Requests& requests) {
  CdrReader cdr(message);
  Call call{.service = service};
  call.caller.client = cdr.get<std::uint64_t>();
  call.caller.sequence = cdr.get<std::int64_t>();
  call.caller.writer = writer;
  if (!cdr.good()) return false;
  const Handlers::Row& row = Handlers::kRows[service];
  if (!row.simulated || waiting_.size() < kMaxWaiting) return row.handler(*this, call, cdr, requests);
  add_result(call, kFailed, "too many requests wait for the run");
  return true;
}

void RosServices::observe(const base::TickRecord* tick, const RunState& state) {
  const bool began_again = state.runs != state_.runs;
  state_ = state;
  if (tick != nullptr) {
    time_ = tick->time;
    for (const base::Report& report : tick->reports) movers_[report.mover] = report;
  }
  if (tick != nullptr || !state.paused) stopped_ = false;
  bool ticked = tick != nullptr;
  std::erase_if(waiting_, [&](Call& call) { return finish(call, ticked, began_again); });
}

std::vector<Answer> RosServices::answers() { return std::exchange(answers_, {}); }

CdrWriter RosServices::begin_answer(const Call& call) {
  CdrWriter cdr(answers_.emplace_back(Answer{call.service, call.caller, {}}).message);
  cdr.put(call.caller.client);
  cdr.put(call.caller.sequence);
  return cdr;
}

void RosServices::add_result(const Call& call, std::uint8_t code, std::string_view message) {
  CdrWriter cdr = begin_answer(call);
  if (types_[call.service].response == kResult)
    cdr.put(code);
  else
    cdr.put(code == kOk);
  cdr.put(message);
}

bool RosServices::wait(const Call& call) {
  waiting_.push_back(call);
  return true;
}

bool RosServices::finish(Call& call, bool& ticked, bool began_again) {
  if (call.until == Until::reset) {
    if (!began_again) return false;
    stopped_ = call.paused && state_.paused;
    return add_result(call, kOk), true;
  }
  if (call.until == Until::state) {
    const bool done = state_.paused == call.paused;
    return add_result(call, done ? kOk : kFailed, done ? "" : "another user chose otherwise"), true;
  }
  if (began_again || !state_.paused) return add_result(call, kFailed, "the run went on or began again"), true;
  if (!std::exchange(ticked, false) || --call.steps > 0) return false;
  add_result(call, kOk);
  return true;
}

}  // namespace sf::bridges
