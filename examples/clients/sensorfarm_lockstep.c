// Drives robots that the farm simulates (`sensorfarm serve WORLD --lockstep`), tick by tick, in C11 and POSIX. Lost
// packets are repeated; a run has the same readings each time, bit for bit.
//
// As a program: robots 1 to 5 drive forward and turn away from nearby obstacles.
//
//   cc -std=c11 -O2 -ffp-contract=off -o sensorfarm_lockstep sensorfarm_lockstep.c -lm
//   ./sensorfarm_lockstep --robots 1-5 --farm 127.0.0.1:9000 --ticks 600
//
// As a library: with -DSENSORFARM_LOCKSTEP_NO_MAIN. Each client is single-threaded. Robots with a key need the client
// in Python; the one in C has no HMAC.

#define SENSORFARM_CLIENT_NO_MAIN
#include "sensorfarm_client.c"

enum { SF_WINDOW = 64, SF_PUSHED = 64 };  // datagrams of a FETCH; datagrams of an answer that arrive without a FETCH

typedef struct {
  uint8_t type;  // of the sensor
  uint16_t sensor;
  uint64_t tick;    // when it arrived
  int64_t time_ns;  // of the measurement
  unsigned total;   // number of values
  double pose[4];   // of the sensor: x, y, z [m], yaw [rad] in the world frame
  double* values;   // row by row; INFINITY: no return
  double error;     // largest error of the first column of all rows; INFINITY: no bound is stated
  bool unsure;      // the type's bound does not hold for all rows: noise, a bend, beams that graze or were not cast
} sf_reading;

typedef struct {
  uint16_t id;
  bool subscribed, commanded;
  double pose[4], velocity[3], command[3];  // x, y, z, yaw; forward, left, turn
  double tilt[2];                           // roll, pitch [rad]
  bool contact;
  unsigned count;  // number of readings: the newest of each sensor
  sf_reading readings[SF_MAX_SENSORS];
} sf_robot;

typedef struct {
  sf_client link;
  unsigned count;    // number of robots
  sf_robot* robots;  // by id
  uint32_t types;    // bit k: sensors of type k; 0: all
  uint64_t tick, wanted;
  int64_t time_ns;   // simulated
  bool driver_lost;  // the farm has dropped another process: from then on runs may differ
  double patience;   // [s] maximum silence of the farm
  // The answer of `tick`.
  unsigned char* parts;  // 1: has arrived
  unsigned datagrams, missing, asked, room;
} sf_lockstep;

static sf_robot* sf_find_robot(sf_lockstep* l, unsigned id) {
  unsigned first = 0, end = l->count;
  while (first < end) {
    const unsigned middle = (first + end) / 2;
    if (l->robots[middle].id < id)
      first = middle + 1;
    else
      end = middle;
  }
  return first < l->count && l->robots[first].id == id ? &l->robots[first] : NULL;
}

// Returns the newest reading of a sensor; NULL before the first.
const sf_reading* sf_find_reading(const sf_robot* robot, uint8_t type, uint16_t sensor) {
  for (unsigned i = 0; i < robot->count; ++i)
    if (robot->readings[i].type == type && robot->readings[i].sensor == sensor) return &robot->readings[i];
  return NULL;
}

static void post(sf_lockstep* l, sf_packet* p) {
  uint8_t bytes[SF_MAX_DATAGRAM];
  p->session = l->link.session;
  p->token = l->link.token;
  const size_t size = p->type >= SF_COMMAND ? sf_encode_lockstep(p, bytes) : sf_encode(p, bytes);
  const struct sockaddr* const farm = (const struct sockaddr*)&l->link.farm;
  if (size == 0 || sendto(l->link.polled[0].fd, bytes, size, 0, farm, sizeof l->link.farm) < 0)
    count_status(&l->link, "not sent");
}

static void post_fetch(sf_lockstep* l, unsigned first, unsigned count) {
  post(l, &(sf_packet){.type = SF_FETCH, .robot = l->robots[0].id, .tick = l->tick, .words = {first, count}});
}

// Sends the new commands, and the request for more ticks.
static void post_step(sf_lockstep* l, unsigned ticks) {
  static _Thread_local sf_packet command;
  unsigned commands = 0;
  command = (sf_packet){.type = SF_COMMAND, .tick = l->tick};
  for (unsigned i = 0; i <= l->count; ++i) {
    if (command.count == 4 * SF_MAX_COMMANDS || (i == l->count && command.count > 0)) {
      post(l, &command);
      command.count = 0;
    }
    if (i == l->count || !l->robots[i].commanded) continue;
    if (command.count == 0) command.robot = l->robots[i].id;
    command.values[command.count++] = l->robots[i].id;
    for (unsigned k = 0; k < 3; ++k) command.values[command.count++] = l->robots[i].command[k];
    ++commands;
  }
  post(l, &(sf_packet){.type = SF_STEP, .robot = l->robots[0].id, .tick = l->tick, .words = {ticks, commands}});
}

static void place_values(sf_robot* robot, const sf_packet* p) {
  sf_reading* reading = (sf_reading*)sf_find_reading(robot, (uint8_t)p->words[2], p->sensor);
  if (!reading) {
    if (robot->count == SF_MAX_SENSORS) return;
    reading = &robot->readings[robot->count++];
    *reading = (sf_reading){.type = (uint8_t)p->words[2], .sensor = p->sensor};
  }
  if (reading->total != p->words[3]) {
    double* const values = realloc(reading->values, p->words[3] * sizeof *values);
    if (!values) return;
    reading->values = values;
    reading->total = p->words[3];
  }
  reading->tick = p->tick;
  reading->time_ns = p->time_ns;
  reading->error = p->error;
  reading->unsure = p->unsure;
  memcpy(reading->pose, p->sensor_pose, sizeof reading->pose);
  memcpy(reading->values + p->words[4], p->values, p->count * sizeof *p->values);
}

// Stores one datagram of an answer, once.
static void place(sf_lockstep* l, const sf_packet* p) {
  sf_robot* const robot = sf_find_robot(l, p->robot);
  if (p->type == SF_STATE && robot && !robot->subscribed) {
    robot->subscribed = true;
    l->wanted = p->tick;
  }
  if (p->tick != l->wanted) return;
  if (l->tick != p->tick || l->datagrams != p->words[1]) {
    if (p->words[1] > l->room) {
      unsigned char* const parts = realloc(l->parts, p->words[1]);
      if (!parts) return;
      l->parts = parts;
      l->room = p->words[1];
    }
    l->tick = p->tick;
    l->datagrams = l->missing = p->words[1];
    l->asked = SF_PUSHED;
    memset(l->parts, 0, l->datagrams);
  }
  if (l->parts[p->words[0]]) return;
  l->parts[p->words[0]] = 1;
  --l->missing;
  if (!robot) return;
  if (p->type == SF_VALUES) {
    place_values(robot, p);
    return;
  }
  memcpy(robot->pose, p->values, sizeof robot->pose);
  memcpy(robot->velocity, p->values + 4, sizeof robot->velocity);
  memcpy(robot->tilt, p->tilt, sizeof robot->tilt);
  robot->contact = p->words[2];
  l->driver_lost = p->words[3];
  l->time_ns = p->time_ns;
}

// Receives all waiting packets. Returns whether any packet of the farm arrived.
static bool receive_all(sf_lockstep* l, double timeout) {
  static _Thread_local sf_packet packet;
  bool came = false;
  poll(l->link.polled, 1, (int)ceil(1e3 * timeout));
  while (true) {
    uint8_t bytes[2048];
    struct sockaddr_in from = {0};
    socklen_t length = sizeof from;
    const ssize_t size =
        recvfrom(l->link.polled[0].fd, bytes, sizeof bytes, MSG_DONTWAIT, (struct sockaddr*)&from, &length);
    if (size < 0) return came;
    const char* status = "wrong source";
    if (from.sin_addr.s_addr == l->link.farm.sin_addr.s_addr && from.sin_port == l->link.farm.sin_port)
      status = sf_decode(bytes, (size_t)size, &packet);
    if (!status && packet.token == l->link.session && packet.type == SF_REFUSAL) status = refusal_text(&packet);
    const bool challenge = packet.type == SF_CHALLENGE;
    if (!status && (packet.token != l->link.session || (!challenge && packet.session != l->link.farm_session)))
      status = "wrong source";
    if (!status && !challenge && packet.type != SF_STATE && packet.type != SF_VALUES) status = "wrong direction";
    count_status(&l->link, status ? status : "accepted");
    if (status) continue;
    came = true;
    if (challenge) {
      l->link.token = packet.words[0];
      l->link.farm_session = packet.session;
    } else {
      place(l, &packet);
    }
  }
}

static void fetch_ahead(sf_lockstep* l) {
  const unsigned have = l->datagrams - l->missing;
  for (; l->tick == l->wanted && l->asked < l->datagrams && have + SF_WINDOW / 2 >= l->asked; l->asked += SF_WINDOW)
    post_fetch(l, l->asked, SF_WINDOW);
}

// Waits until the answer of the requested tick is complete. Returns false after `patience` without a packet of the
// farm.
static bool await_answer(sf_lockstep* l, unsigned ticks) {
  double wait = 0.02, heard = now_s();
  while (l->tick != l->wanted || l->datagrams == 0 || l->missing > 0) {
    if (receive_all(l, wait)) {
      wait = 0.02;
      heard = now_s();
      fetch_ahead(l);
      continue;
    }
    if (now_s() - heard > l->patience) return false;
    wait = fmin(2 * wait, 0.5);
    unsigned first = 0;
    while (l->tick == l->wanted && first < l->datagrams && l->parts[first]) ++first;
    if (l->tick == l->wanted)
      post_fetch(l, first, SF_WINDOW);
    else
      post_step(l, ticks);
  }
  return true;
}

// Subscribes robots `first` to `last` to sensors of `types` (bit k: type k; 0: all). Returns false if no farm in
// lockstep answers within `patience` [s]. Call sf_lockstep_close in either case.
bool sf_lockstep_open(sf_lockstep* l, unsigned first, unsigned last, const char* host, const char* port, uint32_t types,
                      double patience) {
  memset(l, 0, sizeof *l);
  l->types = types;
  l->patience = patience;
  l->robots = last < first ? NULL : calloc(last - first + 1, sizeof *l->robots);
  if (!l->robots || !sf_open(&l->link, (uint16_t)first, host, port, false)) return false;
  const int buffer = 1 << 22;  // [byte]; the system may grant less
  setsockopt(l->link.polled[0].fd, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
  l->count = last - first + 1;
  for (unsigned i = 0; i < l->count; ++i) l->robots[i].id = (uint16_t)(first + i);
  double heard = now_s();
  for (uint32_t round = 0;; ++round) {
    unsigned asked = 0;
    for (unsigned i = 0; i < l->count && asked < SF_WINDOW; ++i) {
      if (l->robots[i].subscribed) continue;
      ++asked;
      post(l, &(sf_packet){.type = SF_SUBSCRIBE, .robot = l->robots[i].id, .sequence = round, .words = {types}});
    }
    if (asked == 0) break;
    if (receive_all(l, 0.02)) heard = now_s();
    if (now_s() - heard > patience) return false;
  }
  l->tick = l->wanted;
  l->datagrams = 0;
  post_fetch(l, 0, SF_PUSHED);
  return await_answer(l, 1);
}

// Sets the command of a robot from now on: forward, left [m/s], turn [rad/s]. Returns false for a robot of another
// process.
bool sf_lockstep_command(sf_lockstep* l, unsigned id, double forward, double left, double turn) {
  sf_robot* const robot = sf_find_robot(l, id);
  if (!robot) return false;
  robot->commanded = true;
  robot->command[0] = forward, robot->command[1] = left, robot->command[2] = turn;
  return true;
}

// Simulates 1 to 1000 ticks; robots without a new command continue as before. Returns false if the farm is silent.
bool sf_lockstep_step(sf_lockstep* l, unsigned ticks) {
  l->wanted = l->tick + ticks;
  post_step(l, ticks);
  const bool answered = await_answer(l, ticks);
  for (unsigned i = 0; i < l->count; ++i) l->robots[i].commanded = false;
  return answered;
}

void sf_lockstep_close(sf_lockstep* l) {
  for (unsigned i = 0; i < l->count; ++i) {
    post(l, &(sf_packet){.type = SF_LEAVE, .robot = l->robots[i].id});
    for (unsigned k = 0; k < l->robots[i].count; ++k) free(l->robots[i].readings[k].values);
  }
  if (l->link.sockets > 0) close(l->link.polled[0].fd);
  free(l->robots);
  free(l->parts);
}

#ifndef SENSORFARM_LOCKSTEP_NO_MAIN

static int refuse(const char* text, const char* about) {
  fprintf(stderr, "sensorfarm_lockstep: %s%s\n", text, about);
  return 2;
}

// Drives forward, and away from nearby obstacles: the left half of a scan comes last.
static void avoid(sf_lockstep* l, const sf_robot* robot, const sf_reading* scan) {
  double nearest = scan->values[0];
  for (unsigned i = 1; i < scan->total; ++i) nearest = scan->values[i] < nearest ? scan->values[i] : nearest;
  const double turn = 0.125 * (scan->values[scan->total - 1] - scan->values[0]);
  sf_lockstep_command(l, robot->id, 0.25 * (nearest < 2.0 ? nearest : 2.0), 0, nearest < 0.6 ? 1.0 : turn);
}

int main(int argc, char** argv) {
  static sf_lockstep l;
  const char* const names[] = {"--robots", "--farm", "--ticks", "--timeout"};
  const char* values[] = {"", "127.0.0.1:9000", "600", "10"};
  for (int i = 1; i < argc; i += 2) {
    unsigned k = 0;
    while (k < 4 && strcmp(argv[i], names[k]) != 0) ++k;
    if (k == 4 || i + 1 == argc)
      return refuse("--robots FIRST-LAST [--farm HOST:PORT] [--ticks N] [--timeout S]; not ", argv[i]);
    values[k] = argv[i + 1];
  }
  char host[256], port[6], rest;
  unsigned first = 0, last = 0, ticks = 0;
  double patience = 0;
  const int read = sscanf(values[0], "%6u-%6u%c", &first, &last, &rest);
  if (read == 1 && strchr(values[0], '-') == NULL && values[0][strspn(values[0], "0123456789")] == 0)
    last = first;
  else if (read != 2)
    return refuse("--robots takes ids such as 7 or 1-5, not ", values[0]);
  if (last < first || last > 65535) return refuse("--robots takes ids from 0 to 65535 in order, not ", values[0]);
  if (sscanf(values[1], "%255[^:]:%5[0-9]%c", host, port, &rest) != 2)
    return refuse("--farm takes HOST:PORT, not ", values[1]);
  if (strchr(values[2], '-') || sscanf(values[2], "%9u%c", &ticks, &rest) != 1)
    return refuse("--ticks takes a number of ticks, not ", values[2]);
  if (sscanf(values[3], "%lf%c", &patience, &rest) != 1 || !(patience > 0 && patience <= 1e6))
    return refuse("--timeout takes seconds, not ", values[3]);

  bool good = sf_lockstep_open(&l, first, last, host, port, 1u << SF_LASER, patience);
  if (!good) refuse("no farm in lockstep answers, for all of these robots, at ", values[1]);
  const double begun = now_s();
  for (unsigned tick = 0; good && tick < ticks; ++tick) {
    for (unsigned i = 0; i < l.count; ++i) {
      const sf_reading* const scan = sf_find_reading(&l.robots[i], SF_LASER, 0);
      if (scan) avoid(&l, &l.robots[i], scan);
    }
    good = sf_lockstep_step(&l, 1);
    if (!good) refuse("the farm is silent: it has ended, or left out this process; it was at ", values[1]);
  }
  const double seconds = now_s() - begun;
  for (unsigned i = 0; good && i < l.count; ++i)
    printf("robot %u at tick %llu: x = %.17g, y = %.17g, yaw = %.17g\n", l.robots[i].id, (unsigned long long)l.tick,
           l.robots[i].pose[0], l.robots[i].pose[1], l.robots[i].pose[3]);
  if (good) fprintf(stderr, "%u ticks in %.3f s: %.0f a second\n", ticks, seconds, ticks / fmax(seconds, 1e-9));
  sf_lockstep_close(&l);
  return good ? 0 : 1;
}

#endif
