#pragma once
// Services of a run for nodes of ROS 2: those of simulation_interfaces 2.1 (github.com/ros-simulation/
// simulation_interfaces, 172a1b1), which serve clients of 1.0 too, its action, and three of std_srvs for users without
// that package. One thread: requests come between two ticks, and those that change the run are answered when it has
// changed.

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

/// Where an answer goes. rmw_cyclonedds writes the first two before a request, and looks for them before the answer.
struct Caller {
  std::uint64_t client = 0;
  std::int64_t sequence = 0;
  DdsSender sender;
};

struct Answer {
  std::size_t service = 0;  ///< row of `RosServices::types`
  Caller caller;
  base::Bytes message;  ///< with encapsulation, and the caller's first two
};

class RosServices {
 public:
  static constexpr std::size_t kMaxWaiting = 64;       ///< requests that wait for the run; more are refused
  static constexpr std::uint32_t kMaxSteps = 1000000;  ///< of one request
  static constexpr std::size_t kMaxSpawns = 64;        ///< robots that wait to join; more are refused

  explicit RosServices(const Scene& scene);

  /// The scene has other movers than before. @param is_new it is another world
  void show_scene(bool is_new);

  /// Those of this run: where robots are not simulated, those that change nothing.
  std::span<const ServiceType> types() const { return types_; }

  /// Takes one request, with encapsulation. @param sender see Caller @param requests out: what it asks of the run
  /// @return false: it cannot be read, and is dropped
  bool take(std::size_t service, std::span<const std::uint8_t> message, const DdsSender& sender, Requests& requests);
  /// Called with every tick, or while the run is paused without one, when the requests above were done.
  void observe(const base::TickRecord* tick, const RunState& state);
  /// Gives those that came to be since the last call.
  std::vector<Answer> answers();
  /// Likewise of topics of actions.
  std::vector<ActionMessage> messages() { return steps_.messages(); }

 private:
  struct Handlers;
  enum class Until { state, reset, steps, outcomes, goal, result };
  /// A request, and what it waits for.
  struct Call {
    std::size_t service = 0;
    Caller caller;
    Until until = Until::state;
    bool paused = false;             ///< the state that it wants
    std::uint32_t steps = 0;         ///< that are left
    std::vector<Spawn> spawns = {};  ///< of which those that are wanted have outcomes
    std::vector<std::shared_ptr<Outcome>> outcomes = {};
    std::function<void(RosServices&, const Call&)> answer = {};  ///< when all outcomes are there
    StepsAction::Id goal = {};
  };

  record::CdrWriter begin_answer(const Call& call);
  /// Answers with a simulation_interfaces/Result, or a success and a message of std_srvs.
  void add_result(const Call& call, std::uint8_t code, std::string_view message = {});
  bool wait(const Call& call);  ///< @return true
  /// @param ticked a tick was made, which no call before this one has counted; false once it is counted
  /// @return whether it waits no more
  bool finish(Call& call, bool& ticked, bool began_again);
  bool finish_goal(Call& call, bool& ticked, bool began_again);
  std::uint32_t row_of(const std::string& name) const;  ///< of a mover that is present; else the number of rows
  std::string world_uri();
  const std::vector<AvailableWorld>& worlds();
  std::set<std::string> waiting_names() const;  ///< of robots that wait to join

  const Scene scene_;
  std::vector<ServiceType> types_;
  std::vector<Call> waiting_;
  std::vector<Answer> answers_;
  RunState state_;
  bool stopped_ = false;                               ///< paused at the begin, by STATE_STOPPED
  std::int64_t time_ = 0;                              ///< [ns] of the last tick
  std::vector<base::Report> movers_;                   ///< by row, as of the last tick
  std::vector<std::uint32_t> kinds_;                   ///< see kinds_of
  std::size_t loaded_ = 0;                             ///< movers of the world at load
  bool unloaded_ = false;                              ///< by UnloadWorld
  std::optional<std::vector<AvailableWorld>> worlds_;  ///< read once per tick
  StepsAction steps_;
};

}  // namespace sf::bridges
