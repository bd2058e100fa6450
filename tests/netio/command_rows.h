#pragma once
// Rows of COMMAND packets, which only clients write.

#include "base/bytes.h"
#include "netio/packets.h"

namespace sf::netio {

inline void add_row(const CommandRow& row, base::Bytes& rows) {
  base::ByteWriter writer(rows);
  for (const double speed : {row.twist.forward, row.twist.left, row.twist.turn}) writer.put(speed);
  writer.put(row.robot);
  writer.put(std::uint32_t{0});
}

}  // namespace sf::netio
