#include "bridges/steps_action.h"

#include <algorithm>
#include <utility>

namespace sf::bridges {

using record::CdrReader;
using record::CdrWriter;

namespace {

// action_msgs/srv/CancelGoal
constexpr std::int8_t kNoError = 0, kRejected = 1, kUnknownGoal = 2, kGoalEnded = 3;
constexpr std::uint8_t kCanceledCode = 4;  // simulation_interfaces/msg/Result: the operation failed
constexpr std::int64_t kSecond = 1'000'000'000;

enum Topic : std::size_t { kFeedback, kStatus };

void put_id(CdrWriter& cdr, const StepsAction::Id& id) {
  for (const std::uint8_t byte : id) cdr.put(byte);
}

}  // namespace

const std::array<ActionTopic, 2> StepsAction::kTopics = {{
    {"/simulate_steps/_action/feedback", "simulation_interfaces/action/SimulateSteps_FeedbackMessage",
     "unique_identifier_msgs/UUID goal_id\nsimulation_interfaces/action/SimulateSteps_Feedback feedback\n", false},
    {"/simulate_steps/_action/status", "action_msgs/msg/GoalStatusArray", "action_msgs/GoalStatus[] status_list\n",
     true},
}};

StepsAction::Id StepsAction::get_id(CdrReader& cdr) {
  Id id;
  for (std::uint8_t& byte : id) byte = cdr.get<std::uint8_t>();
  return id;
}

void StepsAction::put_info(CdrWriter& cdr, const Goal& goal) {
  put_id(cdr, goal.id);
  cdr.put(static_cast<std::int32_t>(goal.accepted / kSecond));
  cdr.put(static_cast<std::uint32_t>(goal.accepted % kSecond));
}

StepsAction::Goal* StepsAction::find(const Id& id) {
  const auto found = std::find_if(goals_.begin(), goals_.end(), [&](const Goal& goal) { return goal.id == id; });
  return found == goals_.end() ? nullptr : &*found;
}

bool StepsAction::accept(const Id& id, std::uint64_t steps, std::int64_t now) {
  const auto active = std::count_if(goals_.begin(), goals_.end(), [](const Goal& goal) { return goal.is_active(); });
  if (find(id) != nullptr || active >= static_cast<std::ptrdiff_t>(kMostActive)) return false;
  if (goals_.size() == kMostKept)
    goals_.erase(std::find_if(goals_.begin(), goals_.end(), [](const Goal& goal) { return !goal.is_active(); }));
  goals_.push_back({.id = id, .accepted = now, .steps = steps});
  changed_ = true;
  return true;
}

void StepsAction::step(Goal& goal) {
  ++goal.completed;
  CdrWriter cdr(messages_.emplace_back(ActionMessage{kFeedback, {}}).bytes);
  put_id(cdr, goal.id);
  cdr.put(goal.completed);
  cdr.put(goal.steps - goal.completed);
}

void StepsAction::end(Goal& goal, Status status, std::uint8_t code, std::string message) {
  goal.status = status;
  goal.code = code;
  goal.message = std::move(message);
  changed_ = true;
}

std::uint64_t StepsAction::cancel(CdrReader& request, CdrWriter& answer) {
  const Id id = get_id(request);
  const std::int64_t until = kSecond * request.get<std::int32_t>() + request.get<std::uint32_t>();
  const bool all = id == Id{};
  std::vector<Goal*> canceled;
  for (Goal& goal : goals_)
    if (goal.is_active() && (all ? until == 0 || goal.accepted <= until : goal.id == id)) canceled.push_back(&goal);
  const Goal* const named = find(id);
  const std::int8_t why = all ? kRejected : named == nullptr ? kUnknownGoal : kGoalEnded;
  answer.put(canceled.empty() ? why : kNoError);
  answer.put_count(canceled.size());
  std::uint64_t left = 0;
  for (Goal* goal : canceled) {
    put_info(answer, *goal);
    left += goal->steps - goal->completed;
    end(*goal, Status::canceled, kCanceledCode, "canceled");
  }
  return left;
}

void StepsAction::put_result(CdrWriter& cdr, const Goal& goal) {
  cdr.put(static_cast<std::int8_t>(goal.status));
  cdr.put(goal.code);
  cdr.put(goal.message);
}

std::vector<ActionMessage> StepsAction::messages() {
  if (std::exchange(changed_, false)) {
    CdrWriter cdr(messages_.emplace_back(ActionMessage{kStatus, {}}).bytes);
    cdr.put_count(goals_.size());
    for (const Goal& goal : goals_) {
      put_info(cdr, goal);
      cdr.put(static_cast<std::int8_t>(goal.status));
    }
  }
  return std::exchange(messages_, {});
}

}  // namespace sf::bridges
