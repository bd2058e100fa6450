// ROS 2 messages: definitions (ros2msg text) and bytes (CDR, XCDR1, either byte order).

const sizes = { bool: 1, byte: 1, char: 1, uint8: 1, int8: 1, uint16: 2, int16: 2, uint32: 4, int32: 4, float32: 4, uint64: 8, int64: 8, float64: 8 };
const arrays = { uint8: Uint8Array, byte: Uint8Array, char: Uint8Array, int8: Int8Array, uint16: Uint16Array, int16: Int16Array, uint32: Uint32Array, int32: Int32Array, float32: Float32Array, float64: Float64Array };

class Reader {
  constructor(view) {
    this.view = view;
    this.origin = 4;  // alignment counts from the end of the encapsulation header
    this.at = 4;
    this.little = view.getUint8(1) === 1;
    if (view.getUint8(0) !== 0) throw new Error('not plain CDR');
  }
  align(size) {
    const past = (this.at - this.origin) % size;
    if (past) this.at += size - past;
  }
  number(type) {
    const size = sizes[type], { view, little } = this;
    this.align(size);
    const at = this.at;
    this.at += size;
    switch (type) {
      case 'float64': return view.getFloat64(at, little);
      case 'float32': return view.getFloat32(at, little);
      case 'uint32': return view.getUint32(at, little);
      case 'int32': return view.getInt32(at, little);
      case 'bool': return view.getUint8(at) !== 0;
      case 'uint8': case 'byte': case 'char': return view.getUint8(at);
      case 'int8': return view.getInt8(at);
      case 'uint16': return view.getUint16(at, little);
      case 'int16': return view.getInt16(at, little);
      case 'uint64': return Number(view.getBigUint64(at, little));
      case 'int64': return Number(view.getBigInt64(at, little));
    }
    throw new Error('unknown type ' + type);
  }
  string() {
    const size = this.number('uint32');
    const bytes = new Uint8Array(this.view.buffer, this.view.byteOffset + this.at, Math.max(0, size - 1));
    this.at += size;
    return utf8.decode(bytes);
  }
  numbers(type, count) {
    const size = sizes[type], Made = arrays[type];
    if (count > 0) this.align(size);
    if (count * size > this.view.byteLength - this.at) throw new Error('array beyond the end');
    if (Made && this.little) {
      const begin = this.view.byteOffset + this.at;
      this.at += count * size;
      return new Made(this.view.buffer.slice(begin, begin + count * size));
    }
    return Array.from({ length: count }, () => this.number(type));
  }
}
const utf8 = new TextDecoder();

function parseFields(text) {
  const fields = [];
  for (const raw of text.split('\n')) {
    const line = raw.replace(/#.*/, '').trim();
    const match = /^([\w/]+)(<=\d+)?(\[(<=)?(\d*)\])?\s+(\w+)(\s*=.*)?/.exec(line);
    if (!match || match[7]) continue;  // empty, or a constant
    const count = match[3] ? (match[5] && !match[4] ? Number(match[5]) : -1) : 0;
    fields.push({ name: match[6], type: match[1], count });  // count 0: one value, -1: a sequence
  }
  return fields;
}

/** Returns a function that parses a message (a DataView) of this definition into an object. */
export function readerOf(schema) {
  const [root, ...rest] = schema.split(/^=+$/m);
  const types = new Map();
  for (const part of rest) {
    const match = /^\s*MSG:\s*(\S+)\s*\n([\s\S]*)$/.exec(part);
    if (match) types.set(match[1].replace('/msg/', '/'), parseFields(match[2]));
  }
  const made = new Map();
  const readOne = (type) => {
    if (type === 'string') return (reader) => reader.string();
    if (sizes[type]) return (reader) => reader.number(type);
    const name = type.replace('/msg/', '/');
    if (!made.has(name)) {
      const fields = types.get(name) ?? types.get([...types.keys()].find((key) => key.endsWith('/' + name)));
      if (!fields) throw new Error('no definition of ' + type);
      made.set(name, null);
      made.set(name, readStruct(fields));
    }
    return made.get(name);
  };
  const readField = ({ type, count }) => {
    if (count === 0) return readOne(type);
    if (sizes[type]) return (reader) => reader.numbers(type, count < 0 ? reader.number('uint32') : count);
    const one = readOne(type);
    return (reader) => {
      const length = count < 0 ? reader.number('uint32') : count;
      if (length > reader.view.byteLength) throw new Error('array beyond the end');
      const list = new Array(length);
      for (let i = 0; i < length; ++i) list[i] = one(reader);
      return list;
    };
  };
  const readStruct = (fields) => {
    const readers = fields.map((field) => [field.name, readField(field)]);
    return (reader) => {
      const value = {};
      for (let i = 0; i < readers.length; ++i) value[readers[i][0]] = readers[i][1](reader);
      return value;
    };
  };
  const read = readStruct(parseFields(root));
  return (view) => read(new Reader(view));
}

/** Serializes a planar geometry_msgs/msg/Twist. */
export function twistBytes(forward, left, turn) {
  const view = new DataView(new ArrayBuffer(4 + 48));
  view.setUint8(1, 1);
  [forward, left, 0, 0, 0, turn].forEach((value, i) => view.setFloat64(4 + 8 * i, value, true));
  return new Uint8Array(view.buffer);
}
