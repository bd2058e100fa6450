#pragma once
// The measurements of a filter's last seconds in sorted order, each with the filter's state after it. A late
// measurement is inserted at its place, and the later ones are applied again.

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace sf::estimation {

/// Result of a measurement.
enum class Verdict : std::uint8_t {
  started,   ///< used: the first measurement with a position, the first after a stale time, or one beyond the gate when
             ///< no position was used during that time
  used,      ///< updated the estimate
  outlier,   ///< rejected by the gate
  jump,      ///< rejected: farther than `max_jump` from the prediction
  no_track,  ///< rejected: it has no position and the object has no state
  replayed,  ///< rejected: identical to one in the window or to the newest that left it
  too_late,  ///< rejected: before the window
  future,    ///< rejected: ahead of the clock
  invalid    ///< rejected: `is_valid` is false
};
inline constexpr std::size_t kVerdicts = 9;
std::string_view name(Verdict verdict);

/// Number of measurements by verdict. A late measurement may change the verdicts of later ones. Each measurement counts
/// once.
using VerdictCounts = std::array<std::uint64_t, kVerdicts>;

/// Allocates in the constructor, or until it first is as large as needed; copies of a State may allocate, too.
/// @tparam Measurement totally ordered, first by its `time` [ns]; only identical measurements are equal
/// @tparam State with known() and, if known, time() [ns]; by default the state before any measurement
template <class Measurement, class State>
class MeasurementWindow {
 public:
  /// @param span [ns] > 0 measurements older than the newest by more are rejected
  /// @param capacity > 0 measurements; when full, the window becomes shorter
  MeasurementWindow(std::int64_t span, std::size_t capacity) : span_(span), capacity_(capacity), entries_(capacity) {}
  /// @param allocated in (0, capacity] measurements; more memory is allocated when they do not suffice
  MeasurementWindow(std::int64_t span, std::size_t capacity, std::size_t allocated)
      : span_(span), capacity_(capacity), entries_(allocated) {}
  /// @param first the state before any measurement
  MeasurementWindow(std::int64_t span, std::size_t capacity, const State& first) : MeasurementWindow(span, capacity) {
    before_ = first;
  }

  /// Inserts a measurement, and applies it and all later ones again.
  /// @param apply Verdict(const Measurement&, State&); a rejected measurement leaves the state unchanged
  /// @return its verdict: `replayed` or `too_late` if it was not inserted, else that of `apply`
  template <class Apply>
  Verdict take(const Measurement& measurement, const Apply& apply) {
    if (const Verdict refusal = place_for(measurement); refusal != Verdict::used) return count(refusal);
    const std::size_t place = insert(measurement);
    apply_from(place, apply);
    return entry(place).verdict;
  }

  /// Applies all measurements later than `time` again, after a change of something else that `apply` uses.
  template <class Apply>
  void apply_after(std::int64_t time, const Apply& apply) {
    std::size_t place = size_;
    while (place > 0 && entry(place - 1).measurement.time > time) --place;
    apply_from(place, apply);
  }

  /// Counts a measurement that was rejected elsewhere.
  Verdict count(Verdict verdict) {
    ++counts_[static_cast<std::size_t>(verdict)];
    return verdict;
  }
  const VerdictCounts& counts() const { return counts_; }

  /// Returns the last state at or before `time` for which `known` is true, or the first such state; null if there is
  /// none. Valid until the next measurement.
  const State* state_at(std::int64_t time) const {
    // Backwards, since the newest is wanted most often.
    for (std::size_t k = size_; k-- > 0;)
      if (const State& after = entry(k).after; after.known() && after.time() <= time) return &after;
    if (before_.known()) return &before_;
    for (std::size_t k = 0; k < size_; ++k)
      if (entry(k).after.known()) return &entry(k).after;
    return nullptr;
  }

  /// Changes all states, the one before the window included.
  template <class Change>
  void for_each_state(const Change& change) {
    change(before_);
    for (std::size_t k = 0; k < size_; ++k) change(entry(k).after);
  }

  /// Returns the state after the measurements that left the window.
  const State& before() const { return before_; }

  /// Drops everything except the counts.
  void clear() {
    first_ = size_ = 0;
    before_ = {};
    any_left_ = false;
  }

 private:
  struct Entry {
    Measurement measurement;
    Verdict verdict = Verdict::used;
    State after;
  };
  Entry& entry(std::size_t k) { return entries_[(first_ + k) % entries_.size()]; }
  const Entry& entry(std::size_t k) const { return entries_[(first_ + k) % entries_.size()]; }

  template <class Apply>
  void apply_from(std::size_t place, const Apply& apply) {
    for (std::size_t k = place; k < size_; ++k) {
      Entry& next = entry(k);
      next.after = k > 0 ? entry(k - 1).after : before_;
      --counts_[static_cast<std::size_t>(next.verdict)];
      next.verdict = count(apply(next.measurement, next.after));
    }
  }

  /// Makes room for a measurement. Returns `used` if it may be inserted.
  Verdict place_for(const Measurement& measurement) {
    const std::int64_t newest = size_ > 0 ? entry(size_ - 1).measurement.time : measurement.time;
    if (any_left_ && measurement == last_left_) return Verdict::replayed;
    if (measurement.time < newest - span_ || (any_left_ && measurement < last_left_)) return Verdict::too_late;
    for (std::size_t k = size_; k > 0 && measurement.time <= entry(k - 1).measurement.time; --k)
      if (measurement == entry(k - 1).measurement) return Verdict::replayed;
    const std::int64_t start = std::max(newest, measurement.time) - span_;
    while (size_ > 0 && entry(0).measurement.time < start) drop_oldest();
    if (size_ < entries_.size() || grow()) return Verdict::used;
    // The oldest entry leaves, unless the new one is even older.
    if (measurement < entry(0).measurement) return Verdict::too_late;
    drop_oldest();
    return Verdict::used;
  }

  /// Returns false if the window has `capacity_` entries. A ring no larger than needed reuses memory that is in caches.
  bool grow() {
    if (entries_.size() == capacity_) return false;
    std::rotate(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(first_), entries_.end());
    entries_.resize(std::min(capacity_, 2 * entries_.size()));
    first_ = 0;
    return true;
  }

  void drop_oldest() {
    std::swap(before_, entry(0).after);
    last_left_ = entry(0).measurement;
    any_left_ = true;
    first_ = (first_ + 1) % entries_.size();
    --size_;
  }

  std::size_t insert(const Measurement& measurement) {
    std::size_t place = size_++;
    for (; place > 0 && measurement < entry(place - 1).measurement; --place) std::swap(entry(place), entry(place - 1));
    entry(place).measurement = measurement;
    entry(place).verdict = Verdict::used;
    count(Verdict::used);
    return place;
  }

  std::int64_t span_;
  std::size_t capacity_;
  std::vector<Entry> entries_;  ///< ring of at most `capacity_`, sorted from first_ on
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  State before_;             ///< after the measurements that left the window
  Measurement last_left_{};  ///< newest measurement that left the window
  bool any_left_ = false;
  VerdictCounts counts_{};
};

}  // namespace sf::estimation
