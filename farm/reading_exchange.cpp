#include "farm/reading_exchange.h"

#include <type_traits>

namespace sf::farm {

namespace {

template <class T>
void put_all(std::span<const T> row, base::ByteWriter& out) {
  out.put(static_cast<std::uint32_t>(row.size()));
  out.put_bytes(row.data(), row.size_bytes());
}

template <class T>
std::span<const T> get_all(std::vector<T>& row, base::ByteReader& in) {
  const auto said = in.get<std::uint32_t>();
  row.resize(std::min<std::size_t>(said, in.left() / sizeof(T)));
  in.get_into(row.data(), row.size() * sizeof(T));
  return row;
}

}  // namespace

void write_reading(const base::ReadingBlock& reading, base::ByteWriter& out) {
  static_assert(std::is_trivially_copyable_v<base::ReadingBlock>);
  out.put_bytes(&reading, sizeof reading);  // includes spans, whose addresses are meaningless in other processes
  put_all(reading.values, out);
  put_all(reading.hits, out);
  put_all(reading.quality, out);
}

void ReadingFromBytes::read(base::ByteReader& in) {
  in.get_into(&block, sizeof block);
  block.values = get_all(values, in);
  block.hits = get_all(hits, in);
  block.quality = get_all(quality, in);
}

}  // namespace sf::farm
