#include "netio/signature_trouble_log.h"

#include <fmt/format.h>

#include <cmath>

namespace sf::netio {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;  ///< [ns]

std::string peer_text(const Claim& claim, const std::string& name) {
  const std::string in_brackets = name.empty() ? "" : fmt::format(" ({})", name);
  switch (claim.kind) {
    case PeerKind::robot:
      return fmt::format("robot {}{}", claim.id, in_brackets);
    case PeerKind::tag:
      return fmt::format("tag {}{}", claim.id, in_brackets);
    case PeerKind::light:
      return fmt::format("intersection {}", claim.id);
    case PeerKind::centre:
      return "the control centre";
    case PeerKind::start:
    case PeerKind::group:  // claimed by no packet to the farm
      break;
  }
  return "START";
}

bool is_refusal(PacketStatus reason) {
  return reason == PacketStatus::not_signed || reason == PacketStatus::wrong_signature ||
         reason == PacketStatus::replayed || reason == PacketStatus::wrong_source;
}

/// @param lag [us] of the counter
std::string reason_text(PacketStatus reason, std::uint64_t lag) {
  if (reason == PacketStatus::accepted)
    return "whose signature is not checked: the sender uses a key, but --peers has none for it here; start `serve` "
           "with --peers and that key, or the sender without";
  if (reason == PacketStatus::wrong_source)
    return "from an address other than the one in --peers here, or than that of another sender with this id, which has "
           "it until it leaves or is silent for 2 s";
  if (reason == PacketStatus::not_signed)
    return "without a signature: --peers has a key for it here, but the sender uses none (start it with --peers, too)";
  if (reason == PacketStatus::wrong_signature)
    return "with a wrong signature: the sender's key differs from the one in --peers here; compare both files";
  return fmt::format(
      "with a counter {:.1f} s behind an earlier one: the sender's clock was set back (or someone replays old "
      "packets); set that clock, or restart `serve`",
      1e-6 * static_cast<double>(lag));
}

}  // namespace

std::string trouble_text(const SignatureTrouble& trouble, const std::string& who, std::int64_t unix_time) {
  const double behind = 1e-9 * static_cast<double>(trouble.farm_time - unix_time);
  switch (trouble.reason) {
    case PacketStatus::not_signed:
      return trouble.of_farm
                 ? fmt::format("refuses packets without a signature of {}: start this one with --peers, too", who)
                 : fmt::format("does not sign its packets: start `serve` with --peers and the key of {}, too", who);
    case PacketStatus::wrong_signature:
      return fmt::format("has another key for {} than --peers here: compare both files", who);
    case PacketStatus::wrong_source:
      return fmt::format(
          "accepts {} from another address only: --peers has one for it there, or another sender has this id until it "
          "leaves or is silent for 2 s",
          who);
    default:
      return trouble.of_farm
                 ? fmt::format(
                       "has received packets of {} with later times: this machine's clock was set back, and reads "
                       "{:.1f} s {} than the farm's; set it, or restart `serve`",
                       who, std::abs(behind), behind < 0.0 ? "more" : "less")
                 : "sends earlier times than before: its clock was set back; set it, or restart this process";
  }
}

void SignatureTroubleLog::note(PacketStatus reason, const Packet& packet, const Endpoint& who, const std::string& name,
                               std::int64_t now, Inbox& inbox, Outbox& answers, RateLimitedLog& log) {
  if (!is_refusal(reason) && !packet.unchecked) return;
  if (!is_refusal(reason)) reason = PacketStatus::accepted;
  answer(reason, packet, who, now, inbox, answers);
  const Claim claim = claim_of(packet.header);
  const std::uint64_t count = rows_[{claim.kind, claim.id, reason}].packets.count(now);
  if (count == 0) return;
  log.write(fmt::format("{} at {}: {}{}, {}", peer_text(claim, name), endpoint_text(who), packets_text(count),
                        is_refusal(reason) ? " dropped" : "", reason_text(reason, inbox.lag(claim))),
            now);
}

void SignatureTroubleLog::answer(PacketStatus reason, const Packet& packet, const Endpoint& who, std::int64_t now,
                                 Inbox& inbox, Outbox& answers) {
  const Claim claim = claim_of(packet.header);
  Row& row = rows_[{claim.kind, claim.id, reason}];
  if (!is_refusal(reason) || now < row.next_answer || !inbox.refuse(packet, reason, now, answer_)) return;
  row.next_answer = now + kSecond / 2;
  answers.queue(who, answer_);
}

}  // namespace sf::netio
