#include "server/peer_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/files.h"
#include "server/wire_ids.h"
#include "world/toml_reader.h"

namespace sf::server {

namespace {

using netio::Peer;
using netio::PeerKind;
using world::TomlNode;
using world::TomlReader;

constexpr std::array<std::string_view, 1> kKeys{"peer"};
constexpr std::array<std::string_view, 8> kPeerKeys{"robot", "tag",    "start",   "light",
                                                    "group", "centre", "address", "key"};
constexpr std::array<std::string_view, 6> kKindKeys{"robot", "tag", "start", "light", "group", "centre"};
/// Kinds without an id, written as KEY = true.
constexpr std::pair<std::string_view, PeerKind> kFlagKinds[] = {
    {"start", PeerKind::start}, {"group", PeerKind::group}, {"centre", PeerKind::centre}};

/// Returns the only key of `table` that names the sender of its packets.
const TomlNode& kind_node(const TomlReader& reader, const TomlNode& table) {
  const TomlNode* found = nullptr;
  for (const std::string_view key : kKindKeys) {
    const TomlNode* node = world::find(table, key);
    if (node == nullptr) continue;
    if (found != nullptr) reader.fail(*node, fmt::format("a peer can have '{}' or '{}', not both", found->key, key));
    found = node;
  }
  if (found == nullptr)
    reader.fail(table,
                "a peer requires robot = ID, tag = ID, light = ID, start = true, centre = true, or group = true");
  return *found;
}

/// @param rows by id
void require_known(const TomlReader& reader, const TomlNode& node, const std::map<std::uint32_t, std::uint32_t>& rows,
                   std::uint32_t id) {
  constexpr std::size_t kMost = 16;  // names listed in the error
  if (rows.count(id) > 0) return;
  std::vector<std::uint32_t> ids = ids_of(rows);
  const bool more = ids.size() > kMost;
  ids.resize(std::min(ids.size(), kMost));
  reader.fail(node, fmt::format("the world has no {} with the id {}; it has {}{}", node.key, id,
                                ids.empty() ? "none" : fmt::format("{}", fmt::join(ids, ", ")), more ? ", ..." : ""));
}

void read_identity(const TomlReader& reader, const TomlNode& table, const WireNames* names, Peer& peer) {
  const TomlNode& node = kind_node(reader, table);
  for (const auto& [key, kind] : kFlagKinds) {
    if (node.key != key) continue;
    peer.kind = kind;
    if (!reader.flag(table, key)) reader.fail(node, fmt::format("'{}' expects true", key));
    return;
  }
  if (node.key == "light") {
    peer.kind = PeerKind::light;
    peer.id = static_cast<std::uint32_t>(reader.whole(table, node.key, 0, netio::kMaxId));
    return;
  }
  const bool tag = node.key == "tag";
  peer.kind = tag ? PeerKind::tag : PeerKind::robot;
  peer.id = static_cast<std::uint32_t>(reader.whole(table, node.key, 0, netio::kMaxId));
  if (tag && peer.id < netio::kMinTag) reader.fail(node, "'tag' expects a whole number from 1 to 65535");
  if (names != nullptr) require_known(reader, node, tag ? names->tags : names->robots, peer.id);
}

void read_address(const TomlReader& reader, const TomlNode& table, Peer& peer) {
  if (world::find(table, "address") == nullptr) return;
  if (peer.kind == PeerKind::group) reader.fail(*world::find(table, "address"), "a group has a key, but no address");
  const std::string text = reader.text(table, "address", "");
  peer.address = netio::parse_address(text);
  if (!peer.address)
    reader.fail(*world::find(table, "address"), "'address' expects an IPv4 address such as \"192.168.1.7\"");
}

/// Errors do not quote the text, because they may be logged.
void read_key(const TomlReader& reader, const TomlNode& table, Peer& peer) {
  if (world::find(table, "key") == nullptr) return;
  const std::string text = reader.text(table, "key", "");
  netio::SigningKey key{};
  bool fine = text.size() == 2 * key.size();
  for (std::size_t i = 0; fine && i < key.size(); ++i) {
    const char* first = text.data() + 2 * i;
    fine = std::from_chars(first, first + 2, key[i], 16).ptr == first + 2;
  }
  if (!fine)
    reader.fail(*world::find(table, "key"),
                fmt::format("'key' expects {} hexadecimal digits, as `openssl rand -hex {}` prints them",
                            2 * key.size(), key.size()));
  peer.key = key;
}

/// Tags of one camera may share a key. Two robots must not, because each would accept packets addressed to the other as
/// signed.
void require_own_key(const TomlReader& reader, const TomlNode& table, const Peer& peer,
                     std::map<netio::SigningKey, PeerKind>& keys) {
  if (!peer.key) return;
  const auto [other, is_new] = keys.emplace(*peer.key, peer.kind);
  if (!is_new && (peer.kind != PeerKind::tag || other->second != PeerKind::tag))
    reader.fail(*world::find(table, "key"), "another peer has this key; expected a unique key, except for tags");
}

}  // namespace

std::vector<Peer> parse_peers(const std::string& file, std::string_view text, const world::World* world) {
  const TomlNode root = world::parse_toml(file, text);
  const TomlReader reader(file);
  reader.require_known(root, kKeys);
  const std::vector<const TomlNode*> tables = reader.tables(root, "peer");
  if (tables.empty())
    throw base::InputError(file, 0, "has no peer; expected a [[peer]] section for each, see docs/robots.md");
  if (tables.size() > kMaxPeers) reader.fail(*tables[kMaxPeers], fmt::format("more than {} peers", kMaxPeers));

  const WireNames names = world != nullptr ? wire_names(*world) : WireNames{};
  std::vector<Peer> peers;
  std::set<std::pair<PeerKind, std::uint32_t>> seen;
  std::map<netio::SigningKey, PeerKind> keys;
  for (const TomlNode* table : tables) {
    reader.require_known(*table, kPeerKeys);
    Peer& peer = peers.emplace_back();
    read_identity(reader, *table, world != nullptr ? &names : nullptr, peer);
    if (!seen.emplace(peer.kind, peer.id).second) reader.fail(kind_node(reader, *table), "this peer is listed twice");
    read_address(reader, *table, peer);
    read_key(reader, *table, peer);
    require_own_key(reader, *table, peer, keys);
  }
  for (std::size_t i = 0; i < peers.size(); ++i)
    if (!peers[i].address && !peers[i].key)
      reader.fail(*tables[i],
                  "a peer requires an address, a key, or both: without either, none of its packets are checked");
  return peers;
}

std::vector<Peer> read_peers(const std::string& file, const world::World* world) {
  return parse_peers(file, base::read_text(file), world);
}

bool is_open_to_others(const std::string& file) {
  using std::filesystem::perms;
  std::error_code error;
  const perms mode = std::filesystem::status(file, error).permissions();
  return !error && (mode & (perms::group_all | perms::others_all)) != perms::none;
}

}  // namespace sf::server
