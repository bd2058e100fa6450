// Checks sensorfarm_client.c against tests/netio/vectors: decoding gives their text, encoding their bytes.
//
//   vectors FILE...

#define SENSORFARM_CLIENT_NO_MAIN
#include "examples/clients/sensorfarm_client.c"

static void print_fields(FILE* out, const sf_packet* p, const char* prefix) {
  fprintf(out, "%stype = %u\n%srobot = %u\n%ssensor = %u\n", prefix, p->type, prefix, p->robot, prefix, p->sensor);
  fprintf(out, "%ssequence = %lu\n%stime_ns = %lld\n", prefix, (unsigned long)p->sequence, prefix,
          (long long)p->time_ns);
  fprintf(out, "%ssession = %lu\n%stoken = %lu\n", prefix, (unsigned long)p->session, prefix, (unsigned long)p->token);
  if (has_accuracy(p)) {
    fprintf(out, "mode = %u\nunsure = %u\n", p->mode, p->unsure);
    fprintf(out, isnan(p->bound) ? "bound = none\n" : "bound = %.10g\n", p->bound);
  }
  if (p->fused) fprintf(out, "fused = 1\n");
  if (p->type < 128 || p->age_us > 0) {
    fprintf(out, "age_us = %lu\nstale = %u\ncovariance =", (unsigned long)p->age_us, p->stale);
    for (unsigned i = 0; i < 6; ++i) fprintf(out, " %.10g", p->covariance[i]);
    fputc('\n', out);
  }
  sf_print_body(out, p, prefix, "\n");
  for (unsigned i = 0; p->type == SF_NEIGHBOURS && i < p->count; ++i) {
    sf_packet state;
    char inner[12];
    snprintf(inner, sizeof inner, "%u.", i);
    sf_decode(p->states + SF_V2V_BYTES * i, SF_V2V_BYTES, &state);
    print_fields(out, &state, inner);
  }
}

// One packet: `text` as in the file.
static bool judge(const char* text, const uint8_t* bytes, size_t size) {
  sf_packet packet;
  char* found = NULL;
  size_t length = 0;
  FILE* out = open_memstream(&found, &length);
  const char* const reason = sf_decode(bytes, size, &packet);
  const bool of_status = strncmp(text, "status = ", 9) == 0;
  if (of_status || reason)
    fprintf(out, "status = %s\n", reason ? reason : "accepted");
  else
    print_fields(out, &packet, "");
  fclose(out);
  bool same = strcmp(found, text) == 0;
  if (!same) printf("expected:\n%sfound:\n%s", text, found);
  free(found);
  uint8_t again[SF_MAX_DATAGRAM];
  if (same && !of_status && packet.type >= SF_V2V && (packet.type <= SF_LEAVE || packet.type == SF_OBJECT))
    same = sf_encode(&packet, again) == size && memcmp(again, bytes, size) == 0;
  if (same && !of_status && packet.type >= SF_COMMAND && packet.type <= SF_FETCH)
    same = sf_encode_lockstep(&packet, again) == size && memcmp(again, bytes, size) == 0;
  if (same && !of_status && packet.type == SF_OWN_READINGS)
    same = sf_encode_own_readings(&packet, again) == size && memcmp(again, bytes, size) == 0;
  return same;
}

static void read_hex(const char* at, uint8_t* bytes, size_t* size) {
  unsigned byte;
  for (; sscanf(at, " %2x", &byte) == 1; at += 3) bytes[(*size)++] = (uint8_t)byte;
}

/* Packet `row` of the file NAME.txt next to `path`. */
static size_t read_packet(const char* path, const char* name, unsigned row, uint8_t* bytes) {
  char other[4096], line[8192];
  snprintf(other, sizeof other, "%.*s%s.txt", (int)(strrchr(path, '/') + 1 - path), path, name);
  FILE* file = fopen(other, "r");
  size_t size = 0;
  while (file && fgets(line, sizeof line, file)) {
    if (strncmp(line, "  ", 2) == 0 && row == 0) read_hex(line + 1, bytes, &size);
    if (line[0] == '\n' && row-- == 0) break;
  }
  if (file) fclose(file);
  return size;
}

/* Applies a line of statuses.txt that edits a packet (tests/netio/vectors.h). */
static int edit(const char* path, const char* line, uint8_t* bytes, size_t* size) {
  char name[64];
  unsigned at;
  if (sscanf(line, "like = %63s %u", name, &at) == 2) {
    memset(bytes, 0, 2048);
    *size = read_packet(path, name, at, bytes);
  } else if (sscanf(line, "size = %u", &at) == 1) {
    if (at < *size) memset(bytes + at, 0, *size - at);
    *size = at;
  } else if (sscanf(line, "at %u =", &at) == 1) {
    unsigned times = 1;
    uint8_t piece[1024];
    size_t length = 0;
    read_hex(strchr(line, '=') + 1, piece, &length);
    const char* repeat = strstr(line, " x ");
    if (repeat) sscanf(repeat, " x %u", &times);
    for (; times-- > 0; at += length) memcpy(bytes + at, piece, length);
  } else {
    return 0;
  }
  return 1;
}

int main(int argc, char** argv) {
  unsigned count = 0;
  for (int i = 1; i < argc; ++i) {
    FILE* file = fopen(argv[i], "r");
    if (!file) return 2;
    char line[8192], text[16384] = "";
    uint8_t bytes[2048];
    size_t size = 0;
    while (true) {
      const bool more = fgets(line, sizeof line, file) != NULL;
      if (more && strncmp(line, "  ", 2) == 0) {
        read_hex(line + 1, bytes, &size);
      } else if (more && edit(argv[i], line, bytes, &size)) {
      } else if (more && line[0] != '#' && line[0] != '\n' && strcmp(line, "hex =\n") != 0) {
        strcat(text, line);
      } else if ((!more || line[0] == '\n') && size > 0) {
        if (!judge(text, bytes, size)) return printf("%s: packet of\n%s", argv[i], text), 1;
        ++count;
        size = 0;
        text[0] = 0;
      }
      if (!more) break;
    }
    fclose(file);
  }
  printf("%u packets\n", count);
  return 0;
}
