// Read a trace with @mcap/core, by its index and as a stream, and print what is in it as one JSON object:
// per topic its schema's name, encoding and text, its message encoding, the number of messages, and the messages
// as the file's own schema has them: JSON parsed, protobuf by the descriptors in the file.
import { open } from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import zstd from "@foxglove/wasm-zstd";
import protobuf from "protobufjs";
import descriptor from "protobufjs/ext/descriptor/index.js";

await zstd.isLoaded;
const decompressHandlers = { zstd: (data, size) => zstd.decompress(data, Number(size)) };
const file = await open(process.argv[2]);
const bytes = await file.readFile();

function entry(topics, channel, schemas) {
  const schema = schemas.get(channel.schemaId);
  topics[channel.topic] ??= {
    schema: schema.name,
    schemaEncoding: schema.encoding,
    schemaBase64: Buffer.from(schema.data).toString("base64"),
    encoding: channel.messageEncoding,
    messages: 0,
    contents: [],
  };
  return topics[channel.topic];
}

const types = new Map();

// The type of a topic's messages, made of nothing but what the file says of it.
function typeOf(topic) {
  if (!types.has(topic.schema)) {
    const files = descriptor.FileDescriptorSet.decode(Buffer.from(topic.schemaBase64, "base64"));
    types.set(topic.schema, protobuf.Root.fromDescriptor(files).lookupType(topic.schema));
  }
  return types.get(topic.schema);
}

function decoded(topic, data) {
  if (topic.encoding === "json") {
    return JSON.parse(new TextDecoder().decode(data));
  }
  const type = typeOf(topic);
  return type.toObject(type.decode(data), { bytes: String, longs: Number });
}

function parsed(topic, data) {
  topic.contents.push(decoded(topic, data));
  topic.messages += 1;
}

async function byIndex() {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const topics = {};
  for (const channel of reader.channelsById.values()) {
    entry(topics, channel, reader.schemasById);
  }
  for await (const message of reader.readMessages()) {
    parsed(topics[reader.channelsById.get(message.channelId).topic], message.data);
  }
  const attachments = {};
  for await (const attachment of reader.readAttachments()) {
    attachments[attachment.name] = attachment.data.length;
  }
  return { topics, attachments };
}

function asStream() {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(bytes);
  const [schemas, channels, topics] = [new Map(), new Map(), {}];
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
    if (record.type === "Schema") {
      schemas.set(record.id, record);
    } else if (record.type === "Channel") {
      channels.set(record.id, record);
      entry(topics, record, schemas);
    } else if (record.type === "Message") {
      parsed(topics[channels.get(record.channelId).topic], record.data);
    }
  }
  return { topics, done: reader.done() };
}

console.log(JSON.stringify({ index: await byIndex(), stream: asStream() }));
await file.close();
