#include "world/roads/problems.h"

#include <fmt/format.h>

#include <algorithm>

namespace sf::world {

namespace {

constexpr std::size_t kMostProblems = 100;
constexpr std::size_t kMostSlips = 10'000;

}  // namespace

void Problems::tolerate(int line, const std::string& what, const std::string& remedy, const std::string& taken) {
  if (strict_) throw base::InputError(file_, line, fmt::format("{}; {}", what, remedy));
  if (warnings_->size() >= kMostSlips)
    return refuse(line,
                  fmt::format("{}, and there were {} slips before; is this file what it should be?", what, kMostSlips));
  warnings_->push_back({file_, line, fmt::format("{}; {}", what, taken)});
}

void Problems::refuse(int line, const std::string& what) { keep(line, base::InputError(file_, line, what).what()); }

void Problems::keep(int line, const std::string& text) {
  if (strict_) throw base::InputError(text);
  refused_.emplace_back(line, text);
  if (refused_.size() >= kMostProblems) settle();
}

void Problems::settle() {
  if (refused_.empty()) return;
  std::stable_sort(warnings_->begin(), warnings_->end(),
                   [](const Warning& a, const Warning& b) { return a.line < b.line; });
  std::stable_sort(refused_.begin(), refused_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::string text;
  for (const auto& [line, problem] : refused_) text += (text.empty() ? "" : "\n") + problem;
  const std::size_t shown = std::min(warnings_->size(), kMostProblems);
  for (std::size_t i = 0; i < shown; ++i)
    text += fmt::format("\n{}:{}: warning: {}", file_, (*warnings_)[i].line, (*warnings_)[i].message);
  if (refused_.size() + shown > 1)
    text += fmt::format("\n{}: {}{} without a clear meaning: nothing is taken of it", file_, refused_.size(),
                        refused_.size() >= kMostProblems ? " problems and more"
                        : refused_.size() == 1           ? " problem"
                                                         : " problems");
  throw base::InputError(text);
}

}  // namespace sf::world
