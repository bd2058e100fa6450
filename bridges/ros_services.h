#pragma once
// Services of a run for ROS 2 nodes: those of simulation_interfaces 2.1
// (github.com/ros-simulation/simulation_interfaces, 172a1b1), which also serve clients of 1.0, its action, and three of
// std_srvs for users without that package. Not thread-safe: requests are handled between two ticks, and those that
// change the run are answered after the change.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "bridges/bridge.h"
#include "bridges/dds.h"
#include "bridges/steps_action.h"
#include "bridges/world_services.h"
#include "record/cdr.h"

namespace sf::bridges {

struct ServiceType {
  std::string_view name;               ///< "/set_simulation_state"
  std::string_view type;               ///< "simulation_interfaces/srv/SetSimulationState"
  std::string_view request, response;  ///< fields, one per line (`ros2msg`)
};

/// The address of an answer. rmw_cyclonedds writes the first two members before a request, and expects them before the
/// answer.
struct Caller {
  std::uint64_t client = 0;
  std::int64_t sequence = 0;
  DdsSender sender;
};

struct Answer {
  std::size_t service = 0;  ///< row of `RosServices::types`
  Caller caller;
  base::Bytes message;  ///< with encapsulation, and the caller's first two members
};

class RosServices {
 public:
  static constexpr std::size_t kMaxWaiting = 64;  ///< maximum number of requests waiting for the run; more are refused
  static constexpr std::uint32_t kMaxSteps = 1000000;  ///< per request
  static constexpr std::size_t kMaxSpawns = 64;        ///< maximum number of robots waiting to join; more are refused

  explicit RosServices(const Scene& scene);

  /// Updates the services after the movers in the scene have changed.
  /// @param is_new whether it is another world
  void show_scene(bool is_new);

  /// Returns the services of this run. If robots are not simulated, only those that change nothing.
  std::span<const ServiceType> types() const { return types_; }

  /// Handles one request, with encapsulation.
  /// @param sender see Caller @param requests out: resulting requests to the run
  /// @return false: it cannot be parsed and is dropped
  bool take(std::size_t service, std::span<const std::uint8_t> message, const DdsSender& sender, Requests& requests);
  /// Called with every tick, or without one while the run is paused, after the requests above have been executed.
  void observe(const base::TickRecord* tick, const RunState& state);
  /// Returns the answers created since the last call.
  std::vector<Answer> answers();
  /// Returns the messages of action topics created since the last call.
  std::vector<ActionMessage> messages() { return steps_.messages(); }

 private:
  struct Handlers;
  enum class Until { state, reset, steps, outcomes, goal, result };
  /// A request and the condition that it waits for.
  struct Call {
    std::size_t service = 0;
    Caller caller;
    Until until = Until::state;
    bool paused = false;             ///< the requested state
    std::uint32_t steps = 0;         ///< that are left
    std::vector<Spawn> spawns = {};  ///< robots to spawn; accepted ones have outcomes
    std::vector<std::shared_ptr<Outcome>> outcomes = {};
    std::function<void(RosServices&, const Call&)> answer = {};  ///< called when all outcomes are available
    StepsAction::Id goal = {};
  };

  record::CdrWriter begin_answer(const Call& call);
  /// Answers with a simulation_interfaces/Result, or with success and message of std_srvs.
  void add_result(const Call& call, std::uint8_t code, std::string_view message = {});
  bool wait(const Call& call);  ///< @return true
  /// @param ticked a tick was simulated that no earlier call has counted; set to false once it is counted
  /// @return whether the call is finished
  bool finish(Call& call, bool& ticked, bool began_again);
  bool finish_goal(Call& call, bool& ticked, bool began_again);
  std::uint32_t row_of(const std::string& name) const;  ///< of a present mover; else the number of rows
  std::string world_uri();
  const std::vector<AvailableWorld>& worlds();
  std::set<std::string> waiting_names() const;  ///< of robots waiting to join

  const Scene scene_;
  std::vector<ServiceType> types_;
  std::vector<Call> waiting_;
  std::vector<Answer> answers_;
  RunState state_;
  bool stopped_ = false;                               ///< paused at the start by STATE_STOPPED
  std::int64_t time_ = 0;                              ///< [ns] of the last tick
  std::vector<base::Report> movers_;                   ///< by row, as of the last tick
  std::vector<std::uint32_t> kinds_;                   ///< see kinds_of
  std::size_t loaded_ = 0;                             ///< number of movers in the world file
  bool unloaded_ = false;                              ///< by UnloadWorld
  std::optional<std::vector<AvailableWorld>> worlds_;  ///< read once per tick
  StepsAction steps_;
};

}  // namespace sf::bridges
