'use strict';
// A CANopen tool that is not ours looks into a controller node, and sends its first axis to a target.
//   node look.js INTERFACE TARGET_COUNTS
const { DataType } = require('canopen');
const { connect } = require('./channel');

const controller = 0x7F;
const target = Number(process.argv[3]);
const { device } = connect(0x64, process.argv[2]);

function require_equal(name, found, wanted) {
  if (found !== wanted) throw new Error(`${name} is ${found}, not ${wanted}`);
  console.log(`${name} = ${found}`);
}

const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));
const read = (index, subIndex, dataType) => device.sdo.upload({ serverId: controller, index, subIndex, dataType });
const write = (index, subIndex, data, dataType) =>
  device.sdo.download({ serverId: controller, index, subIndex, data, dataType });
const refusal = (transfer) => transfer.then(() => 'none', (error) => (error.code >>> 0).toString(16));

async function read_node() {
  require_equal('name of the device', String(await read(0x1008, 0, DataType.VISIBLE_STRING)), 'breakaway');
  require_equal('error register', await read(0x1001, 0, DataType.UNSIGNED8), 0);
  require_equal('axes', await read(0x2000, 1, DataType.UNSIGNED8), 1);
  require_equal('period', await read(0x2000, 2, DataType.UNSIGNED32), 1000000);
  const steps = await read(0x2000, 3, DataType.UNSIGNED32);
  await pause(100);
  const more = (await read(0x2000, 3, DataType.UNSIGNED32)) - steps;
  require_equal('steps go on', more >= 100 && more < 1000, true);
  require_equal('missed ticks', await read(0x2000, 4, DataType.UNSIGNED32), 0);
}

async function read_axis() {
  require_equal('fault', await read(0x2101, 9, DataType.UNSIGNED8), 0);
  require_equal('its name', String(await read(0x2101, 0x0A, DataType.VISIBLE_STRING)), 'none');
  require_equal('state of the drive', (await read(0x2101, 0x0D, DataType.UNSIGNED16)) & 0x6F, 0x27);
  require_equal('force is a number', Number.isFinite(await read(0x2101, 5, DataType.REAL32)), true);
}

async function try_what_is_refused() {
  const u8 = DataType.UNSIGNED8, i32 = DataType.INTEGER32;
  require_equal('abort code of an axis that is not there', await refusal(read(0x2102, 1, u8)), '6020000');
  require_equal('of an entry that is not there', await refusal(read(0x2101, 0x20, u8)), '6090011');
  require_equal('of a fault that is written', await refusal(write(0x2101, 9, 0, u8)), '6010002');
  require_equal('of a target of one byte', await refusal(write(0x2101, 2, 0, u8)), '6070010');
  require_equal('of one beyond the limits', await refusal(write(0x2101, 2, 2000000000, i32)), '6090031');
}

async function send_to_target() {
  await write(0x2101, 2, target, DataType.INTEGER32);
  require_equal('target', await read(0x2101, 2, DataType.INTEGER32), target);
  for (let i = 0; i < 100; ++i) {
    const [mode, position] = [await read(0x2101, 7, DataType.UNSIGNED8), await read(0x2101, 3, DataType.INTEGER32)];
    if (mode === 3 && Math.abs(position - target) <= 2) return console.log('at the target');
    await pause(50);
  }
  throw new Error(`not at the target, but at ${await read(0x2101, 3, DataType.INTEGER32)}`);
}

async function main() {
  device.eds.addSdoClientParameter(controller, 0x600 + controller, 0x580 + controller);
  device.start();
  await read_node();
  await read_axis();
  await try_what_is_refused();
  await send_to_target();
  console.log('done');
}

main().then(() => process.exit(0), (error) => {
  console.error(error);
  process.exit(1);
});
