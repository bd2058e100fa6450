// Reads a recording with @mcap/core, by its index and front to back, and decodes every message by its schema.
// Exits with an error at the first violation.

const fs = require("fs");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { crc32 } = require("@foxglove/crc");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const { decompress } = require("fzstd");

/** Decompressors by the name in a chunk. */
const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };

const FOOTER = 1 + 8 + 8 + 8 + 4;
const MAGIC = 8;

function check(condition, message) {
  if (!condition) throw new Error(message);
}

/** Reads front to back and checks every CRC. Returns records by type and messages by topic. */
function readStream(bytes) {
  const reader = new McapStreamReader({ includeChunks: true, validateCrcs: true, decompressHandlers });
  reader.append(bytes);
  const seen = { compression: new Set(), schemas: new Map(), channels: new Map(), topics: new Map(), records: new Map(), messages: [] };
  for (let record; (record = reader.nextRecord()); ) {
    seen.records.set(record.type, (seen.records.get(record.type) ?? 0) + 1);
    if (record.type === "Schema") seen.schemas.set(record.id, record);
    if (record.type === "Channel") seen.channels.set(record.id, record);
    if (record.type === "Message") seen.messages.push(record);
    if (record.type === "DataEnd") seen.dataEnd = record;
    if (record.type === "Footer") seen.footer = record;
    if (record.type === "Chunk") seen.compression.add(record.compression || "none");
    if (record.type === "Chunk") check(record.uncompressedCrc !== 0 || record.records.length === 0, "a chunk has no CRC");
  }
  check(reader.done(), "the stream reader did not reach the end of the file");
  check(reader.bytesRemaining() === 0, `${reader.bytesRemaining()} bytes behind the end`);
  return seen;
}

/** Checks the two checksums that the stream reader does not check. */
function checkSums(bytes, seen) {
  const summaryStart = Number(seen.footer.summaryStart);
  const dataEnd = summaryStart - (1 + 8 + 4);
  check(bytes[dataEnd] === 0x0f, "no DataEnd before the summary");
  check(seen.dataEnd.dataSectionCrc === crc32(bytes.subarray(0, dataEnd)), "the data section's CRC does not fit");
  const footer = bytes.length - MAGIC - FOOTER;
  const summary = bytes.subarray(summaryStart, footer + FOOTER - 4);
  check(seen.footer.summaryCrc === crc32(summary), "the summary's CRC does not fit");
}

/** Decodes every message by the type in its schema, and checks that it consumes the whole message. */
function decodeAll(seen) {
  const readers = new Map();
  for (const schema of seen.schemas.values()) {
    check(schema.encoding === "ros2msg", `${schema.name} is described in ${schema.encoding}`);
    const definitions = parse(new TextDecoder().decode(schema.data), { ros2: true });
    readers.set(schema.id, new MessageReader(definitions));
  }
  for (const message of seen.messages) {
    const channel = seen.channels.get(message.channelId);
    check(channel.messageEncoding === "cdr", `${channel.topic} is encoded in ${channel.messageEncoding}`);
    const topic = seen.topics.get(channel.topic) ?? { type: seen.schemas.get(channel.schemaId).name, count: 0, bytes: 0 };
    topic.last = readers.get(channel.schemaId).readMessage(message.data);
    topic.count += 1;
    topic.bytes += message.data.length;
    seen.topics.set(channel.topic, topic);
  }
}

/** Checks the content of a message. */
function checkContent(seen) {
  for (const [name, topic] of seen.topics) {
    if (topic.type === "sensor_msgs/msg/LaserScan") {
      const { angle_min, angle_max, angle_increment, ranges } = topic.last;
      const last = angle_min + angle_increment * (ranges.length - 1);
      check(Math.abs(last - angle_max) < 1e-4, `${name}: the last beam is at ${last}, not ${angle_max}`);
    }
    if (topic.type === "nav_msgs/msg/Odometry" || topic.type === "tf2_msgs/msg/TFMessage") {
      const turns = topic.last.transforms?.map((t) => t.transform.rotation) ?? [topic.last.pose.pose.orientation];
      for (const { x, y, z, w } of turns) check(Math.abs(Math.hypot(x, y, z, w) - 1) < 1e-12, `${name}: no unit quaternion`);
    }
  }
  check(seen.topics.get("/run")?.count >= 1, "no /run message"); // again when robots join or shapes change
}

/** Reads by the index, as viewers do. */
async function readIndexed(bytes) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const counts = new Map();
  let previous = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const { topic } = reader.channelsById.get(message.channelId);
    check(message.logTime >= previous, `${topic} goes back in time`);
    previous = message.logTime;
    counts.set(topic, (counts.get(topic) ?? 0) + 1);
  }
  const attachments = [];
  for await (const attachment of reader.readAttachments({ validateCrcs: true })) attachments.push(attachment);
  const metadata = [];
  for await (const entry of reader.readMetadata({ name: "sensorfarm" })) metadata.push(entry);
  return { reader, counts, attachments, metadata };
}

function checkIndexed({ reader, counts, attachments, metadata }, seen) {
  check(reader.header.profile === "ros2", `profile ${reader.header.profile}`);
  check(/^sensorfarm \d+\.\d+\.\d+$/.test(reader.header.library), `library ${reader.header.library}`);
  for (const [name, topic] of seen.topics) {
    check(counts.get(name) === topic.count, `${name}: ${counts.get(name)} by the index, ${topic.count} front to back`);
  }
  check(counts.size === seen.topics.size, "the index knows other topics than the file");
  check(attachments.some((a) => a.name === "world.bin" && a.data.length > 0), "no world.bin inside");
  check(metadata.length === 1, "no metadata 'sensorfarm'");
  const { statistics } = reader;
  check(statistics.messageCount === BigInt(seen.messages.length), "the statistics count other messages");
  check(statistics.schemaCount === seen.schemas.size && statistics.channelCount === seen.channels.size, "statistics");
  check(statistics.chunkCount === seen.records.get("Chunk"), "the statistics count other chunks");
}

async function main(file) {
  const bytes = new Uint8Array(fs.readFileSync(file));
  const seen = readStream(bytes);
  checkSums(bytes, seen);
  decodeAll(seen);
  checkContent(seen);
  const indexed = await readIndexed(bytes);
  checkIndexed(indexed, seen);

  const rows = [...seen.topics].map(([name, { type, count, bytes }]) => ({ topic: name, type, messages: count, bytes }));
  console.table(rows.slice(0, 40));
  if (rows.length > 40) console.log(`... and ${rows.length - 40} more topics`);
  console.log(Object.fromEntries(indexed.metadata[0].metadata));
  console.log(`${file}: ${bytes.length} bytes, ${seen.messages.length} messages, ${seen.records.get("Chunk")} chunks (${[...seen.compression]}): sound`);
}

main(process.argv[2]).catch((error) => {
  console.error(`${process.argv[2]}: ${error.message}`);
  process.exit(1);
});
