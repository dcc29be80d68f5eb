'use strict';
// A drive that is not ours, as far as set-up and state machine go: its axis stands on its target.
//   node slave.js INTERFACE NODE_ID
const { DataType, AccessType } = require('canopen');
const { connect } = require('./channel');

const id = Number(process.argv[3]);
const { device } = connect(id, process.argv[2]);
const { eds } = device;

function add(index, parameterName, dataType, defaultValue) {
  return eds.addEntry(index, { parameterName, dataType, accessType: AccessType.READ_WRITE, defaultValue });
}

// The states that a controlword leads to; the axis has nothing to decelerate.
function state_after(controlword) {
  if ((controlword & 0x8F) === 0x0F) return 0x0237;
  if ((controlword & 0x8F) === 0x07) return 0x0233;
  if ((controlword & 0x87) === 0x06) return 0x0231;
  return 0x0250;
}

eds.getEntry(0x1000).value = 0x00020192;
add(0x603F, 'Error code', DataType.UNSIGNED16, 0);
const controlword = add(0x6040, 'Controlword', DataType.UNSIGNED16, 0);
const statusword = add(0x6041, 'Statusword', DataType.UNSIGNED16, 0x0250);
const mode = add(0x6060, 'Mode', DataType.INTEGER8, 0);
const mode_display = add(0x6061, 'Mode display', DataType.INTEGER8, 0);
const position = add(0x6064, 'Position', DataType.INTEGER32, 0);
const target_torque = add(0x6071, 'Target torque', DataType.INTEGER16, 0);
add(0x6072, 'Max torque', DataType.UNSIGNED16, 2000);
add(0x6075, 'Rated current', DataType.UNSIGNED32, 2000);
add(0x6076, 'Rated torque', DataType.UNSIGNED32, 500);
const torque = add(0x6077, 'Torque', DataType.INTEGER16, 0);
add(0x6502, 'Supported modes', DataType.UNSIGNED32, 1 << 9);

eds.setSyncCobId(0x80);
eds.addSdoServerParameter(127, 0x580 + id, 0x600 + id);
// Not setHeartbeatProducerTime: that makes an object of 32 bits, and CiA 301 has 16.
add(0x1017, 'Producer heartbeat time', DataType.UNSIGNED16, 50);
eds.addReceivePdo({ cobId: 0x200 + id, transmissionType: 254, dataObjects: [controlword, target_torque] });
eds.addTransmitPdo({ cobId: 0x180 + id, transmissionType: 1, dataObjects: [statusword, position, torque] });

device.pdo.addListener('pdo', () => {
  const next = state_after(controlword.value);
  if (next === statusword.value) return;
  statusword.value = next;
  console.log(`controlword ${controlword.value.toString(16)}`);
});
mode.addListener('update', () => {
  mode_display.value = mode.value;
  console.log(`mode ${mode.value}`);
});
device.nmt.addListener('changeState', (state) => console.log(`NMT state ${state}`));
device.start();
console.log(`node ${id} listens`);
