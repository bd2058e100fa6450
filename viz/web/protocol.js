// A client for Foxglove's WebSocket protocol: foxglove.sdk.v1, or foxglove.websocket.v1 without playback control.

import { readerOf } from './cdr.js';

const utf8 = new TextEncoder();

/** Events: open, close, info, channels, time, parameters, playback, status, each with its message. */
export class Connection extends EventTarget {
  #socket; #channels = new Map(); #wanted = new Map(); #subscriptions = new Map(); #services = new Map();
  #next = 1; #own = new Map(); #calls = new Map();

  constructor(url) {
    super();
    this.#socket = new WebSocket(url, ['foxglove.sdk.v1', 'foxglove.websocket.v1']);
    this.#socket.binaryType = 'arraybuffer';
    this.#socket.onopen = () => this.#tell('open');
    this.#socket.onclose = () => this.#tell('close');
    this.#socket.onmessage = ({ data }) => (typeof data === 'string' ? this.#text(JSON.parse(data)) : this.#binary(new DataView(data)));
  }

  /**
   * @param onMessage called with (message, time in s); `read: false` passes the bytes as a DataView
   * @param owner of the subscription: several may subscribe to one topic, and a later one gets the newest message at once
   */
  subscribe(topic, onMessage, { read = true, owner = 'page' } = {}) {
    if (!this.#wanted.has(topic)) this.#wanted.set(topic, { listeners: new Map(), read, id: 0, last: null });
    const { listeners, last } = this.#wanted.get(topic);
    listeners.set(owner, onMessage);
    this.#trySubscribe(topic);
    if (last) onMessage(...last);
  }
  unsubscribe(topic, owner = 'page') {
    const wish = this.#wanted.get(topic);
    wish?.listeners.delete(owner);
    if (!wish || wish.listeners.size > 0) return;
    this.#wanted.delete(topic);
    if (!wish.id) return;
    this.#subscriptions.delete(wish.id);
    this.#send({ op: 'unsubscribe', subscriptionIds: [wish.id] });
  }
  /** [name, value] pairs. */
  set(...pairs) {
    this.#send({ op: 'setParameters', parameters: pairs.map(([name, value]) => ({ name, value })) });
  }
  watchParameters() {
    this.#send({ op: 'getParameters', parameterNames: [], id: 'all' });
    this.#send({ op: 'subscribeParameterUpdates', parameterNames: [] });
  }
  call(name, request = {}) {
    const id = this.#services.get(name);
    if (id === undefined) return;
    const call = this.#next++, body = utf8.encode(JSON.stringify(request));
    const view = new DataView(new ArrayBuffer(17 + body.length));
    view.setUint8(0, 2);
    view.setUint32(1, id, true);
    view.setUint32(5, call, true);
    view.setUint32(9, 4, true);
    new Uint8Array(view.buffer).set(utf8.encode('json'), 13);
    new Uint8Array(view.buffer).set(body, 17);
    this.#socket.send(view.buffer);
  }
  /** @param bytes CDR of geometry_msgs/msg/Twist */
  drive(topic, bytes) {
    if (!this.#own.has(topic)) {
      this.#own.set(topic, this.#own.size + 1);
      this.#send({ op: 'advertise', channels: [{ id: this.#own.get(topic), topic, encoding: 'cdr', schemaName: 'geometry_msgs/msg/Twist' }] });
    }
    const view = new DataView(new ArrayBuffer(5 + bytes.length));
    view.setUint8(0, 1);
    view.setUint32(1, this.#own.get(topic), true);
    new Uint8Array(view.buffer).set(bytes, 5);
    this.#socket.send(view.buffer);
  }
  /** @param time [s] to go to, or undefined */
  play({ paused, speed, time }) {
    const id = utf8.encode('page-' + this.#next++);
    const view = new DataView(new ArrayBuffer(19 + id.length));
    view.setUint8(0, 3);
    view.setUint8(1, paused ? 1 : 0);
    view.setFloat32(2, speed, true);
    view.setUint8(6, time === undefined ? 0 : 1);
    view.setBigUint64(7, BigInt(Math.round(1e9 * (time ?? 0))), true);
    view.setUint32(15, id.length, true);
    new Uint8Array(view.buffer).set(id, 19);
    this.#socket.send(view.buffer);
  }
  close() { this.#socket.close(); }
  topics() { return [...this.#channels.keys()]; }

  #send(message) {
    if (this.#socket.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(message));
  }
  #tell(type, detail) { this.dispatchEvent(new CustomEvent(type, { detail })); }

  #trySubscribe(topic) {
    const wish = this.#wanted.get(topic), channel = this.#channels.get(topic);
    if (!wish || wish.id || !channel) return;
    wish.id = this.#next++;
    wish.reader = wish.read ? readerOf(channel.schema) : (view) => view;
    this.#subscriptions.set(wish.id, wish);
    this.#send({ op: 'subscribe', subscriptions: [{ id: wish.id, channelId: channel.id }] });
  }

  #text(message) {
    switch (message.op) {
      case 'serverInfo': this.#tell('info', message); break;
      case 'advertise':
        for (const channel of message.channels) {
          this.#channels.set(channel.topic, channel);
          this.#trySubscribe(channel.topic);
        }
        this.#tell('channels', message.channels);
        break;
      case 'advertiseServices': for (const { name, id } of message.services) this.#services.set(name, id); break;
      case 'parameterValues': this.#tell('parameters', Object.fromEntries(message.parameters.map(({ name, value }) => [name, value]))); break;
      case 'status': this.#tell('status', message); break;
      case 'serviceCallFailure': this.#tell('status', { level: 2, message: message.message }); break;
    }
  }

  #binary(view) {
    switch (view.getUint8(0)) {
      case 1: {
        const wish = this.#subscriptions.get(view.getUint32(1, true));
        if (!wish) break;
        const time = Number(view.getBigUint64(5, true)) * 1e-9;
        wish.last = [wish.reader(new DataView(view.buffer, 13)), time];
        for (const onMessage of wish.listeners.values()) onMessage(...wish.last);
        break;
      }
      case 2: this.#tell('time', Number(view.getBigUint64(1, true)) * 1e-9); break;
      case 5:
        this.#tell('playback', {
          status: ['playing', 'paused', 'buffering', 'ended'][view.getUint8(1)],
          time: Number(view.getBigUint64(2, true)) * 1e-9,
          speed: view.getFloat32(10, true),
          sought: view.getUint8(14) !== 0,
        });
        break;
    }
  }
}
