// Foxglove's client: subscribes to every channel and decodes every message by the schema it comes with; then does what
// standard input asks for, a line of JSON each, and answers with a line: {"do": "counts"}, {"do": "get", "names": []},
// {"do": "set", "parameters": []}, {"do": "call", "service": "rig/reset", "request": {}}, {"do": "play", ...}.
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const readline = require("readline");
const WebSocket = require("ws");

const SUBPROTOCOLS = ["foxglove.sdk.v1", FoxgloveClient.SUPPORTED_SUBPROTOCOL];
const socket = new WebSocket(process.argv[2], SUBPROTOCOLS);
const client = new FoxgloveClient({ ws: socket });
const topics = {}; // by name: schema, count, and the last message with its time
const byChannel = new Map(); // channel -> topic
const bySubscription = new Map(); // subscription -> topic
const services = new Map(); // name -> id
const statuses = [];
const errors = [];
let server = null;
let time = null;
let advertised = 0;
let calls = 0;

const plain = (value) => JSON.parse(JSON.stringify(value, (_, v) => (typeof v === "bigint" ? `${v}` : ArrayBuffer.isView(v) ? Array.from(v) : Number.isNaN(v) ? "nan" : v)));
const print = (answer) => process.stdout.write(`${JSON.stringify(plain(answer))}\n`);

client.on("error", (error) => { // this client is older than the play bar, whose state it does not know
  if (!error.message.startsWith("Unrecognized server opcode")) errors.push(error.message);
});
client.on("close", () => process.exit(0));
client.on("serverInfo", (info) => { server = info; });
client.on("status", (status) => statuses.push(status.message));
client.on("time", (now) => { time = now.timestamp; });
client.on("advertiseServices", (offered) => offered.forEach((one) => services.set(one.name, one.id)));
client.on("advertise", (channels) => {
  for (const channel of channels) {
    advertised += 1;
    const reader = new MessageReader(parse(channel.schema, { ros2: true }));
    topics[channel.topic] ??= { type: channel.schemaName, encoding: channel.encoding, count: 0, times: [] };
    const topic = topics[channel.topic];
    byChannel.set(channel.id, channel.topic);
    bySubscription.set(client.subscribe(channel.id), { topic, reader });
  }
});
client.on("unadvertise", (ids) => ids.forEach((id) => byChannel.delete(id)));
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const { topic, reader } = bySubscription.get(subscriptionId);
  topic.last = reader.readMessage(data);
  topic.count += 1;
  topic.times.push(timestamp);
});

const once = (name) => new Promise((resolve) => {
  const listener = (answer) => { client.off(name, listener); resolve(answer); };
  client.on(name, listener);
});

async function call(name, request) {
  calls += 1;
  const data = new TextEncoder().encode(JSON.stringify(request));
  const answers = Promise.race([once("serviceCallResponse"), once("serviceCallFailure")]);
  client.sendServiceCallRequest({ serviceId: services.get(name), callId: calls, encoding: "json", data: new DataView(data.buffer) });
  const answer = await answers;
  return answer.data ? JSON.parse(new TextDecoder().decode(answer.data)) : { failed: answer.message };
}

// of the SDK's protocol: 1 byte opcode 3, command, float32 speed, has seek, uint64 seek, uint32 length and the request's id
function play({ play: plays, speed, seek }) {
  const id = new TextEncoder().encode("play");
  const bytes = new DataView(new ArrayBuffer(1 + 1 + 4 + 1 + 8 + 4 + id.length));
  bytes.setUint8(0, 3);
  bytes.setUint8(1, plays ? 0 : 1);
  bytes.setFloat32(2, speed, true);
  bytes.setUint8(6, seek === undefined ? 0 : 1);
  bytes.setBigUint64(7, BigInt(seek ?? 0), true);
  bytes.setUint32(15, id.length, true);
  new Uint8Array(bytes.buffer).set(id, 19);
  socket.send(bytes.buffer);
}

const acts = {
  counts: async () => ({ server, time, statuses, errors, advertised, channels: byChannel.size, services: [...services.keys()], topics }),
  get: async ({ names }) => { const answer = once("parameterValues"); client.getParameters(names, "get"); return (await answer).parameters; },
  set: async ({ parameters }) => { const answer = once("parameterValues"); client.setParameters(parameters, "set"); return (await answer).parameters; },
  call: async ({ service, request }) => call(service, request),
  play: async (wanted) => { play(wanted); return {}; },
};

client.on("open", () => {
  print({ open: socket.protocol });
  readline.createInterface({ input: process.stdin }).on("line", async (line) => {
    const asked = JSON.parse(line);
    print(await acts[asked.do](asked));
  }).on("close", () => client.close());
});
