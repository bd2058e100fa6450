#include "bridges/ros_services.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "bridges/ros_entities.h"

namespace sf::bridges {

using record::CdrReader;
using record::CdrWriter;

namespace {

// Additional codes: SetSimulationState, SetEntityState, SpawnEntities, GetCurrentWorld and UnloadWorld, LoadWorld
constexpr std::uint8_t kAlready = 101, kInvalidPose = 101, kSpawnFailed = 150, kNoWorld = 101, kParseError = 103,
                       kUnsupportedElements = 106;

// simulation_interfaces/msg/SimulationState
constexpr std::uint8_t kStateStopped = 0, kStatePlaying = 1, kStatePaused = 2;

// simulation_interfaces/srv/ResetSimulation: all; time and state; both, and spawned entities
constexpr std::array<std::uint8_t, 4> kScopes = {0, 3, 7, 255};

// simulation_interfaces/msg/SimulatorFeatures. Always available: named poses with bounds, bounds, states and infos of
// entities, state and world of the run. In simulated runs also: spawning one or several entities from spawnables,
// deleting and placing them; resetting the run (time, state, spawned entities), starting, pausing, and single or
// multiple steps, also as an action; listing, loading and unloading worlds.
constexpr std::array<std::uint16_t, 7> kFeatures = {2, 3, 5, 10, 12, 24, 44};
constexpr std::array<std::uint16_t, 17> kFeaturesSimulated = {0,  1,  11, 14, 20, 21, 22, 23, 25,
                                                              26, 31, 32, 33, 40, 43, 45, 50};

constexpr std::string_view kResult = "simulation_interfaces/Result result\n";
constexpr std::string_view kBounds = "simulation_interfaces/Result result\nsimulation_interfaces/Bounds bounds\n";
constexpr std::string_view kWorld = "simulation_interfaces/Result result\nsimulation_interfaces/WorldResource world\n";
constexpr std::string_view kSpawn =
    "string name\nbool allow_renaming\nsimulation_interfaces/Resource entity_resource\n"
    "string entity_namespace\ngeometry_msgs/PoseStamped initial_pose\n";
constexpr std::string_view kUuid = "unique_identifier_msgs/UUID goal_id\n";
constexpr const char* kNoEntity = "no entity of that name is present";
constexpr const char* kManySpawns = "64 robots are waiting to join; try again";
constexpr std::size_t kLeastSpawn = 90;  // [byte] of a SpawnEntity
constexpr std::string_view kSuccess = "bool success\nstring message\n";

std::uint8_t code_of(const Outcome& outcome) {
  switch (outcome.fault) {
    case Outcome::Fault::none:
      return kOk;
    case Outcome::Fault::unreadable:
      return kParseError;
    case Outcome::Fault::unsupported:
      return kUnsupportedElements;
    case Outcome::Fault::failed:
      return kFailed;
  }
  return kFailed;
}

void put_result(CdrWriter& cdr, std::uint8_t code, std::string_view message = {}) {
  cdr.put(code);
  cdr.put(message);
}

}  // namespace

/// The services and their handlers. A handler returns false if the request cannot be parsed.
struct RosServices::Handlers {
  using Handler = bool (*)(RosServices&, Call, CdrReader&, Requests&);
  struct Row {
    ServiceType type;
    Handler handler;
    bool simulated;
  };
  static const std::array<Row, 27> kRows;

  static bool get_features(RosServices& of, Call call, CdrReader&, Requests&) {
    CdrWriter cdr = of.begin_answer(call);
    cdr.put_count(kFeatures.size() + (of.scene_.simulated ? kFeaturesSimulated.size() : 0));
    for (const std::uint16_t feature : kFeatures) cdr.put(feature);
    if (of.scene_.simulated)
      for (const std::uint16_t feature : kFeaturesSimulated) cdr.put(feature);
    cdr.put_count(0);  // formats of spawnables
    cdr.put("");
    return true;
  }

  static bool get_state(RosServices& of, Call call, CdrReader&, Requests&) {
    CdrWriter cdr = of.begin_answer(call);
    cdr.put(of.stopped_ ? kStateStopped : of.state_.paused ? kStatePaused : kStatePlaying);
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
    const std::uint32_t row = of.row_of(name);
    const bool found = row < of.movers_.size();
    CdrWriter cdr = of.begin_answer(call);
    cdr.put(found ? kOk : kNotFound);
    cdr.put(found ? "" : kNoEntity);
    put_entity_state(cdr, of.time_, found ? of.movers_[row] : base::Report{});
    return true;
  }

  static bool set_entity(RosServices& of, Call call, CdrReader& request, Requests& requests) {
    const std::string name = request.get_string();
    const std::uint32_t row = of.row_of(name);
    const bool found = row < of.movers_.size();
    const EntityState wanted = get_entity_state(request, found ? of.movers_[row].X_WM.z : 0.0);
    if (!request.good()) return false;
    if (!found) return of.add_result(call, kNotFound, kNoEntity), true;
    if (!wanted.frame.empty() && wanted.frame != "world")
      return of.add_result(call, kUnsupported, "poses are in the frame \"world\""), true;
    if (!wanted.pose || wanted.twist || wanted.acceleration)
      return of.add_result(call, kUnsupported, "only poses can be set; velocities are commanded by cmd_vel"), true;
    if (!wanted.valid)
      return of.add_result(call, kInvalidPose, "expected a finite position, and a quaternion of length 1"), true;
    requests.placements.push_back({row, wanted.X_WM, wanted.tilt});
    of.add_result(call, kOk);
    return true;
  }

  static bool get_info(RosServices& of, Call call, CdrReader& request, Requests&) {
    const std::uint32_t row = of.row_of(request.get_string());
    if (!request.good()) return false;
    const bool found = row < of.movers_.size();
    CdrWriter cdr = of.begin_answer(call);
    put_result(cdr, found ? kOk : kNotFound, found ? "" : kNoEntity);
    if (found) return put_entity_info(cdr, of.scene_, row), true;
    cdr.put(std::uint8_t{0});
    cdr.put("");
    cdr.put_count(0);
    return true;
  }

  static bool answer_bounds(RosServices& of, const Call& call, std::uint32_t row, const char* fault) {
    CdrWriter cdr = of.begin_answer(call);
    put_result(cdr, fault == nullptr ? kOk : kNotFound, fault == nullptr ? "" : fault);
    put_bounds(cdr, of.scene_, row);
    return true;
  }
  static bool get_bounds(RosServices& of, Call call, CdrReader& request, Requests&) {
    const std::uint32_t row = of.row_of(request.get_string());
    return request.good() && answer_bounds(of, call, row, row < of.movers_.size() ? nullptr : kNoEntity);
  }

  static bool get_poses(RosServices& of, Call call, CdrReader& request, Requests&) {
    const TagsFilter filter = get_tags_filter(request);
    if (!request.good()) return false;
    std::vector<NamedPose> poses = named_poses_of(of.scene_);
    std::erase_if(poses, [&](const NamedPose& pose) { return !filter.matches(pose.tags); });
    CdrWriter cdr = of.begin_answer(call);
    put_result(cdr, kOk);
    cdr.put_count(poses.size());
    for (const NamedPose& pose : poses) put_named_pose(cdr, pose);
    return true;
  }
  static bool get_pose_bounds(RosServices& of, Call call, CdrReader& request, Requests&) {
    const std::string name = request.get_string();
    if (!request.good()) return false;
    for (const NamedPose& pose : named_poses_of(of.scene_))
      if (pose.name == name) return answer_bounds(of, call, pose.mover, nullptr);
    return answer_bounds(of, call, ~0u, "no pose has that name");
  }

  static bool get_spawnables(RosServices& of, Call call, CdrReader& request, Requests&) {
    std::string unknown;
    for (std::uint32_t left = request.get_count(5); left > 0 && request.good(); --left)
      unknown += (unknown.empty() ? "not searched: " : ", ") + request.get_string();
    if (!request.good()) return false;
    CdrWriter cdr = of.begin_answer(call);
    put_result(cdr, kOk, unknown.substr(0, 1000));
    cdr.put_count(of.kinds_.size());
    for (const std::uint32_t row : of.kinds_) put_spawnable(cdr, of.scene_, row);
    return true;
  }

  /// Answers immediately if there is nothing to do.
  static bool wait_for(RosServices& of, Call call) {
    call.until = Until::outcomes;
    return call.outcomes.empty() ? call.answer(of, call), true : of.wait(call);
  }
  static void ask(Call& call, std::vector<Spawn> spawns, Requests& requests) {
    for (const Spawn& spawn : spawns) {
      if (spawn.code != kOk) continue;
      requests.joining.push_back(spawn.joining);
      call.outcomes.push_back(spawn.joining.outcome);
    }
    call.spawns = std::move(spawns);
  }
  static void put_spawned(CdrWriter& cdr, const Spawn& spawn) {
    const bool asked = spawn.code == kOk;
    const std::uint8_t code = asked ? code_of(*spawn.joining.outcome) : spawn.code;
    put_result(cdr, code, asked ? spawn.joining.outcome->reason : spawn.message);
    cdr.put(code == kOk ? spawn.joining.name : "");
  }
  static bool spawn(RosServices& of, Call call, CdrReader& request, Requests& requests) {
    std::set<std::string> taken = of.waiting_names();
    const bool room = taken.size() < kMaxSpawns;
    Spawn wanted = get_spawn(request, of.scene_, of.movers_, taken);
    if (!request.good()) return false;
    if (!room) wanted = {kFailed, kManySpawns, {}};
    ask(call, {std::move(wanted)}, requests);
    call.answer = [](RosServices& to, const Call& done) {
      CdrWriter cdr = to.begin_answer(done);
      put_spawned(cdr, done.spawns.front());
    };
    return wait_for(of, call);
  }
  static bool spawn_several(RosServices& of, Call call, CdrReader& request, Requests& requests) {
    std::set<std::string> taken = of.waiting_names();
    const std::size_t room = kMaxSpawns - std::min(kMaxSpawns, taken.size());
    const std::uint32_t count = request.get_count(kLeastSpawn);
    std::vector<Spawn> all;
    for (std::uint32_t i = 0; i < std::min<std::size_t>(count, room) && request.good(); ++i)
      all.push_back(get_spawn(request, of.scene_, of.movers_, taken));
    if (!request.good()) return false;
    all.resize(count, {kFailed, kManySpawns, {}});
    ask(call, std::move(all), requests);
    call.answer = [](RosServices& to, const Call& done) {
      const bool good = std::all_of(done.spawns.begin(), done.spawns.end(), [](const Spawn& each) {
        return each.code == kOk && each.joining.outcome->fault == Outcome::Fault::none;
      });
      CdrWriter cdr = to.begin_answer(done);
      put_result(cdr, good ? kOk : kSpawnFailed, good ? "" : "see the results");
      cdr.put_count(done.spawns.size());
      for (const Spawn& each : done.spawns) put_spawned(cdr, each);
    };
    return wait_for(of, call);
  }

  static bool remove(RosServices& of, Call call, CdrReader& request, Requests& requests) {
    const std::uint32_t row = of.row_of(request.get_string());
    if (!request.good()) return false;
    if (row >= of.movers_.size()) return of.add_result(call, kNotFound, kNoEntity), true;
    requests.leaving.push_back({row, call.outcomes.emplace_back(std::make_shared<Outcome>())});
    call.answer = [row](RosServices& to, const Call& done) {
      const Outcome& outcome = *done.outcomes.front();
      if (outcome.fault == Outcome::Fault::none && row < to.movers_.size()) to.movers_[row].X_WM = base::kAbsent;
      to.add_result(done, code_of(outcome), outcome.reason);
    };
    return wait_for(of, call);
  }

  static void answer_world(RosServices& of, const Call& call, std::uint8_t code, const std::string& message) {
    CdrWriter cdr = of.begin_answer(call);
    put_result(cdr, code, message);
    const bool good = code == kOk;
    put_world(cdr, good ? of.world_uri() : "", good ? of.scene_.info.world : "");
  }
  static bool get_world(RosServices& of, Call call, CdrReader&, Requests&) {
    return answer_world(of, call, of.unloaded_ ? kNoWorld : kOk, of.unloaded_ ? "no world is loaded" : ""), true;
  }
  static bool get_worlds(RosServices& of, Call call, CdrReader& request, Requests&) {
    std::string unknown;
    for (std::uint32_t left = request.get_count(5); left > 0 && request.good(); --left)
      unknown += (unknown.empty() ? "not searched: " : ", ") + request.get_string();
    const TagsFilter filter = get_tags_filter(request);
    request.get<bool>(), request.get<bool>();  // local sources only; continue after errors
    if (!request.good()) return false;
    const std::vector<AvailableWorld> worlds = filter.matches({}) ? of.worlds() : std::vector<AvailableWorld>();
    CdrWriter cdr = of.begin_answer(call);
    put_result(cdr, kOk, unknown.substr(0, 1000));
    cdr.put_count(worlds.size());
    for (const AvailableWorld& each : worlds) put_world(cdr, each.uri, each.uri);
    return true;
  }
  static bool load_world(RosServices& of, Call call, CdrReader& request, Requests& requests) {
    const std::string uri = request.get_string(), text = request.get_string();
    const bool strict = request.get<bool>();
    request.get<bool>();  // missing assets: a world without its files is not accepted
    if (!request.good()) return false;
    const auto refuse = [&](std::uint8_t code, const std::string& why) { answer_world(of, call, code, why); };
    constexpr std::uint8_t kFormat = 101, kNone = 102;
    if (uri.empty() && text.empty()) return refuse(kNone, "expected a URI that /get_available_worlds lists"), true;
    if (uri.empty()) return refuse(kUnsupported, "worlds are loaded by URI, not from text"), true;
    const std::vector<AvailableWorld>& worlds = of.worlds();
    const auto found = std::find_if(worlds.begin(), worlds.end(), [&](const auto& each) { return each.uri == uri; });
    const bool is_format = uri.ends_with(".world") || uri.ends_with(".yaml");
    if (found == worlds.end() && !is_format)
      return refuse(kFormat, "expected a world file (.world) or a ROS map (.yaml)"), true;
    if (found == worlds.end()) return refuse(kNotFound, "expected a URI that /get_available_worlds lists"), true;
    requests.world = WorldChange{found->file, strict, call.outcomes.emplace_back(std::make_shared<Outcome>())};
    call.answer = [](RosServices& to, const Call& done) {
      const Outcome& outcome = *done.outcomes.front();
      if (outcome.fault == Outcome::Fault::none) to.stopped_ = true, to.unloaded_ = false;
      answer_world(to, done, code_of(outcome), outcome.reason);
    };
    return wait_for(of, call);
  }
  static bool unload_world(RosServices& of, Call call, CdrReader&, Requests& requests) {
    if (of.unloaded_) return of.add_result(call, kNoWorld, "no world is loaded"), true;
    requests.world = WorldChange{"", false, call.outcomes.emplace_back(std::make_shared<Outcome>())};
    call.answer = [](RosServices& to, const Call& done) {
      const Outcome& outcome = *done.outcomes.front();
      if (outcome.fault == Outcome::Fault::none) to.stopped_ = to.unloaded_ = true;
      to.add_result(done, code_of(outcome), outcome.reason);
    };
    return wait_for(of, call);
  }

  static bool send_goal(RosServices& of, Call call, CdrReader& request, Requests& requests) {
    call.goal = StepsAction::get_id(request);
    const auto steps = request.get<std::uint64_t>();
    if (!request.good()) return false;
    const bool accepted = of.steps_.accept(call.goal, steps, of.time_);
    CdrWriter cdr = of.begin_answer(call);
    cdr.put(accepted);
    cdr.put(static_cast<std::int32_t>(of.time_ / 1'000'000'000));
    cdr.put(static_cast<std::uint32_t>(of.time_ % 1'000'000'000));
    if (!accepted) return true;
    StepsAction::Goal& goal = *of.steps_.find(call.goal);
    const auto abort = [&](const std::string& why) {
      of.steps_.end(goal, StepsAction::Status::aborted, kFailed, why);
      return true;
    };
    if (!of.state_.paused) return abort("the run is not paused");
    if (steps == 0 || steps > kMaxSteps) return abort(fmt::format("expected 1 to {} steps", kMaxSteps));
    requests.steps += static_cast<std::uint32_t>(steps);
    call.until = Until::goal;
    return of.wait(call);
  }
  static bool cancel_goal(RosServices& of, Call call, CdrReader& request, Requests& requests) {
    base::Bytes fields;
    CdrWriter cdr = of.begin_answer(call);
    const std::uint64_t left = of.steps_.cancel(request, cdr);
    if (!request.good()) return of.answers_.pop_back(), false;
    requests.dropped_steps += static_cast<std::uint32_t>(left);
    return true;
  }
  static bool get_result(RosServices& of, Call call, CdrReader& request, Requests&) {
    call.goal = StepsAction::get_id(request);
    if (!request.good()) return false;
    const StepsAction::Goal* const goal = of.steps_.find(call.goal);
    call.until = Until::result;
    if (goal != nullptr && goal->is_active()) return of.wait(call);
    CdrWriter cdr = of.begin_answer(call);
    StepsAction::put_result(cdr, goal != nullptr ? *goal : StepsAction::Goal{.status = StepsAction::Status::unknown});
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
    if (wanted > kStatePaused)
      return of.add_result(call, kUnsupported, "expected stopped (0), playing (1) or paused (2)"), true;
    const std::uint8_t present = of.stopped_ ? kStateStopped : of.state_.paused ? kStatePaused : kStatePlaying;
    if (wanted == present) return of.add_result(call, kAlready), true;
    if (wanted == kStatePaused && present == kStateStopped) return of.stopped_ = false, of.add_result(call, kOk), true;
    if (wanted != kStateStopped) return pause(of, call, wanted == kStatePaused, requests);
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
      return of.add_result(call, kUnsupported, "time and state can only be reset together: scope 0, 3, 7 or 255"), true;
    if (scope == 3 && of.movers_.size() > of.loaded_)
      return of.add_result(call, kUnsupported, "every reset removes spawned entities: scope 0, 7 or 255"), true;
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

const std::array<RosServices::Handlers::Row, 27> RosServices::Handlers::kRows = {{
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
    {{"/get_entity_info", "simulation_interfaces/srv/GetEntityInfo", "string entity\n",
      "simulation_interfaces/Result result\nsimulation_interfaces/EntityInfo info\n"},
     get_info,
     false},
    {{"/get_entity_bounds", "simulation_interfaces/srv/GetEntityBounds", "string entity\n", kBounds},
     get_bounds,
     false},
    {{"/get_named_poses", "simulation_interfaces/srv/GetNamedPoses", "simulation_interfaces/TagsFilter tags\n",
      "simulation_interfaces/Result result\nsimulation_interfaces/NamedPose[] poses\n"},
     get_poses,
     false},
    {{"/get_named_pose_bounds", "simulation_interfaces/srv/GetNamedPoseBounds", "string name\n", kBounds},
     get_pose_bounds,
     false},
    {{"/get_current_world", "simulation_interfaces/srv/GetCurrentWorld", "", kWorld}, get_world, false},
    {{"/get_spawnables", "simulation_interfaces/srv/GetSpawnables", "string[] sources\n",
      "simulation_interfaces/Result result\nsimulation_interfaces/Spawnable[] spawnables\n"},
     get_spawnables,
     true},
    {{"/spawn_entity", "simulation_interfaces/srv/SpawnEntity", kSpawn,
      "simulation_interfaces/Result result\nstring entity_name\n"},
     spawn,
     true},
    {{"/spawn_entities", "simulation_interfaces/srv/SpawnEntities",
      "simulation_interfaces/SpawnEntity[] spawn_requests\n",
      "simulation_interfaces/Result result\nsimulation_interfaces/SpawnResult[] results\n"},
     spawn_several,
     true},
    {{"/delete_entity", "simulation_interfaces/srv/DeleteEntity", "string entity\n", kResult}, remove, true},
    {{"/get_available_worlds", "simulation_interfaces/srv/GetAvailableWorlds",
      "string[] additional_sources\nsimulation_interfaces/TagsFilter filter\n"
      "bool offline_only\nbool continue_on_error\n",
      "simulation_interfaces/Result result\nsimulation_interfaces/WorldResource[] worlds\n"},
     get_worlds,
     true},
    {{"/load_world", "simulation_interfaces/srv/LoadWorld",
      "simulation_interfaces/Resource world_resource\nbool fail_on_unsupported_element\n"
      "bool ignore_missing_or_unsupported_assets\n",
      kWorld},
     load_world,
     true},
    {{"/unload_world", "simulation_interfaces/srv/UnloadWorld", "", kResult}, unload_world, true},
    {{"/simulate_steps/_action/send_goal", "simulation_interfaces/action/SimulateSteps_SendGoal",
      "unique_identifier_msgs/UUID goal_id\nsimulation_interfaces/action/SimulateSteps_Goal goal\n",
      "bool accepted\nbuiltin_interfaces/Time stamp\n"},
     send_goal,
     true},
    {{"/simulate_steps/_action/cancel_goal", "action_msgs/srv/CancelGoal", "action_msgs/GoalInfo goal_info\n",
      "int8 return_code\naction_msgs/GoalInfo[] goals_canceling\n"},
     cancel_goal,
     true},
    {{"/simulate_steps/_action/get_result", "simulation_interfaces/action/SimulateSteps_GetResult", kUuid,
      "int8 status\nsimulation_interfaces/action/SimulateSteps_Result result\n"},
     get_result,
     true},
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

// Services that change nothing come first, so a service has the same row in both lists.
RosServices::RosServices(const Scene& scene) : scene_(scene) {
  for (const Handlers::Row& row : Handlers::kRows)
    if (scene.simulated || !row.simulated) types_.push_back(row.type);
  show_scene(true);
}

void RosServices::show_scene(bool is_new) {
  if (is_new) movers_.clear(), time_ = 0, loaded_ = scene_.world.movers.size();
  for (std::size_t row = movers_.size(); row < scene_.world.movers.size(); ++row)
    movers_.push_back({.mover = static_cast<std::uint32_t>(row), .X_WM = scene_.world.movers[row].X_WM});
  movers_.resize(scene_.world.movers.size());
  kinds_ = kinds_of(scene_.world);
}

std::uint32_t RosServices::row_of(const std::string& name) const {
  for (std::uint32_t row = 0; row < movers_.size(); ++row)
    if (scene_.info.movers[row].frame == name && !base::is_absent(movers_[row].X_WM)) return row;
  return static_cast<std::uint32_t>(movers_.size());
}

const std::vector<AvailableWorld>& RosServices::worlds() {
  if (!worlds_) worlds_ = worlds_in(scene_.world_folders);
  return *worlds_;
}

std::string RosServices::world_uri() {
  for (const AvailableWorld& each : worlds())
    if (each.file == scene_.world.file) return each.uri;
  return scene_.info.world;
}

std::set<std::string> RosServices::waiting_names() const {
  std::set<std::string> names;
  for (const Call& call : waiting_)
    for (const Spawn& spawn : call.spawns)
      if (spawn.code == kOk) names.insert(spawn.joining.name);
  return names;
}

bool RosServices::take(std::size_t service, std::span<const std::uint8_t> message, const DdsSender& sender,
                       Requests& requests) {
  CdrReader cdr(message);
  Call call{.service = service};
  call.caller.client = cdr.get<std::uint64_t>();
  call.caller.sequence = cdr.get<std::int64_t>();
  call.caller.sender = sender;
  if (!cdr.good()) return false;
  const Handlers::Row& row = Handlers::kRows[service];
  if (!row.simulated || waiting_.size() < kMaxWaiting) return row.handler(*this, call, cdr, requests);
  add_result(call, kFailed, "too many requests are waiting for the run");
  return true;
}

void RosServices::observe(const base::TickRecord* tick, const RunState& state) {
  const bool began_again = state.runs != state_.runs;
  worlds_.reset();
  state_ = state;
  if (tick != nullptr) {
    time_ = tick->time;
    for (const base::Report& report : tick->reports)
      if (report.mover < movers_.size()) movers_[report.mover] = report;
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

bool RosServices::finish_goal(Call& call, bool& ticked, bool began_again) {
  StepsAction::Goal* const goal = steps_.find(call.goal);
  if (goal == nullptr || !goal->is_active()) return true;
  if (began_again || !state_.paused)
    return steps_.end(*goal, StepsAction::Status::aborted, kFailed, "the run continued or restarted"), true;
  if (!std::exchange(ticked, false)) return false;
  steps_.step(*goal);
  if (goal->completed < goal->steps) return false;
  return steps_.end(*goal, StepsAction::Status::succeeded, kOk, ""), true;
}

bool RosServices::finish(Call& call, bool& ticked, bool began_again) {
  if (call.until == Until::goal) return finish_goal(call, ticked, began_again);
  if (call.until == Until::outcomes) {
    const auto done = [](const auto& outcome) { return outcome->done; };
    if (!std::all_of(call.outcomes.begin(), call.outcomes.end(), done)) return false;
    return call.answer(*this, call), true;
  }
  if (call.until == Until::result) {
    const StepsAction::Goal* const goal = steps_.find(call.goal);
    if (goal != nullptr && goal->is_active()) return false;
    CdrWriter cdr = begin_answer(call);
    StepsAction::put_result(cdr, goal != nullptr ? *goal : StepsAction::Goal{.status = StepsAction::Status::unknown});
    return true;
  }
  if (call.until == Until::reset) {
    if (!began_again) return false;
    stopped_ = call.paused && state_.paused;
    return add_result(call, kOk), true;
  }
  if (call.until == Until::state) {
    const bool done = state_.paused == call.paused;
    return add_result(call, done ? kOk : kFailed, done ? "" : "another user changed the setting"), true;
  }
  if (began_again || !state_.paused) return add_result(call, kFailed, "the run continued or restarted"), true;
  if (!std::exchange(ticked, false) || --call.steps > 0) return false;
  add_result(call, kOk);
  return true;
}

}  // namespace sf::bridges
