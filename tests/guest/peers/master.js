'use strict';
// A master that is not ours takes the emulated drive (node 1) from its set-up to torque and back, and checks each answer.
//   node master.js INTERFACE
const { DataType } = require('canopen');
const { connect } = require('./channel');

const drive = 1;
const { device, channel } = connect(0x64, process.argv[2]);

function require_equal(name, found, wanted) {
  if (found !== wanted) throw new Error(`${name} is ${found}, not ${wanted}`);
  console.log(`${name} = ${found}`);
}

const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));
const read = (index, dataType, subIndex = 0) => device.sdo.upload({ serverId: drive, index, subIndex, dataType });
const write = (index, data, dataType, subIndex = 0) =>
  device.sdo.download({ serverId: drive, index, subIndex, data, dataType });

async function read_identity() {
  require_equal('device type', await read(0x1000, DataType.UNSIGNED32), 0x00020192);
  const modes = await read(0x6502, DataType.UNSIGNED32);
  require_equal('cyclic synchronous torque', (modes >> 9) & 1, 1);
  // Longer than four bytes: a segmented transfer.
  require_equal('name', String(await read(0x1008, DataType.VISIBLE_STRING)), 'breakaway drive emulator');
  let code = 'an answer';
  await read(0x5FFF, DataType.UNSIGNED32).catch((error) => { code = error.code >>> 0; });
  require_equal('abort code of an object that is not there', code, 0x06020000);
}

// Statusword, position and torque on every SYNC.
async function map_feedback() {
  await write(0x1800, 0xC0000181, DataType.UNSIGNED32, 1);
  await write(0x1A00, 0, DataType.UNSIGNED8, 0);
  await write(0x1A00, 0x60410010, DataType.UNSIGNED32, 1);
  await write(0x1A00, 0x60640020, DataType.UNSIGNED32, 2);
  await write(0x1A00, 0x60770010, DataType.UNSIGNED32, 3);
  await write(0x1A00, 3, DataType.UNSIGNED8, 0);
  await write(0x1800, 1, DataType.UNSIGNED8, 2);
  await write(0x1800, 0x40000181, DataType.UNSIGNED32, 1);
}

async function walk_to_operation() {
  await write(0x6060, 10, DataType.INTEGER8);
  require_equal('mode', await read(0x6061, DataType.INTEGER8), 10);
  for (const [controlword, state] of [[0x06, 0x21], [0x07, 0x23], [0x0F, 0x27]]) {
    await write(0x6040, controlword, DataType.UNSIGNED16);
    require_equal(`state after controlword ${controlword}`, (await read(0x6041, DataType.UNSIGNED16)) & 0x6F, state);
  }
}

async function main() {
  const states = [];
  let feedback = null;
  device.nmt.addListener('heartbeat', ({ state }) => states.push(state));
  channel.addListener('onMessage', ({ id, data }) => { if (id === 0x181) feedback = data; });
  device.eds.addSdoClientParameter(drive, 0x600 + drive, 0x580 + drive);
  device.eds.addHeartbeatConsumer(drive, 300);
  device.eds.setSyncCobId(0x80);
  device.eds.setSyncGenerationEnable(true);
  device.start();
  device.nmt.startNode(device.id);

  await read_identity();
  await write(0x1017, 50, DataType.UNSIGNED16);
  await pause(120);
  await map_feedback();
  device.nmt.startNode(drive);
  await walk_to_operation();
  await write(0x6071, 100, DataType.INTEGER16);
  device.sync.write();
  await pause(20);
  device.sync.write();
  await pause(20);
  require_equal('bytes of the feedback PDO', feedback && feedback.length, 8);
  require_equal('state in it', feedback.readUInt16LE(0) & 0x6F, 0x27);
  require_equal('torque in it', feedback.readInt16LE(6), 100);

  await write(0x6040, 0x00, DataType.UNSIGNED16);
  await pause(100);
  require_equal('state after disable voltage', (await read(0x6041, DataType.UNSIGNED16)) & 0x4F, 0x40);
  device.nmt.stopNode(drive);
  await pause(200);
  require_equal('heartbeats', states.join(' '), '127 5 4');
  console.log('done');
}

main().then(() => process.exit(0), (error) => {
  console.error(error);
  process.exit(1);
});
