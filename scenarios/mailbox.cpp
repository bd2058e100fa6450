#include "scenarios/mailbox.h"

#include <algorithm>
#include <utility>

namespace sf::scenarios {

Mailbox::Slot& Mailbox::slot_of(const base::ReadingBlock& reading) {
  for (Slot& slot : slots_)
    if (slot.type == reading.type && slot.sensor == reading.sensor) return slot;
  Slot& slot = slots_.emplace_back();
  slot.type = reading.type;
  slot.sensor = reading.sensor;
  open_.reserve(slots_.size());
  return slot;
}

void Mailbox::send(const base::ReadingBlock& reading, std::int64_t now) {
  const std::uint32_t stream = std::uint32_t{reading.type} << 16 | reading.sensor;
  const auto later = netio::sample_delay(link_, {robot_, stream, reading.sequence});
  if (!later) return;
  Slot& slot = slot_of(reading);
  auto place = std::find_if(slot.coming.begin(), slot.coming.end(), [](const Kept& kept) { return !kept.used; });
  if (place == slot.coming.end()) place = slot.coming.emplace(slot.coming.end());
  place->reading.take(reading);
  place->due = now + *later;
  place->used = true;
}

/// Moves the newest due reading to `shown` and discards the other due ones.
void Mailbox::show(Slot& slot, std::int64_t now) {
  slot.renewed = false;
  for (Kept& kept : slot.coming) {
    if (!kept.used || kept.due > now) continue;
    kept.used = false;
    if (slot.has && kept.reading.block().sequence <= slot.shown.reading.block().sequence) continue;
    std::swap(slot.shown, kept);
    slot.shown.used = kept.used = false;
    slot.has = slot.renewed = true;
  }
}

std::span<const base::ReadingBlock> Mailbox::receive(std::int64_t now) {
  open_.clear();
  for (Slot& slot : slots_) {
    show(slot, now);
    if (slot.has) open_.push_back(slot.shown.reading.block());
  }
  return open_;
}

bool Mailbox::renewed(std::uint8_t type) const {
  return std::any_of(slots_.begin(), slots_.end(), [&](const Slot& s) { return s.type == type && s.renewed; });
}

}  // namespace sf::scenarios
