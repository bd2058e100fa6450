#include "farm/processor_budget.h"

#include <algorithm>
#include <functional>

namespace sf::farm {

namespace {

constexpr double kLearning = 0.2;      // share of an error of the prediction that one call corrects
constexpr double kForgetting = 0.995;  // factor per call of costs of types of which nothing is admitted

}  // namespace

ProcessorBudget::ProcessorBudget(double rate, double limit, std::span<const sensors::DerivedNode> derived)
    : bucket_(rate, limit) {
  set_derived(derived);
}

void ProcessorBudget::set_derived(std::span<const sensors::DerivedNode> derived) {
  input_priorities_.clear();
  // Consumers come before their inputs, so that priorities pass through all levels.
  std::vector<const sensors::DerivedNode*> nodes;
  for (const sensors::DerivedNode& node : derived) nodes.push_back(&node);
  std::ranges::stable_sort(nodes, std::greater(), &sensors::DerivedNode::level);
  for (const sensors::DerivedNode* node : nodes) {
    const std::uint8_t priority = priority_of(node->type->id, node->spec);
    for (const sensors::WiredInput& input : node->inputs) {
      std::uint8_t& largest = input_priorities_[{input.type, input.mover, input.sensor}];
      largest = std::max(largest, priority);
    }
  }
}

std::uint8_t ProcessorBudget::priority_of(std::uint8_t type, const sensors::SensorSpec& spec) const {
  const auto found = input_priorities_.find({type, spec.mover, spec.sensor});
  return found == input_priorities_.end() ? spec.priority : std::max(spec.priority, found->second);
}

std::vector<std::uint64_t>& ProcessorBudget::admitted_of(const SensorPipeline& pipeline) {
  std::vector<std::uint64_t>& rows = admitted_[pipeline.group->type->id];
  if (rows.size() < pipeline.group->rows.size()) rows.resize(pipeline.group->rows.size());
  return rows;
}

void ProcessorBudget::admit(std::int64_t now, std::span<SensorPipeline* const> pipelines) {
  bucket_.refill(now);
  ++calls_;
  elements_.fill(0.0), candidates_.clear(), dropped_.clear();
  for (std::uint32_t p = 0; p < pipelines.size(); ++p) {
    const SensorPipeline& pipeline = *pipelines[p];
    const std::vector<std::uint64_t>& last = admitted_of(pipeline);
    for (std::uint32_t d = 0; d < pipeline.due.size(); ++d) {
      const std::uint32_t row = pipeline.due[d].row;
      const sensors::SensorSpec& spec = pipeline.group->rows[row];
      const std::uint8_t type = pipeline.group->type->id;
      candidates_.push_back({priority_of(type, spec), last[row], p, d, costs_[type] * spec.elements});
    }
  }
  std::ranges::stable_sort(candidates_, [](const Candidate& a, const Candidate& b) {
    return std::tuple(b.priority, a.last) < std::tuple(a.priority, b.last);
  });
  const std::uint8_t highest = candidates_.empty() ? 0 : candidates_.front().priority;
  bool enough = true;
  highest_only_ = true;
  for (Candidate& candidate : candidates_) {
    if (candidate.priority < highest) bucket_.settle();
    if (!bucket_.may_have(candidate.cost)) continue;  // it waits for nothing
    if (enough = bucket_.has(candidate.cost); !enough) break;
    candidate.admitted = true;
    highest_only_ &= candidate.priority == highest;
    bucket_.spend(candidate.cost);
  }
  if (enough) bucket_.settle();
  std::ranges::sort(candidates_, {}, [](const Candidate& c) { return std::tuple(c.pipeline, c.due); });
  std::size_t next = 0;
  for (SensorPipeline* const pipeline : pipelines) {
    const std::uint8_t type = pipeline->group->type->id;
    const bool had_due = !pipeline->due.empty();
    std::erase_if(pipeline->due, [&](const sensors::DueSample& due) {
      const sensors::SensorSpec& spec = pipeline->group->rows[due.row];
      if (candidates_[next++].admitted) {
        elements_[type] += spec.elements;
        admitted_[type][due.row] = calls_;
        return false;
      }
      dropped_.push_back({spec.mover, type, spec.sensor});
      return true;
    });
    if (pipeline->due.empty() && had_due) costs_[type] *= kForgetting;
  }
}

/// One step of normalized least mean squares.
void ProcessorBudget::spent(double seconds) {
  double predicted = 0.0, squares = 0.0;
  for (std::size_t type = 0; type < costs_.size(); ++type) {
    predicted += costs_[type] * elements_[type];
    squares += elements_[type] * elements_[type];
  }
  bucket_.charge(seconds - predicted, (highest_only_ ? 1.0 : TokenBucket::kMostCharged) * bucket_.limit());
  if (squares == 0.0) return;
  for (std::size_t type = 0; type < costs_.size(); ++type)
    costs_[type] = std::max(0.0, costs_[type] + kLearning * (seconds - predicted) * elements_[type] / squares);
}

}  // namespace sf::farm
