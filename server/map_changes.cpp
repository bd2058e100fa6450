#include "server/map_changes.h"

#include <cmath>

#include "netio/packets.h"

namespace sf::server {

namespace {

constexpr std::int64_t kNodesPerCell = 9;

// Small differences of either sign become small numbers (zigzag), which take one byte per 7 bits (LEB128).
std::uint64_t zigzag(std::int64_t d) {
  return static_cast<std::uint64_t>(d) << 1 ^ static_cast<std::uint64_t>(d >> 63);
}
std::int64_t from_zigzag(std::uint64_t z) { return static_cast<std::int64_t>(z >> 1 ^ (~(z & 1) + 1)); }

void put_number(std::uint64_t number, base::ByteWriter& writer) {
  for (; number >= 0x80; number >>= 7) writer.put(static_cast<std::uint8_t>(number | 0x80));
  writer.put(static_cast<std::uint8_t>(number));
}

/// @return nullopt for more than 56 bits, and past the end
std::optional<std::uint64_t> get_number(base::ByteReader& reader) {
  std::uint64_t number = 0;
  for (unsigned shift = 0; shift < 56; shift += 7) {
    const auto byte = reader.get<std::uint8_t>();
    if (!reader.good()) return std::nullopt;
    number |= std::uint64_t{byte & 0x7Fu} << shift;
    if (byte < 0x80) return number;
  }
  return std::nullopt;
}

/// Reads a count of rows of at least `least` bytes each, and reserves them.
template <class Row>
std::optional<std::uint64_t> get_count(base::ByteReader& reader, std::size_t least, std::vector<Row>& rows) {
  const auto count = get_number(reader);
  if (!count || *count > reader.left() / least) return std::nullopt;
  rows.reserve(*count);
  return count;
}

bool read_cells(base::ByteReader& reader, const maps::GridGeometry& geometry, control::MapChanges& out) {
  const std::int64_t columns = maps::columns(geometry), cells = columns * maps::rows(geometry);
  std::int64_t key = 0;
  const auto count = get_count(reader, 1, out.cells);
  for (std::uint64_t i = 0; count && i < *count; ++i) {
    const auto word = get_number(reader);
    if (!word) return false;
    key += from_zigzag(*word >> 1);
    if (key < 0 || key >= cells) return false;
    out.cells.push_back({{key % columns, key / columns}, (*word & 1) != 0 ? maps::Cell::occupied : maps::Cell::free});
  }
  return count.has_value();
}

bool read_points(base::ByteReader& reader, control::MapChanges& out) {
  const auto count = get_count(reader, sizeof(glm::dvec2), out.points);
  for (std::uint64_t i = 0; count && i < *count; ++i) {
    glm::dvec2& p = out.points.emplace_back();
    p.x = reader.get<double>();
    p.y = reader.get<double>();
    if (!(std::abs(p.x) <= netio::kMaxPosition && std::abs(p.y) <= netio::kMaxPosition)) return false;
  }
  return count.has_value();
}

bool read_nodes(base::ByteReader& reader, const maps::GridGeometry& geometry, control::MapChanges& out) {
  const std::int64_t nodes = kNodesPerCell * maps::columns(geometry) * maps::rows(geometry);
  std::int64_t node = 0;
  const auto count = get_count(reader, 1, out.nodes);
  for (std::uint64_t i = 0; count && i < *count; ++i) {
    const auto word = get_number(reader);
    if (!word) return false;
    node += from_zigzag(*word);
    if (node < 0 || node >= nodes) return false;
    out.nodes.push_back(static_cast<std::int32_t>(node));
  }
  return count.has_value();
}

}  // namespace

void encode_changes(const control::MapChanges& changes, const maps::GridGeometry& geometry, base::Bytes& out) {
  base::ByteWriter writer(out);
  std::int64_t before = 0;
  put_number(changes.cells.size(), writer);
  for (const auto& [at, state] : changes.cells) {
    const std::int64_t key = at.row * maps::columns(geometry) + at.column;
    put_number(zigzag(key - before) << 1 | (state == maps::Cell::occupied ? 1u : 0u), writer);
    before = key;
  }
  put_number(changes.points.size(), writer);
  for (const glm::dvec2& p : changes.points) {
    writer.put(p.x);
    writer.put(p.y);
  }
  before = 0;
  put_number(changes.nodes.size(), writer);
  for (const std::int32_t node : changes.nodes) {
    put_number(zigzag(node - before), writer);
    before = node;
  }
}

std::optional<control::MapChanges> decode_changes(std::span<const std::uint8_t> bytes,
                                                  const maps::GridGeometry& geometry) {
  base::ByteReader reader(bytes);
  control::MapChanges changes;
  const bool good = read_cells(reader, geometry, changes) && read_points(reader, changes) &&
                    read_nodes(reader, geometry, changes) && reader.left() == 0;
  return good ? std::optional(std::move(changes)) : std::nullopt;
}

}  // namespace sf::server
