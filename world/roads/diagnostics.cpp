#include "world/roads/diagnostics.h"

#include <fmt/format.h>

#include <algorithm>

namespace sf::world {

namespace {

constexpr std::size_t kMaxProblems = 100;
constexpr std::size_t kMaxSlips = 10'000;

}  // namespace

void Diagnostics::add_warning(int line, const std::string& what, const std::string& remedy, const std::string& taken) {
  if (strict_) throw base::InputError(file_, line, fmt::format("{}; {}", what, remedy));
  if (warnings_->size() >= kMaxSlips)
    return add_error(line, fmt::format("{}, after {} warnings; is this the right file?", what, kMaxSlips));
  warnings_->push_back({file_, line, fmt::format("{}; {}", what, taken)});
}

void Diagnostics::add_error(int line, const std::string& what) {
  keep(line, base::InputError(file_, line, what).what());
}

void Diagnostics::keep(int line, const std::string& text) {
  if (strict_) throw base::InputError(text);
  refused_.emplace_back(line, text);
  if (refused_.size() >= kMaxProblems) throw_errors();
}

void Diagnostics::throw_errors() {
  if (refused_.empty()) return;
  std::stable_sort(warnings_->begin(), warnings_->end(),
                   [](const Warning& a, const Warning& b) { return a.line < b.line; });
  std::stable_sort(refused_.begin(), refused_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::string text;
  for (const auto& [line, problem] : refused_) text += (text.empty() ? "" : "\n") + problem;
  const std::size_t shown = std::min(warnings_->size(), kMaxProblems);
  for (std::size_t i = 0; i < shown; ++i)
    text += fmt::format("\n{}:{}: warning: {}", file_, (*warnings_)[i].line, (*warnings_)[i].message);
  if (refused_.size() + shown > 1)
    text += fmt::format("\n{}: {}{} without a clear meaning: the file is not used", file_, refused_.size(),
                        refused_.size() >= kMaxProblems ? " problems and more"
                        : refused_.size() == 1          ? " problem"
                                                        : " problems");
  throw base::InputError(text);
}

}  // namespace sf::world
