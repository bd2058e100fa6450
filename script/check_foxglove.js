// Connects Foxglove's own client (@foxglove/ws-protocol, foxglove.websocket.v1) to a live run: topics, schemas, messages,
// time, parameters, services and commands. Exits with an error at the first violation.

const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader, MessageWriter } = require("@foxglove/rosmsg2-serialization");
const { WebSocket } = require("ws");
const { start, check, run } = require("./live_run");

/** Returns the next event of that name for which `wanted` returns true. */
function next(client, name, wanted = () => true) {
  return new Promise((resolve) => {
    const listener = (event) => {
      if (!wanted(event)) return;
      client.off(name, listener);
      resolve(event);
    };
    client.on(name, listener);
  });
}

class Reader {
  constructor(client) {
    this.client = client;
    this.channels = new Map();
    client.on("advertise", (channels) => channels.forEach((channel) => this.channels.set(channel.topic, channel)));
  }
  async next(topic, wanted = () => true) {
    const channel = this.channels.get(topic);
    check(channel, `${topic} is not advertised`);
    const reader = new MessageReader(parse(channel.schema, { ros2: true }));
    const id = this.client.subscribe(channel.id);
    let decoded;
    await next(this.client, "message", ({ subscriptionId, data }) => {
      if (subscriptionId !== id) return false;
      decoded = reader.readMessage(data);
      return wanted(decoded);
    });
    this.client.unsubscribe(id);
    return decoded;
  }
}

const twist = [
  { definitions: [{ name: "linear", type: "geometry_msgs/Vector3", isComplex: true }, { name: "angular", type: "geometry_msgs/Vector3", isComplex: true }] },
  { name: "geometry_msgs/Vector3", definitions: ["x", "y", "z"].map((name) => ({ name, type: "float64" })) },
];

async function main() {
  const server = start(process.argv[2], ["run", "worlds/cave.world", "--robots", "3", "--view", "0"]);
  const url = (await server.url).replace("http:", "ws:");
  const client = new FoxgloveClient({ ws: new WebSocket(url, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
  client.on("error", (error) => { throw error; });
  client.on("status", ({ level, message }) => check(level < 2, message));
  const reader = new Reader(client);
  const [info, services] = await Promise.all([next(client, "serverInfo"), next(client, "advertiseServices")]);
  for (const capability of ["clientPublish", "time", "parameters", "parametersSubscribe", "services"])
    check(info.capabilities.includes(capability), `no ${capability}`);

  const fleet = await reader.next("/fleet");
  check(fleet.states.length === 3, `${fleet.states.length} robots`);
  const scanned = [...reader.channels.values()].find(({ schemaName }) => schemaName === "sensor_msgs/msg/LaserScan");
  const scan = await reader.next(scanned.topic);
  check(scan.ranges.length > 1 && scan.ranges.every((range) => range > 0), "a scan without ranges");
  for (const { topic, schema } of reader.channels.values()) check(parse(schema, { ros2: true }).length > 0, `${topic}: unreadable schema`);
  await reader.next("/run");  // latched
  const first = await next(client, "time");
  const later = await next(client, "time", ({ timestamp }) => timestamp > first.timestamp);

  client.subscribeParameterUpdates(["/paused"]);
  client.setParameters([{ name: "/speed", value: 2 }], "speed");
  await next(client, "parameterValues", ({ id, parameters }) => id === "speed" && parameters[0].value === 2);
  const driven = fleet.states.length - 1;
  const name = [...reader.channels.keys()].filter((topic) => topic.endsWith("/ground_truth/odom"))[driven].replace("/ground_truth/odom", "");
  const channel = client.advertise({ topic: `${name}/cmd_vel`, encoding: "cdr", schemaName: "geometry_msgs/msg/Twist" });
  const zero = { x: 0, y: 0, z: 0 };
  client.sendMessage(channel, new MessageWriter(twist).writeMessage({ linear: zero, angular: { ...zero, z: 0.3125 } }));
  const odometry = await reader.next(`${name}/ground_truth/odom`, (odom) => Math.abs(odom.twist.twist.angular.z - 0.3125) < 1e-9);
  check(odometry.child_frame_id === `${name.slice(1)}/base_link`, odometry.child_frame_id);

  const paused = next(client, "parameterValues", ({ parameters }) => parameters.some((p) => p.name === "/paused" && p.value === true));
  const call = (service, request) => {
    const { id } = services.find((one) => one.name === service);
    client.sendServiceCallRequest({ serviceId: id, callId: 1, encoding: "json", data: new TextEncoder().encode(JSON.stringify(request)) });
    return next(client, "serviceCallResponse", ({ serviceId }) => serviceId === id);
  };
  const answer = await call("/pause", { data: true });
  check(JSON.parse(new TextDecoder().decode(answer.data)).success === true, "the pause was refused");
  await paused;
  const still = await reader.next("/fleet");
  await call("/step", {});
  const stepped = await reader.next("/fleet", ({ tick }) => tick !== still.tick);
  check(stepped.tick === still.tick + 1n, `one step went from tick ${still.tick} to ${stepped.tick}`);
  await call("/pause", { data: false });
  await call("/reset", {});
  await reader.next("/fleet", ({ tick }) => tick < still.tick);

  console.log(`${reader.channels.size} topics, ${services.length} services, time ${first.timestamp} to ${later.timestamp} ns; watched, driven, paused, stepped, reset`);
  client.close();
  const code = await server.end();
  check(code === 0, `the program ended with ${code}`);
}

run(main);
