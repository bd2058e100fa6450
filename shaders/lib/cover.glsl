// Computes the effect of a scan on the cells of one word, from the strips that cross it and the ends marked by the
// host.
//
// The kernel declares the tables strips and hit_words.

struct WordUpdate {
  int word;        // in the table of all maps; -1: this lane has no work
  uint freed;      // bit 2 k of cell k
  uint occupied;   // bit 2 k of cell k
};

// Returns four bits of each of the four consecutive strips that cross a word. The strips start at `at`; the word's
// cells start at `across` within them.
uvec4 nibbles(StripTable table, int at, int across, bool inside) {
  const int first = int(table.first) + (across / SF_STRIP - int(table.chunk)) * int(table.pitch) + at - int(table.low);
  const int safe = inside ? first : 0;
  const uvec4 four = uvec4(imageLoad(strips, safe).x, imageLoad(strips, safe + 1).x, imageLoad(strips, safe + 2).x,
                           imageLoad(strips, safe + 3).x);
  return (four >> uint(across & (SF_STRIP - 1))) & 15u;
}

WordUpdate cover_word(int lane, MapBlock block, MapRow map) {
  const ivec2 at = ivec2(int(block.place & 0xFFFFu) + lane % SF_MAP_BLOCK, int(block.place >> 16));
  const bool inside = at.x < int(map.box_right);

  // Flat strips are columns: bit k is row k and moves to bit 8 k of the word. Steep strips are rows: bit k is column k
  // and moves to bit 2 k.
  const uvec4 columns = nibbles(map.flat_strips, 4 * at.x, 4 * at.y, inside);
  const uvec4 lines = nibbles(map.steep_strips, 4 * at.y, 4 * at.x, inside);
  const uvec4 down = (columns & 1u) | (columns & 2u) << 7 | (columns & 4u) << 14 | (columns & 8u) << 21;
  const uvec4 pairs = (lines | lines << 2) & 0x33u;
  const uvec4 over = (pairs | pairs << 1) & 0x55u;
  const uint freed = down.x | down.y << 2 | down.z << 4 | down.w << 6 | over.x | over.y << 8 | over.z << 16 | over.w << 24;
  return WordUpdate(inside ? int(map.words + uint(at.y) * map.word_columns) + at.x : -1, inside ? freed : 0u,
               inside ? imageLoad(hit_words, lane).x : 0u);
}
