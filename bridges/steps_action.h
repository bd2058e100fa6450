#pragma once
// Goals of the action simulation_interfaces/SimulateSteps: simulates a number of ticks of a paused run, with feedback
// after each.

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "record/cdr.h"

namespace sf::bridges {

/// A topic of an action.
struct ActionTopic {
  std::string_view name, type, fields;
  bool latched = false;
};

struct ActionMessage {
  std::size_t topic = 0;  ///< row of `StepsAction::kTopics`
  base::Bytes bytes;      ///< with encapsulation
};

class StepsAction {
 public:
  static constexpr std::size_t kMostActive = 16;  ///< maximum number of active goals; more are rejected
  static constexpr std::size_t kMostKept = 64;  ///< maximum number of goals whose results are kept; ended ones included
  static const std::array<ActionTopic, 2> kTopics;

  using Id = std::array<std::uint8_t, 16>;
  /// action_msgs/msg/GoalStatus
  enum class Status : std::int8_t { unknown = 0, executing = 2, succeeded = 4, canceled = 5, aborted = 6 };
  struct Goal {
    Id id{};
    std::int64_t accepted = 0;  ///< [ns]
    std::uint64_t steps = 0, completed = 0;
    Status status = Status::executing;
    std::uint8_t code = 0;  ///< of its result
    std::string message;
    bool is_active() const { return status == Status::executing; }
  };

  static Id get_id(record::CdrReader& cdr);
  /// Returns the goal with that id, or null.
  Goal* find(const Id& id);
  /// Returns false if the goal is rejected.
  bool accept(const Id& id, std::uint64_t steps, std::int64_t now);
  void step(Goal& goal);  ///< counts one completed step
  void end(Goal& goal, Status status, std::uint8_t code, std::string message);
  /// Reads an action_msgs/srv/CancelGoal, cancels the goals that it names, and appends the fields of the answer.
  /// @return number of steps that they had left
  std::uint64_t cancel(record::CdrReader& request, record::CdrWriter& answer);
  static void put_result(record::CdrWriter& cdr, const Goal& goal);
  const std::deque<Goal>& goals() const { return goals_; }

  /// Returns the messages created since the last call.
  std::vector<ActionMessage> messages();

 private:
  static void put_info(record::CdrWriter& cdr, const Goal& goal);

  std::deque<Goal> goals_;
  std::vector<ActionMessage> messages_;
  bool changed_ = true;  ///< whether a status has changed; late clients read the newest
};

}  // namespace sf::bridges
