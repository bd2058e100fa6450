// Checks the signatures of sensorfarm_client.c against RFC 4231, another implementation of HMAC, and the farm's window.

#define SENSORFARM_CLIENT_NO_MAIN
#include "examples/clients/sensorfarm_client.c"

static unsigned failures;
static void expect(bool fine, const char* what, unsigned row) {
  if (!fine) fprintf(stderr, "%s %u\n", what, row), ++failures;
}

static bool is_hex(const uint8_t* bytes, const char* digits) {
  char text[65];
  for (unsigned i = 0; i < 32; ++i) snprintf(text + 2 * i, 3, "%02x", bytes[i]);
  return strncmp(text, digits, strlen(digits)) == 0;
}

// RFC 4231, cases 1 to 4, 6 and 7: key and data are either a repeated byte `fill` or the text.
static void check_rfc_4231(void) {
  uint8_t rising[25], code[32], key[131], data[152];
  for (unsigned i = 0; i < 25; ++i) rising[i] = (uint8_t)(i + 1);
  sf_hmac_sha256(memset(key, 0x0b, 20), 20, (const uint8_t*)"Hi There", 8, code);
  expect(is_hex(code, "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7"), "RFC 4231, case", 1);
  sf_hmac_sha256((const uint8_t*)"Jefe", 4, (const uint8_t*)"what do ya want for nothing?", 28, code);
  expect(is_hex(code, "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843"), "RFC 4231, case", 2);
  sf_hmac_sha256(memset(key, 0xaa, 20), 20, memset(data, 0xdd, 50), 50, code);
  expect(is_hex(code, "773ea91e36800e46854db8ebd09181a72959098b3ef8c122d9635514ced565fe"), "RFC 4231, case", 3);
  sf_hmac_sha256(rising, 25, memset(data, 0xcd, 50), 50, code);
  expect(is_hex(code, "82558a389a443c0ea4cc819899f2083a85f0faa3e578f8077a2e3ff46729665b"), "RFC 4231, case", 4);
  const char* const six = "Test Using Larger Than Block-Size Key - Hash Key First";
  sf_hmac_sha256(memset(key, 0xaa, 131), 131, (const uint8_t*)six, strlen(six), code);
  expect(is_hex(code, "60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54"), "RFC 4231, case", 6);
  const char* const seven =
      "This is a test using a larger than block-size key and a larger than block-size data. The key needs to be hashed "
      "before being used by the HMAC algorithm.";
  sf_hmac_sha256(key, 131, (const uint8_t*)seven, strlen(seven), code);
  expect(is_hex(code, "9b09ffa71b942fcb27635fbcd5b0e944bfdc63644f0713938a7f51535c3a35e2"), "RFC 4231, case", 7);
}

// Keys of 0 to 199 bytes and data of 0 to 331, where each code is part of the next data: all paddings of a block. The
// last code was computed by Python's hmac.
static void check_lengths(void) {
  uint8_t key[200], data[332], code[32] = {0};
  for (unsigned i = 0; i < 200; ++i) key[i] = (uint8_t)i;
  for (unsigned n = 0; n < 300; ++n) {
    const unsigned head = n == 0 ? 0 : 32;
    memcpy(data, code, head);
    memset(data + head, (int)(n % 256), n);
    sf_hmac_sha256(key, n % 200, data, head + n, code);
  }
  expect(is_hex(code, "efb97115887e6a63d09cf561e35a5635cb5caad62026f4b80d35ddc9ef91effd"), "lengths", 0);
}

static size_t signed_leave(uint8_t* bytes, const uint8_t* key, uint64_t counter) {
  const sf_packet leave = {.type = SF_LEAVE, .robot = 7, .time_ns = INT64_C(30000000000)};
  return sf_sign(bytes, sf_encode(&leave, bytes), key, counter);
}

// Counters at the edges of the window, as in signatures.py.
static void check_window(const uint8_t* key) {
  static const struct {
    uint64_t counter;
    bool fresh;
  } rows[] = {{0, true},    {0, false},    {100, true},        {37, true},          {36, false},
              {37, false},  {101, true},   {38, true},         {37, false},         {10000, true},
              {9937, true}, {9936, false}, {UINT64_MAX, true}, {UINT64_MAX, false}, {10001, false}};
  uint8_t bytes[SF_TAG_BYTES + SF_SIGNATURE];
  sf_window window = {0};
  for (unsigned i = 0; i < sizeof rows / sizeof *rows; ++i) {
    const size_t size = signed_leave(bytes, key, rows[i].counter);
    const char* const status = sf_check_signature(&window, bytes, size, key);
    expect(rows[i].fresh ? status == NULL : status && strcmp(status, "replayed") == 0, "window, row", i);
  }
}

static void check_forgeries(const uint8_t* key) {
  uint8_t bytes[SF_TAG_BYTES + SF_SIGNATURE], other[32] = {0};
  const size_t size = signed_leave(bytes, key, 1);
  const sf_window none = {0};
  sf_window window = none;
  expect(sf_check_signature(&window, bytes, size, other) != NULL, "another key", 0);
  for (unsigned bit = 0; bit < 8 * size; ++bit) {
    bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
    expect(sf_check_signature(&window, bytes, size, key) != NULL, "flipped bit", bit);
    bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
  }
  for (size_t cut = 1; cut <= size; ++cut)
    expect(sf_check_signature(&window, bytes, size - cut, key) != NULL, "cut bytes", (unsigned)cut);
  expect(window.seen == 0 && window.newest == 0, "forgeries change the counters", 0);
  expect(sf_check_signature(&window, bytes, size, key) == NULL, "the packet itself", 0);
}

// The example of docs/packets.md.
static void check_example(const uint8_t* key) {
  static const uint8_t trailer[] = {0x00, 0x40, 0x1e, 0x18, 0x24, 0x0a, 0x06, 0x00, 0x7e, 0x68, 0x96, 0x47,
                                    0xf7, 0xa5, 0xed, 0x99, 0xd7, 0xbc, 0x55, 0x08, 0x3a, 0x61, 0x59, 0x4a};
  uint8_t bytes[SF_TAG_BYTES + SF_SIGNATURE];
  const size_t size = signed_leave(bytes, key, UINT64_C(1700000000000000));
  expect(size == SF_HEADER + SF_SIGNATURE && memcmp(bytes + SF_HEADER, trailer, sizeof trailer) == 0, "example", 0);
  sf_packet packet;
  expect(sf_decode(bytes, size, &packet) == NULL && packet.type == SF_LEAVE, "decoded example", 0);
}

int main(void) {
  uint8_t key[32];
  for (unsigned i = 0; i < 32; ++i) key[i] = (uint8_t)i;
  check_rfc_4231();
  check_lengths();
  check_window(key);
  check_forgeries(key);
  check_example(key);
  if (failures == 0) puts("sound");
  return failures == 0 ? 0 : 1;
}
