'use strict';
// A CANopen device of the npm package `canopen` on a CAN interface.
const { Device } = require('canopen');
const can = require('socketcan');

function connect(id, interfaceName) {
  const channel = can.createRawChannel(interfaceName);
  const device = new Device({ id });
  device.addListener('message', (message) => channel.send(message));
  channel.addListener('onMessage', (message) => device.receive(message));
  channel.start();
  return { device, channel };
}

module.exports = { connect };
