// SPDX-License-Identifier: BSD-3-Clause
// node mcap_read.mjs FILE.mcap: reads it with the reference reader, front to back and by its index, checks every
// checksum and that schemas are Foxglove's, and prints its messages in order of time, a JSON object a line.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import schemas from "@foxglove/schemas/jsonschema.js";

const bytes = readFileSync(process.argv[2]);
const undescribed = (o) => Array.isArray(o) ? o.map(undescribed) : o !== null && typeof o === "object"
  ? Object.fromEntries(Object.entries(o).filter(([k, v]) => !(["description", "title", "$comment"].includes(k) && typeof v === "string")).map(([k, v]) => [k, undescribed(v)])) : o;

const stream = new McapStreamReader({ validateCrcs: true });
stream.append(bytes);
let streamed = 0, statistics = null;
for (let record; (record = stream.nextRecord()); ) {
  if (record.type === "Message") ++streamed;
  if (record.type === "Statistics") statistics = record;
}
assert.ok(stream.done(), "the file ends where it should");
assert.equal(Number(statistics.messageCount), streamed);

const readable = { size: async () => BigInt(bytes.length), read: async (at, size) => bytes.subarray(Number(at), Number(at + size)) };
const reader = await McapIndexedReader.Initialize({ readable });
assert.equal(reader.channelsById.size, statistics.channelCount);
let before = 0n, indexed = 0;
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const channel = reader.channelsById.get(message.channelId), schema = reader.schemasById.get(channel.schemaId);
  const said = JSON.parse(Buffer.from(schema.data).toString());
  assert.equal(channel.messageEncoding, "json");
  assert.equal(schema.encoding, "jsonschema");
  if (schema.name.startsWith("foxglove.")) assert.deepEqual(said, undescribed(schemas[schema.name.slice(9)]), schema.name);
  assert.ok(message.logTime >= before);
  before = message.logTime;
  ++indexed;
  console.log(JSON.stringify({ topic: channel.topic, schema_name: schema.name, schema: said, time_ns: String(message.logTime), message: JSON.parse(Buffer.from(message.data).toString()) }));
}
assert.equal(indexed, streamed);
